// A message in gRPC's memory, as buffers from which it can be written without a copy.
#pragma once

#include <boost/asio/buffer.hpp>
#include <cstddef>
#include <vector>

#include "base/status.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/slice.h"

namespace thunderhead::gateway {

class MessageSlices {
 public:
  explicit MessageSlices(const grpc::ByteBuffer& message) : size_bytes_(message.Length()) {
    const grpc::Status dumped = message.Dump(&slices_);
    THUNDERHEAD_CHECK(dumped.ok(), dumped.error_message());
  }

  size_t SizeBytes() const { return size_bytes_; }
  // Appends the message's buffers, which are valid during the lifetime of this object.
  void AppendTo(std::vector<boost::asio::const_buffer>& buffers) const {
    for (const grpc::Slice& slice : slices_) buffers.emplace_back(slice.begin(), slice.size());
  }

 private:
  std::vector<grpc::Slice> slices_;
  size_t size_bytes_;
};

}  // namespace thunderhead::gateway
