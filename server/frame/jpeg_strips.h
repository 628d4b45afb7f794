// Joins strips of a picture, each encoded as a separate JPEG, to one JPEG. Several processors can
// thus encode one picture. The code works on bytes and calls no codec.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::frame {

// Returns the JPEG of height `height_px` whose strips, from top to bottom, are `strips`. They must
// be baseline JPEGs without restart markers, with the same width, sampling, quality and Huffman
// tables. Every strip except the last holds `units` minimum coded units, at most 65535, which fill
// whole rows. Restart markers between the strips' data reset the prediction (ITU-T T.81, F.1.1.5
// and B.2.4.4). The picture therefore decodes as if it had been encoded whole. Returns INTERNAL if
// a strip is not such a JPEG.
absl::StatusOr<std::string> JoinJpegStrips(const std::vector<std::string>& strips, int units,
                                           int height_px);

}  // namespace thunderhead::frame
