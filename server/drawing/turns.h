// The order of drawing: deficit round robin in ms. There are three classes: pictures that people
// wait for, refinement while they look, and pictures outside sessions, in this order. The later
// classes get a tenth of the time even if the earlier ones always have work, so that they finish.
//
// Within a class all contenders get the same time, whatever the length of their pieces. A newcomer
// inherits the overuse of one that left, so that leaving and coming back gains nothing. Shared
// views and own views each form a group with half of the time. So a class of pupils who look around
// takes at most half.
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

// Minimum share of a class, relative to the time that the classes before it use.
inline constexpr double kMinShare = 0.1;

// A session or lane that may get a turn.
struct Contender {
  std::string id;
  bool own_view = false;          // view of one person
  std::optional<TurnClass> work;  // pending work, if any
};

class Turns {
 public:
  // Returns the index of the contender that draws next; none if no contender has work. Among
  // contenders with the same used time, it is the one whose id follows that of the last served.
  std::optional<std::size_t> Next(const std::vector<Contender>& contenders);

  // Charges the contender for the time that it has drawn.
  void Used(const Contender& contender, double milliseconds);

 private:
  // Time used beyond the share of the contender that used least; zero or negative.
  using Balances = std::map<std::string, double>;
  // A group of a class: all shared views, or all own views.
  struct Group {
    Balances balances;
    std::vector<double> left_behind;  // negative balances of contenders that left
    std::string last_served;
  };

  static void Leave(const std::set<std::string>& present, Group* group);
  // Returns which of `waiting` has the next turn.
  static std::string NextOf(const std::set<std::string>& waiting, Group* group);
  std::optional<TurnClass> ClassNow(const std::vector<Contender>& contenders);

  std::map<std::string, Group> groups_;
  Balances group_balances_;
  std::string last_group_;
  // Time that a class may use before the earlier classes.
  std::array<double, kTurnClasses> owed_ms_{};
};

}  // namespace thunderhead::drawing
