#include <algorithm>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/commands.h"
#include "base/status.h"
#include "gl/context.h"
#include "measure/extremes.h"
#include "measure/machine.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct ExtremesFlags {
  std::string device = "auto";
  bool json = false;
};

struct Row {
  std::string name;
  measure::Verdict verdict;
};

absl::StatusOr<std::vector<Row>> RunAll() {
  runs::ProgressBar bar("trying extremes");
  measure::Probe probe;
  std::vector<Row> rows;
  const std::vector<measure::Extreme> extremes = measure::Extremes();
  for (const measure::Extreme& extreme : extremes) {
    THUNDERHEAD_ASSIGN_OR_RETURN(measure::Verdict verdict, extreme.check(probe));
    rows.push_back({extreme.name, std::move(verdict)});
    bar.Set(static_cast<double>(rows.size()) / static_cast<double>(extremes.size()));
  }
  return rows;
}

std::string Table(const std::vector<Row>& rows) {
  std::string text =
      absl::StrFormat("%-75s %-38s %-38s %s\n", "case", "expected", "got", "verdict");
  for (const Row& row : rows) {
    absl::StrAppendFormat(&text, "%-75s %-38s %-38s %s\n", row.name, row.verdict.expected,
                          row.verdict.got, row.verdict.passed ? "ok" : "FAILED");
  }
  return text;
}

std::string Json(const measure::Machine& machine, const std::vector<Row>& rows) {
  std::string text =
      absl::StrCat("{\n  \"machine\": ", measure::ToJson(machine), ",\n  \"rows\": [");
  const char* separator = "\n";
  for (const Row& row : rows) {
    absl::StrAppendFormat(
        &text, "%s    {\"case\": %s, \"expected\": %s, \"got\": %s, \"passed\": %s}", separator,
        measure::JsonText(row.name), measure::JsonText(row.verdict.expected),
        measure::JsonText(row.verdict.got), row.verdict.passed ? "true" : "false");
    separator = ",\n";
  }
  return text + "\n  ]\n}\n";
}

absl::Status MeasureExtremes(const ExtremesFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<Row> rows, RunAll());
  std::cout << (flags.json ? Json(measure::MachineOf(context->Info()), rows) : Table(rows));
  const auto failed =
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.verdict.passed; });
  if (failed == 0) return absl::OkStatus();
  return absl::InternalError(absl::StrCat(failed, " of ", rows.size(), " extremes failed"));
}

}  // namespace

Command AddMeasureExtremes(CLI::App& measure) {
  auto flags = std::make_shared<ExtremesFlags>();
  CLI::App* extremes = measure.add_subcommand("extremes", "Check the response to extreme inputs");
  extremes->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  extremes->add_flag("--json", flags->json, "Print JSON");
  return {extremes, [flags] { return MeasureExtremes(*flags); }};
}

}  // namespace thunderhead::app
