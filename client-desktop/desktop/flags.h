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
  std::vector<std::string> views;  // scene files, shown in turn
  double view_seconds = 20.0;
  int width = 1280;  // size of the window, in the desktop's units
  int height = 800;
  double scale = 0.0;  // scale of texts and controls; 0: chosen for the monitor
  bool saves_bytes = false;
  std::string status_file;     // file for one line of JSON a second; empty: none
  bool status_always = false;  // writes a line after every turn of the loop instead
  double seconds = 0.0;        // run time; 0: until the window is closed
  double turn_deg_per_s = 0.0;
};

// The flags, or the exit status if the program must end at once. It ends after --help, or after a
// message about a wrong flag.
struct ParsedFlags {
  std::optional<Flags> flags;
  int exit_status = 0;
};
ParsedFlags ParseFlags(int argc, char** argv);

// Reads a scene from a file in protobuf's JSON, like `thunderhead render --scene`. The error names
// the file and the fault.
absl::StatusOr<v1::Scene> ReadScene(const std::string& path);

}  // namespace thunderhead::desktop
