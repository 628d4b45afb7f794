// What each stage of a frame costs on the sample storm at the papers' size: 300 x 300 pixels, 128
// slices. Prints a table of medians; the columns `*_ms` split a frame by stage, `fps` is frames per
// second, `paper_fps` the papers' own on a GeForce FX 5800 (Riley et al. 2003, AMS, Table IV).
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "benchmark/benchmark.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "renderers/scene_renderer.h"
#include "spdlog/spdlog.h"
#include "volume/storm_store.h"
#include "volume/visible_box.h"

namespace thunderhead {
namespace {

constexpr int kMatureTime = 1;  // 40 minutes

enum class Moving { kCamera, kSun, kField, kExposure };

struct Bench {
  std::unique_ptr<gl::Context> context;
  std::shared_ptr<const volume::HydrometeorFields> fields;

  static Bench& Get() {
    static Bench bench = Open();
    return bench;
  }

  static Bench Open() {
    Bench bench;
    auto context = gl::Context::Create("auto");
    auto store = volume::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
    if (!context.ok() || !store.ok()) {
      spdlog::error("{} {}", context.status().ToString(), store.status().ToString());
      std::exit(1);
    }
    bench.context = *std::move(context);
    auto fields = (*store)->Get((*store)->Storms().front().id, kMatureTime, {});
    if (!fields.ok()) {
      spdlog::error("{}", fields.status().ToString());
      std::exit(1);
    }
    bench.fields = *std::move(fields);
    return bench;
  }
};

scene::Scene PaperScene(const volume::HydrometeorFields& fields) {
  scene::Scene scene;
  scene.output = {300, 300, 88};
  const volume::WorldBox box = volume::VisibleBox(fields);
  scene.camera = scene::Framing(scene::OrbitCamera(), box.low_m, box.high_m, 1.0);
  return scene;
}

void Move(Moving moving, scene::Scene* scene) {
  switch (moving) {
    case Moving::kCamera:
      std::get<scene::OrbitCamera>(scene->camera).azimuth_deg += 1.0;
      break;
    case Moving::kSun:
      scene->sun.azimuth_deg += 1.0;
      break;
    case Moving::kField:
      scene->fields[0].scale *= 1.01F;
      break;
    case Moving::kExposure:
      scene->display.exposure_ev += 0.01;
      break;
  }
}

void DrawFrames(benchmark::State& state, scene::Scene scene, Moving moving) {
  renderers::SceneRenderer renderer;
  frame::ToneMapper tone_mapper;
  std::map<std::string, double> total_ms;
  int balls = 0;
  int warm_frames = -1;  // the first frame also compiles shaders
  for (auto _ : state) {
    Move(moving, &scene);
    const auto linear = renderer.Draw(scene, Bench::Get().fields, {});
    const auto mapped = tone_mapper.Map(*linear->radiance, scene.display);
    const auto jpeg =
        frame::EncodeJpeg(scene.output.width_px, scene.output.height_px, mapped->rgb, 88);
    benchmark::DoNotOptimize(jpeg);
    balls = linear->balls;
    if (++warm_frames > 0) {
      for (const renderers::StageTime& stage : linear->stages) {
        total_ms[stage.stage + "_ms"] += stage.milliseconds;
      }
      total_ms["tone_ms"] += mapped->tone_ms;
      total_ms["read_back_ms"] += mapped->read_back_ms;
    }
  }
  for (const auto& [name, milliseconds] : total_ms) {
    state.counters[name] = milliseconds / warm_frames;
  }
  if (balls > 0) state.counters["balls"] = balls;
  state.counters["fps"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void Register(const std::string& name, const scene::Scene& scene, Moving moving,
              double paper_fps = 0.0) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) {
                                 DrawFrames(state, scene, moving);
                                 state.counters["paper_fps"] = paper_fps;
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void RegisterModes(const std::string& path, scene::Renderer renderer) {
  scene::Scene scene = PaperScene(*Bench::Get().fields);
  scene.rendering.renderer = renderer;
  struct Row {
    const char* name;
    scene::Mode mode;
    double paper_fps;
  };
  for (const Row& row :
       {Row{"uniform_phase_low_albedo", scene::Mode::kUniformPhaseLowAlbedo, 5.1},
        Row{"uniform_phase_translucent", scene::Mode::kUniformPhaseTranslucent, 4.3},
        Row{"per_field_phase_translucent", scene::Mode::kPerFieldPhaseTranslucent, 1.7},
        Row{"per_field_phase_detail_translucent", scene::Mode::kPerFieldPhaseDetailTranslucent,
            1.2}}) {
    scene.rendering.mode = row.mode;
    Register(path + "/" + row.name, scene, Moving::kCamera, row.paper_fps);
  }
  scene.rendering.mode = scene::Mode::kPerFieldPhaseTranslucent;
  Register(path + "/sun_moves", scene, Moving::kSun);
  Register(path + "/field_scale_moves", scene, Moving::kField);
  Register(path + "/exposure_moves", scene, Moving::kExposure);
  for (const int slices : {32, 256}) {
    scene.rendering.slices = slices;
    Register(path + "/slices_" + std::to_string(slices), scene, Moving::kCamera);
  }
  scene.rendering.slices = 128;
  scene.output = {600, 600, 88};
  Register(path + "/600x600", scene, Moving::kCamera);
}

// The scenes and the picture of P. Man, Generating and Real-Time Rendering of Clouds, section 5;
// his figures are from a GeForce 4. Balls of no weight are dropped from a fit, so that more are
// asked for.
void RegisterMetaballs() {
  scene::Scene scene = PaperScene(*Bench::Get().fields);
  scene.output = {1024, 768, 88};
  scene.rendering.renderer = scene::Renderer::kMetaball;
  struct Row {
    const char* name;
    int asked;
    double paper_fps;
  };
  for (const Row& row : {Row{"1200", 2100, 43.0}, Row{"10000", 14800, 7.0}}) {
    scene.rendering.metaballs.count = row.asked;
    for (const auto transport : {scene::Transport::kConsistent, scene::Transport::kPaper}) {
      scene.rendering.transport = transport;
      const char* const name = transport == scene::Transport::kPaper ? "paper" : "consistent";
      const std::string path = std::string("metaball/") + row.name + '/' + name;
      Register(path, scene, Moving::kCamera, row.paper_fps);
      Register(path + "/sun_moves", scene, Moving::kSun);
    }
  }
}

void EncodeJpeg(benchmark::State& state) {
  scene::Scene scene = PaperScene(*Bench::Get().fields);
  scene.output = {1280, 720, 88};
  renderers::SceneRenderer renderer;
  const auto linear = renderer.Draw(scene, Bench::Get().fields, {});
  const auto mapped = frame::ToneMapper().Map(*linear->radiance, scene.display);
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto jpeg = frame::EncodeJpeg(1280, 720, mapped->rgb, 88);
    bytes = jpeg->size();
  }
  state.counters["Mpixel/s"] = benchmark::Counter(
      1280.0 * 720.0 * 1e-6 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["bytes"] = static_cast<double>(bytes);
}

// Prints the medians alone.
class MedianReporter : public benchmark::ConsoleReporter {
 public:
  MedianReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> medians;
    for (const Run& run : runs) {
      if (run.aggregate_name == "median") medians.push_back(run);
    }
    ConsoleReporter::ReportRuns(medians);
  }
};

int Run(int argc, char** argv) {
  // Defaults that the command line may override.
  std::vector<std::string> arguments = {argv[0], "--benchmark_counters_tabular=true",
                                        "--benchmark_repetitions=5", "--benchmark_min_time=0.3",
                                        "--benchmark_report_aggregates_only=true"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  auto count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;
  benchmark::AddCustomContext("gl_renderer", Bench::Get().context->Info().renderer);
  RegisterModes("half_angle", scene::Renderer::kHalfAngle);
  RegisterModes("light_volume", scene::Renderer::kLightVolume);
  RegisterMetaballs();
  benchmark::RegisterBenchmark("encode_jpeg/1280x720", EncodeJpeg)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  Bench::Get() = Bench();
  return 0;
}

}  // namespace
}  // namespace thunderhead

int main(int argc, char** argv) { return thunderhead::Run(argc, argv); }
