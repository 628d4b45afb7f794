// The benchmark program. It prints a table of medians: `./dev bench [--benchmark_filter=saving]`.
#include <string>
#include <vector>

#include "benchmark/benchmark.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "renderers/scene_renderer.h"
#include "tests/bench/storm_bench.h"

namespace thunderhead::bench {
namespace {

void EncodeJpeg(benchmark::State& state) {
  scene::Scene scene = PaperScene();
  scene.output = {1280, 720, 88};
  renderers::SceneRenderer renderer;
  const auto linear = renderer.Draw(scene, Sample::Get().fields, {});
  const auto mapped = frame::ToneMapper().Map(*linear->radiance, scene);
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto jpeg = frame::EncodeJpeg(1280, 720, mapped->rgb, 88);
    bytes = jpeg->size();
  }
  state.counters["Mpixel/s"] = benchmark::Counter(
      1280.0 * 720.0 * 1e-6 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["bytes"] = static_cast<double>(bytes);
}

// A reporter that prints only the medians.
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
  // These defaults may be overridden on the command line.
  std::vector<std::string> arguments = {argv[0], "--benchmark_counters_tabular=true",
                                        "--benchmark_repetitions=5", "--benchmark_min_time=0.3",
                                        "--benchmark_report_aggregates_only=true"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  auto count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;
  benchmark::AddCustomContext("gl_renderer", Sample::Get().context->Info().renderer);
  RegisterModes();
  RegisterPresets();
  RegisterMetaballs();
  RegisterCumulus();
  RegisterSavings();
  RegisterGrowth();
  RegisterWideDomain();
  RegisterPaths();
  benchmark::RegisterBenchmark("encode_jpeg/1280x720", EncodeJpeg)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  Sample::Get() = Sample();
  return 0;
}

}  // namespace
}  // namespace thunderhead::bench

int main(int argc, char** argv) { return thunderhead::bench::Run(argc, argv); }
