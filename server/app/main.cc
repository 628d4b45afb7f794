// thunderhead: storms from weather models as they would look in the sky. The exit codes are in
// runs/exit_codes.h.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "app/commands.h"
#include "app/hidden_flags.h"
#include "app/library_log.h"
#include "app/log_format.h"
#include "app/value_checks.h"
#include "base/error_details.h"
#include "base/loose_thread.h"
#include "base/process_limits.h"
#include "base/version.h"
#include "runs/exit_codes.h"
#include "runs/tell_user.h"
#include "spdlog/sinks/stdout_color_sinks.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

int Report(const absl::Status& status) {
  if (!status.ok()) {
    std::string text(status.message());
    const std::string limits = base::TextOf(base::ReadProcessLimits());
    if (base::DetailsOf(status).reason == "OUT_OF_MEMORY" && !limits.empty()) {
      absl::StrAppend(&text, "; ", limits);
    }
    runs::TellUser(text);
  }
  return static_cast<int>(runs::ExitCodeOf(status));
}

// Reports an allocation, or the start of a thread, that failed.
int ReportNoMemory(const char* what) {
  return Report(
      base::WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                            "the system gives the program no more memory or threads (", what, ")")),
                        {.reason = "OUT_OF_MEMORY"}));
}

// Returns an error that names an unknown subcommand. The parser would only report that a subcommand
// is required.
absl::Status CheckSubcommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return absl::OkStatus();
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::ranges::find(names, argv[1]) != names.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "there is no subcommand '", argv[1], "'; the subcommands are ", absl::StrJoin(names, ", ")));
}

int Main(int argc, char** argv) {
  // SIGXFSZ is ignored, so that reaching the limit on the size of files is a write error and not a
  // signal.
  std::signal(SIGXFSZ, SIG_IGN);
  base::TellLimitsAtUnhandledExceptions();
  // Standard output is for results, so the log goes to standard error.
  spdlog::set_default_logger(spdlog::stderr_color_mt("thunderhead"));
  spdlog::default_logger()->set_formatter(TextFormatter());
  TakeLibraryLogs();
  CLI::App app("Storms from weather models as they would look in the sky.", "thunderhead");
  app.formatter(HelpFormatter());
  app.set_version_flag("--version", "thunderhead " + base::Version());
  app.require_subcommand(1);
  const std::array commands = {AddServe(app),   AddRender(app), AddSequence(app),  AddWatch(app),
                               AddInspect(app), AddFlux(app),   AddMeasure(app),   AddGenerate(app),
                               AddFit(app),     AddExport(app), AddImportVdb(app), AddLoad(app)};
  RefuseWrongValues(app);
  app.footer(runs::ExitCodesHelp());
  for (const Command& command : commands) command.app->footer(runs::ExitCodesHelp());
  if (const absl::Status status = CheckSubcommand(app, argc, argv); !status.ok()) {
    return Report(status);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "thunderhead: " << error.what() << "; see thunderhead --help\n";
    return static_cast<int>(runs::ExitCode::kBadRequest);
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return Report(command.run());
  }
  return static_cast<int>(runs::ExitCode::kBadRequest);
}

}  // namespace
}  // namespace thunderhead::app

int main(int argc, char** argv) {
  try {
    const int code = thunderhead::app::Main(argc, argv);
    if (thunderhead::base::LooseThread::AnyLeftBehind()) {
      spdlog::default_logger()->flush();
      std::fflush(nullptr);
      std::_Exit(code);
    }
    return code;
  } catch (const std::bad_alloc& error) {
    return thunderhead::app::ReportNoMemory(error.what());
  } catch (const std::exception& error) {
    const auto* const failed = dynamic_cast<const std::system_error*>(&error);
    if (failed != nullptr && failed->code() == std::errc::resource_unavailable_try_again) {
      return thunderhead::app::ReportNoMemory(error.what());
    }
    std::fprintf(stderr, "thunderhead: %s\n", error.what());
    return static_cast<int>(thunderhead::runs::ExitCode::kProgramError);
  }
}
