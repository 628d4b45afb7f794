#include "product/logo.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "frame/png_text.h"
#include "product/cairo_surface.h"

namespace thunderhead::product {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr std::uint32_t kMaxSize_px = 4096;
// Offsets in IHDR, the first chunk of each PNG.
constexpr std::size_t kWidthAt = 16;
constexpr std::size_t kHeightAt = 20;

std::uint32_t NumberAt(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    number = number << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return number;
}

cairo_status_t Read(void* rest, unsigned char* to, unsigned int count) {
  auto& bytes = *static_cast<std::string_view*>(rest);
  if (count > bytes.size()) return CAIRO_STATUS_READ_ERROR;
  std::copy_n(bytes.begin(), count, to);
  bytes.remove_prefix(count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

absl::StatusOr<Logo> Logo::Decode(std::string_view png, const std::string& what) {
  const auto bad = [&what](const std::string& why) {
    return absl::DataLossError(absl::StrCat(what, ": ", why, "; give a PNG of at most ",
                                            kMaxSize_px, " x ", kMaxSize_px, " pixels"));
  };
  if (!png.starts_with(kSignature) || png.size() < kHeightAt + 4) return bad("is not a PNG");
  // The size is checked before Cairo allocates memory for it.
  const std::uint32_t width = NumberAt(png, kWidthAt);
  const std::uint32_t height = NumberAt(png, kHeightAt);
  if (std::max(width, height) > kMaxSize_px) {
    return bad(absl::StrCat("is ", width, " x ", height, " pixels"));
  }
  if (!frame::CheckPngChunks(png).ok()) return bad("is a damaged PNG (it is cut short)");
  std::string_view rest = png;
  CairoSurface surface(cairo_image_surface_create_from_png_stream(Read, &rest));
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    return bad(absl::StrCat("is a damaged PNG (", cairo_status_to_string(status), ")"));
  }
  return Logo(std::move(surface));
}

}  // namespace thunderhead::product
