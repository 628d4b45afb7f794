// This example opens a session on a server, waits for its frame in full quality, and saves it as
// JPEG:
//   save_picture localhost:50051 storm.jpg
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <iostream>
#include <memory>
#include <mutex>
#include <string>

#include "thunderhead_client/connection.h"
#include "thunderhead_client/session.h"

namespace {

namespace client = thunderhead::client;
namespace v1 = thunderhead::v1;

constexpr int kUsage = 64;
constexpr int kUnavailable = 69;
constexpr int kCannotCreate = 73;
constexpr std::chrono::minutes kPatience{10};

// Returns true for a frame in full quality. On a slow machine the first frame after the camera
// stops has fewer rays, and its image_scale is below 1.
bool IsFull(const v1::Frame& frame) {
  return frame.refined() && (!frame.has_accuracy() || frame.accuracy().image_scale() >= 1.0F);
}

// A listener that keeps the JPEG of the first frame in full quality. Its methods are called on the
// session's thread.
class FirstPicture final : public client::SessionListener {
 public:
  void Changed() override {}
  void StreamBegan() override {}
  void Received(v1::Frame frame, std::size_t /*bytes*/) override {
    if (!IsFull(frame)) return;
    const std::lock_guard lock(mutex_);
    if (!jpeg_.empty()) return;
    jpeg_ = frame.jpeg();
    arrived_.notify_all();
  }
  void SceneTaken(std::uint64_t /*revision*/, std::chrono::steady_clock::time_point) override {}

  // Returns the JPEG, or an empty string if no frame arrived before the timeout.
  std::string Await() {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, kPatience, [this] { return !jpeg_.empty(); });
    return jpeg_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::string jpeg_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: save_picture HOST:PORT FILE.jpg\n";
    return kUsage;
  }
  client::ServerAccess access;
  access.address = argv[1];
  const auto connection = client::Connection::Open(access);
  if (!connection.ok()) {
    std::cerr << connection.status().message() << "\n";
    return kUsage;
  }
  client::SessionOptions options;
  options.name = "save_picture";
  options.scene.mutable_output()->set_width_px(640);
  options.scene.mutable_output()->set_height_px(400);
  // Path-traced correction is off. It would otherwise change the refined frame, and even the first
  // refined frame could contain a part of it.
  options.scene.mutable_rendering()->mutable_light_volume()->set_traced_light(v1::TRACED_LIGHT_OFF);
  FirstPicture picture;
  client::Session session(*connection, options, picture);  // joins on a separate thread
  const std::string jpeg = picture.Await();
  if (jpeg.empty()) {
    std::cerr << "no frame arrived from the server: " << session.State().reason << "\n";
    return kUnavailable;
  }
  std::ofstream file(argv[2], std::ios::binary);
  file << jpeg;
  file.close();
  if (!file) {
    std::cerr << "cannot write '" << argv[2] << "'\n";
    return kCannotCreate;
  }
  return 0;
}
