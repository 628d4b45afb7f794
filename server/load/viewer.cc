#include "load/viewer.h"

#include "absl/strings/str_cat.h"
#include "load/response_reader.h"
#include "load/turning.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::load {

Viewer::Viewer(ViewerKind kind, const std::atomic<bool>& measuring, Errors& errors)
    : measuring_(measuring), errors_(errors) {
  record_.kind = kind;
}

void Viewer::Join(Transport& transport, const std::string& key, double kbit_per_s,
                  bool takes_video) {
  takes_video_ = takes_video;
  v1::InteractRequest request;
  request.mutable_join()->set_session_key(key);
  request.mutable_join()->set_marks_by_changes(true);
  if (takes_video) {
    request.mutable_join()->add_codecs(v1::CODEC_VP9);
    request.mutable_join()->mutable_window()->set_saves_bytes(true);
  }
  LinkOptions options;
  options.reads = kind() != ViewerKind::kStalled;
  if (kind() == ViewerKind::kThrottled) options.kbit_per_s = kbit_per_s;
  waits_since_s_ = Now_s();
  joined_at_s_ = *waits_since_s_;
  frames_before_ = frames_;
  link_ = transport.Interact(*this, options);
  link_->Send(request.SerializeAsString());
}

void Viewer::LookAround(const v1::Camera& camera) {
  own_camera_ = camera;
  v1::InteractRequest request;
  *request.mutable_detach()->mutable_camera() = camera;
  link_->Send(request.SerializeAsString());
}

void Viewer::Turn(double angle_deg) {
  load::Turn(angle_deg, own_camera_);
  v1::InteractRequest request;
  *request.mutable_move_camera()->mutable_camera() = own_camera_;
  link_->Send(request.SerializeAsString());
}

void Viewer::ComeAgain(Transport& transport, const std::string& key) {
  Stop();
  // If the call ended on its own, it has already reported its error.
  if (waits_since_s_.has_value() && !ended_)
    errors_.Add("a viewer left before it received a frame");
  ended_ = false;
  Join(transport, key, 0.0, takes_video_);
}

void Viewer::Leave() {
  leaving_ = true;
  if (kind() == ViewerKind::kHealthy || kind() == ViewerKind::kLooking) return link_->HalfClose();
  link_->Close();
  ended_ = true;
}

void Viewer::OnMessage(google::protobuf::io::ZeroCopyInputStream& message, std::size_t bytes) {
  const double now_s = Now_s();
  const bool measuring = measuring_;
  if (measuring) record_.bytes += bytes;
  const std::optional<Response> response = ReadResponse(message);
  if (!response.has_value()) return errors_.Add(kUnreadable);
  if (response->part == Response::Part::kRefused) return errors_.Add(response->refusal);
  if (response->part != Response::Part::kFrame) return;
  Acknowledge(response->sequence, response->own_view);
  // Until the viewer's own view exists, frames of the session's view may arrive. They are not
  // counted.
  if (kind() == ViewerKind::kLooking && !response->own_view) return;
  if (waits_since_s_.has_value()) {
    record_.first_frames_ms.push_back(1e3 * (now_s - *waits_since_s_));
    waits_since_s_.reset();
  }
  record_.frames.push_back({now_s, response->scene_revision});
  if (measuring) {
    ++record_.frame_count;
    ++measured_frames_;
    record_.frame_bytes += bytes;
  }
  ++frames_;
}

void Viewer::Acknowledge(std::uint64_t sequence, bool own_view) {
  v1::InteractRequest request;
  request.mutable_acknowledge()->set_sequence(sequence);
  request.mutable_acknowledge()->set_own_view(own_view);
  link_->Send(request.SerializeAsString());
}

void Viewer::OnEnd(const absl::Status& status) {
  if (!status.ok()) {
    errors_.Add(status.ToString());
  } else if (!leaving_) {
    errors_.Add("the server ended a call early, without an error");
  }
  ended_ = true;
}

}  // namespace thunderhead::load
