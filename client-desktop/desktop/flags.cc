#include "desktop/flags.h"

#include <google/protobuf/util/json_util.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"

namespace thunderhead::desktop {

ParsedFlags ParseFlags(int argc, char** argv) {
  CLI::App app("Shows the storms of a Thunderhead server in a window.");
  Flags flags;
  flags.access.address = "localhost:50051";  // a server on this machine with its default port
  app.add_option("server", flags.access.address, "HOST:PORT of the server's gRPC port")
      ->capture_default_str();
  app.add_option("--key", flags.key,
                 "key of the session to join; without it a new session is opened");
  app.add_option("--name", flags.name, "name that others in the session see");
  app.add_option("--storm", flags.storm, "id of the storm to begin with (default: the first)");
  app.add_option("--tls-ca", flags.access.tls_ca_file,
                 "PEM file of the authority that signed the server's certificate; without it "
                 "nothing is encrypted");
  app.add_option("--token-file", flags.access.token_file, "file with the access token");
  app.add_flag("--allow-plaintext-token", flags.access.allow_plaintext_token,
               "sends the token to another machine without encryption, where others may read it");
  app.add_flag("--full-screen", flags.full_screen, "begins in full screen");
  CLI::Option* const kiosk =
      app.add_flag("--kiosk", flags.kiosk,
                   "for a wall display: full screen, no controls, reconnects without end");
  app.add_option("--views", flags.views, "scene files (JSON) that a kiosk shows in turn")
      ->needs(kiosk);
  app.add_option("--view-seconds", flags.view_seconds,
                 "seconds for which a kiosk shows each of --views")
      ->check(CLI::Range(1.0, 86400.0));
  app.add_option("--width", flags.width, "width of the window")->check(CLI::Range(320, 16384));
  app.add_option("--height", flags.height, "height of the window")->check(CLI::Range(240, 16384));
  app.add_option("--scale", flags.scale,
                 "factor for the size of texts and controls (default: the monitor's)")
      ->check(CLI::Range(0.5, 4.0));
  app.add_flag("--save-bytes", flags.saves_bytes,
               "receives video even on a fast link, to save bytes");
  app.add_option(
      "--status", flags.status_file,
      "file to which a line of JSON is appended each second; at 1 MiB it is renamed to FILE.1");
  // Tests need this flag to wait for states. The empty group hides it in the help.
  app.add_flag("--status-always", flags.status_always)->group("");
  app.add_option("--seconds", flags.seconds,
                 "ends after this many seconds and prints the figures of the pictures shown")
      ->check(CLI::Range(1.0, 1e7));
  app.add_option("--turn", flags.turn_deg_per_s,
                 "turns the camera, in degrees a second, to measure")
      ->check(CLI::Range(-360.0, 360.0));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int kUsage = 64;  // same exit status as the server's program for wrong flags
    return {{}, app.exit(error) == 0 ? 0 : kUsage};
  }
  return {std::move(flags), 0};
}

absl::StatusOr<v1::Scene> ReadScene(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return absl::NotFoundError(
        absl::StrCat("cannot read the view '", path, "'; check its path and permissions"));
  }
  const std::string text(std::istreambuf_iterator<char>(file), {});
  v1::Scene scene;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &scene);
  if (!status.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", path, "' is not a scene: ", std::string(status.message()),
                     "; docs/guide has examples"));
  }
  return scene;
}

}  // namespace thunderhead::desktop
