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
  bool has_background_work = false;  // which it may do in a turn for that
};

// Background work (traced light) is what nobody waits for: it is done while nothing else is.
enum class TurnKind { kAny, kBackground };

// Nothing else has been done for so long before background work begins, so that it does not come
// between the frames of somebody else's moving camera.
inline constexpr Clock::duration kQuietBeforeBackground = std::chrono::milliseconds(300);

class Turns {
 public:
  using TakeTurn = std::function<TurnOutcome(std::size_t index, TurnKind kind)>;

  // Offers a turn to each of `ids`, which are sorted, from the one after the last that used it,
  // until one uses it; then, if all have been quiet, turns for background work. Returns when to
  // look again without being woken.
  std::optional<Clock::time_point> Next(const std::vector<std::string>& ids,
                                        const TakeTurn& take_turn);

 private:
  std::string last_served_;
  std::optional<Clock::time_point> last_drew_at_;  // not counting background work
};

}  // namespace thunderhead::session
