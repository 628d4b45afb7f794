#include "device_paths/device_tracer.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "base/guarded.h"
#include "base/status.h"
#include "device_paths/bindings.h"
#include "gl/device_faults.h"
#include "reference/eye_segment.h"
#include "reference/parallel.h"
#include "reference/philox.h"
#include "reference/roulette.h"
#include "shaders/uniforms.h"

namespace thunderhead::device_paths {
namespace {

// Number of paths traced at once. Their states take at most 25 MB.
constexpr std::size_t kPathsOfChunk = 65536;
// The assumed cost of a block of kGroupsOfBlock work groups, used until the cost of a block has
// been measured. The cost is not measured for single groups, because a GPU runs many groups at the
// same time. A pass over the last few paths needs only a few groups, and its cost per group is
// higher than that of a full pass.
constexpr gl::PieceCost kBlockOfPaths{"paths", 1e7};
constexpr int kGroupsOfBlock = 64;
// Number of paths that the host begins or ends in one task.
constexpr std::size_t kPathsOfTask = 256;

// Runs work(i) for i = 0 to `count` - 1 on `threads` threads.
template <typename Work>
void ForPaths(int threads, std::size_t count, const Work& work) {
  reference::ParallelForBlocks(threads, count, kPathsOfTask,
                               [&](std::size_t begin, std::size_t end) {
                                 for (std::size_t i = begin; i < end; ++i) work(i);
                               });
}

// This bit separates the host's random streams from those of the device. It is the highest bit of
// the counter's last word, which in the device's streams is the number of the sample.
constexpr std::uint64_t kHostStreams = std::uint64_t{1} << 63U;

glm::uvec3 StreamOf(std::size_t ray, std::uint32_t sample, std::uint32_t kind,
                    std::uint32_t hero = 0) {
  return {kind | (hero << 30U), static_cast<std::uint32_t>(ray), sample};
}

}  // namespace

bool TracesOnDevice() {
  static const char* const chosen = std::getenv("THUNDERHEAD_PATHS");
  return chosen != nullptr && std::string_view(chosen) == "device";
}

struct DeviceTracer::Begun {
  reference::EyeSegment segment;
  std::uint32_t hero = 0;
  std::uint32_t air_hero = 0;
  // Index of this path's first state on the device. The states are those of the shaded light, of
  // the air and of the path itself.
  std::size_t first_state = 0;
};

absl::StatusOr<std::unique_ptr<DeviceTracer>> DeviceTracer::Create(
    const reference::Medium& medium, std::shared_ptr<gl::ProgramCache> programs) {
  // The CPU prepares the data without the device turn, so that other contexts can draw in the
  // meantime.
  absl::StatusOr<DeviceMedium> on_device = absl::InternalError("not made");
  THUNDERHEAD_RETURN_IF_ERROR(programs->Pieces().OffTurn([&] {
    on_device = DeviceMedium::Of(medium);
    glFinish();
  }));
  if (!on_device.ok()) return on_device.status();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs->Get(gl::ProgramSource::Compute("paths/trace.comp", on_device->Defines())));
  return std::unique_ptr<DeviceTracer>(
      new DeviceTracer(*std::move(on_device), program, std::move(programs)));
}

DeviceTracer::DeviceTracer(DeviceMedium medium, const gl::Program* program,
                           std::shared_ptr<gl::ProgramCache> programs)
    : medium_(std::move(medium)), program_(program), programs_(std::move(programs)) {}

DeviceTracer::PathState DeviceTracer::StateOf(const reference::Ray& ray, int what,
                                              const glm::uvec3& stream) const {
  PathState state;
  state.place = glm::vec4(glm::vec3(medium_.InBricks(ray.origin_m)), shaders::kEndlessPath_m);
  state.direction = glm::vec4(glm::vec3(ray.direction), static_cast<float>(what));
  state.throughput = glm::vec4(1.0F, 1.0F, 1.0F, 0.0F);
  state.spectral = glm::vec4(1.0F, 1.0F, 1.0F, static_cast<float>(reference::kLongPath));
  state.counter = glm::uvec4(0U, stream);
  return state;
}

void DeviceTracer::BindSurroundings(const reference::Surroundings& surroundings,
                                    const reference::TraceRaysOptions& options) {
  std::vector<glm::vec4> lights;
  for (const glm::dvec3& sun : surroundings.sun_by_height) lights.emplace_back(sun, 0.0);
  if (lights.empty()) lights.emplace_back(surroundings.sun_irradiance, 0.0);
  program_->Set(uniform::sun_heights, static_cast<int>(lights.size()));
  program_->Set(uniform::sun_step_m, static_cast<float>(reference::Surroundings::kSunStep_m));
  program_->Set(uniform::other_lights, static_cast<int>(surroundings.lights.size()));
  for (const reference::DirectionalLight& light : surroundings.lights) {
    lights.emplace_back(light.towards, 0.0);
    lights.emplace_back(light.irradiance, 0.0);
  }
  lights_ = gl::Buffer(lights.size() * sizeof(glm::vec4), lights.data(), 0);
  lights_.BindStorage(shaders::kPathLightsBinding);
  program_->Set(uniform::towards_sun, glm::vec3(surroundings.towards_sun));
  program_->Set(uniform::similar_after, options.similar_after);
  program_->Set(uniform::key, glm::ivec2(static_cast<std::int32_t>(options.seed),
                                         static_cast<std::int32_t>(options.seed >> 32U)));
  program_->Set(uniform::has_ground, surroundings.ground.has_value());
  if (!surroundings.ground.has_value()) return;
  const reference::Ground& ground = *surroundings.ground;
  program_->Set(uniform::low_from_touch_m,
                glm::vec3(medium_.BrickLow_m() - glm::dvec3(ground.touch_m, ground.height_m)));
  program_->Set(uniform::ground_albedo, glm::vec3(ground.albedo));
  program_->Set(uniform::ground_radiance, glm::vec3(ground.radiance));
  program_->Set(uniform::ground_curvature_per_m, static_cast<float>(ground.curvature_per_m));
}

absl::StatusOr<std::vector<glm::dvec3>> DeviceTracer::Trace(
    const reference::Surroundings& surroundings, const std::vector<reference::Ray>& rays,
    const reference::TraceRaysOptions& options) {
  const auto of_ray = static_cast<std::size_t>(options.paths_per_ray);
  std::vector<glm::dvec3> radiance(rays.size(), glm::dvec3(0.0));
  const std::size_t rays_of_chunk = std::max<std::size_t>(kPathsOfChunk / of_ray, 1);
  for (std::size_t first = 0; first < rays.size(); first += rays_of_chunk) {
    const std::size_t count = (std::min(rays.size(), first + rays_of_chunk) - first) * of_ray;
    const auto ray_of = [&](std::size_t path) { return first + path / of_ray; };
    const auto sample_of = [&](std::size_t path) {
      return static_cast<std::uint32_t>(path % of_ray);
    };

    // The distances at which the rays meet the medium's particles, computed on the device.
    std::vector<PathState> met(count);
    std::vector<double> grounds_m(count);
    ForPaths(options.threads, count, [&](std::size_t i) {
      const reference::Ray& ray = rays[ray_of(i)];
      grounds_m[i] = reference::GroundDistance_m(surroundings, ray);
      met[i] =
          StateOf(ray, shaders::kPathMeets, StreamOf(ray_of(i), sample_of(i), shaders::kPathMeets));
      met[i].place.w =
          static_cast<float>(std::min(grounds_m[i], static_cast<double>(shaders::kEndlessPath_m)));
    });
    THUNDERHEAD_RETURN_IF_ERROR(Run(surroundings, options, &met));

    // The first segments of the paths, and the states from which the device continues them.
    std::vector<Begun> begun(count);
    ForPaths(options.threads, count, [&](std::size_t i) {
      reference::RandomStream random(options.seed, kHostStreams | ray_of(i), sample_of(i));
      const float at_m = met[i].radiance.w;
      const auto collision_m = at_m < 0.0F ? std::nullopt : std::optional<double>(at_m);
      begun[i].segment = reference::FollowFromEye(surroundings, rays[ray_of(i)], grounds_m[i],
                                                  collision_m, &random);
      begun[i].hero = static_cast<std::uint32_t>(3.0 * random.Uniform());
      begun[i].air_hero = static_cast<std::uint32_t>(3.0 * random.Uniform());
    });
    std::vector<PathState> states;
    for (std::size_t i = 0; i < count; ++i) {
      Begin(ray_of(i), sample_of(i), &begun[i], &states);
    }
    THUNDERHEAD_RETURN_IF_ERROR(Run(surroundings, options, &states));

    std::vector<glm::dvec3> estimates(count);
    ForPaths(options.threads, count,
             [&](std::size_t i) { estimates[i] = End(surroundings, begun[i], states); });
    for (std::size_t i = 0; i < count; ++i) {
      radiance[ray_of(i)] += estimates[i] / static_cast<double>(of_ray);
    }
  }
  return radiance;
}

void DeviceTracer::Begin(std::size_t ray, std::uint32_t sample, Begun* begun,
                         std::vector<PathState>* states) const {
  begun->first_state = states->size();
  const reference::EyeSegment& segment = begun->segment;
  // Each traced ray has its own random stream, identified by a number. For the ray through the air
  // and for the path itself this number is the kind of their state (kPathTries, kPathFlies). The
  // rays of shaded light use the numbers after the last kind, which is kPathMissed.
  std::uint32_t kind = shaders::kPathMissed;
  for (const reference::ThroughMedium& light : segment.shaded) {
    states->push_back(StateOf(light.ray, shaders::kPathShines, StreamOf(ray, sample, ++kind)));
  }
  if (segment.air.has_value()) {
    states->push_back(StateOf(segment.air->ray, shaders::kPathTries,
                              StreamOf(ray, sample, shaders::kPathTries, begun->air_hero)));
  }
  using Then = reference::EyeSegment::Then;
  if (segment.then == Then::kEnds) return;
  const int what = segment.then == Then::kScatters ? shaders::kPathScatters : shaders::kPathFlies;
  PathState state =
      StateOf(segment.onward, what, StreamOf(ray, sample, shaders::kPathFlies, begun->hero));
  state.throughput = glm::vec4(glm::vec3(segment.throughput), 0.0F);
  states->push_back(state);
}

// Returns the radiance of a path. It is the sum of the path's first segment, of the light that its
// states have gathered, and of the sky into which they left.
glm::dvec3 DeviceTracer::End(const reference::Surroundings& surroundings, const Begun& begun,
                             const std::vector<PathState>& states) {
  const auto light_of = [&](const PathState& state) {
    glm::dvec3 light(state.radiance);
    if (static_cast<int>(state.direction.w) == shaders::kPathEscaped && surroundings.sky) {
      light += glm::dvec3(state.throughput) * glm::dvec3(state.spectral) *
               surroundings.sky(glm::normalize(glm::dvec3(state.direction)));
    }
    return light;
  };
  const reference::EyeSegment& segment = begun.segment;
  glm::dvec3 radiance = segment.radiance;
  std::size_t next = begun.first_state;
  for (const reference::ThroughMedium& light : segment.shaded) {
    radiance += light.radiance * static_cast<double>(states[next++].radiance.w);
  }
  if (segment.air.has_value()) {
    const PathState& state = states[next++];
    if (static_cast<int>(state.direction.w) != shaders::kPathMissed) {
      radiance -= segment.air->of_sky - segment.air->per_radiance * light_of(state);
    }
  }
  if (segment.then != reference::EyeSegment::Then::kEnds) radiance += light_of(states[next]);
  return radiance;
}

absl::Status DeviceTracer::Run(const reference::Surroundings& surroundings,
                               const reference::TraceRaysOptions& options,
                               std::vector<PathState>* states) {
  if (states->empty()) return absl::OkStatus();
  return programs_->Pieces().During([&]() -> absl::Status {
    const std::size_t bytes = states->size() * sizeof(PathState);
    if (states_.Bytes() < bytes) {
      // A list of paths holds its length and then the indices of the paths.
      const std::size_t of_list = (states->size() + 1) * sizeof(std::uint32_t);
      // states_ is set last. Its size implies that the lists are large enough, even if an
      // allocation fails.
      states_ = {};
      list_ = gl::Buffer(of_list, nullptr, GL_DYNAMIC_STORAGE_BIT);
      next_list_ = gl::Buffer(of_list, nullptr, GL_DYNAMIC_STORAGE_BIT);
      gl::Buffer made(bytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
      THUNDERHEAD_RETURN_IF_ERROR(gl::FaultNow());
      states_ = std::move(made);
    }
    glNamedBufferSubData(states_.Get(), 0, static_cast<GLsizeiptr>(bytes), states->data());
    medium_.Bind(*program_);
    BindSurroundings(surroundings, options);
    states_.BindStorage(shaders::kPathStatesBinding);
    program_->Use();
    THUNDERHEAD_RETURN_IF_ERROR(RunPasses(options, static_cast<int>(states->size())));
    glGetNamedBufferSubData(states_.Get(), 0, static_cast<GLsizeiptr>(bytes), states->data());
    return absl::OkStatus();
  });
}

absl::Status DeviceTracer::RunPasses(const reference::TraceRaysOptions& options, int count) {
  for (bool by_list = false; count > 0; by_list = true) {
    if (options.wanted) THUNDERHEAD_RETURN_IF_ERROR(options.wanted());
    const std::uint32_t none = 0;
    glClearNamedBufferSubData(next_list_.Get(), GL_R32UI, 0, sizeof(none), GL_RED_INTEGER,
                              GL_UNSIGNED_INT, &none);
    list_.BindStorage(shaders::kPathListBinding);
    next_list_.BindStorage(shaders::kPathNextListBinding);
    program_->Set(uniform::by_list, by_list);
    constexpr int kPathsOfBlock = kGroupsOfBlock * shaders::kPathGroupSize;
    const int blocks = (count + kPathsOfBlock - 1) / kPathsOfBlock;
    THUNDERHEAD_RETURN_IF_ERROR(
        programs_->Pieces().Steps(kBlockOfPaths, blocks, [&](int begin, int end) {
          const int end_path = std::min(end * kPathsOfBlock, count);
          program_->Set(uniform::first_path, begin * kPathsOfBlock);
          program_->Set(uniform::end_path, end_path);
          const int groups = (end_path - begin * kPathsOfBlock + shaders::kPathGroupSize - 1) /
                             shaders::kPathGroupSize;
          glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
        }));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    std::uint32_t going = 0;
    glGetNamedBufferSubData(next_list_.Get(), 0, sizeof(going), &going);
    count = static_cast<int>(going);
    std::swap(list_, next_list_);
  }
  return absl::OkStatus();
}

reference::MakesTracer TracersFor(std::shared_ptr<gl::ProgramCache> programs) {
  return [programs = std::move(programs)](const std::shared_ptr<const reference::Medium>& medium)
             -> absl::StatusOr<reference::RayTracer> {
    if (!TracesOnDevice()) return reference::TracerOnProcessors(medium);
    auto made = base::Guarded([&] {
      return programs->Pieces().During([&] { return DeviceTracer::Create(*medium, programs); });
    });
    if (absl::IsUnimplemented(made.status()) || absl::IsResourceExhausted(made.status())) {
      spdlog::info("paths are traced on the CPU instead of the device: {}",
                   made.status().ToString());
      return reference::TracerOnProcessors(medium);
    }
    if (!made.ok()) return made.status();
    return [tracer = std::shared_ptr<DeviceTracer>(*std::move(made))](
               const reference::Surroundings& surroundings, const std::vector<reference::Ray>& rays,
               const reference::TraceRaysOptions& options) {
      return tracer->Trace(surroundings, rays, options);
    };
  };
}

}  // namespace thunderhead::device_paths
