// Protobuf's wire format for messages that share their largest part: the shared bytes are
// serialized once, and a few bytes before them make each message.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace thunderhead::service {

// Appends a field with a number or a truth value.
void AppendNumber(int field, std::uint64_t value, std::string* bytes);
// Appends the tag and length of a field whose `size` bytes follow.
void AppendLength(int field, std::size_t size, std::string* bytes);

// Bytes that are shared without a copy; they live as long as the slice.
grpc::Slice SharedSlice(const std::shared_ptr<const std::string>& bytes);

// The message `prefix` + `shared`.
grpc::ByteBuffer Joined(const std::string& prefix, const grpc::Slice& shared);
grpc::ByteBuffer Whole(const std::string& bytes);

}  // namespace thunderhead::service
