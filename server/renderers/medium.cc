#include "renderers/medium.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/stopwatch.h"
#include "gl/device_memory.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "physics/detail_tile.h"
#include "physics/optics.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"
#include "volume/brick_map.h"
#include "volume/coarsen.h"
#include "volume/detail_control.h"
#include "volume/water_path_memo.h"

namespace thunderhead::renderers {
namespace {

constexpr std::size_t kMaxBoxes = 8192;
// Number of the noise's level whose texels are as long as the noise's longest wavelength, so that
// this level is almost uniform. Level 0 is the finest.
constexpr double kLevelsOfBillows = 4.0;
// Width in cells that a sample represents for light. Light is stored by cell, so detail that cells
// cannot resolve must not flicker from cell to cell.
constexpr double kLightFootprintInCells = 1.0;

std::vector<DetailLayer> LayersOf(const Medium& medium, const volume::AirMotion& motion,
                                  DetailNoises* noises) {
  std::vector<DetailLayer> layers;
  for (scene::DetailLayer& layer : scene::DetailLayersOf(medium.groups)) {
    auto noise = noises->Get(layer.detail.octaves, layer.detail.seed);
    const glm::dvec2 drift_m = layer.Drift_m(motion);
    layers.push_back({std::move(layer), std::move(noise), drift_m});
  }
  return layers;
}

// Packs one value for each group into vectors for shaders, four values to a vector.
std::vector<glm::vec4> Packed(const std::vector<double>& by_group, double factor) {
  std::vector<glm::vec4> packed((by_group.size() + 3) / 4, glm::vec4(0.0F));
  for (std::size_t i = 0; i < by_group.size(); ++i) {
    packed[i / 4][static_cast<int>(i % 4)] = static_cast<float>(by_group[i] * factor);
  }
  return packed;
}

std::uint64_t NextId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

struct Computed {
  volume::ExtinctionVolume extinction;
  volume::DetailControl detail_control;  // empty if the medium has no detail
  volume::WaterPathEffort effort = volume::WaterPathEffort::kFull;
};

// Returns the cache of water paths for all media of the process. Several sessions and contexts may
// draw the same storm.
volume::WaterPathMemo& RememberedWaterPaths() {
  constexpr std::size_t kMostBytes = 32U << 20U;
  static volume::WaterPathMemo memo(kMostBytes);
  return memo;
}

Computed ComputedOf(const volume::HydrometeorFields& fields, const Medium& medium,
                    DetailNoises* noises, volume::WaterPathEffort effort) {
  Computed computed;
  computed.extinction =
      volume::ComputeExtinction(fields, medium.terms, static_cast<int>(medium.groups.size()));
  const std::vector<scene::DetailLayer> layers = scene::DetailLayersOf(medium.groups);
  if (layers.empty() || computed.extinction.Empty()) return computed;
  computed.detail_control = volume::DetailControlOf(fields, medium.terms, computed.extinction);
  const auto tile_of = [&](const scene::Detail& detail) {
    return &noises->Get(detail.octaves, detail.seed)->tile;
  };
  computed.effort = RememberedWaterPaths().Keep(
      scene::PlacedDetailOf(layers, tile_of, computed.extinction.grid.spacing_m, fields.motion),
      &computed.detail_control, &computed.extinction, effort);
  return computed;
}

// Computes the medium. If a texture cannot hold all cells, it uses fewer and larger cells.
Computed ComputedThatFits(const volume::HydrometeorFields& fields, const Medium& medium,
                          DetailNoises* noises, volume::WaterPathEffort effort) {
  GLint max_texels = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_texels);
  const glm::ivec3 factor = volume::CoarseningFor(fields, max_texels);
  if (factor == glm::ivec3(1)) return ComputedOf(fields, medium, noises, effort);
  return ComputedOf(volume::Coarsened(fields, factor), medium, noises, effort);
}

// Returns boxes around the occupied bricks. The first brick begins at `corner_m`.
Boxes BoxesOf(const volume::BrickMap& bricks, const glm::dvec3& brick_m,
              const glm::dvec3& corner_m) {
  const volume::BrickCubes cubes = volume::OccupiedCubesOf(bricks, kMaxBoxes);
  const glm::dvec3 cube_m = static_cast<double>(cubes.bricks_across) * brick_m;
  Boxes boxes{{}, cube_m / 2.0};
  boxes.middles_m.reserve(cubes.occupied.size());
  for (const std::uint32_t cube : cubes.occupied) {
    const glm::dvec3 place(cube & 1023U, cube >> 10U & 1023U, cube >> 20U);
    boxes.middles_m.push_back(corner_m + (place + 0.5) * cube_m);
  }
  return boxes;
}

}  // namespace

ResidentMedium::ResidentMedium(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                               DetailNoises* noises, Cost* cost, volume::WaterPathEffort effort)
    : id_(NextId()), content_(scene::GroupedFieldsOf(scene, fields)) {
  constexpr std::array<GLenum, 5> kFormats = {0, GL_R16F, GL_RG16F, 0, GL_RGBA16F};
  constexpr std::array<GLenum, 5> kTransferFormats = {0, GL_RED, GL_RG, 0, GL_RGBA};
  base::Stopwatch stopwatch;
  details_ = LayersOf(content_, fields.motion, noises);
  // Reserves the memory of the texels until they are uploaded. Each cell has a half float for each
  // group, and a texel that controls detail.
  const base::MemoryReservation on_the_way = gl::DeviceMemory::ReserveBeside(
      fields.grid.CellCount() * (2 * content_.groups.size() + sizeof(volume::DetailTexel)));
  Computed computed = ComputedThatFits(fields, content_, noises, effort);
  bounds_ = std::move(computed.extinction);
  const volume::BrickMap bricks = volume::BrickMapOf(bounds_);
  const volume::CellBlocks blocks = volume::CellBlocksOf(bricks, bounds_.grid);
  cost->extinction_ms = stopwatch.Restart();
  std::vector<physics::PhaseFunction> phases;
  for (const MediumGroup& group : content_.groups) phases.push_back(group.phase);
  if (!phases.empty()) phase_curves_ = PhaseCurves(phases);
  if (bounds_.Empty()) return;
  for (volume::ExtinctionPlane& plane : bounds_.planes) {
    const auto channels = static_cast<std::size_t>(plane.channels);
    gl::Texture3D texture(kFormats[channels], bounds_.grid.cells);
    texture.Upload(kTransferFormats[channels], GL_HALF_FLOAT, plane.texels.data());
    textures_.push_back(std::move(texture));
  }
  bounds_.planes.clear();
  bricks_ = gl::Texture3D(GL_R8UI, bricks.bricks, gl::Filter::kNearest);
  bricks_.Upload(GL_RED_INTEGER, GL_UNSIGNED_BYTE, bricks.content.data());
  brick_m_ = glm::dvec3(bricks.cells_per_brick) * bounds_.grid.spacing_m;
  bricks_low_m_ = bounds_.grid.low_corner_m - 0.5 * bounds_.grid.spacing_m;
  const auto empty =
      std::count_if(bricks.content.begin(), bricks.content.end(), volume::BrickMap::IsEmpty);
  occupied_count_ = static_cast<int>(bricks.content.size()) - static_cast<int>(empty);
  occupied_boxes_ = BoxesOf(bricks, brick_m_, bricks_low_m_);
  cells_per_block_ = blocks.cells_per_block;
  block_count_ = static_cast<int>(blocks.occupied.size());
  if (block_count_ > 0) {
    blocks_ = gl::Buffer(blocks.occupied.size() * sizeof(std::uint32_t), blocks.occupied.data(), 0);
  }
  if (!computed.detail_control.empty()) {
    has_quick_water_paths_ = computed.effort == volume::WaterPathEffort::kQuick;
    detail_control_ = gl::Texture3D(GL_RGBA8, bounds_.grid.cells);
    detail_control_.Upload(GL_RGBA, GL_UNSIGNED_BYTE, computed.detail_control.data());
    detail_fibres_ = glm::mat3(physics::FibresAlong(fields.motion.shear_m_per_s));
  }
  cost->upload_ms = stopwatch.ElapsedMs();
}

void ResidentMedium::Bind(const gl::Program& program) const {
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    textures_[i].Bind(shaders::kMediumPlaneUnit + static_cast<GLuint>(i));
  }
  phase_curves_.Bind();
  BindBox(program);
  program.Set(uniform::extinction_weights,
              Weights(std::vector<double>(content_.groups.size(), 1.0)));
  if (!details_.empty()) BindDetails(program);
}

void ResidentMedium::BindBox(const gl::Program& program) const {
  const glm::dvec3 extent_m = glm::dvec3(bounds_.grid.cells) * bounds_.grid.spacing_m;
  program.Set(uniform::texture_from_local_scale, glm::vec3(1.0 / extent_m));
  program.Set(uniform::texture_from_local_offset,
              glm::vec3((Middle_m() - bounds_.grid.low_corner_m) / extent_m));
  program.Set(uniform::medium_low_m, glm::vec3(-HalfExtent_m()));
  program.Set(uniform::medium_high_m, glm::vec3(HalfExtent_m()));
}

void ResidentMedium::BindWithBricks(const gl::Program& program) const {
  Bind(program);
  BindBricks(program);
}

void ResidentMedium::BindBricks(const gl::Program& program) const {
  bricks_.Bind(shaders::kBricksUnit);
  program.Set(uniform::brick_from_local_scale, glm::vec3(1.0 / brick_m_));
  program.Set(uniform::brick_from_local_offset, glm::vec3((Middle_m() - bricks_low_m_) / brick_m_));
  program.Set(uniform::brick_count, bricks_.Size());
}

void ResidentMedium::BindDetails(const gl::Program& program) const {
  const glm::dvec3& cell_m = bounds_.grid.spacing_m;
  const glm::dvec3 extent_m = glm::dvec3(bounds_.grid.cells) * cell_m;
  std::vector<glm::vec3> sizes;
  std::vector<glm::vec3> corners;
  std::vector<glm::vec4> shares;
  for (std::size_t i = 0; i < details_.size(); ++i) {
    const DetailLayer& layer = details_[i];
    sizes.emplace_back(layer.Tile_m() / extent_m);
    // The low corner is not reduced modulo the tile size, because this would displace fibres, whose
    // tiles have a different size.
    corners.emplace_back((glm::dvec3(layer.drift_m, 0.0) - bounds_.grid.low_corner_m) / extent_m);
    const std::vector<glm::vec4> packed = Packed(layer.share_by_group, 1.0);
    shares.insert(shares.end(), packed.begin(), packed.end());
  }
  detail_control_.Bind(shaders::kDetailControlUnit);
  program.Set(uniform::detail_tile_size, sizes);
  program.Set(uniform::detail_tile_corner, corners);
  program.Set(uniform::detail_shares, shares);
  program.Set(uniform::detail_fibres, detail_fibres_);
  program.Set(uniform::detail_warp,
              glm::vec3(physics::DetailWarp_m(cell_m, details_[0].detail.wavelength_m) / extent_m));
  BindNoises(program, {kLightFootprintInCells * std::max(cell_m.x, cell_m.y), 0.0}, 0.0);
}

void ResidentMedium::BindPixel(const gl::Program& program, const scene::View& view,
                               const glm::ivec2& size_px) const {
  if (details_.empty()) return;
  const glm::dvec3 nearest_m =
      glm::max(glm::abs(view.eye_m - Middle_m()) - HalfExtent_m(), glm::dvec3(0.0));
  BindNoises(program,
             {2.0 * view.half_height_m / size_px.y, 2.0 * view.tan_half_height / size_px.y},
             glm::length(nearest_m));
}

// Selects for each noise the level that suits the nearest part of the medium.
void ResidentMedium::BindNoises(const gl::Program& program, const Footprint& footprint,
                                double nearest_m) const {
  std::vector<float> left_out;
  std::vector<float> fades_at_start;
  std::vector<float> fades_per_m;
  for (std::size_t i = 0; i < details_.size(); ++i) {
    const DetailLayer& layer = details_[i];
    const double texel_m = static_cast<double>(layer.detail.wavelength_m) *
                           physics::DetailTile::kWaves / physics::DetailTile::kSide;
    const double texels = (footprint.at_start_m + footprint.per_m * nearest_m) / texel_m;
    const std::vector<gl::Texture3D>& levels = layer.noise->levels;
    const int level = std::clamp(static_cast<int>(std::floor(std::log2(std::max(texels, 1.0)))), 0,
                                 static_cast<int>(levels.size()) - 1);
    levels[static_cast<std::size_t>(level)].Bind(shaders::kDetailNoiseUnit +
                                                 static_cast<GLuint>(i));
    left_out.push_back(static_cast<float>(std::min(level / kLevelsOfBillows, 1.0)));
    // The fade begins where the footprint (the width that a sample represents) is one texel of that
    // level. It ends where the footprint is 16 texels, which at the finest level is the longest
    // wavelength.
    const double level_texel_m = texel_m * std::ldexp(1.0, level);
    const double reach = std::ldexp(1.0, static_cast<int>(kLevelsOfBillows)) - 1.0;
    fades_at_start.push_back(
        static_cast<float>((footprint.at_start_m / level_texel_m - 1.0) / reach));
    fades_per_m.push_back(static_cast<float>(footprint.per_m / level_texel_m / reach));
  }
  program.Set(uniform::detail_left_out, left_out);
  program.Set(uniform::detail_fade_at_start, fades_at_start);
  program.Set(uniform::detail_fade_per_m, fades_per_m);
}

double ResidentMedium::OccupiedShare() const {
  if (Empty()) return 0.0;
  // Bricks extend beyond the box, so the sum could exceed 1.
  const glm::dvec3 sides = brick_m_ / (2.0 * HalfExtent_m());
  return std::min(occupied_count_ * sides.x * sides.y * sides.z, 1.0);
}

double ResidentMedium::ShortestBrickSide_m() const {
  return std::min({brick_m_.x, brick_m_.y, brick_m_.z});
}

void ResidentMedium::BindBlocks(const gl::Program& program) const {
  blocks_.BindStorage(shaders::kBlocksBinding);
  program.Set(uniform::cells_per_block, cells_per_block_);
}

std::size_t ResidentMedium::Bytes() const {
  std::size_t bytes =
      bricks_.Bytes() + blocks_.Bytes() + phase_curves_.Bytes() + detail_control_.Bytes();
  for (const gl::Texture3D& texture : textures_) bytes += texture.Bytes();
  for (const DetailLayer& layer : details_) bytes += layer.noise->Bytes();
  return bytes;
}

std::vector<glm::vec4> ResidentMedium::Weights(const std::vector<double>& by_group) const {
  return Packed(by_group, bounds_.extinction_per_m);
}

}  // namespace thunderhead::renderers
