#include <iostream>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "accuracy/named_settings.h"
#include "app/commands.h"
#include "app/picture_size.h"
#include "base/status.h"
#include "gl/context.h"
#include "measure/frame_rates.h"
#include "runs/local_service.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

using FieldsPtr = std::shared_ptr<const volume::HydrometeorFields>;

struct FramesFlags {
  std::string storm;
  std::optional<int> time_index;
  measure::FrameRateOptions options;
  std::string size = absl::StrCat(options.width_px, "x", options.height_px);
  std::string transport = "consistent";
  std::string device = "auto";
  bool json = false;
};

absl::StatusOr<FieldsPtr> Read(storm_store::StormStore& store, int time_index) {
  THUNDERHEAD_RETURN_IF_ERROR(runs::ReadWithProgress(store, time_index));
  return store.Get(store.Storms().front()->id, time_index, {});
}

// Returns the fields of the requested time, or of the time with the most condensate.
absl::StatusOr<FieldsPtr> Choose(const FramesFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<storm_store::StormStore> store,
                               runs::OpenStorm(flags.storm));
  if (flags.time_index.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const int time_index,
                                 runs::TimeOf(*store, flags.storm, flags.time_index));
    return Read(*store, time_index);
  }
  FieldsPtr best;
  for (std::size_t i = 0; i < store->Storms().front()->times.size(); ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const FieldsPtr fields, Read(*store, static_cast<int>(i)));
    if (best == nullptr || measure::Condensate_kg(*fields) > measure::Condensate_kg(*best)) {
      best = fields;
    }
  }
  return best;
}

absl::Status MeasureFrames(const FramesFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  measure::FrameRateOptions options = flags.options;
  THUNDERHEAD_ASSIGN_OR_RETURN(const PictureSize size, ParsePictureSize(flags.size));
  options.width_px = size.width_px;
  options.height_px = size.height_px;
  if (options.slices < 1 || options.slices > 4096) {
    return absl::InvalidArgumentError(
        absl::StrCat("--slices is ", options.slices, "; it must be from 1 to 4096"));
  }
  for (const auto& transport : accuracy::kTransportNames) {
    if (transport.name == flags.transport) options.transport = transport.value;
  }
  if (options.runs < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("--runs is ", options.runs, "; it must be 1 or more"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const FieldsPtr fields, Choose(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  absl::StatusOr<std::vector<measure::FrameRateRow>> rows;
  {
    runs::ProgressBar bar("drawing");
    rows = measure::MeasureFrameRates(fields, options, [&bar](double share) { bar.Set(share); });
  }
  THUNDERHEAD_RETURN_IF_ERROR(rows.status());
  const measure::Machine machine = measure::MachineOf(context->Info());
  std::cout << (flags.json ? measure::ToJson(machine, *rows) : measure::ToTable(machine, *rows));
  return absl::OkStatus();
}

}  // namespace

Command AddMeasureFrames(CLI::App& measure) {
  auto flags = std::make_shared<FramesFlags>();
  CLI::App* frames =
      measure.add_subcommand("frames", "Measure the frame rate of each technique and preset");
  frames->add_option("STORM", flags->storm, "Storm file or folder")->required();
  frames->add_option("--time", flags->time_index,
                     "Index of the time, from 0; by default the one with the most condensate");
  frames->add_option("--size", flags->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  frames
      ->add_option("--slices", flags->options.slices,
                   "Slices, or samples along a ray, in the papers' modes")
      ->capture_default_str();
  frames
      ->add_option("--transport", flags->transport,
                   "Transport in the papers' modes: paper, consistent or diffusion")
      ->check(CLI::IsMember({"paper", "consistent", "diffusion"}))
      ->capture_default_str();
  frames->add_option("--runs", flags->options.runs, "Number of runs; their medians are printed")
      ->capture_default_str();
  frames
      ->add_option("--seconds", flags->options.seconds_a_run,
                   "Minimum seconds of each run; the camera and the sun are moved in separate runs")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  frames->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  frames->add_option("--mode", flags->options.only_mode,
                     "Only rows of this mode or preset; \"default\": the setting of a new scene");
  frames->add_flag("--json", flags->json, "Print JSON");
  return {frames, [flags] { return MeasureFrames(*flags); }};
}

}  // namespace thunderhead::app
