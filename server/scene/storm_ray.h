// A ray from an eye through a storm, up to the ground: its optical depth, and what it shows. From
// the fields as the scene draws them, without turbulent detail; exact for values that are linear
// between cells' middles (ray_pieces.h). Without GL.
#pragma once

#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "scene/ray_pieces.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

enum class Seen { kCloud, kGround, kSky };

// A ray through less cloud shows what lies behind.
inline constexpr double kThinnestSeen_depth = 0.1;

class StormRay {
 public:
  // `direction` has the length 1.
  StormRay(const Scene& scene, const volume::HydrometeorFields& fields, const glm::dvec3& origin_m,
           const glm::dvec3& direction);

  glm::dvec3 At_m(double along_m) const { return origin_m_ + along_m * direction_; }

  // Up to the ground.
  double OpticalDepth() const { return depth_; }
  // Where that is reached; nothing if it is not.
  std::optional<double> WhereDepthIs_m(double depth) const;
  std::optional<double> Ground_m() const { return ground_m_; }
  // The part in the domain, up to the ground; empty if it misses that.
  const Span& InDomain() const { return in_domain_; }
  // Its pieces near condensate.
  const std::vector<RayPiece>& Pieces() const { return pieces_; }

  Seen WhatIsSeen() const;
  // Of cloud where half of its share of what is seen lies before it; nothing for the sky.
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
  std::vector<Step> steps_;  // of the pieces
  double depth_ = 0.0;
};

}  // namespace thunderhead::scene
