// Fuzzes scene files: Protobuf JSON, as in `--scene` and pictures.
#include <cstdint>
#include <string>

#include "service/messages/scene_json.h"
#include "tests/fuzz/scene_path.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string json(reinterpret_cast<const char*>(data), size);
  const auto scene = thunderhead::service::SceneOfJson(json);
  if (scene.ok()) thunderhead::fuzz::TakeScene(*scene);
  return 0;
}
