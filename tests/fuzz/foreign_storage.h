// Changes how an HDF5 file stores its variables, in ways that netCDF-C itself never writes: types,
// layouts, filters, dataspaces, attributes and links.
#pragma once

#include <string>

#include "tests/fuzz/dice.h"

namespace thunderhead::testing {

// Changes one to three things. Use it in a process of its own, since it leaves objects of HDF5
// open. What HDF5 refuses to write stays as it was.
void ChangeStorage(Dice& dice, const std::string& path);

}  // namespace thunderhead::testing
