#include "thunderhead_client/catalogue.h"

#include <algorithm>
#include <chrono>

namespace thunderhead::client {
namespace {

using Stub = v1::ThunderheadService::Stub;

// The first description of a storm takes long because the server reads the storm's file.
constexpr std::chrono::seconds kPatience{60};

// Returns true for an error that may vanish on its own, so that the request is repeated. After
// another error, such as an unknown storm, the request is repeated only when the catalogue changes.
bool MayPass(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
    case grpc::StatusCode::ABORTED:
      return true;
    default:
      return false;
  }
}

}  // namespace

Catalogue::Catalogue(std::shared_ptr<const Connection> connection, std::function<void()> changed)
    : connection_(std::move(connection)),
      changed_listener_(std::move(changed)),
      thread_([this] { Run(); }) {}

Catalogue::~Catalogue() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  calls_.Cancel();
  changed_.notify_all();
  thread_.join();
}

void Catalogue::Refresh() {
  const std::lock_guard lock(mutex_);
  refresh_ = true;
  if (!described_.first.empty()) wanted_ = std::exchange(described_, {});
  changed_.notify_all();
}

void Catalogue::Describe(const std::string& storm_id, std::uint32_t time_index) {
  const StormTime wanted{storm_id, time_index};
  const std::lock_guard lock(mutex_);
  if (storm_id.empty() || wanted == wanted_.value_or(described_)) return;
  wanted_ = wanted;
  changed_.notify_all();
}

CatalogueState Catalogue::State() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::optional<CatalogueState> Catalogue::StateAfter(std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  if (state_.version <= version) return {};
  return state_;
}

void Catalogue::Run() {
  std::unique_lock lock(mutex_);
  const auto wakes = [this] { return ends_ || refresh_ || wanted_; };
  while (true) {
    changed_.wait(lock, wakes);
    if (ends_) return;
    const bool refresh = std::exchange(refresh_, false);
    const std::optional<StormTime> wanted = std::exchange(wanted_, std::nullopt);
    if (wanted) described_ = *wanted;
    lock.unlock();
    const grpc::Status learnt = refresh ? Learn() : grpc::Status::OK;
    const grpc::Status described = wanted ? LearnStorm(*wanted) : grpc::Status::OK;
    changed_listener_();
    lock.lock();
    if (!MayPass(learnt) && !MayPass(described)) {
      back_off_.Reset();
      continue;
    }
    const auto delay = back_off_.Next(std::max(RetryAfter(learnt), RetryAfter(described)));
    changed_.wait_for(lock, delay, wakes);
    refresh_ = refresh_ || MayPass(learnt);
    if (!wanted_ && MayPass(described)) wanted_ = wanted;
  }
}

// Requests the list of storms and the server's information. Returns an error if either failed.
grpc::Status Catalogue::Learn() {
  v1::ListStormsResponse storms;
  const grpc::Status listed =
      connection_->Call(&Stub::ListStorms, v1::ListStormsRequest(), &storms, kPatience, calls_);
  v1::GetServerInfoResponse server;
  const grpc::Status told = connection_->Call(&Stub::GetServerInfo, v1::GetServerInfoRequest(),
                                              &server, kPatience, calls_);
  const std::lock_guard lock(mutex_);
  if (listed.ok()) state_.storms = std::move(storms);
  if (told.ok()) state_.server = std::move(server);
  ++state_.version;
  return listed.ok() ? told : listed;
}

// Requests a storm's description. If the storm is not available, the last description stays, and
// the request is repeated when the catalogue changes.
grpc::Status Catalogue::LearnStorm(const StormTime& wanted) {
  v1::DescribeStormRequest request;
  request.set_storm_id(wanted.first);
  request.set_time_index(wanted.second);
  v1::DescribeStormResponse response;
  grpc::Status status =
      connection_->Call(&Stub::DescribeStorm, request, &response, kPatience, calls_);
  if (!status.ok()) return status;
  const std::lock_guard lock(mutex_);
  state_.storm = std::move(*response.mutable_storm());
  ++state_.version;
  return status;
}

}  // namespace thunderhead::client
