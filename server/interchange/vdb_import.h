// Turns a grid of an OpenVDB file into a storm of extinction. The file names neither its units nor
// which axis is up, so the caller gives them.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_volume.h"
#include "storm_files/cf_writer.h"

namespace thunderhead::interchange {

// The axis of the file's world that is up. The axes are turned and never mirrored.
enum class UpAxis {
  kX,  // y is east, and z is north
  kY,  // x is east, and -z is north
  kZ   // x is east, and y is north
};

struct ImportOptions {
  UpAxis up = UpAxis::kZ;
  double metres_per_unit = 1.0;   // length of a unit of the file's world
  double extinction_per_m = 1.0;  // extinction (1/m) of a voxel with the value 1
  std::optional<double> base_m;   // height of the lowest face of the active voxels; without
                                  // it heights are those of the file
};

// Returns the extinction on a regular grid with z up and distances in metres. The position that the
// file gives to a voxel is the voxel's centre. Returns INVALID_ARGUMENT if the grid's axes are
// rotated or sheared, if it reaches below height 0, or if it lies too far from the origin. Also
// returns INVALID_ARGUMENT if its voxels are too small or large for a storm, if a value is negative
// or not finite, or if all values are 0.
absl::StatusOr<storm_files::CfCloud> CloudOf(const VdbVolume& volume, const ImportOptions& options);

}  // namespace thunderhead::interchange
