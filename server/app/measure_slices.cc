#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "accuracy/named_settings.h"
#include "app/commands.h"
#include "app/local_scene.h"
#include "app/output_name.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "gl/context.h"
#include "measure/probe.h"
#include "measure/slice_convergence.h"
#include "runs/progress_bar.h"
#include "scene/view.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct SlicesFlags {
  std::string storm;
  std::optional<double> slab;
  SceneFlags scene;
  std::string output;
  std::string device = "auto";
  bool json = false;
};

struct Subject {
  std::string title;
  scene::Scene scene;
  std::shared_ptr<const volume::HydrometeorFields> fields;
};

absl::Status CheckFlags(const SlicesFlags& flags) {
  if (flags.storm.empty() == !flags.slab.has_value()) {
    return absl::InvalidArgumentError("measure slices needs either a STORM or --slab TAU");
  }
  if (flags.slab.has_value() && !(std::isfinite(*flags.slab) && *flags.slab > 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--slab is ", *flags.slab, "; the optical depth must be above 0"));
  }
  if (flags.output.empty()) return absl::OkStatus();
  return CheckEnding("-o", flags.output, {".svg", ".csv"});
}

// Returns the technique with that name; an empty name means half-angle slices.
absl::StatusOr<accuracy::PlainTechnique> TechniqueNamed(const std::string& name) {
  if (name.empty()) return accuracy::Plain<scene::HalfAngle>();
  const auto* const found =
      std::ranges::find(accuracy::kCellTechniques, name, &accuracy::PlainTechnique::name);
  if (found != accuracy::kCellTechniques.end()) return *found;
  return absl::InvalidArgumentError(
      absl::StrCat("--technique is '", name, "'; it must be half_angle or light_volume"));
}

// Returns a smooth cloud of that optical depth, which fills the picture.
Subject SlabOf(double optical_depth) {
  Subject subject{absl::StrFormat("smooth cloud of optical depth %g", optical_depth),
                  {},
                  measure::SmoothCloud(optical_depth)};
  const volume::RegularGrid& grid = subject.fields->grid;
  subject.scene.camera =
      scene::Framing(scene::OrbitCamera(), grid.low_corner_m, grid.HighCorner_m(), 1.0);
  return subject;
}

absl::StatusOr<Subject> SubjectOf(const SlicesFlags& flags) {
  if (flags.slab.has_value()) return SlabOf(*flags.slab);
  THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local, OpenScene(flags.storm, flags.scene));
  return Subject{local.storm_id, local.scene, local.fields};
}

absl::Status MeasureSlices(const SlicesFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_RETURN_IF_ERROR(CheckFlags(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(Subject subject, SubjectOf(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(const accuracy::PlainTechnique technique,
                               TechniqueNamed(flags.scene.technique));
  // Detail is off because procedural detail does not converge with the number of slices.
  subject.scene.rendering.technique = technique.settings();
  subject.scene.output = {.width_px = 160, .height_px = 160};
  // Sky and ground are black, so that only the light of the cloud is measured.
  subject.scene.sky = {0.0, 0.0};
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  absl::StatusOr<std::vector<measure::SliceCurve>> curves;
  {
    runs::ProgressBar bar("slicing");
    curves = measure::MeasureSliceConvergence(subject.scene, subject.fields,
                                              [&bar](double share) { bar.Set(share); });
  }
  THUNDERHEAD_RETURN_IF_ERROR(curves.status());
  if (!flags.output.empty()) {
    const bool svg = absl::EndsWithIgnoreCase(flags.output, ".svg");
    THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(
        flags.output, svg ? measure::ToSvg(subject.title, *curves) : measure::ToCsv(*curves)));
  }
  std::cout << (flags.json ? measure::ToJson(measure::MachineOf(context->Info()), *curves)
                           : measure::ToTable(*curves));
  return absl::OkStatus();
}

}  // namespace

Command AddMeasureSlices(CLI::App& measure) {
  auto flags = std::make_shared<SlicesFlags>();
  CLI::App* slices = measure.add_subcommand(
      "slices", "Measure the convergence of pictures with the number of slices");
  slices->add_option("STORM", flags->storm, "Storm file or folder");
  slices->add_option("--slab", flags->slab,
                     "A smooth cloud of this optical depth instead of a storm");
  slices->add_option("--scene", flags->scene.file, "Scene as Protobuf JSON");
  slices->add_option("--time", flags->scene.time_index,
                     "Index of the storm's time, from 0; by default the last");
  slices->add_option(kTechniqueFlag, flags->scene.technique,
                     "half_angle (the default) or light_volume");
  slices->add_option("-o,--output", flags->output,
                     "File to write: a plot (.svg) or a table (.csv)");
  slices->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  slices->add_flag("--json", flags->json, "Print JSON");
  return {slices, [flags] { return MeasureSlices(*flags); }};
}

}  // namespace thunderhead::app
