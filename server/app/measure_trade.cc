#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "accuracy/named_settings.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/kept_reference.h"
#include "app/local_scene.h"
#include "base/own_file.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "gl/context.h"
#include "measure/reference_comparison.h"
#include "measure/trade_table.h"
#include "reference/trace_scene.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct TradeFlags {
  std::string storm;
  SceneFlags scene;
  std::string output = "trade";
  std::string device = "auto";
  int samples_per_pixel = 256;
  std::vector<double> million_paths = {0.1, 0.3, 1.0, 3.0};
  double error_seconds = 0.0;
  bool transports_alone = false;
  bool json = false;
};

absl::Status CheckFlags(const TradeFlags& flags) {
  if (flags.samples_per_pixel >= 16) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--spp is ", flags.samples_per_pixel, "; the reference needs at least 16 samples per pixel"));
}

absl::StatusOr<picture::LinearPicture> ReferenceOf(const TradeFlags& flags, const LocalScene& local,
                                                   const std::string& path,
                                                   const Interruption& interruption) {
  ReferenceRequest request;
  request.name = "the reference";
  request.scene = measure::ReferenceScene(local.scene);
  request.scene_text = local.message.ShortDebugString();
  request.samples_per_pixel = flags.samples_per_pixel;
  return KeptReference(request, *local.fields, path, interruption);
}

// Returns the rows that an earlier run has written to `path`, if any. Rewrites the file with only
// the complete rows.
absl::StatusOr<std::vector<measure::TradeRow>> RowsSoFar(const std::string& path,
                                                         const std::string& head) {
  std::vector<measure::TradeRow> rows;
  std::string text = head;
  if (std::filesystem::exists(path)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string kept, base::ReadOwnFile(path));
    auto earlier = measure::ReadCsv(kept, head);
    if (!earlier.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, " cannot be continued: ", earlier.status().message()));
    }
    rows = *std::move(earlier);
    for (const measure::TradeRow& row : rows) absl::StrAppend(&text, measure::CsvLine(row));
  }
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(path, text));
  return rows;
}

absl::Status MeasureRest(measure::Trade& trade, const std::string& path,
                         const Interruption& interruption,
                         const std::vector<measure::Setting>& sweep,
                         std::vector<measure::TradeRow>* rows) {
  std::ofstream file(path, std::ios::binary | std::ios::app);
  runs::ProgressBar bar("measuring settings");
  double done = 0.0;
  for (const measure::Setting& setting : sweep) {
    bar.Set(done++ / static_cast<double>(sweep.size()));
    if (std::any_of(rows->begin(), rows->end(),
                    [&](const measure::TradeRow& row) { return row.setting == setting; })) {
      continue;
    }
    const auto row = trade.Measure(setting, interruption.Token());
    if (interruption.Token().stop_requested()) {
      return absl::CancelledError(
          absl::StrCat("interrupted; run the same command again to continue ", path));
    }
    THUNDERHEAD_RETURN_IF_ERROR(row.status());
    file << measure::CsvLine(*row) << std::flush;
    if (!file) return absl::UnavailableError(absl::StrCat(path, " cannot be written"));
    rows->push_back(*row);
  }
  return absl::OkStatus();
}

std::string Table(const std::vector<measure::TradeRow>& rows) {
  std::string text =
      absl::StrFormat("%-13s %-28s %-11s %6s %5s %5s %-6s %6s %4s %9s %8s %8s %7s  %s\n",
                      "renderer", "mode", "transport", "slices", "scale", "light", "bits", "Mpaths",
                      "jpeg", "ms", "RMSE", "bias", "FLIP", "RMSE estimated");
  for (const measure::TradeRow& row : rows) {
    const measure::Setting& setting = row.setting;
    absl::StrAppendFormat(
        &text,
        "%-13s %-28s %-11s %6d %5g %5g %-6s %6g %4d %9.2f %8.4f %+8.4f %7.4f  %6.4f (%.4f to "
        "%.4f)%s\n",
        scene::NameOf(setting.technique), accuracy::ModeOf(setting.technique).name,
        accuracy::TransportNameOf(setting.technique), scene::CountOf(setting.technique),
        setting.image_scale, setting.light_detail, setting.single_precision ? "single" : "half",
        setting.million_paths, setting.jpeg_quality, row.milliseconds, row.relative_rmse,
        row.relative_bias, row.flip, row.estimated_error.value, row.estimated_error.low,
        row.estimated_error.high, row.pareto ? "  *" : "");
  }
  return text;
}

absl::Status MeasureTrade(const TradeFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_RETURN_IF_ERROR(CheckFlags(flags));
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local,
                               OpenScene(flags.storm, flags.scene, interruption.Token()));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      picture::LinearPicture traced,
      ReferenceOf(flags, local, flags.output + ".reference.exr", interruption));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const measure::ReferenceComparison comparison,
      measure::ReferenceComparison::Of(local.scene, *local.fields, std::move(traced),
                                       reference::kPeakCut_deg));
  measure::Trade trade(local.scene, local.fields, comparison, flags.error_seconds);
  measure::TradeTitle title;
  title.storm = absl::StrCat(local.storm_id, ", time ", local.message.time_index());
  title.view = flags.scene.camera.empty() ? "orbit" : flags.scene.camera;
  title.renderer = context->Info().renderer;
  title.size_px = comparison.Reference().size_px;
  title.reference_samples_per_pixel = flags.samples_per_pixel;
  title.reference_noise = comparison.Noise();
  const std::string csv = flags.output + ".csv";
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<measure::TradeRow> rows,
                               RowsSoFar(csv, measure::CsvHead(title)));
  const std::vector<measure::Setting> sweep = flags.transports_alone
                                                  ? measure::TransportSweep(flags.million_paths)
                                                  : measure::DefaultSweep(flags.million_paths);
  THUNDERHEAD_RETURN_IF_ERROR(MeasureRest(trade, csv, interruption, sweep, &rows));
  measure::MarkPareto(&rows);
  const std::string json = measure::TradeJson(title, rows);
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(flags.output + ".json", json));
  THUNDERHEAD_RETURN_IF_ERROR(
      base::WriteWholeFile(flags.output + ".svg", measure::TradeSvg(title, rows)));
  std::cout << (flags.json ? json : Table(rows));
  return absl::OkStatus();
}

}  // namespace

Command AddMeasureTrade(CLI::App& measure) {
  auto flags = std::make_shared<TradeFlags>();
  flags->scene.size = "240x160";
  CLI::App* trade = measure.add_subcommand(
      "trade", "Measure time and error of every setting; continues an interrupted run");
  trade->add_option("STORM", flags->storm, "Storm file or folder")->required();
  trade
      ->add_option("-o,--output", flags->output,
                   "Prefix of the files to write: .csv, .json, .svg and .reference.exr")
      ->capture_default_str();
  AddSceneOptions(*trade, flags->scene);
  trade->add_option("--spp", flags->samples_per_pixel, "Samples per pixel of the reference")
      ->capture_default_str();
  trade
      ->add_option("--million-paths", flags->million_paths,
                   "Also measure the path-traced correction, after this many million paths; give "
                   "several numbers in ascending order")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  trade
      ->add_option("--error-seconds", flags->error_seconds,
                   "Seconds for which each picture's error is also estimated, as a server does "
                   "without a reference; 0: no estimate")
      ->check(CLI::Range(0.0, 600.0))
      ->capture_default_str();
  trade->add_flag("--transports-alone", flags->transports_alone,
                  "Measure only the light volume, with the consistent and diffusion transports and "
                  "the path-traced correction");
  trade->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  trade->add_flag("--json", flags->json, "Print JSON");
  return {trade, [flags] { return MeasureTrade(*flags); }};
}

}  // namespace thunderhead::app
