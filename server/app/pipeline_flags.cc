#include "app/pipeline_flags.h"

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "pipeline/movie.h"
#include "pipeline/product_name.h"

namespace thunderhead::app {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxJobs = 8;

absl::StatusOr<runs::View> ReadView(const SceneFlags& flags, const std::string& name) {
  THUNDERHEAD_ASSIGN_OR_RETURN(v1::Scene scene, ReadScene(flags));
  return runs::MakeView(name, std::move(scene));
}

absl::StatusOr<std::vector<runs::View>> ReadViews(const PipelineFlags& flags) {
  std::vector<runs::View> views;
  if (flags.views.empty()) {
    const std::string name = flags.scene.file.empty() ? "view" : runs::ViewNameOf(flags.scene.file);
    THUNDERHEAD_ASSIGN_OR_RETURN(views.emplace_back(), ReadView(flags.scene, name));
  }
  std::set<std::string> names;
  for (const std::string& file : flags.views) {
    SceneFlags scene = flags.scene;
    scene.view = file;
    THUNDERHEAD_ASSIGN_OR_RETURN(views.emplace_back(), ReadView(scene, runs::ViewNameOf(file)));
    if (names.insert(views.back().name).second) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("two files of --views are named '", views.back().name,
                     "', but products take their names from these files; rename one"));
  }
  return views;
}

}  // namespace

void AddPipelineOptions(CLI::App& command, PipelineFlags& flags) {
  AddViewOptions(command, flags.scene);
  AddTechniqueOptions(command, flags.scene);
  command
      .add_option("--product", flags.product,
                  "Names of the pictures, such as 'out/{storm}_{valid:%Y%m%d_%H%M}_{view}.png'; "
                  "also {run:%Y%m%d%H}, {lead:03d} (hours), {lead_min:04d}, {time:02d}")
      ->required();
  command.add_option("--views", flags.views,
                     "Scene files, one for each view; a view replaces the parts of --scene that it "
                     "has; {view} is the file's name");
  command.add_option(
      "--manifest", flags.manifest,
      "File with a line for each product; by default manifest.jsonl in the products' folder");
  command.add_option("--movie", flags.movie,
                     "Also write a movie of all times, .webm (VP9) or .mp4 (H.264); one of each "
                     "view if its name has {view}, otherwise of the first view");
  command.add_flag(
      "--done", flags.done_markers,
      "Write PRODUCT.done with its SHA-256 (for sha256sum -c) when a product is complete");
  command
      .add_option("--jobs", flags.jobs,
                  "Pictures in progress at a time, so that files are read and written while "
                  "pictures are drawn")
      ->check(CLI::Range(1, kMaxJobs))
      ->capture_default_str();
  command
      .add_option("--error-seconds", flags.error_seconds,
                  "Maximum seconds for measuring each picture's error by path tracing, not with "
                  "--server; 0: take the error from a table")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  AddProductOptions(command, flags.files);
  AddServerFlags(command, flags.server);
  command.add_option("--device", flags.device, "auto, software or a GPU's number")
      ->capture_default_str();
  static const std::map<std::string, runs::ProgressStyle> kStyles = {
      {"auto", runs::ProgressStyle::kAuto},
      {"lines", runs::ProgressStyle::kLines},
      {"json", runs::ProgressStyle::kJson},
      {"ecflow", runs::ProgressStyle::kEcflow},
      {"none", runs::ProgressStyle::kNone}};
  command
      .add_option("--progress", flags.progress,
                  "auto (a bar on a terminal, otherwise a line for each product), lines, json, "
                  "none, or ecflow (lines, and in an ecFlow task also the meter 'products', the "
                  "label 'product' and the event 'first')")
      ->transform(CLI::CheckedTransformer(kStyles).description(""));
}

absl::StatusOr<runs::PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                                     const pipeline::Shard& shard) {
  THUNDERHEAD_ASSIGN_OR_RETURN(pipeline::ProductName product,
                               pipeline::ProductName::Parse("--product", flags.product));
  if (flags.error_seconds > 0.0 && !flags.server.address.empty()) {
    return absl::InvalidArgumentError(
        "--error-seconds works only in this process: omit it or --server");
  }
  runs::PictureRunOptions options{.product = std::move(product)};
  THUNDERHEAD_ASSIGN_OR_RETURN(options.format,
                               ProductFormatOf("--product", flags.product, flags.files));
  THUNDERHEAD_ASSIGN_OR_RETURN(options.views, ReadViews(flags));
  for (runs::View& view : options.views) {
    THUNDERHEAD_RETURN_IF_ERROR(runs::AddFormat(options.format, view));
  }
  if (options.views.size() > 1 && !options.product.Has("view")) {
    return absl::InvalidArgumentError(absl::StrCat("--product is '", flags.product,
                                                   "', so that all ", options.views.size(),
                                                   " views would have the same names; add {view}"));
  }
  options.manifest = flags.manifest;
  if (options.manifest.empty()) {
    options.manifest = (fs::path(options.product.Folder()) / ManifestName(shard)).string();
  }
  options.other_manifests =
      runs::OtherManifestsOf(options.manifest, flags.manifest.empty() && shard.count == 1);
  options.device = flags.device;
  options.jobs = flags.jobs;
  options.error_seconds = flags.error_seconds;
  options.done_markers = flags.done_markers;
  return options;
}

absl::StatusOr<runs::MovieOptions> MovieOptionsOf(const PipelineFlags& flags,
                                                  const runs::ProductFormat& format) {
  runs::MovieOptions options;
  if (flags.movie.empty()) return options;
  if (!format.IsPicture()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--movie needs pictures of .png or .jpg, but --product is '", flags.product,
                     "': omit --movie, or make the movie in a separate run with such pictures"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(options.name, pipeline::ProductName::Parse("--movie", flags.movie));
  const bool of_times = options.name->Has("valid") || options.name->Has("lead") ||
                        options.name->Has("lead_min") || options.name->Has("time");
  if (pipeline::IsMovieName(flags.movie) && !of_times) return options;
  return absl::InvalidArgumentError(absl::StrCat(
      "--movie is '", flags.movie,
      "'; it must end in .webm or .mp4, and have no field but {storm}, {run:...} and {view}"));
}

}  // namespace thunderhead::app
