#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "accuracy/light_corrector.h"
#include "accuracy/named_settings.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/kept_reference.h"
#include "app/local_scene.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/whole_file.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "measure/light_parts.h"
#include "measure/reference_comparison.h"
#include "measure/trade.h"
#include "picture/exr_file.h"
#include "runs/progress_bar.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

using measure::LightPart;

constexpr LightPart kParts[] = {LightPart::kOnce, LightPart::kSun, LightPart::kSky,
                                LightPart::kAll};

struct LightFlags {
  std::string storm;
  SceneFlags scene;
  std::string output = "light";
  std::string device = "auto";
  std::vector<std::string> parts;
  std::vector<std::string> transports;
  int samples_per_pixel = 512;
  int finer = 4;
  std::vector<double> million_paths;
  double peak_cut_deg = reference::kPeakCut_deg;
};

bool Chosen(const std::vector<std::string>& names, std::string_view name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

absl::StatusOr<picture::LinearPicture> ReferenceOf(const LightFlags& flags, const LocalScene& local,
                                                   LightPart part, const std::string& path,
                                                   const Interruption& interruption) {
  v1::Scene message = local.message;
  message.clear_rendering();
  ReferenceRequest request;
  request.name = measure::NameOf(part);
  request.scene = measure::SceneOf(part, measure::ReferenceScene(local.scene));
  request.scene_text = message.ShortDebugString();
  request.options = measure::TraceOptionsOf(part, flags.peak_cut_deg);
  request.samples_per_pixel = flags.samples_per_pixel;
  return KeptReference(request, *local.fields, path, interruption);
}

// Writes three pictures side by side: by the reference, as drawn, and their difference. In the
// difference, mid-grey means that both are equal. A pixel that exceeds the reference by the
// reference's mean radiance is brighter than mid-grey by a quarter of the full range.
absl::Status WriteComparison(const picture::LinearPicture& reference,
                             const picture::LinearPicture& drawn, scene::Scene scene,
                             const std::string& path) {
  frame::ToneMapper tone_mapper;
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped left,
                               tone_mapper.Map(frame::TextureOf(reference), scene));
  scene.display.exposure_ev = left.exposure_ev;
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped middle,
                               tone_mapper.Map(frame::TextureOf(drawn), scene));
  double mean = 0.0;
  for (const glm::vec3& pixel : reference.radiance) mean += (pixel.x + pixel.y + pixel.z) / 3.0;
  mean /= static_cast<double>(reference.radiance.size());
  const auto width = static_cast<std::size_t>(reference.size_px.x);
  std::vector<std::uint8_t> rgb;
  for (std::size_t y = 0; y < static_cast<std::size_t>(reference.size_px.y); ++y) {
    const auto row = static_cast<std::ptrdiff_t>(3 * y * width);
    const auto end = row + static_cast<std::ptrdiff_t>(3 * width);
    rgb.insert(rgb.end(), left.rgb.begin() + row, left.rgb.begin() + end);
    rgb.insert(rgb.end(), middle.rgb.begin() + row, middle.rgb.begin() + end);
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec3 off = drawn.radiance[y * width + x] - reference.radiance[y * width + x];
      for (int color = 0; color < 3; ++color) {
        const double shown = 127.5 + 0.5 * 127.5 * off[color] / mean;
        rgb.push_back(static_cast<std::uint8_t>(std::clamp(shown, 0.0, 255.0)));
      }
    }
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string png,
                               frame::EncodePng(3 * reference.size_px.x, reference.size_px.y, rgb));
  return base::WriteWholeFile(path, png);
}

// Compares drawn pictures of one part of the light with the reference. Print draws a picture,
// prints its row of the table, and writes the picture and the comparison.
struct Compared {
  const LightFlags& flags;
  const LocalScene& local;
  LightPart part;
  measure::ReferenceComparison comparison;
  renderers::SceneRenderer& renderer;

  absl::Status Print(const scene::Scene& scene, const std::string& name,
                     const std::shared_ptr<const renderers::LightCorrection>& correction) const {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const picture::LinearPicture drawn,
        measure::DrawPart(renderer, scene, local.fields, part, flags.finer, correction));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const picture::LinearPicture single,
        measure::DrawPart(renderer, scene, local.fields, part, 1, correction));
    std::cout << absl::StrFormat("%-5s %-15s %8.4f %+8.4f %8.4f %8.4f\n", measure::NameOf(part),
                                 name, comparison.RelativeRmseWithoutNoise(drawn),
                                 comparison.RelativeBias(drawn),
                                 comparison.RelativeRmseWithoutNoise(single), comparison.Noise())
              << std::flush;
    const std::string prefix = absl::StrCat(flags.output, ".", measure::NameOf(part), ".",
                                            absl::StrReplaceAll(name, {{" ", "_"}}));
    THUNDERHEAD_RETURN_IF_ERROR(picture::WriteExr(prefix + ".exr", drawn));
    return WriteComparison(comparison.Reference(), drawn, local.scene, prefix + ".png");
  }
};

// Measures the part "all" again, with path-traced correction of the light.
absl::Status MeasureTracedLight(const Compared& compared, const scene::Scene& scene,
                                const Interruption& interruption) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::unique_ptr<accuracy::LightCorrector> corrector,
      accuracy::LightCorrector::Create(scene, compared.local.fields,
                                       std::make_shared<gl::ProgramCache>(), 0));
  base::Stopwatch stopwatch;
  double traced_ms = 0.0;
  for (const double million_paths : compared.flags.million_paths) {
    stopwatch.Restart();
    {
      runs::ProgressBar bar("tracing light");
      THUNDERHEAD_RETURN_IF_ERROR(corrector->TraceUntil(std::llround(1e6 * million_paths),
                                                        interruption.Token(),
                                                        [&](double share) { bar.Set(share); }));
    }
    traced_ms += stopwatch.ElapsedMs();
    const std::string name = absl::StrFormat("%g Mpaths %.0f s", million_paths, 1e-3 * traced_ms);
    THUNDERHEAD_RETURN_IF_ERROR(compared.Print(scene, name, corrector->Correction()));
  }
  return absl::OkStatus();
}

absl::Status MeasureTransport(const Compared& compared,
                              const accuracy::Named<scene::Transport>& transport,
                              const Interruption& interruption) {
  scene::Scene scene = compared.local.scene;
  auto& technique = std::get<scene::LightVolume>(scene.rendering.technique);
  technique.medium.transport = transport.value;
  technique.medium.look.detail = false;  // off, because the reference has no detail
  THUNDERHEAD_RETURN_IF_ERROR(compared.Print(scene, std::string(transport.name), nullptr));
  technique.traced_light = scene::TracedLight::kAtRest;
  const bool traces = compared.part == LightPart::kAll && !compared.flags.million_paths.empty() &&
                      accuracy::TracesLight(scene, *compared.local.fields);
  return traces ? MeasureTracedLight(compared, scene, interruption) : absl::OkStatus();
}

absl::Status MeasureLight(const LightFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local,
                               OpenScene(flags.storm, flags.scene, interruption.Token()));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(flags.device));
  renderers::SceneRenderer renderer;
  std::cout << "part  transport           RMSE     bias    1 ray    noise\n";
  for (const LightPart part : kParts) {
    if (!Chosen(flags.parts, measure::NameOf(part))) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(
        picture::LinearPicture traced,
        ReferenceOf(flags, local, part,
                    absl::StrCat(flags.output, ".", measure::NameOf(part), ".exr"), interruption));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        measure::ReferenceComparison comparison,
        measure::ReferenceComparison::Of(
            local.scene, *local.fields, std::move(traced),
            measure::TraceOptionsOf(part, flags.peak_cut_deg).peak_cut_deg));
    const Compared compared{flags, local, part, std::move(comparison), renderer};
    for (const auto& transport : accuracy::kTransportNames) {
      const bool once = part == LightPart::kOnce;
      if (once ? transport.value != scene::Transport::kConsistent
               : !Chosen(flags.transports, transport.name)) {
        continue;
      }
      THUNDERHEAD_RETURN_IF_ERROR(MeasureTransport(compared, transport, interruption));
    }
  }
  return absl::OkStatus();
}

}  // namespace

Command AddMeasureLight(CLI::App& measure) {
  auto flags = std::make_shared<LightFlags>();
  flags->scene.size = "96x64";
  CLI::App* light = measure.add_subcommand(
      "light",
      "Measure the errors of sunlight scattered once, all sunlight, skylight, and all light");
  light->add_option("STORM", flags->storm, "Storm file or folder")->required();
  light
      ->add_option("-o,--output", flags->output,
                   "Prefix of the files to write: references (.PART.exr), drawn pictures "
                   "(.PART.TRANSPORT.exr) and comparisons (.PART.TRANSPORT.png: reference, drawn, "
                   "difference)")
      ->capture_default_str();
  light->add_option("--part", flags->parts, "once, sun, sky or all; by default each");
  light->add_option("--transport", flags->transports, "Transports to measure; by default each");
  AddSceneOptions(*light, flags->scene);
  light->add_option("--spp", flags->samples_per_pixel, "Samples per pixel of the reference")
      ->check(CLI::Range(16, 1 << 20))
      ->capture_default_str();
  light
      ->add_option("--million-paths", flags->million_paths,
                   "Also measure diffusion with the path-traced correction, after this many "
                   "million paths; give several numbers in ascending order")
      ->check(CLI::Range(0.0, 1e3));
  light
      ->add_option("--finer", flags->finer,
                   "Supersampling of the drawn picture: N x N rays per pixel")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  light->add_option("--peak-cut", flags->peak_cut_deg, "As in thunderhead render")
      ->check(CLI::Range(0.0, 30.0))
      ->capture_default_str();
  light->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  return {light, [flags] { return MeasureLight(*flags); }};
}

}  // namespace thunderhead::app
