// Benchmarks of the paths of the path-traced correction, on the processors and on the device.
#include <memory>
#include <utility>
#include <vector>

#include "device_paths/device_tracer.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "reference/tracking.h"
#include "tests/bench/storm_bench.h"

namespace thunderhead::bench {
namespace {

constexpr int kWidth_px = 128;
constexpr int kHeight_px = 96;

// Traces the paths of one correction step through the storm. Rays that miss the storm are left out.
void TracePaths(benchmark::State& state, bool on_device) {
  const volume::HydrometeorFields& fields = *Sample::Get().fields;
  scene::Scene scene = PaperScene();
  scene.output = {kWidth_px, kHeight_px, 88};
  const auto medium = *reference::MediumOf(scene, fields, {.peak_cut_deg = 20.0, .similar = true});
  const auto around = reference::SurroundingsOf(scene, fields, reference::GroundLight::kShaded);
  const reference::Camera camera = reference::CameraOf(scene, fields);
  std::vector<reference::Ray> rays;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const reference::Ray ray =
          camera.RayThrough(2.0 * (x + 0.5) / kWidth_px - 1.0, 2.0 * (y + 0.5) / kHeight_px - 1.0);
      reference::RandomStream random(1, rays.size(), 0);
      if (reference::SampleCollision(*medium, ray, reference::kEndless_m, &random).has_value()) {
        rays.push_back(ray);
      }
    }
  }
  reference::RayTracer trace = reference::TracerOnProcessors(medium);
  if (on_device) {
    auto tracer = device_paths::DeviceTracer::Create(*medium, std::make_shared<gl::ProgramCache>());
    if (!tracer.ok()) return state.SkipWithError(tracer.status().ToString().c_str());
    trace = [tracer = std::shared_ptr(*std::move(tracer))](const auto&... arguments) {
      return tracer->Trace(arguments...);
    };
  }
  reference::TraceRaysOptions options{.paths_per_ray = 2,
                                      .similar_after = reference::kSimilarAfter};
  for (auto _ : state) {
    ++options.seed;
    benchmark::DoNotOptimize(trace(around, rays, options));
  }
  state.counters["paths/s"] =
      benchmark::Counter(static_cast<double>(rays.size()) * options.paths_per_ray *
                             static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

}  // namespace

void RegisterPaths() {
  const auto row = [](const char* name, bool on_device) {
    benchmark::RegisterBenchmark(name, TracePaths, on_device)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  };
  row("paths/processors", false);
  row("paths/device", true);
}

}  // namespace thunderhead::bench
