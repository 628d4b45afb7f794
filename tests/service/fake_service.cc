#include "tests/service/fake_service.h"

#include <algorithm>
#include <utility>

#include "base/status.h"
#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {

using Stub = v1::ThunderheadService::Stub;

service::ServerOptions Patient(const base::TimeSource& time) {
  service::ServerOptions options;
  options.time = &time;
  options.shutdown_grace = kHangLimit;
  options.limits.max_render_time = kYears;
  options.limits.delivery_time = kYears;
  options.limits.join_timeout = kYears;
  options.limits.unused_connection = kYears;
  options.sessions.idle_timeout = kYears;
  options.sessions.watched_idle_timeout = kYears;
  options.sessions.roster_timeouts = {.answer = kYears,
                                      .away = kYears,
                                      .come_back = kYears,
                                      .come_back_to_new_server = kYears,
                                      .sign_of_life = kYears,
                                      .sign_of_life_in_all = kYears};
  return options;
}

FakeService::FakeService(const service::ServerOptions& options) {
  auto server = service::Server::Start(options, store, FakeFrameSources(machine));
  THUNDERHEAD_CHECK(server.ok(), server.status().ToString());
  server_ = *std::move(server);
  stub_ = v1::ThunderheadService::NewStub(server_->LocalChannel());
}

FakeService::~FakeService() {
  store->reading.Open();
  machine->drawing.Open();
  server_->Shutdown();
}

std::string FakeService::Open(const v1::Scene& scene) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = scene;
  v1::CreateSessionResponse response;
  const grpc::Status status = Call(*stub_, &Stub::CreateSession, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response.session_id();
}

std::uint64_t FakeService::Update(const std::string& session_id, const v1::Scene& scene) {
  v1::UpdateSceneRequest request;
  request.set_session_id(session_id);
  *request.mutable_scene() = scene;
  v1::UpdateSceneResponse response;
  const grpc::Status status = Call(*stub_, &Stub::UpdateScene, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response.scene_revision();
}

v1::Scene SmallScene() {
  v1::Scene scene;
  scene.mutable_output()->set_width_px(64);
  scene.mutable_output()->set_height_px(36);
  // Path tracing is on only in its own tests, so that a view at rest stays unchanged in the others.
  v1::LightVolume& light_volume = *scene.mutable_rendering()->mutable_light_volume();
  light_volume.set_slices(16);
  light_volume.set_traced_light(v1::TRACED_LIGHT_OFF);
  return scene;
}

Watcher::Watcher(Stub& stub, std::string session_id, bool acknowledges)
    : stub_(stub),
      session_id_(std::move(session_id)),
      acknowledges_(acknowledges),
      thread_([this] { Run(); }) {}

Watcher::~Watcher() {
  context_.TryCancel();
  if (thread_.joinable()) thread_.join();
}

void Watcher::Run() {
  v1::WatchFramesRequest request;
  request.set_session_id(session_id_);
  const auto reader = stub_.WatchFrames(&context_, request);
  v1::WatchFramesResponse message;
  while (reader->Read(&message)) {
    {
      const std::lock_guard lock(mutex_);
      messages_.push_back(message);
    }
    changed_.notify_all();
    if (acknowledges_ && message.has_frame()) Acknowledge(message.frame().sequence());
  }
  const grpc::Status end = reader->Finish();
  const std::lock_guard lock(mutex_);
  end_ = end;
}

bool Watcher::Await(const std::function<bool(const std::vector<v1::WatchFramesResponse>&)>& wanted,
                    std::chrono::seconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [&] { return wanted(messages_); });
}

bool Watcher::AwaitFrame(std::uint64_t revision, bool refined) {
  return Await([=](const std::vector<v1::WatchFramesResponse>& messages) {
    return std::any_of(messages.begin(), messages.end(), [=](const auto& message) {
      return message.has_frame() && message.frame().scene_revision() >= revision &&
             (message.frame().refined() || !refined);
    });
  });
}

std::vector<v1::WatchFramesResponse> Watcher::Messages() {
  const std::lock_guard lock(mutex_);
  return messages_;
}

v1::Frame Watcher::NewestFrame() {
  v1::Frame newest;
  for (const v1::WatchFramesResponse& message : Messages()) {
    if (message.has_frame()) newest = message.frame();
  }
  return newest;
}

void Watcher::Acknowledge(std::uint64_t sequence) {
  v1::AcknowledgeFrameRequest request;
  request.set_session_id(session_id_);
  request.set_viewer_id(Messages().front().viewer_id());
  request.set_sequence(sequence);
  v1::AcknowledgeFrameResponse response;
  // The session may have ended meanwhile, which is not the viewer's error.
  Call(stub_, &Stub::AcknowledgeFrame, request, &response);
}

grpc::Status Watcher::End() {
  thread_.join();
  const std::lock_guard lock(mutex_);
  return end_;
}

}  // namespace thunderhead::testing
