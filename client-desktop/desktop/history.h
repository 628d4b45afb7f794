// Undo and redo of this window's own changes: a step knows what it changed and leaves the rest of
// the scene as it is by then, which somebody else may have changed. Changes of one subject that
// follow one another within a moment, as of a drag, are one step.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead_client/scene_sync.h"

namespace thunderhead::desktop {

class History {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Edit = client::SceneSync::Edit;

  // The scene was changed; `subject` names what of it.
  void Record(const v1::Scene& before, const v1::Scene& after, const std::string& subject,
              TimePoint now);
  // True if another change of the last subject would belong to the last step.
  bool IsOpen(TimePoint now) const;
  // The edit that takes the last step back, or makes it again; nothing where there is none.
  std::optional<Edit> Undo();
  std::optional<Edit> Redo();
  // The steps belong to another storm's scene.
  void Clear();

 private:
  struct Change {
    v1::Scene before;
    v1::Scene after;
  };
  // The changes of one gesture, the first one first. Somebody else may have changed the scene
  // between two of them.
  using Step = std::vector<Change>;

  std::vector<Step> done_;
  std::vector<Step> undone_;
  std::string subject_;
  TimePoint last_{};
};

}  // namespace thunderhead::desktop
