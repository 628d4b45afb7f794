// The diffusion equation of a resident medium. The pass reads from the device the medium's cells
// and the sunlight that arrives at them. It solves the equation (diffuse_light.h) and uploads the
// result as textures for march.frag. Results that depend only on the cells are kept for all suns.
// The class owns GL objects, so use it on the context's thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/group_weights.h"
#include "renderers/light_volume/diffuse_light.h"
#include "renderers/light_volume/sun_parts.h"
#include "renderers/lit_ground.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

class DiffusionPass {
 public:
  explicit DiffusionPass(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Solves for one sun. `arrived` is the output of arrive.comp. `tolerance` is passed to
  // DiffuseLight::SolveSun. If `in_turns` is true, the light of the ground is updated for only a
  // part of the cells (SunParts).
  absl::Status Solve(const ResidentMedium& medium, const GroupWeights& weights,
                     const gl::Texture3D& arrived, const glm::dvec3& towards_sun, double tolerance,
                     const LitGround& ground, bool in_turns);

  // Binds the textures for march.frag.
  void Bind() const;

  // Returns the result of the last Solve, for checks.
  const gl::Texture3D& Exits() const { return exits_; }
  const gl::Texture3D& NetInward() const { return net_inward_; }

  std::size_t Bytes() const {
    return sampled_cells_.Bytes() + sampled_light_.Bytes() + exits_.Bytes() + net_inward_.Bytes();
  }

 private:
  // The inputs that determine the cells.
  struct Key {
    std::uint64_t medium = 0;
    std::vector<double> light;
    std::vector<double> transport;
    std::vector<double> absorption;

    bool operator==(const Key&) const = default;
  };

  absl::StatusOr<DiffusionCells> SampleCells(const ResidentMedium& medium,
                                             const GroupWeights& weights);
  // Creates `light_`, which computes the results that do not depend on the sun.
  void SolveCells(DiffusionCells cells);
  absl::Status SampleLight(const gl::Texture3D& arrived);

  std::shared_ptr<gl::ProgramCache> programs_;
  Key key_;
  base::MemoryReservation memory_;  // main memory of the members below that are not textures
  std::optional<DiffuseLight> light_;
  glm::ivec3 size_{0};
  gl::Texture3D sampled_cells_;
  gl::Texture3D sampled_light_;
  // Texels hold the square root of the optical depth to the nearest exit, DiffuseLight::SkySeen,
  // and component x of DiffuseLight::SkyInward.
  gl::Texture3D exits_;
  // Texels hold the net inward flux of sunlight (DiffuseLight::SolveSun), DiffuseLight::FromWalls,
  // component y of DiffuseLight::SkyInward, and LitGround::ShareAt.
  gl::Texture3D net_inward_;
  SunParts ground_parts_;
  std::vector<float> arrived_root_;
  std::vector<std::uint16_t> arrived_halves_;
  std::vector<std::array<std::uint16_t, 4>> net_inward_texels_;  // half floats
};

}  // namespace thunderhead::renderers
