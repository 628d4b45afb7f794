#include "rpc_port/answer.h"

#include <utility>

#include "rpc_port/status_table.h"

namespace thunderhead::rpc_port {

std::size_t UnreadBytes(const google::protobuf::Message& message) {
  return message.SpaceUsedLong() + message.ByteSizeLong();
}

void Answer::Give(absl::Status status) {
  if (status.ok()) {
    auto place = caller_->TakeAnswer(UnreadBytes(response_));
    status = place.status();
    if (place.ok()) place_ = *std::move(place);
    delivery_.Begin(response_.ByteSizeLong());
  }
  // An error needs no deadline: it sends no message, and HTTP/2 flow control does not delay
  // trailers.
  Finish(ToGrpcStatus(status));
}

}  // namespace thunderhead::rpc_port
