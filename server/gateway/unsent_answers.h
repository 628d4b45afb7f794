// The response messages that wait for their clients to receive them. It limits the memory that they
// use in total, and decides which clients are disconnected to free memory. Runs on one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <unordered_set>

#include "base/time_source.h"
#include "gateway/client_link.h"

namespace thunderhead::gateway {

class UnsentAnswers {
 public:
  // `time` must outlive this object.
  UnsentAnswers(size_t max_bytes, const base::TimeSource& time)
      : max_bytes_(max_bytes), time_(time) {}
  UnsentAnswers(const UnsentAnswers&) = delete;
  UnsentAnswers& operator=(const UnsentAnswers&) = delete;

  // Reserves memory for a message to the client of `link`. The memory is released with the last
  // copy of the result. To free memory, it closes the links of the slowest clients, if they have
  // had some seconds. Returns null if there is still not enough memory. The result must not outlive
  // this object or the link.
  std::shared_ptr<const void> Take(ClientLink& link, size_t bytes);

 private:
  struct Answer;

  bool MakeRoom(size_t bytes);

  const size_t max_bytes_;
  const base::TimeSource& time_;
  size_t bytes_ = 0;
  std::unordered_set<Answer*> answers_;
};

}  // namespace thunderhead::gateway
