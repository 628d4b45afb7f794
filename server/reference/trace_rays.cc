#include "reference/trace_rays.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "base/status.h"
#include "reference/parallel.h"
#include "reference/path_radiance.h"

namespace thunderhead::reference {
namespace {

// Number of rays in a piece of work, which takes some milliseconds.
constexpr std::size_t kRaysInPiece = 64;

}  // namespace

absl::StatusOr<std::vector<glm::dvec3>> TraceRays(const Medium& medium,
                                                  const Surroundings& surroundings,
                                                  const std::vector<Ray>& rays,
                                                  const TraceRaysOptions& options) {
  THUNDERHEAD_CHECK(options.similar_after == 0 || medium.HasSimilar(), "no similar medium");
  std::vector<glm::dvec3> radiance(rays.size(), glm::dvec3(0.0));
  const PathOptions of_path{.similar_after = options.similar_after};
  std::mutex mutex;
  absl::Status ended = absl::OkStatus();
  std::atomic<bool> has_ended{false};
  const auto goes_on = [&] {
    if (options.wanted == nullptr) return true;
    if (has_ended) return false;
    absl::Status wanted = options.wanted();
    if (wanted.ok()) return true;
    const std::lock_guard lock(mutex);
    ended = std::move(wanted);
    has_ended = true;
    return false;
  };
  ParallelForBlocks(
      options.threads, rays.size(), kRaysInPiece, [&](std::size_t begin, std::size_t end) {
        if (!goes_on()) return;
        for (std::size_t i = begin; i < end; ++i) {
          for (int path = 0; path < options.paths_per_ray; ++path) {
            RandomStream random(options.seed, i, static_cast<std::uint32_t>(path));
            radiance[i] +=
                EstimateRadiance(medium, surroundings, rays[i], &random, of_path).radiance;
          }
          radiance[i] /= static_cast<double>(options.paths_per_ray);
        }
      });
  if (!ended.ok()) return ended;
  return radiance;
}

RayTracer TracerOnProcessors(std::shared_ptr<const Medium> medium) {
  return
      [medium = std::move(medium)](const Surroundings& surroundings, const std::vector<Ray>& rays,
                                   const TraceRaysOptions& options) {
        return TraceRays(*medium, surroundings, rays, options);
      };
}

}  // namespace thunderhead::reference
