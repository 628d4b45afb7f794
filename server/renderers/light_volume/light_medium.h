// The medium as the light that is carried sees it: one texture of one value a cell, made once for
// fields and their parameters, in place of groups and detail at each sample along the sun's rays.
// Cells are what light is given to, and detail that they cannot tell apart does not reach it
// anyway.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/group_weights.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

class LightMedium {
 public:
  explicit LightMedium(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Makes it of `medium`, which must not be empty, unless it is that one. `with_transport`: with
  // similarity-scaled extinction beside the light's.
  absl::Status Update(const ResidentMedium& medium, const GroupWeights& weights,
                      bool with_transport);

  // For light_volume/light_medium.glsl.
  void Bind(const gl::Program& program) const;
  std::size_t Bytes() const { return texture_.Bytes(); }

  // Another number each time that it has been made anew; never 0.
  std::uint64_t Version() const { return version_; }

  // For checks: the texture, and the extinction of a texel value of 1.
  const gl::Texture3D& Texture() const { return texture_; }
  double PerMetre() const { return per_m_; }

 private:
  // The inputs that the texture depends on.
  struct Key {
    std::uint64_t medium = 0;
    std::vector<double> light;
    std::vector<double> transport;  // empty without

    bool operator==(const Key&) const = default;
  };

  std::shared_ptr<gl::ProgramCache> programs_;
  Key key_;
  std::uint64_t version_ = 0;
  gl::Texture3D texture_;
  double per_m_ = 1.0;
};

}  // namespace thunderhead::renderers
