// The first two phases of P. Man's method to approximate a field by metaballs (clouds/rbf_fit.h
// cites the paper). They find the centres of clusters by adaptive k-means (eq. 21-22), and the
// sizes of the clusters (eq. 23). Only the positions of the points are used. The result is the same
// for any number of threads.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::clouds {

struct ClusteringOptions {
  int centres = 1000;
  double min_speed = 0.05;  // training ends after the epoch in which the median centre's learning
                            // rate falls below this
  int min_epochs = 4;
  int max_epochs = 12;
  std::uint64_t seed = 1;
  int threads = 1;
};

struct Clusters {
  std::vector<glm::dvec3> centres_m;
  std::vector<double> sigmas_m;  // root mean square distance of each cluster's points from its
                                 // centre, at least `min_sigma_m`
  int epochs = 0;
};

// A function that is called from time to time with the part of the work done, 0 to 1.
using ClusteringObserver = std::function<void(double share)>;

// Clusters the points. There must be at least as many points as centres. If `stop` requests it, the
// function ends early with the centres found so far.
Clusters Cluster(const std::vector<glm::vec3>& points_m, double min_sigma_m,
                 const ClusteringOptions& options, const ClusteringObserver& observer,
                 const std::stop_token& stop);

}  // namespace thunderhead::clouds
