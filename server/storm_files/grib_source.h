// Reads the fields of one time from GRIB files.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"
#include "storm_files/even_columns.h"
#include "storm_files/grib_layers.h"
#include "storm_files/layer_source.h"

namespace thunderhead::storm_files {

// One of the files of a storm. It is opened whenever its bytes are needed.
struct GribInput {
  std::string path;
  std::function<absl::StatusOr<std::shared_ptr<const base::ByteSource>>()> open;
};

// The contents of a storm's GRIB files, and the data needed to open them again. It does not change,
// and is safe to use from any thread.
struct GribStorm {
  std::vector<GribInput> files;
  GribIndexes indexes;    // of each file
  GribContents contents;  // refers to the indexes
  std::shared_ptr<const EvenColumns> even;
};

// Returns the values of one field. Errors name the file and the field.
absl::StatusOr<std::vector<float>> ReadGribField(const GribStorm& storm, const GribPlace& place);

// Opens a time. Errors of the source name the file, the field and its level.
absl::StatusOr<std::unique_ptr<LayerSource>> OpenGribTime(std::shared_ptr<const GribStorm> storm,
                                                          std::size_t record);

}  // namespace thunderhead::storm_files
