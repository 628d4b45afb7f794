// Traces the paths of the Monte Carlo reference on the device. Compute shaders
// (shaders/paths/trace.comp) trace the paths through the medium, which takes most of the time. On
// the CPU, functions of reference/ compute sky, air and ground as the eye sees them. The result
// estimates the same radiance as reference::TraceRays, with different random numbers. The tracer
// owns GL objects, so use it on the context's thread.
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

// Returns whether the thread's device traces paths. It returns true only if THUNDERHEAD_PATHS is
// "device" in the environment, because no GPU has been measured yet (docs/decisions/0057).
bool TracesOnDevice();

class DeviceTracer {
 public:
  // Creates a tracer. `programs` links the programs and dispatches the paths in pieces. Fails if
  // DeviceMedium::Of fails.
  static absl::StatusOr<std::unique_ptr<DeviceTracer>> Create(
      const reference::Medium& medium, std::shared_ptr<gl::ProgramCache> programs);

  // Returns the mean radiance of the paths along each of `rays`, like reference::TraceRays. The
  // result on one device does not depend on how the work is cut into pieces. The function takes and
  // releases the device turn (gl/pieces.h) itself. It fails if the device cannot draw, or with an
  // error of `options.wanted`.
  absl::StatusOr<std::vector<glm::dvec3>> Trace(const reference::Surroundings& surroundings,
                                                const std::vector<reference::Ray>& rays,
                                                const reference::TraceRaysOptions& options);

 private:
  // The layout of PathState in paths/trace.comp.
  struct PathState {
    glm::vec4 place{0.0F};
    glm::vec4 direction{0.0F};
    glm::vec4 throughput{0.0F};
    glm::vec4 spectral{0.0F};
    glm::vec4 radiance{0.0F};
    glm::uvec4 counter{0U};
  };
  struct Begun;  // the part of a path that the host has computed

  DeviceTracer(DeviceMedium medium, const gl::Program* program,
               std::shared_ptr<gl::ProgramCache> programs);

  PathState StateOf(const reference::Ray& ray, int what, const glm::uvec3& stream) const;
  // Begins a path on the host and appends to `states` the rays that the device must trace for it.
  void Begin(std::size_t ray, std::uint32_t sample, Begun* begun,
             std::vector<PathState>* states) const;
  // Returns the radiance along the path's ray from the results of the device.
  static glm::dvec3 End(const reference::Surroundings& surroundings, const Begun& begun,
                        const std::vector<PathState>& states);
  void BindSurroundings(const reference::Surroundings& surroundings,
                        const reference::TraceRaysOptions& options);
  // Traces all paths to their ends.
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

// Returns a factory of tracers. A tracer traces on the device if TracesOnDevice returns true, the
// device supports the medium (DeviceMedium::Of) and has memory for it. Otherwise it traces on the
// CPU. Use the factory and its tracers on the thread of the context of `programs`. Making a tracer
// fails if the device cannot draw.
reference::MakesTracer TracersFor(std::shared_ptr<gl::ProgramCache> programs);

}  // namespace thunderhead::device_paths
