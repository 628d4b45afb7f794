#include "runs/picture_call.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "runs/local_service.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::runs {

absl::StatusOr<v1::RenderImageResponse> CallForPicture(
    const std::shared_ptr<grpc::Channel>& channel, const v1::RenderImageRequest& request,
    const std::string& token, const std::stop_token& stop, const OnPictureProgress& progress) {
  grpc::ClientContext context;
  if (!token.empty()) context.AddMetadata("authorization", absl::StrCat("Bearer ", token));
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  const auto stub = v1::ThunderheadService::NewStub(channel);
  v1::RenderImageRequest in_chunks = request;
  in_chunks.set_in_chunks(true);
  const auto reader = stub->RenderImageWithProgress(&context, in_chunks);
  v1::RenderImageEvent event;
  v1::RenderImageResponse picture;
  std::string bytes;
  while (reader->Read(&event)) {
    if (event.has_progress() && progress) progress(event.progress());
    if (event.has_chunk()) bytes += event.chunk();
    if (event.has_image()) picture = std::move(*event.mutable_image());
  }
  // An older server sends the picture without chunks, in the last event.
  if (picture.image().empty()) picture.set_image(std::move(bytes));
  const grpc::Status status = reader->Finish();
  if (stop.stop_requested()) return absl::CancelledError("interrupted: no picture was written");
  // UNIMPLEMENTED with a message comes from a server that has the call but cannot fulfil the
  // request. Without a message, the server does not have the call.
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED && status.error_message().empty()) {
    return absl::UnimplementedError(
        "the server is older than this program and lacks the call that it needs "
        "(RenderImageWithProgress): run both in the same version");
  }
  THUNDERHEAD_RETURN_IF_ERROR(FromGrpc(status));
  return picture;
}

}  // namespace thunderhead::runs
