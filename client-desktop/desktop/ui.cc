#include "desktop/ui.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <utility>

#include "desktop/scene_edits.h"

namespace thunderhead::desktop {

using Clock = std::chrono::steady_clock;
using google::protobuf::util::MessageDifferencer;

void Ui::Edit(const std::string& subject, client::SceneSync::Edit edit, Recording recording) {
  const v1::Scene before = state.scene;
  v1::Scene after = before;
  edit(after);
  if (MessageDifferencer::Equals(before, after) || !session.Edit(std::move(edit))) return;
  ++edits;
  if (recording == Recording::kRecorded) history.Record(before, after, subject, Clock::now());
  // Without this copy, Refresh() would mistake a new storm for another viewer's choice.
  state.scene = std::move(after);
  Refresh();
}

void Ui::Move(const std::function<client::Pose(const client::Pose&)>& motion) {
  const auto pose = client::PoseOf(state.ViewCamera());
  if (pose) ShowCamera(client::CameraOf(motion(*pose)));
}

void Ui::ShowCamera(const v1::Camera& camera) {
  if (state.Steers()) {
    return Edit("camera", [camera](v1::Scene& scene) { *scene.mutable_camera() = camera; });
  }
  if (session.ShowCamera(camera)) ++edits;
  Refresh();
}

void Ui::ShowTime(int index, Recording recording) {
  const auto edit = [index](v1::Scene& scene) {
    scene.set_time_index(static_cast<std::uint32_t>(std::max(0, index)));
  };
  Edit("time", edit, recording);
}

void Ui::ChooseTime(int index) {
  playback.Pause();
  ShowTime(index);
}

void Ui::ShowStorm(const std::string& storm_id) {
  playback.Pause();
  Edit("storm", [storm_id](v1::Scene& scene) { ChooseStorm(scene, storm_id); });
}

void Ui::TogglePlay() {
  if (!state.Steers()) return;
  if (const auto index = playback.Toggle(time_index(), time_count())) {
    ShowTime(*index, Recording::kUnrecorded);
  }
}

void Ui::StepTime(int by) {
  if (time_count() > 0) ChooseTime(client::Playback::Step(time_index(), by, time_count()));
}

void Ui::Undo() {
  if (state.Steers()) Make(history.Undo());
}

void Ui::Redo() {
  if (state.Steers()) Make(history.Redo());
}

void Ui::Make(const std::optional<History::Edit>& step) {
  if (step) Edit("history", *step, Recording::kUnrecorded);
}

int Ui::time_count() const {
  return storms.storm.id() == state.scene.storm_id() ? storms.storm.times_size() : 0;
}

int Ui::last_time() const {
  if (time_count() > 0) return time_count() - 1;
  for (const v1::StormSummary& storm : storms.storms.storms()) {
    if (storm.id() == state.scene.storm_id() && storm.time_count() > 0) {
      return static_cast<int>(storm.time_count()) - 1;
    }
  }
  return 0;
}

double Ui::true_north_deg() const {
  return storms.storm.id() == state.scene.storm_id() ? storms.storm.true_north_deg() : 0.0;
}

int Ui::time_index() const {
  if (!state.scene.has_time_index()) return last_time();
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
    if (newer->scene.storm_id() != state.scene.storm_id()) history.Clear();
    state = *std::move(newer);
    parameters = client::ParametersOf(state.scene);
    any = true;
  }
  // Storms may have been added while the server was unavailable.
  if (state.joined_count != joined || state.catalogue_revision != catalogue_revision) {
    catalogue.Refresh();
  }
  if (auto newer = catalogue.StateAfter(storms.version)) {
    storms = *std::move(newer);
    any = true;
  }
  if (!state.Steers()) playback.Pause();
  catalogue.Describe(state.scene.storm_id(), static_cast<std::uint32_t>(time_index()));
  return any;
}

}  // namespace thunderhead::desktop
