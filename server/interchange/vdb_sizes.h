// Checks of the sizes that an OpenVDB file states for its texts and metadata. OpenVDB allocates and
// fills the stated memory before it reads the bytes, so a file of 20 kB could make it fill 4 GiB.
// Each function checks what begins at the stream's place, and leaves the place unchanged. It throws
// std::runtime_error if a stated size is larger than the rest of the file, or differs from the
// fixed size of the value's type. It requires a stream that throws at its end.
#pragma once

#include <istream>

namespace thunderhead::interchange {

// Checks a map of metadata: names, types and values.
void CheckStatedMetadata(std::istream& in);

// Checks the texts of a grid's entry in the index of grids.
void CheckStatedEntry(std::istream& in);

// Checks the metadata of a grid and the type of its transform.
void CheckStatedGrid(std::istream& in);

}  // namespace thunderhead::interchange
