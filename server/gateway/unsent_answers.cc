#include "gateway/unsent_answers.h"

#include <chrono>
#include <cstdint>
#include <utility>

namespace thunderhead::gateway {
namespace {

using Clock = ClientLink::Clock;

// A client that has had less time than this to receive its message is not disconnected to free
// memory for others.
constexpr std::chrono::seconds kFairTime{5};

}  // namespace

struct UnsentAnswers::Answer {
  ClientLink& link;
  size_t bytes;  // 0 once the link was closed to free memory for others
  Clock::time_point since;
  uint64_t sent_before = link.SentBytes();

  bool CanBeSpared(Clock::time_point now) const { return bytes > 0 && now - since > kFairTime; }
  double BytesPerSecond(Clock::time_point now) const {
    return static_cast<double>(link.SentBytes() - sent_before) /
           std::chrono::duration<double>(now - since).count();
  }
};

std::shared_ptr<const void> UnsentAnswers::Take(ClientLink& link, size_t bytes) {
  if (bytes > max_bytes_ - bytes_ && !MakeRoom(bytes)) return nullptr;
  auto* const answer = new Answer{link, bytes, time_.Now()};
  bytes_ += bytes;
  answers_.insert(answer);
  return {answer, [this](Answer* ended) {
            bytes_ -= ended->bytes;
            answers_.erase(ended);
            delete ended;
          }};
}

bool UnsentAnswers::MakeRoom(size_t bytes) {
  const auto now = time_.Now();
  size_t spared = 0;
  for (const Answer* answer : answers_) spared += answer->CanBeSpared(now) ? answer->bytes : 0;
  // No client is disconnected if this would not free enough memory.
  if (bytes > max_bytes_ - bytes_ + spared) return false;
  while (bytes > max_bytes_ - bytes_) {
    Answer* slowest = nullptr;
    for (Answer* answer : answers_) {
      if (!answer->CanBeSpared(now)) continue;
      if (slowest == nullptr || answer->BytesPerSecond(now) < slowest->BytesPerSecond(now)) {
        slowest = answer;
      }
    }
    bytes_ -= std::exchange(slowest->bytes, 0);
    slowest->link.Close();
  }
  return true;
}

}  // namespace thunderhead::gateway
