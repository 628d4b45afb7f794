// The wire format of gRPC-Web: frames, trailers, metadata as HTTP headers, timeouts. Pure functions
// that know no socket, no call and no message type.
// https://github.com/grpc/grpc/blob/master/doc/PROTOCOL-WEB.md and PROTOCOL-HTTP2.md
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace thunderhead::gateway {

inline constexpr size_t kFrameHeaderBytes = 5;

// Names are lower case; values of names that end in "-bin" are raw bytes here and base64 on the
// wire.
using Metadata = std::vector<std::pair<std::string, std::string>>;

// True for application/grpc-web and application/grpc-web+proto, the binary kinds.
bool IsBinaryGrpcWeb(std::string_view content_type);

// True for "/package.Service/Method".
bool IsMethodPath(std::string_view path);

// The one message of a request body.
absl::StatusOr<std::string_view> TakeSingleMessage(std::string_view body);

// The header of the frame of a message of `size` bytes.
std::array<uint8_t, kFrameHeaderBytes> MessageFrameHeader(uint32_t size);

// Encoded trailers as text: a line of "name:value" for each.
std::string TrailerBlock(const Metadata& trailers);

// The last frame of a response body.
std::string TrailerFrame(const Metadata& trailers);

// The trailers of a call: grpc-status, grpc-message unless empty, then `metadata`, encoded for the
// wire.
Metadata Trailers(absl::StatusCode code, std::string_view message, const Metadata& metadata);

// `message` in the encoding of grpc-message.
std::string PercentEncode(std::string_view message);

// Parses a grpc-timeout such as "250m".
absl::StatusOr<absl::Duration> ParseTimeout(std::string_view text);

// Adds a request's header to `metadata` unless it belongs to HTTP, the browser or gRPC itself.
absl::Status AddRequestHeader(std::string_view name, std::string_view value, Metadata& metadata);

// True for response metadata that is forwarded to the browser.
bool IsForwardedToBrowser(std::string_view name);

// `value` of metadata `name` in the encoding of an HTTP header.
std::string EncodeValue(std::string_view name, std::string_view value);

}  // namespace thunderhead::gateway
