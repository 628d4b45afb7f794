// Benchmarks of the time and memory of drawing a domain of 58 million cells.
#include <memory>

#include "frame/tone_map.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "tests/bench/storm_bench.h"
#include "tests/support/wide_domain.h"
#include "volume/visible_box.h"

namespace thunderhead::bench {
namespace {

// Returns the domain. It is made when the first row needs it, and dropped after the last.
const Fields& Wide() {
  static const Fields fields = support::WideDomain(*Sample::Get().fields, 5, 6, 1);
  return fields;
}

scene::Scene WideScene() {
  scene::Scene scene;
  scene.output = {1280, 720, 88};
  const volume::WorldBox box = volume::VisibleBox(*Wide());
  scene::OrbitCamera camera;
  camera.elevation_deg = scene::FramingElevation_deg(box.low_m, box.high_m);
  scene.camera = scene::Framing(camera, box.low_m, box.high_m, 16.0 / 9.0);
  return scene;
}

void DrawFirst(benchmark::State& state) {
  const scene::Scene scene = WideScene();
  std::size_t device_bytes = 0;
  for (auto _ : state) {
    renderers::SceneRenderer renderer;
    frame::ToneMapper tone_mapper;
    const auto linear = renderer.Draw(scene, Wide(), {});
    benchmark::DoNotOptimize(tone_mapper.Map(*linear->radiance, scene));
    device_bytes = linear->device_bytes;
  }
  TellMemory(state, Wide(), device_bytes);
}

void DrawMoving(benchmark::State& state, Moving moving) {
  DrawFrames(state, WideScene(), Wide(), moving);
}

}  // namespace

void RegisterWideDomain() {
  const auto row = [](const char* name, auto... arguments) {
    benchmark::RegisterBenchmark(name, arguments...)->Unit(benchmark::kMillisecond)->UseRealTime();
  };
  row("wide/first_frame", DrawFirst);
  row("wide/camera_moves", DrawMoving, Moving::kCamera);
  row("wide/sun_moves", DrawMoving, Moving::kSun);
}

}  // namespace thunderhead::bench
