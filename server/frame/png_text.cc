#include "frame/png_text.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::frame {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
// Bytes of the signature and of the first chunk, IHDR. Text chunks are inserted after them.
constexpr std::size_t kHeaderBytes = 8 + 25;

// Bytes of a chunk's length and type, which are before its data, and of the checksum after it.
constexpr std::size_t kChunkHeadBytes = 8;
constexpr std::size_t kChecksumBytes = 4;

std::size_t NumberAtStart(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes.substr(0, 4)) {
    number = number << 8U | static_cast<unsigned char>(byte);
  }
  return number;
}

void AppendNumber(std::uint32_t number, std::string& bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(number >> shift));
  }
}

// Appends a text chunk (PNG specification, 11.3.3.4) without compression and without a language.
void AppendChunk(const std::string& keyword, const std::string& text, std::string& bytes) {
  std::string chunk = "iTXt" + keyword;
  chunk.append(5, '\0');
  chunk += text;
  AppendNumber(static_cast<std::uint32_t>(chunk.size() - 4), bytes);
  bytes += chunk;
  const auto* data = reinterpret_cast<const unsigned char*>(chunk.data());
  AppendNumber(static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(chunk.size()))), bytes);
}

// The bytes that libpng has not read yet, and its error message.
struct Source {
  std::string_view rest;
  std::string error;
};

void Read(png_structp png, png_bytep to, png_size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (count > source.rest.size()) png_error(png, "it is cut short");
  std::memcpy(to, source.rest.data(), count);
  source.rest.remove_prefix(count);
}

[[noreturn]] void Fail(png_structp png, png_const_charp message) {
  static_cast<Source*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void Warn(png_structp /*png*/, png_const_charp /*message*/) {}

// Reads the header up to the pixel data. Returns false after an error. The function creates no
// objects with destructors, because longjmp would skip them.
bool ReadInfo(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  return true;
}

}  // namespace

std::string WithTexts(const std::string& png, const PngTexts& texts) {
  THUNDERHEAD_CHECK(IsPng(png) && png.size() > kHeaderBytes, "no PNG");
  std::string bytes = png.substr(0, kHeaderBytes);
  for (const auto& [keyword, text] : texts) AppendChunk(keyword, text, bytes);
  return bytes.append(png, kHeaderBytes);
}

bool IsPng(const std::string& bytes) { return bytes.starts_with(kSignature); }

absl::Status CheckPngChunks(std::string_view png) {
  std::string_view rest = png.substr(std::min(png.size(), kSignature.size()));
  while (rest.size() >= kChunkHeadBytes) {
    const std::size_t whole_bytes = kChunkHeadBytes + NumberAtStart(rest) + kChecksumBytes;
    const bool has_pixels = rest.substr(4, 4) == "IDAT";
    if (whole_bytes > rest.size()) {
      if (has_pixels) return absl::OkStatus();
      return absl::InvalidArgumentError("not a PNG: it is cut short");
    }
    rest.remove_prefix(whole_bytes);
  }
  return absl::OkStatus();
}

absl::StatusOr<PngTexts> TextsOf(const std::string& png_file) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckPngChunks(png_file));
  Source source{png_file, ""};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, Fail, Warn);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr)
    return absl::ResourceExhaustedError("there is not enough memory to read a PNG");
  png_set_read_fn(png, &source, Read);
  PngTexts texts;
  const bool whole = ReadInfo(png, info);
  if (whole) {
    png_textp text = nullptr;
    const int count = png_get_text(png, info, &text, nullptr);
    for (int i = 0; i < count; ++i) texts.emplace(text[i].key, text[i].text);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!whole) return absl::InvalidArgumentError(absl::StrCat("not a PNG: ", source.error));
  return texts;
}

}  // namespace thunderhead::frame
