#include "gateway/open_links.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

// A connection that has been sent a file for less than this time is not closed for a new
// connection.
constexpr std::chrono::seconds kFairReading{5};
// Minimum time between two log lines about refusals, so that a flood cannot fill the disk.
constexpr std::chrono::seconds kTellingPause{10};

bool CanBeSpared(const ClientLink& link, ClientLink::Clock::time_point now) {
  switch (link.Use()) {
    case LinkUse::kWaiting:
    case LinkUse::kReceiving:
      return true;
    case LinkUse::kSending:
      return now - link.UsedSince() > kFairReading;
    case LinkUse::kCalling:
      return false;
  }
  return false;
}

// Ranks connections in the order in which they are closed. Connections that wait for a request or
// receive one come before connections on which a file is sent. Within each kind, the connection
// with the longest duration comes first.
auto Rank(const ClientLink& link) {
  return std::tuple(link.Use() == LinkUse::kSending, link.UsedSince());
}

}  // namespace

bool OpenLinks::MakeRoom(const ClientLink& newcomer) {
  const auto own = std::ranges::count_if(
      links_, [&](const auto& link) { return link->Network() == newcomer.Network(); });
  if (static_cast<size_t>(own) >= most_per_address_ && !proxies_.Holds(newcomer.Peer())) {
    if (CloseLeastNeeded(&newcomer.Network())) return true;
  } else if (links_.size() < most_ || CloseLeastNeeded(nullptr)) {
    return true;
  }
  TellOfRefusal(newcomer);
  return false;
}

bool OpenLinks::CloseLeastNeeded(const std::string* network) {
  const auto now = time_.Now();
  std::shared_ptr<ClientLink> least;
  for (const std::shared_ptr<ClientLink>& link : links_) {
    if (network != nullptr && link->Network() != *network) continue;
    if (CanBeSpared(*link, now) && (least == nullptr || Rank(*link) < Rank(*least))) least = link;
  }
  if (least == nullptr) return false;
  least->Close();
  // The link is removed at once, so that it is not chosen again for another new connection. Its
  // coroutine ends a little later.
  links_.erase(least);
  return true;
}

void OpenLinks::StopAll() {
  for (const std::shared_ptr<ClientLink>& link : links_) link->Stop();
}

void OpenLinks::TellOfRefusal(const ClientLink& newcomer) {
  ++untold_;
  const auto now = time_.Now();
  if (now - told_at_ < kTellingPause) return;
  spdlog::warn(
      "refused {} connections of browsers, the last from {}: {} connections are open, and one "
      "address may have {}",
      untold_, newcomer.Peer(), links_.size(), most_per_address_);
  told_at_ = now;
  untold_ = 0;
}

}  // namespace thunderhead::gateway
