#include "renderers/light_volume/light_medium.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"
#include "renderers/light_volume/bindings.h"
#include "renderers/light_volume/cell_blocks.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr gl::PieceCost kLightMediumBlock{"light medium", 12000.0};

// Maximum texel value of the cell that has the largest extinction without detail. Texel values must
// have room for detail. Billows nearly double a cell's extinction. Preserving the columns' water
// can first multiply it by ten (volume/water_paths.h). Half floats range from 2^-24 to 2^16.
constexpr double kThickestTexel = 2048.0;

double PerMetreOf(const ResidentMedium& medium, const GroupWeights& weights) {
  const double most = *std::max_element(weights.light.begin(), weights.light.end());
  const double thickest_per_m = most * medium.Bounds().maximum_per_m;
  return std::exp2(std::ceil(std::log2(std::max(thickest_per_m, 1e-30) / kThickestTexel)));
}

std::vector<double> Times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace

absl::Status LightMedium::Update(const ResidentMedium& medium, const GroupWeights& weights,
                                 bool with_transport) {
  Key key{medium.Id(), weights.light, {}};
  if (with_transport) key.transport = weights.transport;
  if (key == key_) return absl::OkStatus();
  key_ = {};
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::Compute(
                                   "light_volume/light_medium.comp", medium.Variant().Defines())));
  const glm::ivec3 cells = medium.Bounds().grid.cells;
  const GLenum format = with_transport ? GL_RG16F : GL_R16F;
  if (texture_.Size() != cells || texture_.InternalFormat() != format) {
    texture_ = gl::Texture3D(format, cells);
  }
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  texture_.Clear();
  per_m_ = PerMetreOf(medium, weights);
  medium.Bind(*program);
  program->Set(uniform::light_weights, medium.Weights(Times(weights.light, 1.0 / per_m_)));
  program->Set(uniform::transport_weights, medium.Weights(Times(weights.transport, 1.0 / per_m_)));
  texture_.BindImage(shaders::kLightMediumImage, GL_WRITE_ONLY);
  THUNDERHEAD_RETURN_IF_ERROR(ForCellBlocks(programs_->Pieces(), kLightMediumBlock, medium,
                                            *program, 0, medium.BlockCount()));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  key_ = std::move(key);
  ++version_;
  return absl::OkStatus();
}

void LightMedium::Bind(const gl::Program& program) const {
  texture_.Bind(shaders::kLightMediumUnit);
  program.Set(uniform::light_medium_per_m, static_cast<float>(per_m_));
}

}  // namespace thunderhead::renderers
