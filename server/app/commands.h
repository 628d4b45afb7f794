// The program's subcommands. Each function adds a subcommand with its flags to `app`, and returns
// the function to run after the flags are parsed. That function returns OK, or the error to print.
// The error's code decides the program's exit code (runs/exit_codes.h).
#pragma once

#include <functional>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"

namespace thunderhead::app {

struct Command {
  CLI::App* app = nullptr;
  std::function<absl::Status()> run;
};

Command AddServe(CLI::App& app);
Command AddRender(CLI::App& app);
Command AddSequence(CLI::App& app);
Command AddWatch(CLI::App& app);
Command AddInspect(CLI::App& app);
Command AddFlux(CLI::App& app);
Command AddMeasure(CLI::App& app);
// Subcommands of `measure`.
Command AddMeasureFrames(CLI::App& measure);
Command AddMeasureExtremes(CLI::App& measure);
Command AddMeasureSlices(CLI::App& measure);
Command AddMeasureTrade(CLI::App& measure);
Command AddMeasureLight(CLI::App& measure);
Command AddMeasureLook(CLI::App& measure);
Command AddGenerate(CLI::App& app);
Command AddFit(CLI::App& app);
Command AddExport(CLI::App& app);
Command AddImportVdb(CLI::App& app);
Command AddLoad(CLI::App& app);

}  // namespace thunderhead::app
