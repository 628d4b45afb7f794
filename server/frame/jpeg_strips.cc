#include "frame/jpeg_strips.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::frame {
namespace {

constexpr unsigned char kMarker = 0xFF;
constexpr unsigned char kStartOfFrame = 0xC0;  // baseline
constexpr unsigned char kFirstRestart = 0xD0;
constexpr int kRestarts = 8;
constexpr unsigned char kEndOfImage = 0xD9;
constexpr unsigned char kStartOfScan = 0xDA;
constexpr unsigned char kRestartInterval = 0xDD;
constexpr std::size_t kMarkerBytes = 2;

unsigned char ByteAt(std::string_view jpeg, std::size_t at) {
  return static_cast<unsigned char>(jpeg[at]);
}

// Offsets in the bytes of a JPEG with one scan.
struct Layout {
  std::size_t frame_height = 0;  // offset of the picture's height, which has two bytes
  std::size_t scan_header = 0;
  std::size_t scan_data = 0;
  std::size_t end = 0;  // end of the scan's data
};

std::optional<Layout> LayoutOf(std::string_view jpeg) {
  Layout layout;
  std::size_t at = kMarkerBytes;  // begins after the start-of-image marker
  while (at + 2 * kMarkerBytes <= jpeg.size() && ByteAt(jpeg, at) == kMarker) {
    const unsigned char kind = ByteAt(jpeg, at + 1);
    const std::size_t length = ByteAt(jpeg, at + 2) * std::size_t{256} + ByteAt(jpeg, at + 3);
    // The height follows the marker, the length and the bits per sample.
    if (kind == kStartOfFrame) layout.frame_height = at + 5;
    if (kind == kStartOfScan) {
      layout.scan_header = at;
      layout.scan_data = at + kMarkerBytes + length;
      layout.end = jpeg.size() - kMarkerBytes;
      const bool is_whole = layout.frame_height != 0 && layout.scan_data <= layout.end &&
                            ByteAt(jpeg, layout.end) == kMarker &&
                            ByteAt(jpeg, layout.end + 1) == kEndOfImage;
      return is_whole ? std::optional(layout) : std::nullopt;
    }
    at += kMarkerBytes + length;
  }
  return std::nullopt;
}

void AppendMarker(unsigned char kind, std::string* to) {
  to->push_back(static_cast<char>(kMarker));
  to->push_back(static_cast<char>(kind));
}

void AppendNumber(int value, std::string* to) {
  to->push_back(static_cast<char>(value >> 8));
  to->push_back(static_cast<char>(value & 0xFF));
}

}  // namespace

absl::StatusOr<std::string> JoinJpegStrips(const std::vector<std::string>& strips, int units,
                                           int height_px) {
  std::string joined;
  std::size_t bytes = 16;
  for (const std::string& strip : strips) bytes += strip.size();
  joined.reserve(bytes);
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const std::string& strip = strips[i];
    const std::optional<Layout> layout = LayoutOf(strip);
    if (!layout.has_value()) {
      return absl::InternalError(
          absl::StrCat("strip ", i, " of the picture is not a baseline JPEG with one scan"));
    }
    if (i == 0) {
      joined.append(strip, 0, layout->scan_header);
      joined[layout->frame_height] = static_cast<char>(height_px >> 8);
      joined[layout->frame_height + 1] = static_cast<char>(height_px & 0xFF);
      AppendMarker(kRestartInterval, &joined);
      AppendNumber(4, &joined);  // length of the segment
      AppendNumber(units, &joined);
      joined.append(strip, layout->scan_header, layout->scan_data - layout->scan_header);
    } else {
      const int restart = static_cast<int>((i - 1) % kRestarts);
      AppendMarker(static_cast<unsigned char>(kFirstRestart + restart), &joined);
    }
    joined.append(strip, layout->scan_data, layout->end - layout->scan_data);
  }
  AppendMarker(kEndOfImage, &joined);
  return joined;
}

}  // namespace thunderhead::frame
