// The program's flags.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead_client/connection.h"

namespace thunderhead::desktop {

struct Flags {
  client::ServerAccess access;
  std::string key;  // of the session to join; empty: opens one
  std::string name;
  std::string storm;  // that an own session begins with; empty: the server's first
  bool full_screen = false;
  bool kiosk = false;
  std::vector<std::string> views;  // files of scenes, shown in turn
  double view_seconds = 20.0;
  int width = 1280;  // of the window, in the desktop's units
  int height = 800;
  double scale = 0.0;  // of texts and controls; 0: as the monitor asks
  bool saves_bytes = false;
  std::string status_file;     // one line of JSON a second; empty: none
  bool status_always = false;  // a line after every turn of the loop instead
  double seconds = 0.0;        // to run; 0: until it is closed
  double turn_deg_per_s = 0.0;
};

// The flags, or the exit status where the program is to end at once: after --help, or a message
// about a wrong flag.
struct ParsedFlags {
  std::optional<Flags> flags;
  int exit_status = 0;
};
ParsedFlags ParseFlags(int argc, char** argv);

// A scene from a file in protobuf's JSON, as `thunderhead render --scene` reads it. An error names
// the file and its fault.
absl::StatusOr<v1::Scene> ReadScene(const std::string& path);

}  // namespace thunderhead::desktop
