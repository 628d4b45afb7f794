// Tests of mouse, touch and keys as camera motions, with SDL's own events.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include "desktop/field_colors.h"
#include "desktop/history.h"
#include "desktop/input_tally.h"
#include "desktop/keyboard.h"
#include "desktop/kiosk.h"
#include "desktop/panels/panels.h"
#include "desktop/pointer_input.h"
#include "desktop/status_log.h"
#include "desktop/texts.h"
#include "desktop/window.h"
#include "gtest/gtest.h"

namespace thunderhead::desktop {
namespace {

using client::OrbitPose;
using client::Pose;

class Pointer : public ::testing::Test {
 protected:
  Pointer() { input.SetSize(1280.0F, 720.0F); }

  static SDL_Event Button(Uint32 type, Uint8 button, int x, int y) {
    SDL_Event event{};
    event.type = type;
    event.button.button = button;
    event.button.x = x;
    event.button.y = y;
    return event;
  }
  static SDL_Event Motion(int x, int y, int right, int down) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.x = x;
    event.motion.y = y;
    event.motion.xrel = right;
    event.motion.yrel = down;
    return event;
  }
  static SDL_Event Fingers(Uint16 count, float x, float y, float apart) {
    SDL_Event event{};
    event.type = SDL_MULTIGESTURE;
    event.mgesture.numFingers = count;
    event.mgesture.x = x;
    event.mgesture.y = y;
    event.mgesture.dDist = apart;
    return event;
  }
  const OrbitPose& orbit() const { return std::get<OrbitPose>(pose); }

  Pose pose = OrbitPose{{0.0, 0.0, 5000.0}, 180.0, 10.0, 50'000.0, 35.0};
  PointerInput input{[this](const PointerInput::Motion& motion) { pose = motion(pose); }};
};

TEST_F(Pointer, TheLeftButtonTurnsAndTheRightOnePans) {
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_LEFT, 600, 300), true);
  input.Take(Motion(680, 300, 80, 0), true);
  EXPECT_NEAR(orbit().azimuth_deg, 200.0, 1e-9);
  input.Take(Button(SDL_MOUSEBUTTONUP, SDL_BUTTON_LEFT, 680, 300), true);
  input.Take(Motion(700, 300, 20, 0), true);
  EXPECT_NEAR(orbit().azimuth_deg, 200.0, 1e-9);
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_RIGHT, 600, 300), true);
  input.Take(Motion(700, 300, 100, 0), true);
  EXPECT_NEAR(orbit().azimuth_deg, 200.0, 1e-9);
  EXPECT_GT(std::hypot(orbit().target_m[0], orbit().target_m[1]), 1000.0);
}

TEST_F(Pointer, ADragThatBeganOverAPanelMovesNothing) {
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_LEFT, 20, 300), false);
  input.Take(Motion(680, 300, 660, 0), true);
  EXPECT_NEAR(orbit().azimuth_deg, 180.0, 1e-9);
}

TEST_F(Pointer, OneThatBeganOverThePictureGoesOnOverAPanel) {
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_LEFT, 600, 300), true);
  input.Take(Motion(20, 300, 80, 0), false);
  EXPECT_NEAR(orbit().azimuth_deg, 200.0, 1e-9);
}

TEST_F(Pointer, WheelAndTouchPadZoomByTheirSteps) {
  SDL_Event event{};
  event.type = SDL_MOUSEWHEEL;
  event.wheel.y = 1;
  event.wheel.preciseY = 1.0F;
  input.Take(event, true);
  const double one_notch_m = orbit().distance_m;
  EXPECT_NEAR(one_notch_m, 50'000.0 * std::exp(-0.13), 1.0);
  event.wheel.y = 0;
  event.wheel.preciseY = 0.25F;
  for (int i = 0; i < 4; ++i) input.Take(event, true);
  EXPECT_NEAR(orbit().distance_m, one_notch_m * std::exp(-0.13), 1.0);
}

TEST_F(Pointer, TwoFingersPinchAndPanAndDoNotTurn) {
  SDL_Event down{};
  down.type = SDL_FINGERDOWN;
  // SDL also reports the first finger as a mouse.
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_LEFT, 600, 300), true);
  input.Take(down, true);
  input.Take(down, true);
  input.Take(Fingers(2, 0.5F, 0.5F, 0.1F), true);
  EXPECT_LT(orbit().distance_m, 45'000.0);
  input.Take(Motion(680, 300, 80, 0), true);
  EXPECT_NEAR(orbit().azimuth_deg, 180.0, 1e-9);
  input.Take(Fingers(2, 0.6F, 0.5F, 0.0F), true);
  EXPECT_LT(orbit().target_m[0], -1000.0);
}

TEST_F(Pointer, AToolGetsTheLeftButton) {
  int pressed = 0;
  int dragged = 0;
  int released = 0;
  const ToolSteps tool{[&](ScreenPoint) { ++pressed; }, [&](ScreenPoint) { ++dragged; },
                       [&](bool cancelled) { released += cancelled ? 0 : 1; },
                       [](std::optional<ScreenPoint>) {}};
  input.SetTool(&tool);
  input.Take(Button(SDL_MOUSEBUTTONDOWN, SDL_BUTTON_LEFT, 600, 300), true);
  input.Take(Motion(680, 300, 80, 0), true);
  input.Take(Button(SDL_MOUSEBUTTONUP, SDL_BUTTON_LEFT, 680, 300), true);
  EXPECT_EQ(pressed, 1);
  EXPECT_EQ(dragged, 1);
  EXPECT_EQ(released, 1);
  EXPECT_NEAR(orbit().azimuth_deg, 180.0, 1e-9);
}

TEST_F(Pointer, AToolThatIsPutAwayOrLeftIsTold) {
  std::vector<bool> shown;
  const ToolSteps tool{[](ScreenPoint) {}, [](ScreenPoint) {}, [](bool) {},
                       [&](std::optional<ScreenPoint> at) { shown.push_back(at.has_value()); }};
  input.SetTool(&tool);
  input.Take(Motion(600, 300, 1, 0), true);
  input.Take(Motion(60, 300, 1, 0), false);  // the pointer is over a panel
  input.Take(Motion(600, 300, 1, 0), true);
  SDL_Event leaves{};
  leaves.type = SDL_WINDOWEVENT;
  leaves.window.event = SDL_WINDOWEVENT_LEAVE;
  input.Take(leaves, true);
  input.Take(Motion(600, 300, 1, 0), true);
  input.SetTool(nullptr);
  input.Take(Motion(610, 300, 1, 0), true);
  EXPECT_EQ(shown, (std::vector<bool>{true, false, true, false, true, false}));
}

struct Keys {
  Pose pose = OrbitPose{{0.0, 0.0, 5000.0}, 180.0, 10.0, 50'000.0, 35.0};
  Choices choices;
  int undone = 0;
  int stepped = 0;
  KeyActions actions;

  Keys() {
    actions.move = [this](const auto& motion) { pose = motion(pose); };
    actions.toggle_tool = [this](Tool tool) { choices.Toggle(tool); };
    actions.toggle_panel = [this](Panel panel) { choices.Toggle(panel); };
    actions.undo = [this] { ++undone; };
    actions.step_time = [this](int by) { stepped += by; };
  }
  bool Press(SDL_Keycode key, Uint16 modifiers = 0, const KeyFocus& focus = {}) {
    return Press(SDL_SCANCODE_UNKNOWN, key, modifiers, focus);
  }
  bool Press(SDL_Scancode place, SDL_Keycode key, Uint16 modifiers = 0,
             const KeyFocus& focus = {}) {
    SDL_KeyboardEvent event{};
    event.keysym.scancode = place;
    event.keysym.sym = key;
    event.keysym.mod = modifiers;
    return TakeKey(event, focus, actions);
  }
  bool Type(std::string_view text, Uint16 modifiers = 0, const KeyFocus& focus = {}) {
    return TakeText(text, modifiers, focus, actions);
  }
};

TEST(Keyboard, HasThePagesKeys) {
  Keys keys;
  keys.Press(SDLK_RIGHT);
  EXPECT_NEAR(std::get<OrbitPose>(keys.pose).azimuth_deg, 183.0, 1e-9);
  keys.Press(SDLK_k);
  EXPECT_EQ(keys.choices.tool, Tool::kLook);
  keys.Press(SDL_SCANCODE_4, SDLK_4);
  EXPECT_EQ(keys.choices.tool, Tool::kNone);
  keys.Press(SDLK_x);
  EXPECT_EQ(keys.choices.panel, Panel::kDrawer);
  keys.Type("?", KMOD_LSHIFT);
  EXPECT_EQ(keys.choices.panel, Panel::kHelp);
  keys.Type(".");
  EXPECT_EQ(keys.stepped, 1);
  keys.Press(SDLK_z, KMOD_LCTRL);
  EXPECT_EQ(keys.undone, 1);
}

// The web page uses these keys to save, compare and probe. In this client they have no effect.
TEST(Keyboard, KeysOfThePageAloneDoNothing) {
  Keys keys;
  for (const SDL_Keycode key : {SDLK_s, SDLK_c, SDLK_p, SDLK_RETURN}) EXPECT_FALSE(keys.Press(key));
  EXPECT_FALSE(keys.Press(SDL_SCANCODE_6, SDLK_6));
  keys.Press(SDLK_o);
  EXPECT_EQ(keys.choices.panel, Panel::kStorms);
  keys.Press(SDLK_h);
  EXPECT_EQ(keys.choices.panel, Panel::kPeople);
}

TEST(Keyboard, UndoIsWithControlOrCommandAlone) {
  Keys keys;
  EXPECT_TRUE(keys.Press(SDLK_z, KMOD_LGUI));
  EXPECT_TRUE(keys.Press(SDLK_z, KMOD_RCTRL));
  EXPECT_FALSE(keys.Press(SDLK_z, KMOD_LCTRL | KMOD_LALT));
  EXPECT_EQ(keys.undone, 2);
}

TEST(Choices, AnotherToolPutsThePenDown) {
  Choices choices;
  choices.Toggle(Tool::kMarks);
  choices.hand = Hand::kPen;
  choices.Toggle(Tool::kLook);
  EXPECT_EQ(choices.hand, Hand::kCamera);
}

TEST(Choices, AreClosedFromTheUppermostDown) {
  Choices choices;
  choices.Toggle(Tool::kMarks);
  choices.hand = Hand::kPen;
  choices.Toggle(Panel::kPeople);
  EXPECT_TRUE(choices.Close());
  EXPECT_EQ(choices.panel, Panel::kNone);
  EXPECT_EQ(choices.hand, Hand::kPen);
  // The first Close() puts the pen down, and the drawer stays open.
  choices.Toggle(Panel::kDrawer);
  EXPECT_TRUE(choices.Close());
  EXPECT_EQ(choices.hand, Hand::kCamera);
  EXPECT_EQ(choices.panel, Panel::kDrawer);
  EXPECT_TRUE(choices.Close());
  EXPECT_EQ(choices.panel, Panel::kNone);
  EXPECT_EQ(choices.tool, Tool::kMarks);
  EXPECT_TRUE(choices.Close());
  EXPECT_EQ(choices.tool, Tool::kNone);
  EXPECT_FALSE(choices.Close());
}

TEST(Keyboard, ATextUsesAllKeysAndAControlItsOwn) {
  Keys keys;
  EXPECT_FALSE(keys.Press(SDLK_k, 0, {true, true}));
  EXPECT_EQ(keys.choices.tool, Tool::kNone);
  EXPECT_FALSE(keys.Press(SDLK_RIGHT, 0, {false, true}));
  EXPECT_TRUE(keys.Press(SDLK_k, 0, {false, true}));
}

double DistanceOf(const Keys& keys) { return std::get<OrbitPose>(keys.pose).distance_m; }

// An SDL key event contains the key's position and its character without Shift. The text that the
// key produces follows in another event.
TEST(Keyboard, OnAGermanOneDigitsAndQuestionMarkWork) {
  Keys keys;
  keys.Press(SDL_SCANCODE_7, SDLK_7);
  keys.Type("7");
  EXPECT_EQ(keys.choices.tool, Tool::kMarks);
  // Shift and the key of the letter "ß" produce a question mark.
  keys.Press(SDL_SCANCODE_MINUS, 0xDF, KMOD_LSHIFT);
  keys.Type("?", KMOD_LSHIFT);
  EXPECT_EQ(keys.choices.panel, Panel::kHelp);
  // Shift and 7 produce a slash.
  keys.Press(SDL_SCANCODE_7, SDLK_7, KMOD_LSHIFT);
  keys.Type("/", KMOD_LSHIFT);
  EXPECT_EQ(keys.choices.tool, Tool::kMarks);
}

TEST(Keyboard, OnAFrenchOneDigitsWorkWithShiftAndWithout) {
  Keys keys;
  keys.Press(SDL_SCANCODE_7, 0xE8);
  keys.Type("è");
  EXPECT_EQ(keys.choices.tool, Tool::kMarks);
  keys.Press(SDL_SCANCODE_1, SDLK_AMPERSAND, KMOD_LSHIFT);
  keys.Type("1", KMOD_LSHIFT);
  EXPECT_EQ(keys.choices.tool, Tool::kCamera);
  // With Caps Lock, the key of "&" produces the digit 1.
  keys.Press(SDL_SCANCODE_1, SDLK_AMPERSAND, KMOD_CAPS);
  keys.Type("1", KMOD_CAPS);
  EXPECT_EQ(keys.choices.tool, Tool::kNone);
  // Shift and the semicolon's key produce a full stop. The comma's key produces the question mark
  // with Shift.
  keys.Press(SDL_SCANCODE_COMMA, SDLK_SEMICOLON, KMOD_LSHIFT);
  keys.Type(".", KMOD_LSHIFT);
  EXPECT_EQ(keys.stepped, 1);
  keys.Press(SDL_SCANCODE_M, SDLK_COMMA, KMOD_LSHIFT);
  keys.Type("?", KMOD_LSHIFT);
  EXPECT_EQ(keys.choices.panel, Panel::kHelp);
  EXPECT_EQ(keys.stepped, 1);
}

TEST(Keyboard, PlusWithinTheDigitsZoomsAndOpensNoTool) {
  Keys keys;
  // A Czech keyboard produces "+" by the key of the digit 1 without Shift, a Swiss keyboard by this
  // key with Shift.
  keys.Press(SDL_SCANCODE_1, SDLK_PLUS);
  keys.Type("+");
  EXPECT_NEAR(DistanceOf(keys), 50'000.0 * 0.88, 1.0);
  keys.Press(SDL_SCANCODE_1, SDLK_1, KMOD_LSHIFT);
  keys.Type("+", KMOD_LSHIFT);
  EXPECT_NEAR(DistanceOf(keys), 50'000.0 * 0.88 * 0.88, 1.0);
  keys.Press(SDL_SCANCODE_KP_MINUS, SDLK_KP_MINUS);
  keys.Type("-");
  EXPECT_NEAR(DistanceOf(keys), 50'000.0 * 0.88, 1.0);
  EXPECT_EQ(keys.choices.tool, Tool::kNone);
}

TEST(Keyboard, TextWithControlOrInAFieldDoesNothing) {
  Keys keys;
  EXPECT_FALSE(keys.Type("?", 0, {true, true}));
  EXPECT_FALSE(keys.Type("+", KMOD_LCTRL));
  EXPECT_FALSE(keys.Type("?!"));
  EXPECT_EQ(keys.choices.panel, Panel::kNone);
  EXPECT_NEAR(DistanceOf(keys), 50'000.0, 1e-6);
}

TEST(Texts, AreThePages) {
  EXPECT_EQ(FormatNumber(0.02), "0.02");
  EXPECT_EQ(FormatNumber(8.449), "8.45");
  EXPECT_EQ(FormatNumber(50000.0), "50000");
  EXPECT_EQ(FormatLength(50'000.0), "50 km");
  EXPECT_EQ(FormatBitRate(175'000.0), "1.4 Mbit/s");
  EXPECT_EQ(FormatElapsed(4800.0), "+1 h 20 min");
  v1::StormTime time;
  time.set_valid_time("2013-05-20T20:00:00Z");
  EXPECT_EQ(FormatValidTime(time), "2013-05-20 20:00 UTC");
  time.set_valid_time("0001-01-01T00:20:00Z");
  EXPECT_EQ(FormatValidTime(time), "day 1, 00:20");
  time.set_valid_time("");
  time.set_elapsed_s(30.0);
  EXPECT_EQ(FormatValidTime(time), "+30 s");
  EXPECT_EQ(CompassPoint(22.0), "NNE");
  EXPECT_EQ(DescribePose(OrbitPose{{}, 200.0, 4.0, 61'000.0, 35.0}, 0.0),
            "Seen from SSW (200°), 4° high, 61 km away");
}

TEST(Texts, AreCutBetweenCharacters) {
  EXPECT_EQ(CutTo("supercell", 9), "supercell");
  EXPECT_EQ(CutTo("supercell", 5), "super");
  EXPECT_EQ(CutTo("Zürich", 3), "Zü");
  EXPECT_EQ(CutTo("Zürich", 2), "Z");
  EXPECT_EQ(CutTo("雷雨", 5), "雷");
  EXPECT_EQ(CutTo("⛈️", 2), "");
}

TEST(Texts, DirectionsCountFromTrueNorth) {
  EXPECT_EQ(DescribePose(OrbitPose{{}, 350.0, 4.0, 61'000.0, 35.0}, -12.5),
            "Seen from N (3°), 4° high, 61 km away");
  const client::TopDownPose above{{}, 160'000.0};
  EXPECT_EQ(DescribePose(above, 0.2), "160 km from left to right, north up");
  EXPECT_EQ(DescribePose(above, -12.5), "160 km from left to right, the grid's north up");
  v1::Sun sun;
  sun.set_azimuth_deg(260.0F);
  sun.set_elevation_deg(20.0F);
  EXPECT_EQ(DescribeSun(sun, 30.0), "The sun is in SW, 20° high");
}

TEST(Texts, TheRunIsNamedByItsStartAsOnThePage) {
  v1::StormDescription storm;
  EXPECT_EQ(NameOfRun(storm), "");
  storm.set_run_start("2013-05-20T06:00:00Z");
  EXPECT_EQ(NameOfRun(storm), "run 2013-05-20 06:00Z");
  storm.set_run_start("0001-01-01T00:00:00Z");
  EXPECT_EQ(NameOfRun(storm), "run 00:00Z");
}

TEST(Texts, TheLeadTimeIsSinceTheRunsStart) {
  v1::StormDescription storm;
  v1::StormTime time;
  time.set_elapsed_s(3600.0);
  time.set_valid_time("2013-03-01T01:20:00Z");
  EXPECT_EQ(LeadSeconds(storm, time), 3600.0) << "without a start, since the first time";
  storm.set_run_start("2013-02-28T23:00:30Z");
  EXPECT_EQ(LeadSeconds(storm, time), 8370.0);
  storm.set_run_start("0001-01-01T00:00:00Z");
  time.set_valid_time("0001-01-01T01:20:00Z");
  EXPECT_EQ(LeadSeconds(storm, time), 4800.0);
  time.set_lead_s(3600.0);
  EXPECT_EQ(LeadSeconds(storm, time), 3600.0) << "the server counts in the file's calendar";
}

TEST(Texts, AmountsAreInThePagesUnits) {
  v1::FieldDescription field;
  field.set_maximum(0.00823F);
  for (const auto& [units, amount] : {std::pair{"kg kg-1", "up to 8.23 g/kg"},
                                      {"kg m-3", "up to 8.23 g/m³"},
                                      {"m-1", "up to 8.23 /km"}}) {
    field.set_units(units);
    EXPECT_EQ(DescribeAmount(field), amount);
  }
}

TEST(Texts, TheErrorIsTheTablesUntilItIsMeasured) {
  v1::AccuracyReport report;
  report.set_estimated_error(0.135F);
  report.set_model_error(0.128F);
  EXPECT_EQ(ErrorSource(report), "from a table, until measured");
  EXPECT_EQ(DescribeError(report), "Estimated error 13.5 % (light model 12.8 %)");
  report.set_discretisation_error(0.007F);
  EXPECT_EQ(DescribeError(report), "Estimated error 13.5 % (light model 12.8 %, few slices 0.7 %)");
}

TEST(Texts, AMeasuredErrorHasItsIntervalAndBias) {
  v1::AccuracyReport report;
  report.set_measured(true);
  report.set_estimated_error(0.087F);
  report.set_error_low(0.081F);
  report.set_error_high(0.094F);
  report.set_bias(-0.02F);
  // A report of a measured error still has the parts of the estimate from the table.
  report.set_model_error(0.128F);
  report.set_discretisation_error(0.007F);
  EXPECT_EQ(ErrorSource(report), "measured: 8.1 to 9.4 %");
  EXPECT_EQ(DescribeError(report),
            "Measured error 8.7 % (measured: 8.1 to 9.4 %, 2 % too dark on the whole)");
  report.set_bias(0.02F);
  EXPECT_EQ(DescribeError(report),
            "Measured error 8.7 % (measured: 8.1 to 9.4 %, 2 % too bright on the whole)");
}

TEST(FieldColors, ComeBackFromTheScreen) {
  v1::Color color;
  color.set_red(0.5F);
  color.set_green(0.002F);
  color.set_blue(1.0F);
  const ScreenColor shown = ScreenColorOf(color);
  EXPECT_NEAR(shown[0], 188.0 / 255.0, 0.002);
  EXPECT_NEAR(shown[1], 0.02584, 1e-4);
  const v1::Color back = LinearColorOf(shown);
  EXPECT_NEAR(back.red(), 0.5, 1e-5);
  EXPECT_NEAR(back.green(), 0.002, 1e-6);
  EXPECT_NEAR(back.blue(), 1.0, 1e-6);
}

TEST(FieldColors, AreShownWhereTheTechniqueAndTheSceneDoSo) {
  v1::GetServerInfoResponse server;
  v1::TechniqueDescription& technique = *server.add_techniques();
  technique.set_name("light_volume");
  technique.set_shows_field_optics(true);
  v1::Scene scene;
  EXPECT_FALSE(DrawsFalseColors(scene, server));
  scene.mutable_rendering()->mutable_light_volume();
  EXPECT_FALSE(DrawsFalseColors(scene, server));
  scene.mutable_rendering()->mutable_light_volume()->set_false_colors(true);
  EXPECT_TRUE(DrawsFalseColors(scene, server));
  technique.set_shows_field_optics(false);
  EXPECT_FALSE(DrawsFalseColors(scene, server));
  scene.mutable_rendering()->mutable_other()->set_name("light_volume");
  technique.set_shows_field_optics(true);
  EXPECT_FALSE(DrawsFalseColors(scene, server));
}

std::string TextOf(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Scale, IsThatOfTheMonitorInQuartersWhereThatMakesSense) {
  for (const auto& [dpi, scale] :
       {std::pair{96.0F, 1.0F}, {110.0F, 1.25F}, {144.0F, 1.5F}, {192.0F, 2.0F}, {384.0F, 4.0F}}) {
    EXPECT_EQ(ScaleOfMonitor(dpi, 1.0F), scale) << dpi;
  }
  for (const float dpi : {0.0F, -1.0F, 40.0F, 5000.0F, std::nanf("")})
    EXPECT_EQ(ScaleOfMonitor(dpi, 1.0F), 1.0F);
}

TEST(Scale, IsOneWhereTheDesktopScalesTheWindowItself) {
  EXPECT_EQ(ScaleOfMonitor(192.0F, 2.0F), 1.0F);
  EXPECT_EQ(ScaleOfMonitor(144.0F, 1.5F), 1.0F);
}

TEST(InputTally, CountsWhatTheWindowHasTaken) {
  InputTally tally;
  const auto take = [&tally](Uint32 type, SDL_Scancode key = SDL_SCANCODE_UNKNOWN) {
    SDL_Event event{};
    event.type = type;
    if (key != SDL_SCANCODE_UNKNOWN) event.key.keysym.scancode = key;
    tally.Take(event);
  };
  for (const SDL_Scancode key : {SDL_SCANCODE_LCTRL, SDL_SCANCODE_Z, SDL_SCANCODE_RGUI}) {
    take(SDL_KEYDOWN, key);
    take(SDL_KEYUP, key);
  }
  EXPECT_EQ(tally.keys, 1) << "modifiers do not count";
  take(SDL_MOUSEBUTTONDOWN);
  take(SDL_MOUSEBUTTONUP);
  EXPECT_EQ(tally.buttons, 2);
  take(SDL_MOUSEWHEEL);
  EXPECT_EQ(tally.notches, 1);
  SDL_Event motion{};
  motion.type = SDL_MOUSEMOTION;
  std::tie(motion.motion.x, motion.motion.y) = std::pair(30, 40);
  tally.Take(motion);
  EXPECT_EQ(std::pair(tally.pointer_x, tally.pointer_y), std::pair(30, 40));
  take(SDL_WINDOWEVENT);
  take(SDL_USEREVENT);
  EXPECT_EQ(tally.keys + tally.buttons + tally.notches, 4);
}

TEST(StatusFile, ThatCannotBeWrittenIsNamed) {
  EXPECT_TRUE(StatusLog::CheckWritable("").ok());
  EXPECT_TRUE(StatusLog::CheckWritable(::testing::TempDir() + "status_new").ok());
  const absl::Status status = StatusLog::CheckWritable("/nowhere/at/all");
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_EQ(status.message(),
            "cannot write the file of --status, '/nowhere/at/all': No such file or directory");
}

TEST(StatusFile, StaysSmallAndKeepsWholeLines) {
  const std::string path = ::testing::TempDir() + "status";
  std::ofstream(path) << "of another run\n";
  std::ofstream(path + ".1") << "of another run\n";
  constexpr int kMaxBytes = 40;
  RotatedFile file(path, kMaxBytes);
  for (int i = 0; i < 100; ++i) {
    file.Write("line " + std::to_string(i));
    EXPECT_LE(std::filesystem::file_size(path), kMaxBytes);
  }
  EXPECT_EQ(TextOf(path), "line 95\nline 96\nline 97\nline 98\nline 99\n");
  EXPECT_EQ(TextOf(path + ".1"), "line 90\nline 91\nline 92\nline 93\nline 94\n");
  EXPECT_FALSE(std::filesystem::exists(path + ".2"));
}

TEST(StatusFile, ALineThatIsTooLongIsWrittenAlone) {
  const std::string path = ::testing::TempDir() + "status_long";
  RotatedFile file(path, 4);
  file.Write("first line");
  file.Write("second line");
  EXPECT_EQ(TextOf(path), "second line\n");
  EXPECT_EQ(TextOf(path + ".1"), "first line\n");
}

TEST(Layout, ToolAndPanelLieBesideEachOther) {
  for (const auto& [width, scale] : {std::pair{1280.0F, 1.0F}, {800.0F, 1.0F}, {1600.0F, 2.0F}}) {
    const Layout layout = Layout::Of(width, 0.6F * width, scale);
    const float tool_ends = 2.0F * layout.margin + layout.rail_width + layout.tool_width;
    EXPECT_LE(tool_ends + layout.margin, width - layout.margin - layout.panel_width() + 0.01F);
    EXPECT_GE(layout.tool_width, 260.0F * scale);
  }
  EXPECT_EQ(Layout::Of(3840.0F, 2160.0F, 2.0F).tool_width, 660.0F);
}

TEST(KioskView, LeavesNothingToTheNext) {
  v1::Scene scene;
  scene.set_storm_id("run");
  scene.mutable_output()->set_width_px(800);
  v1::Scene bright;
  bright.mutable_sun()->set_elevation_deg(2.0);
  bright.mutable_display()->set_exposure_ev(3.0);
  bright.add_fields()->set_hydrometeor(v1::HYDROMETEOR_ICE);
  bright.mutable_output()->set_width_px(64);
  v1::Scene plain;
  plain.mutable_camera()->mutable_orbit()->set_azimuth_deg(200.0);
  LayView(bright, scene);
  LayView(plain, scene);
  EXPECT_FALSE(scene.has_sun());
  EXPECT_FALSE(scene.has_display());
  EXPECT_EQ(scene.fields_size(), 0);
  EXPECT_EQ(scene.storm_id(), "run");
  EXPECT_EQ(scene.output().width_px(), 800U) << "the window's size, not the file's";
}

TEST(KioskView, IsLaidOverTheSceneWithoutDoublingItsLists) {
  v1::Scene scene;
  scene.set_storm_id("run");
  scene.set_time_index(3);
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(10.0);
  for (const auto name : {v1::HYDROMETEOR_CLOUD, v1::HYDROMETEOR_RAIN}) {
    scene.add_fields()->set_hydrometeor(name);
  }
  scene.add_lights();
  v1::Scene view;
  view.add_fields()->set_hydrometeor(v1::HYDROMETEOR_RAIN);
  view.add_lights();
  view.mutable_camera()->mutable_top_down();
  for (int cycle = 0; cycle < 3; ++cycle) LayView(view, scene);
  ASSERT_EQ(scene.fields_size(), 1);
  EXPECT_EQ(scene.fields(0).hydrometeor(), v1::HYDROMETEOR_RAIN);
  EXPECT_EQ(scene.lights_size(), 1);
  EXPECT_TRUE(scene.camera().has_top_down());
  EXPECT_EQ(scene.time_index(), 3);
  view.set_storm_id("another");
  LayView(view, scene);
  EXPECT_FALSE(scene.has_time_index());
}

}  // namespace
}  // namespace thunderhead::desktop
