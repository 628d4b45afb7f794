#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/output_name.h"
#include "app/seed_flag.h"
#include "base/status.h"
#include "clouds/cloud_file.h"
#include "clouds/presets.h"
#include "runs/progress_bar.h"

namespace thunderhead::app {
namespace {

using clouds::CloudShape;

struct GenerateFlags {
  std::string output;
  std::string preset = "fair-weather-cumulus";
  std::uint64_t seed = 1;
  std::optional<int> octaves;
  std::optional<double> persistence;
  std::string interpolation;
  std::optional<double> feature_m;
  std::optional<double> threshold;
  std::optional<double> dynamics;
  std::optional<double> water_g_per_m3;
  std::optional<double> base_m;
  std::vector<std::string> ellipsoids;
  std::string cells;
  std::optional<double> spacing_m;
};

absl::StatusOr<std::vector<double>> Numbers(const std::string& text, char separator) {
  std::vector<double> numbers;
  for (const auto part : absl::StrSplit(text, separator)) {
    if (!absl::SimpleAtod(part, &numbers.emplace_back())) {
      return absl::InvalidArgumentError(absl::StrCat("'", part, "' is not a number"));
    }
  }
  return numbers;
}

absl::StatusOr<clouds::Ellipsoid> ParseEllipsoid(const std::string& text) {
  const auto numbers = Numbers(text, ',');
  if (!numbers.ok() || (numbers->size() != 6 && numbers->size() != 9)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--ellipsoid is '", text,
        "'; it must be X,Y,Z,RX,RY,RZ in m, optionally followed by ,AX,AY,AZ in degrees"));
  }
  const std::vector<double>& n = *numbers;
  clouds::Ellipsoid ellipsoid{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {}};
  if (n.size() == 9) ellipsoid.rotation_deg = {n[6], n[7], n[8]};
  return ellipsoid;
}

absl::Status SetNoise(const GenerateFlags& flags, CloudShape* shape) {
  shape->noise.octaves = flags.octaves.value_or(shape->noise.octaves);
  shape->noise.persistence = flags.persistence.value_or(shape->noise.persistence);
  shape->feature_m = flags.feature_m.value_or(shape->feature_m);
  if (flags.interpolation == "linear") {
    shape->noise.interpolation = clouds::NoiseInterpolation::kLinear;
  } else if (flags.interpolation == "cosine") {
    shape->noise.interpolation = clouds::NoiseInterpolation::kCosine;
  } else if (flags.interpolation == "cubic") {
    shape->noise.interpolation = clouds::NoiseInterpolation::kCubic;
  } else if (!flags.interpolation.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("--interpolation is '", flags.interpolation,
                                                   "'; it must be linear, cosine or cubic"));
  }
  return absl::OkStatus();
}

absl::Status SetGrid(const GenerateFlags& flags, volume::RegularGrid* grid) {
  if (!flags.cells.empty()) {
    const auto numbers = Numbers(flags.cells, 'x');
    if (!numbers.ok() || numbers->size() != 3) {
      return absl::InvalidArgumentError(absl::StrCat(
          "--cells is '", flags.cells, "'; it must be NXxNYxNZ, for example 128x128x64"));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double count = (*numbers)[static_cast<std::size_t>(axis)];
      if (!(count >= 1.0 && count <= 4096.0 && count == std::floor(count))) {
        return absl::InvalidArgumentError(absl::StrCat(
            "--cells is '", flags.cells, "'; each number must be an integer from 1 to 4096"));
      }
      grid->cells[axis] = static_cast<int>(count);
    }
  }
  if (flags.spacing_m.has_value()) grid->spacing_m = glm::dvec3(*flags.spacing_m);
  grid->low_corner_m = {-0.5 * grid->cells.x * grid->spacing_m.x,
                        -0.5 * grid->cells.y * grid->spacing_m.y, 0.0};
  return absl::OkStatus();
}

absl::StatusOr<CloudShape> ShapeOf(const GenerateFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CloudShape shape, clouds::PresetNamed(flags.preset, flags.seed));
  THUNDERHEAD_RETURN_IF_ERROR(SetNoise(flags, &shape));
  THUNDERHEAD_RETURN_IF_ERROR(SetGrid(flags, &shape.grid));
  shape.threshold = flags.threshold.value_or(shape.threshold);
  shape.dynamics = flags.dynamics.value_or(shape.dynamics);
  if (flags.water_g_per_m3.has_value()) shape.water_kg_per_m3 = 1e-3 * *flags.water_g_per_m3;
  if (!flags.ellipsoids.empty()) {
    shape.ellipsoids.clear();
    shape.base_m.reset();  // the preset's base belongs to the removed ellipsoids
  }
  for (const std::string& text : flags.ellipsoids) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const clouds::Ellipsoid ellipsoid, ParseEllipsoid(text));
    shape.ellipsoids.push_back(ellipsoid);
  }
  if (flags.base_m.has_value()) shape.base_m = flags.base_m;
  return shape;
}

absl::Status Generate(const GenerateFlags& flags) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("-o", flags.output, {".nc"}));
  THUNDERHEAD_ASSIGN_OR_RETURN(const CloudShape shape, ShapeOf(flags));
  const Interruption interruption;
  runs::ProgressBar bar("generating");
  return clouds::WriteGenerated(
      shape, {flags.preset, flags.seed}, flags.output, [&bar](double share) { bar.Set(share); },
      interruption.Token());
}

}  // namespace

Command AddGenerate(CLI::App& app) {
  auto flags = std::make_shared<GenerateFlags>();
  CLI::App* generate = app.add_subcommand("generate", "Generate a cloud without a model run");
  generate->add_option("-o,--output", flags->output, "Storm file to write: .nc")->required();
  generate
      ->add_option("--preset", flags->preset,
                   "Shape of the cloud: " + absl::StrJoin(clouds::PresetNames(), ", "))
      ->capture_default_str();
  AddSeedFlag(*generate, "Seed of the noise", &flags->seed);
  const std::string otherwise = "; by default the preset's";
  generate->add_option("--octaves", flags->octaves, "Octaves of noise, 1 to 16" + otherwise);
  generate->add_option(
      "--persistence", flags->persistence,
      "Ratio of an octave's amplitude to that of the next coarser, up to 1" + otherwise);
  generate->add_option("--interpolation", flags->interpolation,
                       "Interpolation of the noise: linear, cosine or cubic" + otherwise);
  generate->add_option("--feature-size", flags->feature_m,
                       "Coarsest scale of the noise in m" + otherwise);
  generate->add_option("--threshold", flags->threshold,
                       "Density below which the air is clear, from 0 to 1" + otherwise);
  generate->add_option("--dynamics", flags->dynamics,
                       "Factor of the density, above 0 up to 1" + otherwise);
  generate->add_option("--water", flags->water_g_per_m3,
                       "Liquid water content at density 1, g/m3" + otherwise);
  generate->add_option("--base", flags->base_m, "Height of the cloud base in m" + otherwise);
  generate
      ->add_option("--ellipsoid", flags->ellipsoids,
                   "X,Y,Z,RX,RY,RZ[,AX,AY,AZ] in m and degrees instead of the preset's; "
                   "repeat for several")
      ->allow_extra_args(false);
  generate->add_option("--cells", flags->cells, "Number of cells, NXxNYxNZ" + otherwise);
  generate->add_option("--spacing", flags->spacing_m, "Size of a cell in m" + otherwise);
  return {generate, [flags] { return Generate(*flags); }};
}

}  // namespace thunderhead::app
