#include <google/protobuf/util/json_util.h>

#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "accuracy/named_settings.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/output_name.h"
#include "app/product_flags.h"
#include "app/render_reference.h"
#include "app/scene_file.h"
#include "app/server_flags.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "runs/local_service.h"
#include "runs/picture_call.h"
#include "runs/product_files.h"
#include "runs/progress_bar.h"
#include "service/messages/technique_messages.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct RenderFlags {
  std::string storm;
  std::string output;
  SceneFlags scene;
  ReferenceFlags reference;
  ServerFlags server;
  ProductFlags files;
  std::string device = "auto";
  double error_seconds = 2.0;
  bool json = false;
};

absl::Status Interrupted() { return absl::CancelledError("interrupted: no picture was written"); }

void Show(const v1::RenderImageProgress& progress, runs::ProgressBar& bar) {
  bar.Set(progress.share());
  std::string note =
      absl::StrFormat("%.2f million paths", 1e-6 * static_cast<double>(progress.traced_paths()));
  if (progress.has_estimated_error()) {
    absl::StrAppendFormat(&note, ", error about %.2g", progress.estimated_error());
  }
  bar.Note(note);
}

absl::StatusOr<v1::RenderImageResponse> Call(const std::shared_ptr<grpc::Channel>& channel,
                                             const v1::RenderImageRequest& request,
                                             const Interruption& interruption,
                                             const std::string& token = "") {
  runs::ProgressBar bar("rendering");
  return runs::CallForPicture(
      channel, request, token, interruption.Token(),
      [&bar](const v1::RenderImageProgress& progress) { Show(progress, bar); });
}

absl::StatusOr<v1::RenderImageResponse> CallServer(const RenderFlags& flags,
                                                   v1::RenderImageRequest request,
                                                   const Interruption& interruption) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<runs::ServerLink> server,
                               OpenServer(flags.server));
  server->StopOn(interruption.Token());
  request.mutable_scene()->set_storm_id(flags.storm);
  return Call(server->Channel(), request, interruption, server->Token());
}

absl::StatusOr<v1::RenderImageResponse> CallHere(const RenderFlags& flags,
                                                 const v1::RenderImageRequest& request,
                                                 const Interruption& interruption) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<storm_store::StormStore> store,
                               runs::OpenStorm(flags.storm, interruption.Token()));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<service::Server> server,
                               runs::StartLocalService(store, flags.device));
  const std::size_t times = store->Storms().front()->times.size();
  const std::size_t time_index =
      request.scene().has_time_index() ? request.scene().time_index() : times - 1;
  if (time_index < times) {
    THUNDERHEAD_RETURN_IF_ERROR(runs::ReadWithProgress(*store, static_cast<int>(time_index)));
  }
  if (interruption.Token().stop_requested()) return Interrupted();
  return Call(server->LocalChannel(), request, interruption);
}

// Prints the setting and the error. It does so only if the scene asks for an accuracy, a speed or
// path-traced correction, or if the error was measured.
void PrintAccuracy(const v1::RenderImageResponse& response) {
  const v1::Scene& scene = response.scene();
  const bool awaited = scene.rendering().light_volume().traced_light() == v1::TRACED_LIGHT_AWAITED;
  const bool limited = scene.accuracy().limit_case() != v1::Accuracy::LIMIT_NOT_SET;
  const v1::AccuracyReport& report = response.accuracy();
  if (!response.has_accuracy() || (!awaited && !limited && !report.measured())) return;
  if (report.has_unmet()) std::cerr << "thunderhead: " << report.unmet().message() << "\n";
  const scene::Technique technique = service::ToTechnique(report.rendering());
  std::cout << absl::StrFormat("%s, %s, %s, %d slices, image scale %g: error about %.3g",
                               scene::NameOf(technique), accuracy::ModeOf(technique).name,
                               accuracy::TransportNameOf(technique), report.slices(),
                               report.image_scale(), report.estimated_error());
  if (report.measured()) {
    std::cout << absl::StrFormat(" (measured: %.3g to %.3g)", report.error_low(),
                                 report.error_high());
  } else {
    std::cout << " (from a table)";
  }
  if (limited)
    std::cout << absl::StrFormat(", about %.3g ms a frame", report.expected_milliseconds());
  if (response.modelled().traced_paths() > 0) {
    std::cout << absl::StrFormat(", %.3g million traced paths",
                                 1e-6 * static_cast<double>(response.modelled().traced_paths()));
  }
  std::cout << "\n";
}

// The sun's elevation below which civil twilight has ended and pictures are nearly black.
constexpr float kNightBelow_deg = -6.0F;

void TellOfNight(const v1::Scene& scene) {
  if (scene.sun().elevation_deg() >= kNightBelow_deg) return;
  std::cerr << absl::StrFormat(
      "thunderhead: the picture is dark, because the sun is %.0f degrees below the horizon; a "
      "scene "
      "with \"sun\": {\"azimuthDeg\": 245, \"elevationDeg\": 35} shows it by day\n",
      -scene.sun().elevation_deg());
}

absl::Status ByReference(const RenderFlags& flags, const runs::ProductFormat& format) {
  if (!flags.server.address.empty() || flags.json) {
    return absl::InvalidArgumentError(
        "--technique reference works only in this process: omit --server and --json");
  }
  if (!format.fingerprint.empty() ||
      (!format.IsPicture() && format.kind != runs::ProductKind::kExr)) {
    return absl::InvalidArgumentError(
        "--technique reference writes only .png, .jpg and .exr, without --annotate and "
        "--world-file: omit them");
  }
  return RenderReference(flags.storm, flags.scene, flags.reference, flags.output, flags.device);
}

absl::Status Write(const std::string& output, const runs::ProductFormat& format,
                   const v1::RenderImageResponse& picture) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const runs::ProductFile file,
                               runs::MakeProduct(format, "", picture));
  if (file.world_file.has_value()) {
    THUNDERHEAD_RETURN_IF_ERROR(
        base::WriteWholeFile(runs::WorldFilePath(output), *file.world_file));
  }
  return base::WriteWholeFile(output, file.bytes);
}

absl::Status Render(const RenderFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  v1::RenderImageRequest request;
  THUNDERHEAD_ASSIGN_OR_RETURN(*request.mutable_scene(), ReadScene(flags.scene));
  THUNDERHEAD_ASSIGN_OR_RETURN(const runs::ProductFormat format,
                               ProductFormatOf("-o", flags.output, flags.files));
  if (flags.server.address.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckNotInput("-o", flags.output, flags.storm));
  }
  THUNDERHEAD_RETURN_IF_ERROR(runs::CheckScene(format, request.scene()));
  if (request.scene().rendering().has_reference()) return ByReference(flags, format);
  if (flags.reference.AnyLimit() || !flags.reference.light.air ||
      flags.reference.max_scatterings.has_value() ||
      flags.reference.light.detail_voxels_per_cell != 0) {
    return absl::InvalidArgumentError(
        "--spp, --seconds, --target-error, --max-scatterings, --detail and --no-air are for "
        "--technique reference");
  }
  request.set_format(format.Drawn());
  request.set_error_seconds(static_cast<float>(flags.error_seconds));
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(v1::RenderImageResponse response,
                               flags.server.address.empty()
                                   ? CallHere(flags, request, interruption)
                                   : CallServer(flags, request, interruption));
  THUNDERHEAD_RETURN_IF_ERROR(Write(flags.output, format, response));
  TellOfNight(response.scene());
  if (!flags.json) {
    PrintAccuracy(response);
    return absl::OkStatus();
  }
  response.clear_image();
  std::string json;
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  (void)google::protobuf::util::MessageToJsonString(response, &json, options);
  std::cout << json;
  return absl::OkStatus();
}

}  // namespace

Command AddRender(CLI::App& app) {
  auto flags = std::make_shared<RenderFlags>();
  CLI::App* render = app.add_subcommand("render", "Render one picture of a storm");
  render->add_option("STORM", flags->storm, "Storm file or folder; with --server a storm's id")
      ->required();
  render
      ->add_option(
          "-o,--output", flags->output,
          "Picture to write: .png, .jpg or .jpeg; .exr for linear light and optical depth; "
          "from above also .tif (GeoTIFF) and .nc (light and optical depth, CF netCDF)")
      ->required();
  AddSceneOptions(*render, flags->scene);
  AddTechniqueOptions(*render, flags->scene);
  render->add_option("--max-error", flags->scene.max_error,
                     "Draw with the cheapest setting of at most this error (relative RMSE)");
  render->add_option("--max-milliseconds", flags->scene.max_milliseconds,
                     "Draw with the most accurate setting of at most this time a frame");
  render
      ->add_option("--error-seconds", flags->error_seconds,
                   "Maximum seconds for measuring the picture's error by path tracing; 0: take the "
                   "error from a table")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  render->add_option("--spp", flags->reference.samples_per_pixel,
                     "Reference: stop after this many samples per pixel");
  render->add_option("--seconds", flags->reference.seconds,
                     "Reference: stop after this many seconds");
  render->add_option("--target-error", flags->reference.target_error,
                     "Reference: stop at this relative standard error");
  render
      ->add_option("--peak-cut", flags->reference.light.peak_cut_deg,
                   "Reference: treat light scattered by less than this angle in degrees as "
                   "unscattered; 0 is exact but noisy")
      ->capture_default_str();
  render->add_option("--max-scatterings", flags->reference.max_scatterings,
                     "Reference: omit light that is scattered more often than this; by default "
                     "nothing is omitted");
  render
      ->add_option("--detail", flags->reference.light.detail_voxels_per_cell,
                   "Reference: trace the turbulent detail that the light volume draws, on this "
                   "many voxels along a cell's edge; by default without detail")
      ->check(CLI::Range(1, 8));
  render->add_flag("--no-air{false}", flags->reference.light.air,
                   "Reference: omit the air: the sky is black, and sunlight is as strong as above "
                   "the atmosphere");
  AddProductOptions(*render, flags->files);
  AddServerFlags(*render, flags->server);
  render->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  render->add_flag("--json", flags->json, "Print costs and the completed scene as JSON");
  return {render, [flags] { return Render(*flags); }};
}

}  // namespace thunderhead::app
