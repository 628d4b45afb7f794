// Undo and redo of this window's own changes. Undoing a step restores only the values that the step
// changed, because other viewers may have changed the rest of the scene meanwhile. Successive
// changes of one subject within a short time, such as those of a drag, form one step.
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

  // Records a change of the scene. `subject` is a name for the part that was changed; changes with
  // the same subject may form one step.
  void Record(const v1::Scene& before, const v1::Scene& after, const std::string& subject,
              TimePoint now);
  // Returns true if a change of the last subject at time `now` would still become part of the last
  // step.
  bool IsOpen(TimePoint now) const;
  // Returns the edit that undoes or redoes a step; nothing if there is no such step.
  std::optional<Edit> Undo();
  std::optional<Edit> Redo();
  // Forgets all steps. This is needed when another storm is shown.
  void Clear();

 private:
  struct Change {
    v1::Scene before;
    v1::Scene after;
  };
  // The changes of one gesture, the oldest first. Another viewer may have changed the scene between
  // two of them.
  using Step = std::vector<Change>;

  std::vector<Step> done_;
  std::vector<Step> undone_;
  std::string subject_;
  TimePoint last_{};
};

}  // namespace thunderhead::desktop
