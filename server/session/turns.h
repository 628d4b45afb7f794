// Whose turn it is to have something drawn. Goes round all who may want it, so that nobody starves,
// however often others have work. A plain value.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/sessions.h"

namespace thunderhead::session {

// The outcome of somebody's turn.
struct TurnOutcome {
  bool drew = false;  // the turn is used
  std::optional<Clock::time_point> look_again_at;
};

class Turns {
 public:
  // Offers a turn to each of `ids`, which are sorted, from the one after the last that used it,
  // until one uses it. `take_turn` gets an index. Returns when to look again without being woken.
  std::optional<Clock::time_point> Next(const std::vector<std::string>& ids,
                                        const std::function<TurnOutcome(std::size_t)>& take_turn);

 private:
  std::string last_served_;
};

}  // namespace thunderhead::session
