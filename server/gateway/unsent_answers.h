// The messages of calls' answers that wait for their clients to take them: how much memory they
// hold in all, and which of them makes room for others. Runs on one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <unordered_set>

#include "base/time_source.h"
#include "gateway/client_link.h"

namespace thunderhead::gateway {

class UnsentAnswers {
 public:
  // `time` must outlive this.
  UnsentAnswers(size_t max_bytes, const base::TimeSource& time)
      : max_bytes_(max_bytes), time_(time) {}
  UnsentAnswers(const UnsentAnswers&) = delete;
  UnsentAnswers& operator=(const UnsentAnswers&) = delete;

  // The place of a message to `link`'s client, given back with the last copy; null if there is
  // none. To make room, it closes the links whose clients take theirs at the lowest rate, of those
  // that have had some seconds. The place must outlive neither this nor the link.
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
