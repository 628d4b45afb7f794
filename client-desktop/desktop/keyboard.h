// The window's keys. A function that the web page also has uses the same key
// (docs/guide/look-at-a-storm.md). A key that only this window uses has no meaning on the page.
// This code reads SDL's events and does not depend on the window.
#pragma once

#include <SDL.h>

#include <array>
#include <functional>
#include <string_view>
#include <utility>

#include "desktop/choices.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::desktop {

struct KeyActions {
  std::function<void(const std::function<client::Pose(const client::Pose&)>&)> move;
  std::function<void()> home;
  std::function<void(Tool)> toggle_tool;
  std::function<void(Panel)> toggle_panel;
  std::function<void()> toggle_play;
  std::function<void(int by)> step_time;
  std::function<void()> undo;
  std::function<void()> redo;
  std::function<void()> full_screen;
  std::function<void()> focus_panel;
  std::function<void()> escape;  // closes the uppermost panel or tool
};

// The kind of control that has the keyboard focus, if any.
struct KeyFocus {
  bool text = false;      // a text field has the focus and uses all keys
  bool controls = false;  // another control has the focus and uses arrows, space and Enter
};

// Handles a key press. A letter is recognized by the keyboard's layout, a digit also by the key's
// position. Returns true if the key had an effect.
bool TakeKey(const SDL_KeyboardEvent& event, const KeyFocus& focus, const KeyActions& actions);
// Handles the text of an SDL_TEXTINPUT event: punctuation and digits as the keyboard's layout
// produces them, with or without Shift. `modifiers` are the modifier keys that are held now.
// Returns true if the text had an effect.
bool TakeText(std::string_view text, Uint16 modifiers, const KeyFocus& focus,
              const KeyActions& actions);

inline constexpr std::array<std::pair<const char*, const char*>, 16> kKeyTexts{{
    {"Drag, arrows", "turn"},
    {"Right or shift drag, shift + arrows", "move"},
    {"Wheel, pinch, + -", "nearer, farther"},
    {"Home", "see the whole storm"},
    {"Space", "play or pause"},
    {", .", "one time back, forward"},
    {"M T L K F D", "camera, time, light, look, fields, marks"},
    {"1 2 3 4 5 7", "the same"},
    {"X", "every setting"},
    {"H", "share: people, keys and control"},
    {"O", "storms"},
    {"I", "figures of the pictures"},
    {"Tab", "go into the open panel by keys"},
    {"Ctrl + Z, Ctrl + Y", "undo, redo"},
    {"W, F11", "full screen"},
    {"?, Escape", "these keys; close what is open"},
}};

}  // namespace thunderhead::desktop
