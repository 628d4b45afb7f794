#include "rpc_port/wire.h"

#include <array>

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/wire_format_lite.h"

namespace thunderhead::rpc_port {
namespace {

using google::protobuf::internal::WireFormatLite;

void AppendVarint(std::uint64_t value, std::string* bytes) {
  std::array<std::uint8_t, 10> varint{};
  const std::uint8_t* const end =
      google::protobuf::io::CodedOutputStream::WriteVarint64ToArray(value, varint.data());
  bytes->append(reinterpret_cast<const char*>(varint.data()),
                static_cast<std::size_t>(end - varint.data()));
}

}  // namespace

void AppendNumber(int field, std::uint64_t value, std::string* bytes) {
  AppendVarint(WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_VARINT), bytes);
  AppendVarint(value, bytes);
}

void AppendLength(int field, std::size_t size, std::string* bytes) {
  AppendVarint(WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED), bytes);
  AppendVarint(size, bytes);
}

grpc::Slice SharedSlice(const std::shared_ptr<const std::string>& bytes) {
  auto held = std::make_unique<std::shared_ptr<const std::string>>(bytes);
  // gRPC takes a pointer to mutable bytes, but does not change them.
  char* const data = const_cast<char*>(bytes->data());
  return {
      data, bytes->size(),
      [](void* user_data) { delete static_cast<std::shared_ptr<const std::string>*>(user_data); },
      held.release()};
}

grpc::ByteBuffer Joined(const std::string& prefix, const grpc::Slice& shared) {
  const std::array<grpc::Slice, 2> slices = {grpc::Slice(prefix), shared};
  return {slices.data(), slices.size()};
}

grpc::ByteBuffer Whole(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return {&slice, 1};
}

}  // namespace thunderhead::rpc_port
