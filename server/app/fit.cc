#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/output_name.h"
#include "app/seed_flag.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/version.h"
#include "clouds/rbf_fit.h"
#include "runs/local_service.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"
#include "storm_files/cf_writer.h"

namespace thunderhead::app {
namespace {

struct FitFlags {
  std::string storm;
  std::string output;
  std::string volume;
  std::optional<int> time_index;
  std::string field = "extinction";
  std::string basis = "gaussian";
  std::string solver = "direct";
  bool json = false;
  clouds::FitOptions options;
};

// The quantity that the metaballs approximate: the extinction (1/m) of all fields with their
// default optics, or the mass of one field (kg/m3).
struct FitTarget {
  std::string quantity;
  std::string units;
  std::vector<float> values;
};

std::string FieldNames(const volume::HydrometeorFields& fields) {
  return absl::StrJoin(fields.fields, ", ",
                       [](std::string* out, const volume::HydrometeorField& field) {
                         absl::StrAppend(out, std::string(physics::NameOf(field.hydrometeor)));
                       });
}

FitTarget TotalExtinction(const volume::HydrometeorFields& fields) {
  FitTarget target{"extinction", "m-1", std::vector<float>(fields.grid.CellCount(), 0.0F)};
  for (const volume::HydrometeorField& field : fields.fields) {
    const volume::MassExtinction mass_extinction = volume::MassExtinctionOf(
        field, physics::DefaultOptics(field.hydrometeor), physics::SizeSource::kModel);
    volume::AddExtinction(field, mass_extinction, 0, field.concentration_kg_per_m3.size(),
                          target.values.data());
  }
  return target;
}

absl::StatusOr<FitTarget> TargetOf(const volume::HydrometeorFields& fields,
                                   const std::string& name) {
  if (name == "extinction") return TotalExtinction(fields);
  for (const volume::HydrometeorField& field : fields.fields) {
    if (physics::NameOf(field.hydrometeor) != name) continue;
    if (field.quantity == volume::Quantity::kExtinction) break;
    FitTarget target{name, "kg/m3", field.concentration_kg_per_m3};
    target.values.resize(fields.grid.CellCount(), 0.0F);
    return target;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("--field is '", name,
                   "'; it must be extinction or a mass that the storm has: ", FieldNames(fields)));
}

absl::StatusOr<clouds::FitOptions> OptionsOf(const FitFlags& flags) {
  clouds::FitOptions options = flags.options;
  if (flags.basis == "wyvill") {
    options.basis = clouds::Basis::kWyvill;
  } else if (flags.basis != "gaussian") {
    return absl::InvalidArgumentError(
        absl::StrCat("--basis is '", flags.basis, "'; it must be gaussian or wyvill"));
  }
  if (flags.solver == "gradient") {
    options.solver = clouds::Solver::kGradient;
  } else if (flags.solver != "direct") {
    return absl::InvalidArgumentError(
        absl::StrCat("--solver is '", flags.solver, "'; it must be gradient or direct"));
  }
  if (options.balls < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("--balls is ", options.balls, "; it must be 1 or more"));
  }
  if (options.threads < 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--threads is ", options.threads, "; it must be 1 or more, or 0 for one per core"));
  }
  return options;
}

void Print(const FitFlags& flags, const clouds::FitResult& fit, double seconds) {
  if (!flags.json) {
    std::cout << absl::StrFormat(
        "%d balls for %d cells of cloud: H %.6g (%.2f %% of the field, root mean square), %d "
        "epochs "
        "and %d iterations in %.1f s\n",
        fit.cloud.balls.size(), fit.cloudy_cells, fit.error, 100.0 * fit.relative_error, fit.epochs,
        fit.errors.size() - 1, seconds);
    return;
  }
  std::cout << absl::StrFormat(
      "{\n  \"balls\": %d,\n  \"cells\": %d,\n  \"cloudy_cells\": %d,\n  \"error\": %.9g,\n"
      "  \"relative_error\": %.6g,\n  \"epochs\": %d,\n  \"seconds\": %.2f,\n  \"errors\": [",
      fit.cloud.balls.size(), fit.cells, fit.cloudy_cells, fit.error, fit.relative_error,
      fit.epochs, seconds);
  for (std::size_t i = 0; i < fit.errors.size(); ++i) {
    std::cout << absl::StrFormat("%s%.9g", i == 0 ? "" : ", ", fit.errors[i]);
  }
  std::cout << "]\n}\n";
}

absl::StatusOr<clouds::FitResult> FitWithProgress(const volume::RegularGrid& grid,
                                                  const std::vector<float>& values,
                                                  const clouds::FitOptions& options) {
  const Interruption interruption;
  runs::ProgressBar bar("fitting");
  return clouds::Fit(
      grid, values, options,
      [&bar](const clouds::FitProgress& progress) {
        bar.Set(progress.share);
        bar.Note(progress.error > 0.0
                     ? absl::StrFormat("%s, H %.4g", std::string(progress.phase), progress.error)
                     : std::string(progress.phase));
      },
      interruption.Token());
}

// Writes the sum of the balls as a storm file, for comparison with the original.
absl::Status WriteVolume(const FitFlags& flags, const clouds::MetaballCloud& cloud,
                         const volume::RegularGrid& grid) {
  storm_files::CfCloud file;
  file.grid = grid;
  file.quantity = cloud.quantity == "extinction" ? volume::Quantity::kExtinction
                                                 : volume::Quantity::kMassConcentration;
  file.values = clouds::Evaluate(cloud, grid, flags.options.threads);
  file.title = absl::StrCat(cloud.balls.size(), " metaballs");
  file.source = absl::StrCat("thunderhead ", base::Version(), " fit");
  file.comment = absl::StrCat("approximates ", cloud.quantity, " of ", flags.storm);
  return storm_files::WriteCfCloud(file, flags.volume);
}

absl::Status Fit(const FitFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_ASSIGN_OR_RETURN(const clouds::FitOptions options, OptionsOf(flags));
  THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("-o", flags.output, {".balls"}));
  if (!flags.volume.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("--volume", flags.volume, {".nc"}));
    THUNDERHEAD_RETURN_IF_ERROR(CheckNotInput("--volume", flags.volume, flags.storm));
  }
  if (!flags.volume.empty() && flags.field != "extinction" && flags.field != "cloud") {
    return absl::InvalidArgumentError(
        absl::StrCat("--volume can write extinction or cloud, not ", flags.field));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields, runs::ReadStorm(flags.storm, flags.time_index));
  THUNDERHEAD_ASSIGN_OR_RETURN(FitTarget target, TargetOf(*fields, flags.field));
  const base::Stopwatch stopwatch;
  THUNDERHEAD_ASSIGN_OR_RETURN(clouds::FitResult fit,
                               FitWithProgress(fields->grid, target.values, options));
  fit.cloud.quantity = target.quantity;
  fit.cloud.units = target.units;
  const double seconds = 1e-3 * stopwatch.ElapsedMs();
  THUNDERHEAD_RETURN_IF_ERROR(clouds::SaveBalls(fit.cloud, flags.output));
  if (!flags.volume.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(WriteVolume(flags, fit.cloud, fields->grid));
  }
  Print(flags, fit, seconds);
  return absl::OkStatus();
}

}  // namespace

Command AddFit(CLI::App& app) {
  auto flags = std::make_shared<FitFlags>();
  CLI::App* fit = app.add_subcommand("fit", "Approximate a storm by metaballs");
  fit->add_option("STORM", flags->storm, "Storm file or folder")->required();
  fit->add_option("--balls", flags->options.balls, "Number of balls")->required();
  fit->add_option("-o,--output", flags->output, "File of metaballs to write: .balls")->required();
  fit->add_option("--volume", flags->volume, "Also write the balls' sum as a storm file: .nc");
  fit->add_option("--time", flags->time_index,
                  "Index of the storm's time, from 0; by default the last");
  fit->add_option("--field", flags->field,
                  "extinction (of all fields), or a field's mass: cloud, rain, ice, ...")
      ->capture_default_str();
  fit->add_option("--basis", flags->basis, "Radial basis function of a ball: gaussian or wyvill")
      ->capture_default_str();
  fit->add_option("--overlap", flags->options.overlap,
                  "Ratio of a ball's radius to its cluster's sigma")
      ->capture_default_str();
  fit->add_option("--solver", flags->solver, "Solver for the weights: direct or gradient")
      ->capture_default_str();
  fit->add_flag("--non-negative", flags->options.non_negative, "Keep all weights at 0 or above");
  fit->add_option("--iterations", flags->options.max_iterations,
                  "Maximum number of iterations for the weights")
      ->capture_default_str();
  AddSeedFlag(*fit, "Seed of the first centres", &flags->options.seed);
  fit->add_option("--threads", flags->options.threads, "Number of threads; 0: one per core")
      ->capture_default_str();
  fit->add_flag("--json", flags->json,
                "Print JSON, with the error (the paper's H) after every iteration");
  return {fit, [flags] { return Fit(*flags); }};
}

}  // namespace thunderhead::app
