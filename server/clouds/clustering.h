// The first two phases of Man's approximator: centres by adaptive k-means (eq. 21-22) and their
// sizes (eq. 23). Unsupervised: sees positions only. The same for any number of threads.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::clouds {

struct ClusteringOptions {
  int centres = 1000;
  double least_speed =
      0.05;  // an epoch after which the median centre adapts more slowly is the last
  int least_epochs = 4;
  int most_epochs = 12;
  std::uint64_t seed = 1;
  int threads = 1;
};

struct Clusters {
  std::vector<glm::dvec3> centres_m;
  std::vector<double> sigmas_m;  // root mean square distances; never below `least_sigma_m`
  int epochs = 0;
};

// Called now and then with the share done.
using ClusteringObserver = std::function<void(double share)>;

// `points_m` must be at least as many as centres. Stops early, with what there is, if asked to.
Clusters Cluster(const std::vector<glm::vec3>& points_m, double least_sigma_m,
                 const ClusteringOptions& options, const ClusteringObserver& observer,
                 const std::stop_token& stop);

}  // namespace thunderhead::clouds
