// Changes to how an HDF5 file stores its variables, in ways that netCDF-C itself never writes:
// types, layouts, filters, dataspaces, attributes and links.
#pragma once

#include <string>

#include "tests/fuzz/dice.h"

namespace thunderhead::testing {

// Makes one to three changes. Use it in a separate process, because it leaves HDF5 objects open.
// Whatever HDF5 refuses to write stays unchanged.
void ChangeStorage(Dice& dice, const std::string& path);

}  // namespace thunderhead::testing
