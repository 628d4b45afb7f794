// A viewer of a session in a load test. It joins, acknowledges each frame, and records when each
// frame arrived.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "load/recording.h"
#include "load/transport.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::load {

class Viewer final : public Listener {
 public:
  // Bytes are counted only while `measuring` is true. `measuring` and `errors` must outlive the
  // viewer.
  Viewer(ViewerKind kind, const std::atomic<bool>& measuring, Errors& errors);

  // Connects and joins. `kbit_per_s` is the rate at which the viewer reads; 0 means no limit. With
  // `takes_video` it asks for VP9.
  void Join(Transport& transport, const std::string& key, double kbit_per_s, bool takes_video);
  // Leaves the session's view for the viewer's own view, which begins with the orbit camera
  // `camera`.
  void LookAround(const v1::Camera& camera);
  // Turns the camera of the viewer's own view by an angle.
  void Turn(double angle_deg);
  // Aborts the call and joins again.
  void ComeAgain(Transport& transport, const std::string& key);
  // A healthy viewer, or a viewer who looks around, asks the server to end the call. Other viewers
  // abort it.
  void Leave();
  // Aborts the call and ends the recording.
  void Stop() { link_->Close(); }

  ViewerKind kind() const { return record_.kind; }
  bool HasFrame() const { return frames_ > 0; }
  std::uint64_t Frames() const { return frames_; }
  // Returns the number of frames received while `measuring` was true.
  std::uint64_t MeasuredFrames() const { return measured_frames_; }
  // Returns true while no frame has arrived since the last join and the call has not ended.
  bool WaitsForFirstFrame() const { return !ended_ && frames_ == frames_before_; }
  // Returns the time of the last join.
  double joined_at_s() const { return joined_at_s_; }
  bool HasEnded() const { return ended_; }
  // Returns the record. It must be called after Stop.
  const ViewerRecord& record() const { return record_; }

  void OnMessage(google::protobuf::io::ZeroCopyInputStream& message, std::size_t bytes) override;
  void OnEnd(const absl::Status& status) override;

 private:
  void Acknowledge(std::uint64_t sequence, bool own_view);

  const std::atomic<bool>& measuring_;
  Errors& errors_;
  ViewerRecord record_;
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<std::uint64_t> measured_frames_{0};
  std::uint64_t frames_before_ = 0;  // number of frames received before the last join
  double joined_at_s_ = 0.0;
  bool takes_video_ = false;
  v1::Camera own_camera_;
  std::optional<double> waits_since_s_;  // time of the join whose first frame has not arrived yet
  std::atomic<bool> leaving_{false};
  std::atomic<bool> ended_{false};
  std::unique_ptr<Link> link_;
};

}  // namespace thunderhead::load
