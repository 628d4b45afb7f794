// The description of scene.proto by protoc, comments included: a serialized
// google.protobuf.FileDescriptorSet.
#pragma once

#include <string_view>

namespace thunderhead::client {

std::string_view SceneDescriptors();

}  // namespace thunderhead::client
