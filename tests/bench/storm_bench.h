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

// The sample storm and a context to draw it with. It is opened on first use; a failure ends the
// program with a message.
struct Sample {
  std::unique_ptr<gl::Context> context;
  Fields fields;  // at 40 minutes

  static Sample& Get();
};

// The parameter that changes with every frame.
enum class Moving { kCamera, kSun, kSunClimbs, kField, kExposure };

// Adds columns of the memory of fields and textures.
void TellMemory(benchmark::State& state, const Fields& fields, std::size_t device_bytes);

// Returns a scene of the whole storm at the papers' size, 300 x 300 pixels, 128 slices.
scene::Scene PaperScene();

// Draws whole frames, including JPEG, after two frames that are not counted. Reports the memory of
// fields and textures.
void DrawFrames(benchmark::State& state, scene::Scene scene, const Fields& fields, Moving moving);

// Registers whole frames, including JPEG. The columns `*_ms` split the time by stage. `paper_fps`
// is the papers' rate on a GeForce FX 5800 (Riley et al. 2003, AMS, Table IV), or 0 for none.
void Register(const std::string& name, const scene::Scene& scene, const Fields& fields,
              Moving moving, double paper_fps = 0.0);
// Registers whole frames like the function above, of fields that are made only when the row is
// measured.
void Register(const std::string& name, const scene::Scene& scene, const MakeFields& make,
              Moving moving, double paper_fps = 0.0);

// Registers the modes of the papers' table with both techniques, and the stages that a change
// reruns.
void RegisterModes();

// Registers the presets that sessions draw with while something moves.
void RegisterPresets();

// Registers the scenes and the picture of P. Man, Generating and Real-Time Rendering of Clouds,
// section 5. Man's figures are from a GeForce 4. A fit drops balls without weight, so more balls
// are requested.
void RegisterMetaballs();

// Registers Neyret's shader and Lambert's law on the same ellipsoids, at Neyret's 600 x 600 pixels.
// Neyret's paper draws 87 ellipsoids; the benchmark named "paper" draws twice as many.
void RegisterCumulus();

// Registers a domain of 1000 x 960 x 60 cells, with the sample storm 30 times, at 1280 x 720. It
// measures the first frame and frames while the camera or the sun moves, with the memory of fields
// and textures.
void RegisterWideDomain();

// Registers the paths of one step of the path-traced correction (docs/decisions/0057), on the
// processors and on the device.
void RegisterPaths();

// Registers the savings from drawing only what a scene requires.
void RegisterSavings();
// Registers frames whose times show how the time grows with slices, pixels, fields and cells.
void RegisterGrowth();

}  // namespace thunderhead::bench
