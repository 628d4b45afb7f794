// The server's storms and rendering capabilities. A separate thread requests them whenever they may
// have changed.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "thunderhead/v1/storm.pb.h"
#include "thunderhead_client/back_off.h"
#include "thunderhead_client/connection.h"

namespace thunderhead::client {

struct CatalogueState {
  std::uint64_t version = 0;  // increases with every change of this state
  v1::ListStormsResponse storms;
  v1::StormDescription storm;  // answer to the last Describe(): one storm at one of its times
  v1::GetServerInfoResponse server;
};

class Catalogue {
 public:
  // `changed` is called on the catalogue's thread after every change of the state.
  Catalogue(std::shared_ptr<const Connection> connection, std::function<void()> changed);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  // Requests the list of storms, the server's information and the last described storm again.
  // Refresh() and Describe() return at once. A request that fails because the server is busy or
  // cannot be reached is repeated later.
  void Refresh();
  // Requests the description of a storm at one of its times. Does nothing if the last request was
  // for the same description.
  void Describe(const std::string& storm_id, std::uint32_t time_index);

  CatalogueState State() const;
  std::optional<CatalogueState> StateAfter(std::uint64_t version) const;

 private:
  using StormTime = std::pair<std::string, std::uint32_t>;

  void Run();
  grpc::Status Learn();
  grpc::Status LearnStorm(const StormTime& wanted);

  const std::shared_ptr<const Connection> connection_;
  Canceller calls_;
  const std::function<void()> changed_listener_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  CatalogueState state_;
  bool refresh_ = true;
  std::optional<StormTime> wanted_;
  StormTime described_;
  bool ends_ = false;
  BackOff back_off_;
  std::thread thread_;
};

}  // namespace thunderhead::client
