// Checks the structure of an HDF5 file before netCDF-C opens it. HDF5 can store the values of a
// variable in other files. A hostile storm file could therefore show a viewer the contents of any
// file that the server may read.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "absl/status/status.h"

namespace thunderhead::netcdf {

// The smallest nonzero offset in bytes of HDF5's signature. The signature is at the start of a
// file, at this offset, or at this offset times a power of two.
inline constexpr std::size_t kFirstHdf5Offset = 512;

// Returns whether the bytes begin with HDF5's signature of eight bytes.
bool IsHdf5Signature(std::span<const std::byte> bytes);

// Both functions return DATA_LOSS in these cases:
//
// - A dataset keeps its values in other files (external storage, virtual datasets).
// - A link leads to another file, or to a group to which another link leads.
// - There are more than 10,000 objects, or groups that are more than 16 groups deep.
// - The structure cannot be read.
//
// Both functions return OK for a file that is not HDF5. The caller must hold NetcdfLock.
// CheckHdf5Bytes does not copy the bytes.
absl::Status CheckHdf5File(const std::string& path);
absl::Status CheckHdf5Bytes(const std::string& path, std::span<const std::byte> bytes);

}  // namespace thunderhead::netcdf
