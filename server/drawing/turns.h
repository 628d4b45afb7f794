// The order of drawing: deficit round robin in ms. Pictures that people wait for come before what
// becomes finer while they look, and that before pictures for nobody's eyes; but the later ones get
// a tenth of the time however much the earlier have to do, so that they end. Within a class all get
// the same time, however long each one's pieces are; who comes when another has left takes over
// what that one used beyond its share, so that coming and leaving over and over gains nothing. What
// many people see and what one sees for himself count as two, so that a class of pupils who look
// around takes at most half of the time. A plain value, without a clock.
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

// Of the time that the classes before it use.
inline constexpr double kMinShare = 0.1;

// Those who may have a turn.
struct Contender {
  std::string id;
  bool own_view = false;          // of one person
  std::optional<TurnClass> work;  // that waits to be done
};

class Turns {
 public:
  // The index of who is to draw next; none if nobody has work. Among those who have had the same
  // time it is the one whose id comes after that of the last served.
  std::optional<std::size_t> Next(const std::vector<Contender>& contenders);

  // It has drawn for so long.
  void Used(const Contender& contender, double milliseconds);

 private:
  // Time that was used beyond the share of the one that used least: zero or less.
  using Balances = std::map<std::string, double>;
  // Of a class: what people see together, or what one sees for himself.
  struct Group {
    Balances balances;
    std::vector<double> left_behind;  // negative balances of those who have left
    std::string last_served;
  };

  static void Leave(const std::set<std::string>& present, Group* group);
  // Who of `waiting` has the next turn.
  static std::string NextOf(const std::set<std::string>& waiting, Group* group);
  std::optional<TurnClass> ClassNow(const std::vector<Contender>& contenders);

  std::map<std::string, Group> groups_;
  Balances group_balances_;
  std::string last_group_;
  // Time that a class may use before the others.
  std::array<double, kTurnClasses> owed_ms_{};
};

}  // namespace thunderhead::drawing
