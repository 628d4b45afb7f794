// The wire format of gRPC-Web: frames, trailers, metadata as HTTP headers, and timeouts. The
// functions are pure, and independent of sockets, calls and message types.
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

// Pairs of name and value. Names are in lower case. Values of names that end in "-bin" are raw
// bytes here and base64 on the wire.
using Metadata = std::vector<std::pair<std::string, std::string>>;

// Returns true for application/grpc-web and application/grpc-web+proto, the binary content types.
bool IsBinaryGrpcWeb(std::string_view content_type);

// Returns true if `path` has the form "/package.Service/Method".
bool IsMethodPath(std::string_view path);

// Returns the message of a request body. Returns INVALID_ARGUMENT unless the body contains exactly
// one message, and UNIMPLEMENTED for a compressed message.
absl::StatusOr<std::string_view> TakeSingleMessage(std::string_view body);

// Returns the frame header of a message of `size` bytes.
std::array<uint8_t, kFrameHeaderBytes> MessageFrameHeader(uint32_t size);

// Returns trailers, already encoded, as text with one line "name:value" for each.
std::string TrailerBlock(const Metadata& trailers);

// Returns the last frame of a response body.
std::string TrailerFrame(const Metadata& trailers);

// Returns the trailers of a call, encoded for the wire: grpc-status, grpc-message (unless it is
// empty), and `metadata`.
Metadata Trailers(absl::StatusCode code, std::string_view message, const Metadata& metadata);

// Returns `message` in the encoding of grpc-message.
std::string PercentEncode(std::string_view message);

// Parses a grpc-timeout such as "250m". Returns INVALID_ARGUMENT for malformed text.
absl::StatusOr<absl::Duration> ParseTimeout(std::string_view text);

// Adds a header of the request to `metadata`, unless the header belongs to HTTP, the browser or
// gRPC itself. Returns INVALID_ARGUMENT for a name or a value that gRPC metadata cannot have.
absl::Status AddRequestHeader(std::string_view name, std::string_view value, Metadata& metadata);

// Returns true if response metadata of that name is forwarded to the browser.
bool IsForwardedToBrowser(std::string_view name);

// Returns `value`, the value of the metadata `name`, in the encoding of an HTTP header.
std::string EncodeValue(std::string_view name, std::string_view value);

}  // namespace thunderhead::gateway
