// Writes protobuf's wire format for messages that share their largest part. The shared bytes are
// serialized once, and each message gets its own short prefix.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace thunderhead::rpc_port {

// Appends a field with a number or a bool.
void AppendNumber(int field, std::uint64_t value, std::string* bytes);
// Appends the tag and length of a field with `size` bytes. The caller must append these bytes next.
void AppendLength(int field, std::size_t size, std::string* bytes);

// Returns a slice that shares the bytes without a copy and keeps them alive.
grpc::Slice SharedSlice(const std::shared_ptr<const std::string>& bytes);

// Returns the message `prefix` + `shared`.
grpc::ByteBuffer Joined(const std::string& prefix, const grpc::Slice& shared);
grpc::ByteBuffer Whole(const std::string& bytes);

}  // namespace thunderhead::rpc_port
