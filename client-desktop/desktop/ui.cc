#include "desktop/ui.h"

#include <algorithm>
#include <utility>

namespace thunderhead::desktop {

using Clock = std::chrono::steady_clock;

void Ui::Edit(const std::string& subject, client::SceneSync::Edit edit) {
  const v1::Scene before = state.scene;
  if (!session.Edit(std::move(edit))) return;
  history.Record(before, subject, Clock::now());
  Refresh();
}

void Ui::Move(const std::function<client::Pose(const client::Pose&)>& motion) {
  const auto pose = client::PoseOf(state.ViewCamera());
  if (pose) ShowCamera(client::CameraOf(motion(*pose)));
}

void Ui::ShowCamera(const v1::Camera& camera) {
  if (state.Steers()) history.Record(state.scene, "camera", Clock::now());
  session.ShowCamera(camera);
  Refresh();
}

void Ui::ShowTime(int index) {
  Edit("time", [index](v1::Scene& scene) {
    scene.set_time_index(static_cast<std::uint32_t>(std::max(0, index)));
  });
}

void Ui::TogglePlay() {
  if (!state.Steers()) return;
  if (const auto index = playback.Toggle(time_index(), time_count())) ShowTime(*index);
}

void Ui::StepTime(int by) {
  if (time_count() > 0) ShowTime(client::Playback::Step(time_index(), by, time_count()));
}

void Ui::Undo() {
  if (!state.Steers()) return;
  ShowAgain(history.Undo(state.scene));
}

void Ui::Redo() {
  if (!state.Steers()) return;
  ShowAgain(history.Redo(state.scene));
}

void Ui::ShowAgain(std::optional<v1::Scene> scene) {
  if (!scene) return;
  session.Edit([scene = *std::move(scene)](v1::Scene& edited) { edited = scene; });
  Refresh();
}

int Ui::time_count() const { return storms.storm.times_size(); }

int Ui::time_index() const {
  if (!state.scene.has_time_index()) return std::max(0, time_count() - 1);
  return static_cast<int>(state.scene.time_index());
}

bool Ui::IsShown() const {
  return frame.sequence() > 0 && frame.scene_revision() >= state.scene_revision;
}

bool Ui::Refresh() {
  bool any = false;
  const int joined = state.joined_count;
  const std::uint64_t catalogue_revision = state.catalogue_revision;
  if (auto newer = session.StateAfter(state.version)) {
    texts_changed = texts_changed || newer->link != state.link || newer->reason != state.reason ||
                    newer->notice_count != state.notice_count ||
                    newer->problem.has_value() != state.problem.has_value() ||
                    newer->presence.ByteSizeLong() != state.presence.ByteSizeLong();
    state = *std::move(newer);
    parameters = client::ParametersOf(state.scene);
    any = true;
  }
  // Storms may have come while the server was away.
  if (state.joined_count != joined || state.catalogue_revision != catalogue_revision) {
    catalogue.Refresh();
  }
  if (auto newer = catalogue.StateAfter(storms.version)) {
    storms = *std::move(newer);
    any = true;
  }
  if (!state.Steers()) playback.Pause();
  catalogue.Describe(state.scene.storm_id(), state.scene.time_index());
  return any;
}

}  // namespace thunderhead::desktop
