// Fuzzes scene files: Protobuf JSON, as in `--scene` and pictures.
#include <google/protobuf/util/json_util.h>

#include <cstdint>
#include <string>

#include "tests/fuzz/scene_path.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  thunderhead::v1::Scene scene;
  const std::string json(reinterpret_cast<const char*>(data), size);
  if (google::protobuf::util::JsonStringToMessage(json, &scene).ok()) {
    thunderhead::fuzz::TakeScene(scene);
  }
  return 0;
}
