// thunderhead: storms from weather models as they would look in the sky. Exit codes: 0 done, 1
// failed, 2 the command line is wrong.
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "app/commands.h"
#include "base/version.h"
#include "spdlog/sinks/stdout_color_sinks.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

int Report(const absl::Status& status) {
  if (status.ok()) return 0;
  std::cerr << "thunderhead: " << status.message() << "\n";
  return status.code() == absl::StatusCode::kInvalidArgument ? kWrongUsage : kFailed;
}

// The parser would only report that a subcommand is required.
absl::Status CheckSubcommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return absl::OkStatus();
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::ranges::find(names, argv[1]) != names.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "there is no subcommand '", argv[1], "'; the subcommands are ", absl::StrJoin(names, ", ")));
}

int Main(int argc, char** argv) {
  // Standard output is for results, so the log goes to standard error.
  spdlog::set_default_logger(spdlog::stderr_color_mt("thunderhead"));
  CLI::App app("Storms from weather models as they would look in the sky.", "thunderhead");
  app.set_version_flag("--version", "thunderhead " + base::Version());
  app.require_subcommand(1);
  const std::array commands = {AddServe(app), AddRender(app),  AddInspect(app),
                               AddFlux(app),  AddMeasure(app), AddGenerate(app),
                               AddFit(app),   AddExport(app),  AddLoad(app)};
  if (const absl::Status status = CheckSubcommand(app, argc, argv); !status.ok()) {
    return Report(status);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "thunderhead: " << error.what() << "; see thunderhead --help\n";
    return kWrongUsage;
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return Report(command.run());
  }
  return kWrongUsage;
}

}  // namespace
}  // namespace thunderhead::app

int main(int argc, char** argv) {
  try {
    return thunderhead::app::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "thunderhead: %s\n", error.what());
    return 1;
  }
}
