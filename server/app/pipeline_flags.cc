#include "app/pipeline_flags.h"

#include <google/protobuf/util/json_util.h>

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "pipeline/sha256.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::app {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxJobs = 8;

// Returns the file's name in a form that can be part of a product's name.
std::string ViewNameOf(const std::string& file) {
  std::string name = fs::path(file).stem().string();
  for (char& c : name) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') {
      c = '-';
    }
  }
  return name.empty() ? "view" : name;
}

absl::StatusOr<View> ReadView(const SceneFlags& flags, const std::string& name) {
  View view;
  view.name = name;
  THUNDERHEAD_ASSIGN_OR_RETURN(view.scene, ReadScene(flags));
  THUNDERHEAD_RETURN_IF_ERROR(service::CheckLimits(view.scene));
  if (view.scene.rendering().has_reference()) {
    return absl::InvalidArgumentError(
        "the reference draws single pictures alone: use thunderhead render, or another renderer");
  }
  std::string json;
  (void)google::protobuf::util::MessageToJsonString(view.scene, &json);
  view.sha256 = pipeline::Sha256(json);
  return view;
}

absl::StatusOr<std::vector<View>> ReadViews(const PipelineFlags& flags) {
  std::vector<View> views;
  if (flags.views.empty()) {
    const std::string name = flags.scene.file.empty() ? "view" : ViewNameOf(flags.scene.file);
    THUNDERHEAD_ASSIGN_OR_RETURN(views.emplace_back(), ReadView(flags.scene, name));
  }
  std::set<std::string> names;
  for (const std::string& file : flags.views) {
    SceneFlags scene = flags.scene;
    scene.view = file;
    THUNDERHEAD_ASSIGN_OR_RETURN(views.emplace_back(), ReadView(scene, ViewNameOf(file)));
    if (names.insert(views.back().name).second) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("two files of --views are named '", views.back().name,
                     "', which is what products are named by; rename one"));
  }
  return views;
}

// Returns the other manifests in the manifest's folder. Products that they record need not be drawn
// again. If `takes_over` is true (a run of all pictures), the manifests of shares are merged into
// this one.
pipeline::OtherManifests OthersOf(const std::string& manifest, bool takes_over) {
  pipeline::OtherManifests others;
  std::error_code error;
  const fs::path folder = fs::path(manifest).parent_path();
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const std::string name = entry.path().filename().string();
    if (absl::StartsWith(name, "manifest.") && absl::EndsWith(name, ".jsonl") &&
        name != fs::path(manifest).filename()) {
      const bool taken = takes_over && pipeline::IsManifestOfShare(name);
      (taken ? others.take_over : others.count).push_back(entry.path().string());
    }
  }
  return others;
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
                     "Scene files, each of which is a view and goes over --scene; products are "
                     "named by the files' names ({view})");
  command.add_option(
      "--manifest", flags.manifest,
      "File with a line for each product; by default manifest.jsonl in their folder");
  command.add_option("--movie", flags.movie,
                     "Also a movie of all times, .webm (VP9) or .mp4 (H.264); of each view if its "
                     "name has {view}, "
                     "else of the first");
  command.add_flag("--done", flags.done_markers,
                   "Write PRODUCT.done, for sha256sum -c, when a product is whole");
  command
      .add_option("--jobs", flags.jobs,
                  "Pictures under way at a time, so that reading and writing overlap drawing")
      ->check(CLI::Range(1, kMaxJobs))
      ->capture_default_str();
  command
      .add_option("--error-seconds", flags.error_seconds,
                  "Seconds at most for which to measure each picture's error by tracing, in this "
                  "process alone; 0: take it from a table")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  AddProductOptions(command, flags.files);
  AddServerFlags(command, flags.server);
  command.add_option("--device", flags.device, "auto, software or a GPU's number")
      ->capture_default_str();
  static const std::map<std::string, ProgressStyle> kStyles = {{"auto", ProgressStyle::kAuto},
                                                               {"lines", ProgressStyle::kLines},
                                                               {"json", ProgressStyle::kJson},
                                                               {"ecflow", ProgressStyle::kEcflow},
                                                               {"none", ProgressStyle::kNone}};
  command
      .add_option(
          "--progress", flags.progress,
          "auto (a bar on a terminal, else a line a product), lines, json, none, or ecflow: "
          "lines, and in a task of ecFlow its meter 'products', label 'product' and event "
          "'first'")
      ->transform(CLI::CheckedTransformer(kStyles).description(""));
}

absl::StatusOr<PictureRunOptions> RunOptionsOf(const PipelineFlags& flags,
                                               const pipeline::Shard& shard) {
  THUNDERHEAD_ASSIGN_OR_RETURN(pipeline::ProductName product,
                               pipeline::ProductName::Parse("--product", flags.product));
  if (flags.error_seconds > 0.0 && !flags.server.address.empty()) {
    return absl::InvalidArgumentError(
        "--error-seconds works only in this process: omit it or --server");
  }
  PictureRunOptions options{.product = std::move(product)};
  THUNDERHEAD_ASSIGN_OR_RETURN(options.format,
                               ProductFormatOf("--product", flags.product, flags.files));
  THUNDERHEAD_ASSIGN_OR_RETURN(options.views, ReadViews(flags));
  for (View& view : options.views) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckScene(options.format, view.scene));
    if (options.format.fingerprint.empty()) continue;
    view.sha256 = pipeline::Sha256(absl::StrCat(view.sha256, "\n", options.format.fingerprint));
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
  options.other_manifests = OthersOf(options.manifest, flags.manifest.empty() && shard.count == 1);
  options.device = flags.device;
  options.jobs = flags.jobs;
  options.error_seconds = flags.error_seconds;
  options.done_markers = flags.done_markers;
  return options;
}

}  // namespace thunderhead::app
