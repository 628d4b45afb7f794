// A ray from an eye through a storm to the ground: its optical depth, and what a viewer sees along
// it. It uses the fields as the scene draws them, without turbulent detail. Results are exact for
// values that are linear between cell centres (ray_pieces.h). This code does not use GL.
#pragma once

#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "scene/ray_pieces.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

enum class Seen { kCloud, kGround, kSky };

// The smallest optical depth at which cloud counts as seen. A ray with a smaller optical depth
// shows the ground or sky behind the cloud.
inline constexpr double kThinnestSeen_depth = 0.1;

class StormRay {
 public:
  // `direction` must have the length 1.
  StormRay(const Scene& scene, const volume::HydrometeorFields& fields, const glm::dvec3& origin_m,
           const glm::dvec3& direction);

  glm::dvec3 At_m(double along_m) const { return origin_m_ + along_m * direction_; }

  // Returns the optical depth up to the ground.
  double OpticalDepth() const { return depth_; }
  // Returns the distance at which the optical depth reaches `depth`, or nothing if it does not.
  std::optional<double> WhereDepthIs_m(double depth) const;
  std::optional<double> Ground_m() const { return ground_m_; }
  // Returns the part of the ray in the domain, up to the ground. It is empty if the ray misses the
  // domain.
  const Span& InDomain() const { return in_domain_; }
  // Returns the ray's pieces (ray_pieces.h) in and next to cells with condensate.
  const std::vector<RayPiece>& Pieces() const { return pieces_; }

  Seen WhatIsSeen() const;
  // Returns the distance to the cloud or ground that is seen, or nothing for the sky. For cloud,
  // the distance is that of the point with half of the cloud's visible contribution in front of it.
  std::optional<double> WhereSeen_m() const;

 private:
  struct Step {
    Cubic extinction_per_m;
    double depth_before = 0.0;
  };

  const glm::dvec3 origin_m_;
  const glm::dvec3 direction_;
  std::optional<double> ground_m_;
  Span in_domain_;
  std::vector<RayPiece> pieces_;
  std::vector<Step> steps_;  // one for each piece
  double depth_ = 0.0;
};

}  // namespace thunderhead::scene
