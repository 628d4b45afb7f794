// Reads one time of a WRF output file, on the model's own layers. This code does not depend on
// series of files or on the cache of storms.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "storm_files/layer_source.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "storm_files/wrf_metadata.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Opens record `record` of the file that `metadata` describes.
absl::StatusOr<std::unique_ptr<LayerSource>> OpenWrfTime(
    std::shared_ptr<const WrfMetadata> metadata, std::size_t record);

// Reads the record by ReadOnHeights.
absl::StatusOr<volume::HydrometeorFields> ReadWrfTime(const WrfMetadata& metadata,
                                                      std::size_t record,
                                                      const std::optional<VerticalGrid>& grid,
                                                      const ReadCheckpoint& checkpoint);

}  // namespace thunderhead::storm_files
