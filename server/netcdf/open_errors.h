// The errors of opening a netCDF file. Each names the file, and says what to do.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::netcdf {

// Returns whether a program that is writing the file has locked it. HDF5 locks a file that it
// writes with flock(2). Opening a locked file for reading fails with NC_EHDFERR, which netCDF-C
// also returns for any damage.
bool IsHeldByWriter(int file);
bool IsHeldByWriter(const std::string& path);

// Returns UNAVAILABLE, which says that another program is writing the file.
absl::Status HeldByWriter(const std::string& path);

// Returns the error for a code of errno or of netCDF-C. It is NOT_FOUND for ENOENT,
// PERMISSION_DENIED for EACCES, and UNAVAILABLE for EAGAIN. It is INVALID_ARGUMENT for NC_ENOTNC,
// a file of another format. It is DATA_LOSS for other codes.
absl::Status OpenError(const std::string& path, int code);

// Returns DATA_LOSS for a file of 0 bytes, which its writer may have just created.
absl::Status EmptyFile(const std::string& path);

}  // namespace thunderhead::netcdf
