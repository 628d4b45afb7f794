// A source that has only those columns of another source that a window of the storm needs.
#pragma once

#include <memory>

#include "storm_files/layer_source.h"
#include "storm_files/record_part.h"

namespace thunderhead::storm_files {

// Returns a source of the columns in `window`, which must be within the storm's columns. The
// other source is read as a whole, one array after another, and must outlive the returned source.
//
// Its values are those of the whole domain, with three exceptions. The mean wind is that of the
// window's columns. Turbulence that follows from the wind differs at the edges of the window, where
// the neighbouring columns are missing. Resampled fields are not scaled to keep the domain's sum.
std::unique_ptr<LayerSource> MakeWindowedSource(LayerSource& whole, const ColumnWindow& window);

}  // namespace thunderhead::storm_files
