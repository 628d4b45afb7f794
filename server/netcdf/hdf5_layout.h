// Looks through the structure of an HDF5 file before netCDF-C opens it. HDF5 can place the values
// of a variable in other files, which would show a viewer any file that the server's user can read.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "absl/status/status.h"

namespace thunderhead::netcdf {

// HDF5's signature stands at the start of a file, or at this offset, or at a power of two times it.
inline constexpr std::size_t kFirstHdf5Offset = 512;

// Returns whether the bytes begin with HDF5's signature of eight bytes.
bool IsHdf5Signature(std::span<const std::byte> bytes);

// Return DATA_LOSS if a dataset keeps its values in other files (external storage, virtual
// datasets), if a link leads to another file or to a group that another link leads to, or if the
// structure cannot be read, and OK for a file that is not HDF5. The caller holds NetcdfLock. The
// bytes are not copied.
absl::Status CheckHdf5File(const std::string& path);
absl::Status CheckHdf5Bytes(const std::string& path, std::span<const std::byte> bytes);

}  // namespace thunderhead::netcdf
