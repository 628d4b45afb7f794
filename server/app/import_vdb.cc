#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
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
#include "base/status.h"
#include "interchange/vdb_file_reader.h"
#include "interchange/vdb_import.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct ImportVdbFlags {
  std::string file;
  std::string output;
  std::string grid;
  std::string up;
  std::optional<double> metres_per_unit;
  std::optional<double> extinction_per_unit;
  std::optional<double> base_m;
  double memory_mib = 0.0;
};

constexpr char kUpHelp[] = "the axis of the file that is up: x, y or z";
constexpr char kMetresHelp[] = "length in m of a unit of the file's coordinates";
constexpr char kExtinctionHelp[] = "extinction in 1/m of a voxel with the value 1";

// Returns one error that names all missing flags. The OpenVDB file does not contain the values that
// these flags give.
absl::Status CheckGiven(const ImportVdbFlags& flags) {
  std::vector<std::string> missing;
  const auto need = [&missing](bool given, const char* flag, const char* help) {
    if (!given) missing.push_back(absl::StrCat(flag, " (", help, ")"));
  };
  need(!flags.up.empty(), "--up", kUpHelp);
  need(flags.metres_per_unit.has_value(), "--metres-per-unit", kMetresHelp);
  need(flags.extinction_per_unit.has_value(), "--extinction-per-unit", kExtinctionHelp);
  if (missing.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("an OpenVDB file does not say all that a storm "
                   "needs; give ",
                   absl::StrJoin(missing, ", and ")));
}

absl::Status CheckPositive(const char* flag, double value) {
  if (std::isfinite(value) && value > 0.0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " is ", value, "; it must be a number above 0"));
}

absl::StatusOr<interchange::ImportOptions> OptionsOf(const ImportVdbFlags& flags) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckGiven(flags));
  THUNDERHEAD_RETURN_IF_ERROR(CheckPositive("--metres-per-unit", *flags.metres_per_unit));
  THUNDERHEAD_RETURN_IF_ERROR(CheckPositive("--extinction-per-unit", *flags.extinction_per_unit));
  if (flags.base_m.has_value() && !(std::isfinite(*flags.base_m) && *flags.base_m >= 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--base is ", *flags.base_m, "; it must be 0 or more"));
  }
  interchange::ImportOptions options;
  options.metres_per_unit = *flags.metres_per_unit;
  options.extinction_per_m = *flags.extinction_per_unit;
  options.base_m = flags.base_m;
  if (flags.up == "x") {
    options.up = interchange::UpAxis::kX;
  } else if (flags.up == "y") {
    options.up = interchange::UpAxis::kY;
  } else if (flags.up != "z") {
    return absl::InvalidArgumentError(
        absl::StrCat("--up is '", flags.up, "'; it must be x, y or z"));
  }
  return options;
}

void Print(const storm_files::CfCloud& cloud, const std::string& path) {
  const auto& [cells, spacing_m, low_corner_m] = cloud.grid;
  std::cout << absl::StrFormat(
      "%s\n  %d x %d x %d cells of %g x %g x %g m, heights %g to %g m, extinction up to %g 1/m\n",
      path, cells.x, cells.y, cells.z, spacing_m.x, spacing_m.y, spacing_m.z, low_corner_m.z,
      cloud.grid.HighCorner_m().z, *std::max_element(cloud.values.begin(), cloud.values.end()));
}

absl::Status ImportVdb(const ImportVdbFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_RETURN_IF_ERROR(CheckEnding("-o", flags.output, {".nc"}));
  std::optional<interchange::ImportOptions> options;
  // Without the name of a grid, the options are not needed: reading the file then returns an error
  // that lists its grids.
  if (!flags.grid.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(options, OptionsOf(flags));
  }
  const Interruption interruption;
  runs::ProgressBar bar("importing");
  constexpr double kShareOfReading = 0.5;
  const auto checkpoint = [&](double share) -> absl::Status {
    if (interruption.Token().stop_requested()) {
      return absl::CancelledError("interrupted: no file was written");
    }
    bar.Set(kShareOfReading * share);
    return absl::OkStatus();
  };
  const interchange::VdbReaderOptions reader = {
      .memory_bytes = static_cast<std::uint64_t>(flags.memory_mib) << 20,
      .memory_flag = "--memory",
      .stop = interruption.Token()};
  THUNDERHEAD_ASSIGN_OR_RETURN(interchange::VdbVolume volume,
                               interchange::ReadVdb(flags.file, flags.grid, checkpoint, reader));
  if (!options.has_value()) {
    return absl::InternalError(absl::StrCat(flags.file, ": a grid without a name was read"));
  }
  absl::StatusOr<storm_files::CfCloud> cloud = interchange::CloudOf(volume, *options);
  if (!cloud.ok()) return base::Annotate(cloud.status(), flags.file);
  cloud->title =
      absl::StrCat(std::filesystem::path(flags.file).filename().string(), ", ", flags.grid);
  volume = {};
  THUNDERHEAD_RETURN_IF_ERROR(checkpoint(1.0));
  THUNDERHEAD_RETURN_IF_ERROR(storm_files::WriteCfCloud(*cloud, flags.output));
  Print(*cloud, flags.output);
  return absl::OkStatus();
}

}  // namespace

Command AddImportVdb(CLI::App& app) {
  auto flags = std::make_shared<ImportVdbFlags>();
  CLI::App* command = app.add_subcommand(
      "import-vdb", "Convert a density grid of an OpenVDB file to a storm file of extinction");
  command->add_option("FILE", flags->file, "OpenVDB file: .vdb")->required();
  command->add_option("-o,--output", flags->output, "Storm file to write: .nc")->required();
  command->add_option("--grid", flags->grid,
                      "Required: the name of the grid; without it the error lists the grids");
  command->add_option("--up", flags->up, absl::StrCat("Required: ", kUpHelp));
  command->add_option("--metres-per-unit", flags->metres_per_unit,
                      absl::StrCat("Required: ", kMetresHelp));
  command->add_option("--extinction-per-unit", flags->extinction_per_unit,
                      absl::StrCat("Required: ", kExtinctionHelp));
  command->add_option("--base", flags->base_m,
                      "Height in m of the lowest active voxels; by default the file's");
  command
      ->add_option("--memory", flags->memory_mib,
                   "Maximum MiB of memory for reading the file; by default 512 MiB plus 100 times "
                   "the file's size")
      ->check(CLI::Range(16.0, 1e9));
  return {command, [flags] { return ImportVdb(*flags); }};
}

}  // namespace thunderhead::app
