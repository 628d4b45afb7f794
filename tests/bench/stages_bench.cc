// Benchmarks of the cost of each stage of a frame, by each technique in each mode of the papers'
// table, and of the stages that a change reruns.
#include <array>
#include <string>

#include "accuracy/named_settings.h"
#include "accuracy/presets.h"
#include "tests/bench/storm_bench.h"
#include "tests/support/techniques.h"

namespace thunderhead::bench {

void RegisterModes() {
  // The rates are from Riley et al. 2003 (AMS), Table IV, in the order of accuracy::kModes.
  constexpr std::array kPaperFps = {5.1, 4.3, 1.7, 1.2};
  const Fields& fields = Sample::Get().fields;
  for (const auto& plain : accuracy::kCellTechniques) {
    scene::Scene scene = PaperScene();
    test_support::SetTechnique(&scene.rendering.technique, plain);
    const std::string prefix = std::string(plain.name) + "/";
    for (std::size_t i = 0; i < accuracy::kModes.size(); ++i) {
      test_support::SetMode(&scene.rendering.technique, accuracy::kModes[i]);
      Register(prefix + std::string(accuracy::kModes[i].name), scene, fields, Moving::kCamera,
               kPaperFps[i]);
    }
    test_support::SetMode(&scene.rendering.technique, test_support::kPerFieldPhase);
    Register(prefix + "sun_moves", scene, fields, Moving::kSun);
    Register(prefix + "sun_climbs", scene, fields, Moving::kSunClimbs);
    Register(prefix + "field_scale_moves", scene, fields, Moving::kField);
    Register(prefix + "exposure_moves", scene, fields, Moving::kExposure);
  }
}

void RegisterPresets() {
  const Fields& fields = Sample::Get().fields;
  for (const accuracy::Preset preset : {accuracy::Preset::kFast, accuracy::kDefaultPreset}) {
    scene::Scene scene = PaperScene();
    scene.rendering.technique = accuracy::TechniqueOf(preset);
    const std::string name = "preset/" + std::string(accuracy::NameOf(preset));
    Register(name, scene, fields, Moving::kCamera);
    Register(name + "/sun_moves", scene, fields, Moving::kSun);
  }
}

void RegisterMetaballs() {
  scene::Scene scene = PaperScene();
  scene.output = {1024, 768, 88};
  test_support::SetTechnique(&scene.rendering.technique, test_support::kMetaball);
  struct Row {
    const char* name;
    int asked;
    double paper_fps;
  };
  const Fields& fields = Sample::Get().fields;
  for (const Row& row : {Row{"1200", 1660, 43.0}, Row{"10000", 11900, 7.0}}) {
    test_support::MetaballsOf(scene.rendering.technique).count = row.asked;
    for (const auto& transport : accuracy::kTransportNames) {
      if (transport.value == scene::Transport::kDiffusion) continue;  // drawn as consistent
      test_support::SetTransport(&scene.rendering.technique, transport.value);
      const std::string path =
          std::string("metaball/") + row.name + '/' + std::string(transport.name);
      Register(path, scene, fields, Moving::kCamera, row.paper_fps);
      Register(path + "/sun_moves", scene, fields, Moving::kSun);
    }
  }
}

void RegisterCumulus() {
  scene::Scene scene = PaperScene();
  scene.output = {600, 600, 88};
  test_support::SetTechnique(&scene.rendering.technique, test_support::kCumulus);
  struct Row {
    const char* name;
    scene::CumulusSource source;
    int scales;
  };
  const Fields& fields = Sample::Get().fields;
  for (const Row& row : {Row{"paper", scene::CumulusSource::kCauliflower, 2},
                         Row{"cauliflower", scene::CumulusSource::kCauliflower, 4},
                         Row{"storm", scene::CumulusSource::kStorm, 3}}) {
    const std::string name = std::string("cumulus/") + row.name;
    test_support::CumulusOf(scene.rendering.technique) = {};
    test_support::CumulusOf(scene.rendering.technique).source = row.source;
    test_support::CumulusOf(scene.rendering.technique).scales = row.scales;
    Register(name + "/shaded", scene, fields, Moving::kCamera);
    Register(name + "/sun_moves", scene, fields, Moving::kSun);
    test_support::CumulusOf(scene.rendering.technique).component = scene::CumulusComponent::kBalls;
    Register(name + "/lambert_balls", scene, fields, Moving::kCamera);
  }
}

}  // namespace thunderhead::bench
