// The command-line flags of the program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead_client/connection.h"

namespace thunderhead::desktop {

struct Flags {
  client::ServerAccess access;
  std::string key;  // key of the session to join; empty: opens a new session
  std::string name;
  std::string storm;  // storm of a new session; empty: the server's first
  bool full_screen = false;
  bool kiosk = false;
  std::vector<std::string> views;  // scene files that a kiosk shows in turn
  double view_seconds = 20.0;
  int width = 1280;  // size of the window in the desktop's units, which may be several pixels each
  int height = 800;
  // Scale factor of texts and controls; 0: the program chooses it for the monitor.
  double scale = 0.0;
  bool saves_bytes = false;
  std::string status_file;     // file that gets one line of JSON a second; empty: writes no file
  bool status_always = false;  // writes a line at every turn of the event loop, not once a second
  double seconds = 0.0;        // run time in seconds; 0: runs until the window is closed
  double turn_deg_per_s = 0.0;
};

// The parsed flags, or an exit status if the program must end at once. This happens after --help
// and after an error in the flags.
struct ParsedFlags {
  std::optional<Flags> flags;
  int exit_status = 0;
};
ParsedFlags ParseFlags(int argc, char** argv);

// Reads a scene from a Protobuf JSON file, the format of `thunderhead render --scene`. The error
// names the file and what is wrong.
absl::StatusOr<v1::Scene> ReadScene(const std::string& path);

}  // namespace thunderhead::desktop
