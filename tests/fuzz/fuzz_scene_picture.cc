// Fuzzes scenes in PNGs (iTXt). The checksums of chunks are corrected first, because otherwise no
// mutation would get past them.
#include <zlib.h>

#include <cstdint>
#include <string>

#include "frame/png_text.h"
#include "service/messages/picture_texts.h"
#include "service/messages/scene_json.h"
#include "tests/fuzz/scene_path.h"

namespace {

std::uint32_t NumberAt(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

void MendChecksums(std::string& png) {
  std::size_t at = 8;
  while (at + 12 <= png.size()) {
    const std::size_t length = NumberAt(png, at);
    if (length > png.size() - at - 12) return;
    const auto* data = reinterpret_cast<const unsigned char*>(png.data()) + at + 4;
    const auto sum = static_cast<std::uint32_t>(crc32(0, data, static_cast<uInt>(length + 4)));
    for (std::size_t i = 0; i < 4; ++i) {
      png[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    }
    at += length + 12;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string png(reinterpret_cast<const char*>(data), size);
  MendChecksums(png);
  if (!thunderhead::frame::IsPng(png)) return 0;
  const auto texts = thunderhead::frame::TextsOf(png);
  if (!texts.ok()) return 0;
  const auto scene_text = texts->find(thunderhead::service::kSceneText);
  if (scene_text == texts->end()) return 0;
  const auto scene = thunderhead::service::SceneOfJson(scene_text->second);
  if (scene.ok()) thunderhead::fuzz::TakeScene(*scene);
  return 0;
}
