// The presenter of a session in a load test, who turns the camera. The presenter's window is
// hidden, so that the server sends frames only to the viewers.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "load/recording.h"
#include "load/transport.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::load {

class Presenter final : public Listener {
 public:
  // `camera` is the session's orbit camera.
  Presenter(v1::Camera camera, Errors& errors);

  void Join(Transport& transport, const std::string& key);
  // Turns the camera by an angle.
  void Turn(double angle_deg);
  void Leave();
  void Stop() { link_->Close(); }

  bool HasEnded() const { return ended_; }
  // Returns the updates that the server accepted, in the order of their revisions. It must be
  // called after Stop.
  std::vector<Update> Updates() const;

  void OnMessage(google::protobuf::io::ZeroCopyInputStream& message, std::size_t bytes) override;
  void OnEnd(const absl::Status& status) override;

 private:
  Errors& errors_;
  v1::Camera camera_;
  std::uint64_t request_count_ = 0;
  std::mutex mutex_;
  // Sending times of requests without an answer, by request id.
  std::map<std::uint64_t, double> unanswered_s_;
  std::map<std::uint64_t, double> sent_s_;  // sending times of accepted updates, by revision
  std::atomic<bool> leaving_{false};
  std::atomic<bool> ended_{false};
  std::unique_ptr<Link> link_;
};

}  // namespace thunderhead::load
