// The descriptors of scene.proto as protoc writes them: a serialized
// google.protobuf.FileDescriptorSet, which includes the comments.
#pragma once

#include <string_view>

namespace thunderhead::client {

std::string_view SceneDescriptors();

}  // namespace thunderhead::client
