// Round-robin scheduling of drawing, so that nobody starves however often others have work. What
// many people see and what one sees for himself come in turn, so that a class that looks around
// takes at most half of the time. A plain value.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/sessions.h"

namespace thunderhead::session {

// The outcome of a turn.
struct TurnOutcome {
  bool drew = false;  // the turn is used
  std::optional<Clock::time_point> look_again_at;
  bool has_background_work = false;  // to be done in a kBackground turn
};

// Background work (traced light) is done only while there is no other work.
enum class TurnKind { kAny, kBackground };

// Background work begins only after this long without other work, so that it does not delay the
// frames of another session's moving camera.
inline constexpr Clock::duration kQuietBeforeBackground = std::chrono::milliseconds(300);

// Who may have a turn.
struct Contender {
  std::string id;
  bool own_view = false;  // of one person
};

class Turns {
 public:
  using TakeTurn = std::function<TurnOutcome(std::size_t index, TurnKind kind)>;

  // Offers a turn to each contender (sorted by id), first to those of the kind that did not use the
  // last, and of each kind starting after the one that was last served, until one uses it; then, if
  // all have been quiet, offers turns for background work. Returns when to call again without a
  // wake-up.
  std::optional<Clock::time_point> Next(const std::vector<Contender>& contenders,
                                        const TakeTurn& take_turn);

 private:
  std::vector<std::size_t> Order(const std::vector<Contender>& contenders) const;
  void Served(const Contender& contender);

  std::string last_served_;
  std::string last_own_view_served_;
  bool own_views_first_ = false;
  std::optional<Clock::time_point> last_drew_at_;  // not counting background work
};

}  // namespace thunderhead::session
