#include "service/answer.h"

#include <utility>

#include "service/status_table.h"

namespace thunderhead::service {

void Answer::Give(absl::Status status) {
  if (status.ok()) {
    auto place = caller_->TakeAnswer();
    status = place.status();
    if (place.ok()) place_ = *std::move(place);
    delivery_.Begin(response_.ByteSizeLong());
  }
  // Errors have no message, and HTTP/2 always has room for what they do have.
  Finish(ToGrpcStatus(status));
}

}  // namespace thunderhead::service
