// The reference's paths on the device: what takes the time, the way through the medium, in compute
// shaders (shaders/paths/trace.comp); sky, air and ground as the eye sees them by the reference's
// own functions, on the processors. Estimates the same radiance as reference::TraceRays, with other
// random numbers. Owns GL objects: use it on the context's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "device_paths/device_medium.h"
#include "gl/program.h"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "reference/brick_walk.h"
#include "reference/medium.h"
#include "reference/surroundings.h"
#include "reference/trace_rays.h"

namespace thunderhead::device_paths {

// Returns whether the thread's device traces paths: only if THUNDERHEAD_PATHS is "device" in the
// environment, because no GPU has been measured yet (docs/decisions/0057).
bool TracesOnDevice();

class DeviceTracer {
 public:
  // Programs are linked and paths dispatched in pieces by `programs`. Fails as DeviceMedium::Of.
  static absl::StatusOr<std::unique_ptr<DeviceTracer>> Create(
      const reference::Medium& medium, std::shared_ptr<gl::ProgramCache> programs);

  // As reference::TraceRays: radiance along each of `rays`, the mean of its paths. The same on the
  // same device however it is cut into pieces. Takes turns on the device itself. Fails if it cannot
  // draw, or as `options.wanted` does.
  absl::StatusOr<std::vector<glm::dvec3>> Trace(const reference::Surroundings& surroundings,
                                                const std::vector<reference::Ray>& rays,
                                                const reference::TraceRaysOptions& options);

 private:
  // PathState of paths/trace.comp.
  struct PathState {
    glm::vec4 place{0.0F};
    glm::vec4 direction{0.0F};
    glm::vec4 throughput{0.0F};
    glm::vec4 spectral{0.0F};
    glm::vec4 radiance{0.0F};
    glm::uvec4 counter{0U};
  };
  struct Begun;  // what a ray's path has led to on the host

  DeviceTracer(DeviceMedium medium, const gl::Program* program,
               std::shared_ptr<gl::ProgramCache> programs);

  PathState StateOf(const reference::Ray& ray, int what, const glm::uvec3& stream) const;
  // Adds what the device is asked for a path.
  void Begin(std::size_t ray, std::uint32_t sample, Begun* begun,
             std::vector<PathState>* states) const;
  // Radiance along its ray, from what the device has found.
  static glm::dvec3 End(const reference::Surroundings& surroundings, const Begun& begun,
                        const std::vector<PathState>& states);
  void BindSurroundings(const reference::Surroundings& surroundings,
                        const reference::TraceRaysOptions& options);
  // Follows all paths to their ends.
  absl::Status Run(const reference::Surroundings& surroundings,
                   const reference::TraceRaysOptions& options, std::vector<PathState>* states);
  absl::Status RunPasses(const reference::TraceRaysOptions& options, int count);

  const DeviceMedium medium_;
  const gl::Program* program_;
  const std::shared_ptr<gl::ProgramCache> programs_;
  gl::Buffer lights_;
  gl::Buffer states_;
  gl::Buffer list_;
  gl::Buffer next_list_;
};

// Traces rays on the device where TracesOnDevice and a medium has room there, and else on the
// processors. To be used, as what it makes, on the thread of the context of `programs`. Making one
// fails if it cannot draw.
reference::MakesTracer TracersFor(std::shared_ptr<gl::ProgramCache> programs);

}  // namespace thunderhead::device_paths
