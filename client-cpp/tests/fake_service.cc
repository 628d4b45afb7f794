#include "client-cpp/tests/fake_service.h"

#include "absl/strings/str_cat.h"

namespace thunderhead::client::testing {

struct FakeService::Call {
  Stream* stream = nullptr;
  grpc::ServerContext* context = nullptr;
  grpc::Status end;
  std::mutex writing;

  void Write(const v1::InteractResponse& response) {
    const std::lock_guard lock(writing);
    stream->Write(response);
  }
};

FakeService::FakeService() { Start(); }

FakeService::~FakeService() { Stop(); }

void FakeService::Start() {
  grpc::ServerBuilder builder;
  builder.AddListeningPort(absl::StrCat("127.0.0.1:", port_), grpc::InsecureServerCredentials(),
                           &port_);
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
}

void FakeService::Stop() {
  if (server_ == nullptr) return;
  server_->Shutdown(std::chrono::system_clock::now());
  server_.reset();
}

std::shared_ptr<const Connection> FakeService::Connect() const {
  return *Connection::Open({absl::StrCat("127.0.0.1:", port_), "", ""});
}

bool FakeService::Await(const std::function<bool(const Requests&)>& wanted) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kPatience, [&] { return wanted(requests_); });
}

FakeService::Requests FakeService::All() {
  const std::lock_guard lock(mutex_);
  return requests_;
}

std::string FakeService::authorization() {
  const std::lock_guard lock(mutex_);
  return authorization_;
}

int FakeService::opened() {
  const std::lock_guard lock(mutex_);
  return opened_;
}

int FakeService::joined() {
  const std::lock_guard lock(mutex_);
  return joined_;
}

void FakeService::Send(v1::InteractResponse response) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [this] { return call_ != nullptr; });
  if (call_ != nullptr) call_->Write(response);
}

void FakeService::SendPresence(std::uint64_t steering_viewer_id,
                               const std::vector<std::uint64_t>& others) {
  v1::InteractResponse response;
  v1::Presence& presence = *response.mutable_presence();
  std::vector<std::uint64_t> ids = {client};
  ids.insert(ids.end(), others.begin(), others.end());
  for (const std::uint64_t id : ids) {
    v1::Person& person = *presence.add_people();
    person.set_viewer_id(id);
    person.set_role(v1::ROLE_PRESENTER);
    person.set_follows(true);
  }
  presence.set_steering_viewer_id(steering_viewer_id);
  presence.mutable_rules()->set_viewers_may_mark(true);
  Send(std::move(response));
}

void FakeService::SendScene(const v1::Scene& scene, std::uint64_t revision) {
  v1::InteractResponse response;
  *response.mutable_scene()->mutable_scene() = scene;
  response.mutable_scene()->set_scene_revision(revision);
  Send(std::move(response));
}

void FakeService::EndCall(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  if (call_ == nullptr) return;
  call_->end = status;
  call_->context->TryCancel();
}

grpc::Status FakeService::CreateSession(grpc::ServerContext* /*context*/,
                                        const v1::CreateSessionRequest* request,
                                        v1::CreateSessionResponse* response) {
  if (answer_opening) {
    grpc::Status status = answer_opening(request->scene());
    if (!status.ok()) return status;
  }
  const std::lock_guard lock(mutex_);
  ++opened_;
  forgets_sessions = false;
  response->set_session_id(kPresenterKey);
  response->set_viewer_key(kViewerKey);
  *response->mutable_scene() = request->scene();
  response->set_scene_revision(1);
  if (durable.has_value()) response->set_durable(*durable);
  return grpc::Status::OK;
}

grpc::Status FakeService::GetServerInfo(grpc::ServerContext* /*context*/,
                                        const v1::GetServerInfoRequest* /*request*/,
                                        v1::GetServerInfoResponse* response) {
  response->set_version("fake");
  return grpc::Status::OK;
}

grpc::Status FakeService::DescribeStorm(grpc::ServerContext* /*context*/,
                                        const v1::DescribeStormRequest* request,
                                        v1::DescribeStormResponse* response) {
  if (answer_description) return answer_description(*request, *response);
  return {grpc::StatusCode::NOT_FOUND, "no such storm"};
}

grpc::Status FakeService::Interact(grpc::ServerContext* context, Stream* stream) {
  Call call{stream, context, {}, {}};
  {
    const std::lock_guard lock(mutex_);
    if (forgets_sessions) return {grpc::StatusCode::NOT_FOUND, "no such session"};
    const auto found = context->client_metadata().find("authorization");
    authorization_ = found == context->client_metadata().end()
                         ? ""
                         : std::string(found->second.data(), found->second.size());
  }
  v1::InteractRequest request;
  while (stream->Read(&request)) Answer(call, request);
  const std::lock_guard lock(mutex_);
  if (call_ == &call) call_ = nullptr;
  return call.end;
}

void FakeService::Answer(Call& call, const v1::InteractRequest& request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
    changed_.notify_all();
  }
  if (request.has_join()) {
    v1::InteractResponse response;
    v1::Joined& joined = *response.mutable_joined();
    joined.set_viewer_id(client);
    const bool presents = request.join().session_key() == kPresenterKey;
    joined.set_role(presents ? v1::ROLE_PRESENTER : v1::ROLE_VIEWER);
    joined.set_viewer_key(kViewerKey);
    joined.set_participant_key("participant-key");
    call.Write(response);
  }
  if (request.has_update_scene() && answers_scenes) {
    v1::InteractResponse response;
    response.mutable_scene_taken()->set_request_id(request.request_id());
    response.mutable_scene_taken()->set_scene_revision(request.update_scene().expected_revision() +
                                                       1);
    call.Write(response);
  }
  if (!request.has_join()) return;
  const std::lock_guard lock(mutex_);
  call_ = &call;
  ++joined_;
  changed_.notify_all();
}

}  // namespace thunderhead::client::testing
