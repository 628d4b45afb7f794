#include "renderers/light_volume/diffusion_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/half_float.h"
#include "base/status.h"
#include "gl/device_memory.h"
#include "glm/common.hpp"
#include "renderers/light_volume/bindings.h"
#include "renderers/light_volume/shares.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of cells. Media with more cells are solved on a coarser grid.
constexpr double kMaxDiffusionCells = 4e6;

// Memory of DiffuseLight, its inputs and this pass: bytes for each cell, and additional bytes for
// each non-empty cell.
constexpr std::size_t kBytesPerCell = 56;
constexpr std::size_t kBytesPerFullCell = 176;

std::size_t BytesFor(const DiffusionCells& cells) {
  const auto full = static_cast<std::size_t>(
      std::ranges::count_if(cells.light_per_m, [](float per_m) { return per_m > 0.0F; }));
  return kBytesPerCell * cells.light_per_m.size() + kBytesPerFullCell * full;
}

glm::ivec3 SizeFor(const glm::ivec3& cells) {
  const double count = static_cast<double>(cells.x) * cells.y * cells.z;
  const int factor =
      std::max(static_cast<int>(std::ceil(std::cbrt(count / kMaxDiffusionCells))), 1);
  return glm::max((cells + factor - 1) / factor, glm::ivec3(1));
}

void Dispatch(const glm::ivec3& cells) {
  const glm::ivec3 groups = (cells + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y),
                    static_cast<GLuint>(cells.z));
}

}  // namespace

absl::Status DiffusionPass::Solve(const ResidentMedium& medium, const GroupWeights& weights,
                                  const gl::Texture3D& arrived, const glm::dvec3& towards_sun,
                                  double tolerance, const LitGround& ground, bool in_turns) {
  Key key{medium.Id(), weights.light, weights.transport, weights.absorption};
  if (!light_.has_value() || key != key_) {
    light_.reset();
    memory_ = {};
    THUNDERHEAD_ASSIGN_OR_RETURN(DiffusionCells cells, SampleCells(medium, weights));
    memory_ = gl::DeviceMemory::ReserveBeside(BytesFor(cells));
    THUNDERHEAD_RETURN_IF_ERROR(programs_->Pieces().OffTurn([&] { SolveCells(std::move(cells)); }));
    ground_parts_.Forget();
    key_ = std::move(key);
  }
  THUNDERHEAD_RETURN_IF_ERROR(SampleLight(arrived));
  return programs_->Pieces().OffTurn([&] {
    const std::vector<float>& sun = light_->SolveSun(towards_sun, arrived_root_, tolerance);
    const SunParts::Parts parts = ground_parts_.Next(towards_sun, in_turns);
    const std::vector<float>& from_ground = light_->AtCells(
        [&](const glm::dvec3& from_corner_m, const glm::vec3& outward) {
          return ground.ShareAt(medium.Bounds().grid.low_corner_m + from_corner_m, outward);
        },
        parts);
    ground_parts_.Found(parts, towards_sun);
    const std::vector<NumberedCells::Valued>& cells = light_->CellsWithValues();
    ForShares(cells.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const auto i = static_cast<std::size_t>(cells[v].cell);
        net_inward_texels_[i] = {
            base::HalfFromFloat(sun[i]), base::HalfFromFloat(light_->FromWalls()[i]),
            base::HalfFromFloat(light_->SkyInward()[i].y), base::HalfFromFloat(from_ground[i])};
      }
    });
    net_inward_.Upload(GL_RGBA, GL_HALF_FLOAT, net_inward_texels_.data());
  });
}

absl::StatusOr<DiffusionCells> DiffusionPass::SampleCells(const ResidentMedium& medium,
                                                          const GroupWeights& weights) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::Compute(
                                   "light_volume/sample_cells.comp", medium.Variant().Defines())));
  const volume::RegularGrid& grid = medium.Bounds().grid;
  const glm::ivec3 size = SizeFor(grid.cells);
  if (size_ != size) {
    size_ = size;
    sampled_cells_ = gl::Texture3D(GL_RGBA32F, size);
    sampled_light_ = {};
    exits_ = gl::Texture3D(GL_RGBA16F, size);
    net_inward_ = gl::Texture3D(GL_RGBA16F, size);
  }
  medium.Bind(*program);
  program->Set(uniform::cell_count, size);
  program->Set(uniform::samples, (grid.cells + size - 1) / size);
  program->Set(uniform::light_weights, medium.Weights(weights.light));
  program->Set(uniform::transport_weights, medium.Weights(weights.transport));
  program->Set(uniform::absorption_weights, medium.Weights(weights.absorption));
  sampled_cells_.BindImage(shaders::kSampledCellsImage, GL_WRITE_ONLY);
  program->Use();
  Dispatch(size);
  const std::size_t count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                            static_cast<std::size_t>(size.z);
  std::vector<float> texels(4 * count);
  sampled_cells_.Download(GL_RGBA, GL_FLOAT, texels.size() * sizeof(float), texels.data());
  DiffusionCells cells;
  cells.size = size;
  cells.cell_m = glm::dvec3(grid.cells) * grid.spacing_m / glm::dvec3(size);
  for (std::size_t i = 0; i < count; ++i) {
    cells.light_per_m.push_back(texels[4 * i]);
    cells.transport_per_m.push_back(texels[4 * i + 1]);
    cells.absorption_per_m.push_back(texels[4 * i + 2]);
  }
  return cells;
}

void DiffusionPass::SolveCells(DiffusionCells cells) {
  light_.emplace(std::move(cells));
  const std::size_t count = light_->ExitRoot().size();
  arrived_root_.resize(count);
  net_inward_texels_.assign(count, {});
  std::vector<float> exits(4 * count);
  for (std::size_t i = 0; i < count; ++i) {
    exits[4 * i] = light_->ExitRoot()[i];
    exits[4 * i + 1] = light_->SkySeen()[i].x;
    exits[4 * i + 2] = light_->SkySeen()[i].y;
    exits[4 * i + 3] = light_->SkyInward()[i].x;
  }
  exits_.Upload(GL_RGBA, GL_FLOAT, exits.data());
}

absl::Status DiffusionPass::SampleLight(const gl::Texture3D& arrived) {
  if (arrived.Size() == size_ && arrived.InternalFormat() == GL_R16F) {
    // Half floats are downloaded without conversion by GL. A conversion would be a pass over cells
    // that are mostly empty.
    arrived_halves_.resize(arrived_root_.size());
    arrived.Download(GL_RED, GL_HALF_FLOAT, arrived_halves_.size() * sizeof(std::uint16_t),
                     arrived_halves_.data());
    ForShares(arrived_root_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        arrived_root_[i] = base::FloatFromHalf(arrived_halves_[i]);
      }
    });
    return absl::OkStatus();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute("light_volume/sample_light.comp")));
  if (sampled_light_.Size() != size_) sampled_light_ = gl::Texture3D(GL_R32F, size_);
  program->Set(uniform::cell_count, size_);
  arrived.Bind(shaders::kArrivedUnit);
  sampled_light_.BindImage(shaders::kSampledLightImage, GL_WRITE_ONLY);
  program->Use();
  Dispatch(size_);
  sampled_light_.Download(GL_RED, GL_FLOAT, arrived_root_.size() * sizeof(float),
                          arrived_root_.data());
  return absl::OkStatus();
}

void DiffusionPass::Bind() const {
  exits_.Bind(shaders::kExitsUnit);
  net_inward_.Bind(shaders::kNetInwardUnit);
}

}  // namespace thunderhead::renderers
