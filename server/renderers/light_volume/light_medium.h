// The medium for propagating light: one texture with one extinction value for each cell, computed
// once for the fields and their parameters. Samples along the sun's rays read this texture instead
// of all groups and their detail. Light is stored by cell, so detail finer than cells does not
// affect it anyway.
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

  // Computes the texture of `medium`, which must not be empty, unless the texture is up to date. If
  // `with_transport` is true, texels also hold the similarity-scaled extinction.
  absl::Status Update(const ResidentMedium& medium, const GroupWeights& weights,
                      bool with_transport);

  // Binds the texture for light_volume/light_medium.glsl.
  void Bind(const gl::Program& program) const;
  std::size_t Bytes() const { return texture_.Bytes(); }

  // Returns a number that changes each time the texture is computed. It is never 0.
  std::uint64_t Version() const { return version_; }

  // Return the texture, and the extinction that a texel value of 1 stands for. Only checks use
  // them.
  const gl::Texture3D& Texture() const { return texture_; }
  double PerMetre() const { return per_m_; }

 private:
  // The inputs that determine the texture.
  struct Key {
    std::uint64_t medium = 0;
    std::vector<double> light;
    std::vector<double> transport;  // empty if not requested

    bool operator==(const Key&) const = default;
  };

  std::shared_ptr<gl::ProgramCache> programs_;
  Key key_;
  std::uint64_t version_ = 0;
  gl::Texture3D texture_;
  double per_m_ = 1.0;
};

}  // namespace thunderhead::renderers
