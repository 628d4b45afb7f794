// The state that the panels show, and the actions that they call. It holds copies of the session's
// and the catalogue's state, which are updated before each drawing, and the choices made in this
// window.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "desktop/choices.h"
#include "desktop/history.h"
#include "thunderhead_client/catalogue.h"
#include "thunderhead_client/parameters.h"
#include "thunderhead_client/picture_flow.h"
#include "thunderhead_client/playback.h"
#include "thunderhead_client/pose.h"
#include "thunderhead_client/session.h"
#include "thunderhead_client/statistics.h"

namespace thunderhead::desktop {

struct Ui {
  Ui(client::Session& the_session, client::Catalogue& the_catalogue)
      : session(the_session), catalogue(the_catalogue) {}

  client::Session& session;
  client::Catalogue& catalogue;

  client::SessionState state;
  client::CatalogueState storms;
  std::vector<client::Parameter> parameters;  // parameters of state.scene
  client::Statistics::Figures figures;
  std::uint64_t dropped = 0;
  v1::Frame frame;       // the frame that is shown, without its encoded picture
  std::string encoding;  // encoding of the frame's picture
  std::string failure;   // why the last picture could not be decoded; empty if it could

  Choices choices;
  bool typing = false;  // a text field has the keyboard
  int edits = 0;        // number of times that this window has changed the scene or its own view
  client::Playback playback;
  History history;
  std::function<void()> toggle_full_screen;
  float scale = 1.0F;
  float width = 0.0F;  // size of the window, in its units
  float height = 0.0F;

  // Whether a change is recorded in the history, so that it can be undone.
  enum class Recording { kRecorded, kUnrecorded };

  // Changes the scene if this window steers. `subject` names the changed part for History.
  void Edit(const std::string& subject, client::SceneSync::Edit edit,
            Recording recording = Recording::kRecorded);
  // Applies a motion to the camera of the view that this window shows.
  void Move(const std::function<client::Pose(const client::Pose&)>& motion);
  void ShowCamera(const v1::Camera& camera);
  void ShowTime(int index, Recording recording = Recording::kRecorded);
  // Shows a time that the user picked, and stops playback.
  void ChooseTime(int index);
  // Shows another storm's last time, and stops playback.
  void ShowStorm(const std::string& storm_id);
  void TogglePlay();
  void StepTime(int by);
  void Undo();
  void Redo();

  // Number of times of the storm that is shown, and the index of the time that is shown. The number
  // is 0 until the server has described the storm. If the scene has no index, the last time is
  // shown.
  int time_count() const;
  int time_index() const;
  // The direction of true north in the scene, in degrees clockwise from the grid's north. It is 0
  // until the server has described the storm.
  double true_north_deg() const;
  // Returns true once the picture of the newest scene is on the screen.
  bool IsShown() const;
  // Copies the state of the session and the catalogue if it has changed. Returns true if anything
  // has changed.
  bool Refresh();
  // True after texts appeared or vanished. The interface needs more than one drawing to lay them
  // out.
  bool texts_changed = false;

 private:
  // Returns the index of the last time of the storm that is shown. Takes it from the list of storms
  // until the server has described the storm, and returns 0 if the list does not have it either.
  int last_time() const;
  // Applies a step of the history, if there is one.
  void Make(const std::optional<History::Edit>& step);
};

}  // namespace thunderhead::desktop
