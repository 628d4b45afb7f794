// The sample storm and its papers' scene, and a benchmark that draws frame after frame of it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "benchmark/benchmark.h"
#include "gl/context.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::bench {

using Fields = std::shared_ptr<const volume::HydrometeorFields>;
using MakeFields = std::function<Fields()>;

// Opened on first use; ends the program with a message if that fails.
struct Sample {
  std::unique_ptr<gl::Context> context;
  Fields fields;  // at 40 minutes

  static Sample& Get();
};

// The parameter that changes with every frame.
enum class Moving { kCamera, kSun, kSunClimbs, kField, kExposure };

// Adds columns of the memory of fields and textures.
void TellMemory(benchmark::State& state, const Fields& fields, std::size_t device_bytes);

// The storm as a whole at the papers' size, 300 x 300 pixels, 128 slices.
scene::Scene PaperScene();

// Draws whole frames, JPEG included, after two that are not counted; with the memory of fields and
// textures.
void DrawFrames(benchmark::State& state, scene::Scene scene, const Fields& fields, Moving moving);

// Registers whole frames, JPEG included; the columns `*_ms` split them by stage. `paper_fps` is the
// papers' own on a GeForce FX 5800 (Riley et al. 2003, AMS, Table IV), 0 for none.
void Register(const std::string& name, const scene::Scene& scene, const Fields& fields,
              Moving moving, double paper_fps = 0.0);
// The same of fields that are made when the row is measured.
void Register(const std::string& name, const scene::Scene& scene, const MakeFields& make,
              Moving moving, double paper_fps = 0.0);

// The modes of the papers' table by both paths, and the stages that a change reruns.
void RegisterModes();

// The presets that sessions draw with while something moves.
void RegisterPresets();

// The scenes and the picture of P. Man, Generating and Real-Time Rendering of Clouds, section 5;
// his figures are from a GeForce 4. A fit drops balls without weight, so more are
// requested.
void RegisterMetaballs();

// Neyret's shader against Lambert's law on the same ellipsoids, at his 600 x 600 pixels; "paper"
// has twice his 87.
void RegisterCumulus();

// A domain of 1000 x 960 x 60 cells, the sample storm 30 times, at 1280 x 720: the first frame, and
// frames while the camera or the sun moves; with the memory of fields and textures.
void RegisterWideDomain();

// A step's paths of traced light (docs/decisions/0057), on the processors and on the device.
void RegisterPaths();

// Savings by drawing only what a scene requires, and the growth of time.
void RegisterSavings();
void RegisterGrowth();

}  // namespace thunderhead::bench
