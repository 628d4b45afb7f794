#include "tests/bench/storm_bench.h"

#include <map>
#include <variant>

#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "spdlog/spdlog.h"
#include "storm_store/storm_store.h"
#include "tests/support/techniques.h"
#include "volume/visible_box.h"

namespace thunderhead::bench {
namespace {

constexpr int kMatureTime = 1;  // 40 minutes
constexpr int kWarmFrames = 2;  // the first also compiles shaders

Sample Open() {
  Sample sample;
  auto context = gl::Context::Create("auto");
  auto store = storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  if (!context.ok() || !store.ok()) {
    spdlog::error("{} {}", context.status().ToString(), store.status().ToString());
    std::exit(1);
  }
  sample.context = *std::move(context);
  auto fields = (*store)->Get((*store)->Storms().front()->id, kMatureTime, {});
  if (!fields.ok()) {
    spdlog::error("{}", fields.status().ToString());
    std::exit(1);
  }
  sample.fields = *std::move(fields);
  return sample;
}

void Move(Moving moving, scene::Scene* scene) {
  switch (moving) {
    case Moving::kCamera:
      std::get<scene::OrbitCamera>(scene->camera).azimuth_deg += 1.0;
      break;
    case Moving::kSun:
      scene->sun.azimuth_deg += 1.0;
      break;
    case Moving::kSunClimbs:
      scene->sun.elevation_deg =
          scene->sun.elevation_deg < 60.0 ? scene->sun.elevation_deg + 0.5 : 30.0;
      break;
    case Moving::kField:
      scene->fields[0].scale *= 1.01F;
      break;
    case Moving::kExposure:
      scene->display.exposure_ev = scene->display.exposure_ev.value_or(0.0) + 0.01;
      break;
  }
}

}  // namespace

Sample& Sample::Get() {
  static Sample sample = Open();
  return sample;
}

scene::Scene PaperScene() {
  scene::Scene scene = test_support::PlainScene();
  scene.output = {300, 300, 88};
  const volume::WorldBox box = volume::VisibleBox(*Sample::Get().fields);
  scene.camera = scene::Framing(scene::OrbitCamera(), box.low_m, box.high_m, 1.0);
  return scene;
}

void TellMemory(benchmark::State& state, const Fields& fields, std::size_t device_bytes) {
  constexpr double kBytesPerMB = 1e6;
  state.counters["fields_MB"] = static_cast<double>(fields->Bytes()) / kBytesPerMB;
  state.counters["device_MB"] = static_cast<double>(device_bytes) / kBytesPerMB;
}

void DrawFrames(benchmark::State& state, scene::Scene scene, const Fields& fields, Moving moving) {
  renderers::SceneRenderer renderer;
  frame::ToneMapper tone_mapper;
  std::map<std::string, double> total_ms;
  int balls = 0;
  std::size_t device_bytes = 0;
  const auto draw = [&] {
    Move(moving, &scene);
    const auto linear = renderer.Draw(scene, fields, {});
    const auto mapped = tone_mapper.Map(*linear->radiance, scene);
    const auto jpeg =
        frame::EncodeJpeg(scene.output.width_px, scene.output.height_px, mapped->rgb, 88);
    benchmark::DoNotOptimize(jpeg);
    balls = linear->content.balls;
    device_bytes = linear->device_bytes;
    for (const scene::StageTime& stage : linear->stages) {
      total_ms[std::string(scene::NameOf(stage.stage)) + "_ms"] += stage.milliseconds;
    }
    total_ms["tone_ms"] += mapped->tone_ms;
    total_ms["read_back_ms"] += mapped->read_back_ms;
  };
  for (int i = 0; i < kWarmFrames; ++i) draw();
  total_ms.clear();
  for (auto _ : state) draw();
  for (const auto& [name, milliseconds] : total_ms) {
    state.counters[name] = milliseconds / static_cast<double>(state.iterations());
  }
  if (balls > 0) state.counters["balls"] = balls;
  TellMemory(state, fields, device_bytes);
  state.counters["fps"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void Register(const std::string& name, const scene::Scene& scene, const Fields& fields,
              Moving moving, double paper_fps) {
  const MakeFields make = [fields] { return fields; };
  Register(name, scene, make, moving, paper_fps);
}

void Register(const std::string& name, const scene::Scene& scene, const MakeFields& make,
              Moving moving, double paper_fps) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) {
                                 DrawFrames(state, scene, make(), moving);
                                 if (paper_fps > 0.0) state.counters["paper_fps"] = paper_fps;
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

}  // namespace thunderhead::bench
