// Reads a grid from the bytes of an OpenVDB file. OpenVDB does not protect itself from hostile
// files, so only a confined process may call this (vdb_reader_main.h).
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_volume.h"

namespace thunderhead::interchange {

// Registers OpenVDB's types. Must be called before the process is confined.
void PrepareVdb();

// Reads the grid named `grid` of the file with these bytes. `path` is for messages. `progress` (may
// be empty) receives the completed share, 0 to 1. Returns INVALID_ARGUMENT if there is no such
// grid, if its transform is not linear, or if the box of its active voxels has more than
// kMostVdbVoxels. Also returns INVALID_ARGUMENT if the grid is not a density: its values are not
// floats, it is a level set, or its background is not 0. The error for an empty or unknown name
// lists the file's grids. Returns DATA_LOSS if the file is damaged, and RESOURCE_EXHAUSTED if it
// needs more memory than there is.
absl::StatusOr<VdbVolume> ReadVdbGrid(const std::string& path, std::span<const std::byte> bytes,
                                      const std::string& grid,
                                      const std::function<void(double share)>& progress);

}  // namespace thunderhead::interchange
