// Strips of a picture, each encoded as a JPEG of its own, joined to one JPEG: several processors
// can encode one picture. Works on bytes; calls no codec.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::frame {

// The JPEG of height `height_px` whose strips, from top to bottom, are `strips`: baseline JPEGs of
// one width, sampling and quality and with the same Huffman tables, without restarts. Every strip
// but the last holds `units` minimum coded units (a whole number of their rows), at most 65535.
// Markers between the strips' data start the prediction anew (ITU-T T.81, F.1.1.5 and B.2.4.4), so
// the picture decodes as if it had been encoded whole. INTERNAL for what is no such JPEG.
absl::StatusOr<std::string> JoinJpegStrips(const std::vector<std::string>& strips, int units,
                                           int height_px);

}  // namespace thunderhead::frame
