// Undo and redo of a scene's changes. Changes that follow one another within a moment, as of a
// drag, are one.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

class History {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // `before` is about to be changed; `subject` names what of it.
  void Record(const v1::Scene& before, const std::string& subject, TimePoint now);
  // The scene to go back to from `now`, or forward to; nothing where there is none.
  std::optional<v1::Scene> Undo(const v1::Scene& now);
  std::optional<v1::Scene> Redo(const v1::Scene& now);

 private:
  std::vector<v1::Scene> done_;
  std::vector<v1::Scene> undone_;
  std::string subject_;
  TimePoint last_{};
};

}  // namespace thunderhead::desktop
