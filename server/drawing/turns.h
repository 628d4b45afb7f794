// The order in which contenders (sessions and workers) draw: deficit round robin, counted in
// milliseconds. There are three classes of work, in this order: pictures that people wait for,
// refinement of shown pictures, and pictures outside sessions. Each later class gets at least a
// tenth of the time, even if the earlier classes always have work, so that its work finishes.
//
// Within a class all contenders get the same time, whatever the length of their pieces. A new
// contender inherits the overuse of one that left, so that leaving and coming back gains nothing.
// Shared views and own views are two groups that each get half of the time. Therefore, if many
// viewers of a session open own views, these views together use at most half of the time.
//
// A plain value, without a clock.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace thunderhead::drawing {

enum class TurnClass {
  kInteractive,  // a scene that has just changed
  kRefining,     // finer frames of scenes at rest, and tracing their light
  kBatch,        // pictures outside any session
};
inline constexpr std::size_t kTurnClasses = 3;

// Minimum time of a class, as a share of the time that this class and the earlier classes use
// together.
inline constexpr double kMinShare = 0.1;

// A session or worker that may get a turn.
struct Contender {
  std::string id;
  bool own_view = false;          // true for a person's own view
  std::optional<TurnClass> work;  // pending work, if any
};

class Turns {
 public:
  // Returns the index of the contender that draws next; none if no contender has work. Among
  // contenders that have used the same time, it is the next one by id after the last served.
  std::optional<std::size_t> Next(const std::vector<Contender>& contenders);

  // Charges the contender for the time that its drawing took.
  void Used(const Contender& contender, double milliseconds);

 private:
  // Time that a contender used beyond the least used time of its group, as a value of zero or
  // below.
  using Balances = std::map<std::string, double>;
  // A group of a class: all shared views, or all own views.
  struct Group {
    Balances balances;
    std::vector<double> left_behind;  // negative balances of contenders that have left
    std::string last_served;
  };

  static void Leave(const std::set<std::string>& present, Group* group);
  // Returns the id in `waiting` that has the next turn.
  static std::string NextOf(const std::set<std::string>& waiting, Group* group);
  std::optional<TurnClass> ClassNow(const std::vector<Contender>& contenders);

  std::map<std::string, Group> groups_;
  Balances group_balances_;
  std::string last_group_;
  // Time that a class may use before it is the earlier classes' turn.
  std::array<double, kTurnClasses> owed_ms_{};
};

}  // namespace thunderhead::drawing
