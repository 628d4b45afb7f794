#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/local_scene.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "measure/look.h"
#include "measure/soundness.h"
#include "reference/trace_scene.h"
#include "renderers/scene_renderer.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct LookFlags {
  std::string storm;
  SceneFlags scene;
  std::string output;
  std::string device = "auto";
  int samples_per_pixel = 0;
  reference::TraceOptions light;
};

absl::StatusOr<picture::LinearPicture> Traced(const LookFlags& flags, const LocalScene& local) {
  const Interruption interruption;
  runs::ProgressBar bar("tracing");
  THUNDERHEAD_ASSIGN_OR_RETURN(
      reference::TracedScene traced,
      reference::TraceScene(
          local.scene, *local.fields, flags.light, {flags.samples_per_pixel, 0.0, 0.0},
          [&](const reference::ImageProgress& progress) {
            bar.Set(static_cast<double>(progress.samples_per_pixel) / flags.samples_per_pixel);
          },
          interruption.Token()));
  return std::move(traced.image);
}

std::string Stops(const std::optional<double>& stops) {
  return stops.has_value() ? absl::StrFormat("%.2f", *stops) : "-";
}

std::string ShareText(const std::optional<double>& share) {
  return share.has_value() ? absl::StrFormat("1/%.1f", 1.0 / *share) : "-";
}

absl::Status WritePng(const std::string& path, const glm::ivec2& size_px,
                      const std::vector<std::uint8_t>& rgb) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string png, frame::EncodePng(size_px.x, size_px.y, rgb));
  return base::WriteWholeFile(path, png);
}

// Prints the figures of a picture, and writes the picture if requested.
absl::Status Print(const LookFlags& flags, const std::string& name, const scene::Scene& scene,
                   const volume::HydrometeorFields& fields, const picture::LinearPicture& picture) {
  frame::ToneMapper tone_mapper;
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped mapped,
                               tone_mapper.Map(frame::TextureOf(picture), scene));
  const std::vector<measure::Region> regions = measure::RegionsOf(scene, fields, picture.opacity);
  const measure::LookFigures light = measure::FiguresOf(regions, picture);
  const measure::LookFigures shown = measure::FiguresOf(
      regions, frame::RgbImage{picture.size_px.x, picture.size_px.y, mapped.rgb});
  std::cout << absl::StrFormat("%-18s %7d %7d %7s %7s %7.2f %7.2f %7s %7s\n", name,
                               light.tower_pixels, light.base_pixels, Stops(light.tower_stops),
                               Stops(shown.tower_stops), light.frame_stops, shown.frame_stops,
                               ShareText(light.base_share), ShareText(shown.base_share))
            << std::flush;
  if (flags.output.empty()) return absl::OkStatus();
  std::vector<std::uint8_t> marked = mapped.rgb;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i] == measure::Region::kTower) marked[3 * i] = 255;
    if (regions[i] == measure::Region::kBase) marked[3 * i + 2] = 255;
  }
  const std::string prefix = absl::StrCat(flags.output, ".", name);
  THUNDERHEAD_RETURN_IF_ERROR(WritePng(absl::StrCat(prefix, ".png"), picture.size_px, mapped.rgb));
  THUNDERHEAD_RETURN_IF_ERROR(
      WritePng(absl::StrCat(prefix, ".regions.png"), picture.size_px, marked));
  return absl::OkStatus();
}

// Returns the cameras to measure; an empty name means the scene's own camera.
std::vector<std::string> CamerasOf(const SceneFlags& flags) {
  if (!flags.camera.empty()) return {flags.camera};
  if (!flags.file.empty()) return {""};
  return {"orbit", "spotter"};
}

absl::Status MeasureLook(const LookFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  std::cout << "                      pixels of     tower, stops  picture, stops      base\n"
               "picture              tower    base   light   shown   light   shown   light   "
               "shown\n";
  renderers::SceneRenderer renderer;
  for (const std::string& camera : CamerasOf(flags.scene)) {
    SceneFlags with_camera = flags.scene;
    with_camera.camera = camera;
    THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local, OpenScene(flags.storm, with_camera));
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame frame,
                                 renderer.Draw(local.scene, local.fields, {}));
    const std::string name = camera.empty() ? "scene" : camera;
    const std::string unsound = measure::UnsoundPicture(frame::ReadLinear(*frame.radiance));
    if (!unsound.empty()) return absl::InternalError(absl::StrCat(name, ": ", unsound));
    THUNDERHEAD_RETURN_IF_ERROR(
        Print(flags, name, local.scene, *local.fields, frame::PictureOf(*frame.radiance)));
    if (flags.samples_per_pixel == 0) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(const picture::LinearPicture traced, Traced(flags, local));
    THUNDERHEAD_RETURN_IF_ERROR(
        Print(flags, absl::StrCat(name, "-reference"), local.scene, *local.fields, traced));
  }
  return absl::OkStatus();
}

}  // namespace

Command AddMeasureLook(CLI::App& measure) {
  auto flags = std::make_shared<LookFlags>();
  flags->scene.size = "480x300";
  CLI::App* look = measure.add_subcommand(
      "look",
      "Measure the brightness of a storm's tower and of the whole picture in stops, and how dark "
      "the storm's base is. Fails if any radiance is negative or not finite");
  look->add_option("STORM", flags->storm, "Storm file or folder")->required();
  AddSceneOptions(*look, flags->scene);
  look->add_option("-o,--output", flags->output,
                   "Prefix of pictures to write (.CAMERA.png, and .regions.png with the tower red "
                   "and the base blue); by default none");
  look->add_option("--spp", flags->samples_per_pixel,
                   "Also trace the reference with this many samples per pixel")
      ->check(CLI::Range(1, 1 << 20));
  look->add_option("--peak-cut", flags->light.peak_cut_deg, "As in thunderhead render")
      ->check(CLI::Range(0.0, 30.0))
      ->capture_default_str();
  look->add_option("--detail", flags->light.detail_voxels_per_cell, "As in thunderhead render")
      ->check(CLI::Range(1, 8));
  look->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  return {look, [flags] { return MeasureLook(*flags); }};
}

}  // namespace thunderhead::app
