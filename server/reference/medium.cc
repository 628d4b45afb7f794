#include "reference/medium.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/vec4.hpp"
#include "glm/vector_relational.hpp"

namespace thunderhead::reference {
namespace {

// Factor of majorants. Because of rounding, an interpolated value could exceed the exact maximum.
constexpr double kMajorantMargin = 1.0 + 1e-6;

absl::Status CheckGroup(const ScatteringGroup& group, std::size_t cells) {
  if (group.extinction_per_m.size() != cells) {
    return absl::InvalidArgumentError(absl::StrCat("extinction has ", group.extinction_per_m.size(),
                                                   " values for a grid of ", cells,
                                                   " cells; give one value per cell"));
  }
  const auto usable = [](float value) { return std::isfinite(value) && value >= 0.0F; };
  const auto bad =
      std::find_if_not(group.extinction_per_m.begin(), group.extinction_per_m.end(), usable);
  if (bad != group.extinction_per_m.end()) {
    return absl::InvalidArgumentError(
        absl::StrCat("extinction of cell ", bad - group.extinction_per_m.begin(), " is ", *bad,
                     " 1/m; it must be finite and not negative: replace missing values by 0"));
  }
  for (int color = 0; color < 3; ++color) {
    if (!(group.albedo[color] >= 0.0 && group.albedo[color] <= 1.0)) {
      return absl::InvalidArgumentError(
          absl::StrCat("single-scattering albedo is ", group.albedo[color], "; give 0 to 1"));
    }
  }
  THUNDERHEAD_CHECK(group.phase != nullptr, "a group without phase function");
  return absl::OkStatus();
}

absl::Status CheckBox(const MediumDescription& description) {
  const volume::RegularGrid& grid = description.grid;
  const bool cells = glm::all(glm::greaterThan(grid.cells, glm::ivec3(0))) &&
                     glm::all(glm::greaterThan(grid.spacing_m, glm::dvec3(0.0)));
  if (!cells || !glm::all(glm::lessThan(description.low_m, description.high_m))) {
    return absl::InvalidArgumentError("the medium's box has no volume; give a grid with cells");
  }
  const glm::dvec3 slack = 1e-6 * grid.spacing_m;
  THUNDERHEAD_CHECK(
      glm::all(glm::greaterThanEqual(description.low_m, grid.low_corner_m - slack)) &&
          glm::all(glm::lessThanEqual(description.high_m, grid.HighCorner_m() + slack)),
      "the box reaches beyond the grid");
  return absl::OkStatus();
}

double MeanColor(const glm::dvec3& color) { return (color.x + color.y + color.z) / 3.0; }

void AddTo(const std::vector<float>& values, float factor, std::vector<float>* sum) {
  sum->resize(values.size(), 0.0F);
  std::transform(sum->begin(), sum->end(), values.begin(), sum->begin(),
                 [factor](float before, float value) { return before + factor * value; });
}

int FloorMod(int value, int divisor) {
  const int rest = value % divisor;
  return rest < 0 ? rest + divisor : rest;
}

}  // namespace

DeltaScaled ScaleForward(const glm::dvec3& albedo, double forward_share) {
  const double largest = std::max({albedo.x, albedo.y, albedo.z});
  const double extinction = 1.0 - largest * forward_share;
  return {extinction, glm::min(albedo * ((1.0 - forward_share) / extinction), 1.0)};
}

absl::StatusOr<std::shared_ptr<const Medium>> Medium::Create(MediumDescription description) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckBox(description));
  for (const ScatteringGroup& group : description.groups) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckGroup(group, description.grid.CellCount()));
  }
  return std::shared_ptr<const Medium>(new Medium(std::move(description)));
}

Medium::Medium(MediumDescription description)
    : grid_(description.grid),
      low_m_(description.low_m),
      high_m_(description.high_m),
      linear_(description.interpolation == Interpolation::kLinear),
      periodic_(description.sides == Sides::kPeriodic),
      strides_(1, grid_.Offset(0, 1, 0), grid_.Offset(0, 0, 1)) {
  if (description.groups.empty()) exact_.extinction_per_m.assign(grid_.CellCount(), 0.0F);
  const bool several = description.groups.size() > 1;
  for (ScatteringGroup& group : description.groups) {
    const double mean = MeanColor(group.albedo);
    exact_.groups.push_back({1.0, group.albedo, mean, std::move(group.phase)});
    AddTo(group.extinction_per_m, 1.0F, &exact_.extinction_per_m);
    if (several) group_extinctions_per_m_.push_back(std::move(group.extinction_per_m));
  }
  BuildBricks();
  BuildMajorants(&exact_);
  FindEmptyLayers();
  if (description.similar) AddSimilar();
}

void Medium::AddSimilar() {
  for (std::size_t i = 0; i < exact_.groups.size(); ++i) {
    const GroupOptics& exact = exact_.groups[i];
    const double asymmetry = exact.phase->Asymmetry();
    const double forward = asymmetry > 0.0 ? asymmetry * asymmetry : 0.0;
    const double rest = asymmetry > 0.0 ? asymmetry / (1.0 + asymmetry) : asymmetry;
    GroupOptics similar;
    const DeltaScaled scaled = ScaleForward(exact.albedo, forward);
    similar.share = scaled.extinction;
    similar.albedo = scaled.albedo;
    similar.choice_albedo = MeanColor(similar.albedo);
    similar.phase = std::make_shared<const SampledPhase>(SampledPhase::HenyeyGreenstein(rest));
    similar_.groups.push_back(similar);
    AddTo(group_extinctions_per_m_.empty() ? exact_.extinction_per_m : group_extinctions_per_m_[i],
          static_cast<float>(similar.share), &similar_.extinction_per_m);
  }
  if (similar_.groups.empty()) similar_.extinction_per_m = exact_.extinction_per_m;
  BuildMajorants(&similar_);
}

int Medium::CellIndex(int axis, int cell) const {
  if (periodic_ && axis < 2) return FloorMod(cell, grid_.cells[axis]);
  return std::clamp(cell, 0, grid_.cells[axis] - 1);
}

// Returns the range of cells from which extinction in the brick is interpolated.
Medium::CellRange Medium::CellsOfBrick(int axis, int brick) const {
  const int first = first_cell_[axis] + brick;
  return {first, linear_ ? first + 1 : first};
}

double Medium::LargestIn(const Lattice& lattice, const CellRange& x, const CellRange& y,
                         const CellRange& z) const {
  float largest = 0.0F;
  for (int k = z.first; k <= z.last; ++k) {
    for (int j = y.first; j <= y.last; ++j) {
      for (int i = x.first; i <= x.last; ++i) {
        const std::size_t offset = grid_.Offset(CellIndex(0, i), CellIndex(1, j), CellIndex(2, k));
        largest = std::max(largest, lattice.extinction_per_m[offset]);
      }
    }
  }
  return largest;
}

// Sets the layout of the bricks. With linear interpolation, a brick lies between the centres of
// neighbouring cells, so the extinction in it is one trilinear function. With constant cells, a
// brick is a cell. The outermost bricks may extend beyond the box.
void Medium::BuildBricks() {
  constexpr double kSlack = 1e-6;
  const double centre = linear_ ? 0.5 : 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing_m = grid_.spacing_m[axis];
    const double corner_m = grid_.low_corner_m[axis];
    const bool wraps = periodic_ && axis < 2;
    const double low = wraps ? 0.0 : (low_m_[axis] - corner_m) / spacing_m - centre;
    first_cell_[axis] = static_cast<int>(std::floor(low + kSlack));
    brick_low_m_[axis] = corner_m + (first_cell_[axis] + centre) * spacing_m;
    const double cells = (high_m_[axis] - brick_low_m_[axis]) / spacing_m;
    bricks_[axis] =
        wraps ? grid_.cells[axis] : std::max(static_cast<int>(std::ceil(cells - kSlack)), 1);
    cells_per_m_[axis] = 1.0 / spacing_m;
  }
}

void Medium::BuildMajorants(Lattice* lattice) const {
  lattice->majorants_per_m.reserve(static_cast<std::size_t>(bricks_.x) *
                                   static_cast<std::size_t>(bricks_.y) *
                                   static_cast<std::size_t>(bricks_.z));
  for (int z = 0; z < bricks_.z; ++z) {
    const CellRange cells_z = CellsOfBrick(2, z);
    for (int y = 0; y < bricks_.y; ++y) {
      const CellRange cells_y = CellsOfBrick(1, y);
      for (int x = 0; x < bricks_.x; ++x) {
        lattice->majorants_per_m.push_back(static_cast<float>(
            LargestIn(*lattice, CellsOfBrick(0, x), cells_y, cells_z) * kMajorantMargin));
      }
    }
  }
}

void Medium::FindEmptyLayers() {
  const std::size_t bricks = BrickOffset({0, 0, 1});
  for (auto first = exact_.majorants_per_m.begin(); first != exact_.majorants_per_m.end();
       first += static_cast<std::ptrdiff_t>(bricks)) {
    const auto empty = [](float majorant) { return majorant <= 0.0F; };
    empty_layers_.push_back(
        std::all_of(first, first + static_cast<std::ptrdiff_t>(bricks), empty) ? 1 : 0);
  }
}

Medium::Place Medium::PlaceOf(const glm::dvec3& point_m) const {
  glm::dvec3 cell = (point_m - grid_.low_corner_m) * cells_per_m_;
  if (periodic_) {
    cell.x -= std::floor(cell.x / grid_.cells.x) * grid_.cells.x;
    cell.y -= std::floor(cell.y / grid_.cells.y) * grid_.cells.y;
  }
  Place place;
  if (!linear_) {
    const glm::ivec3 at(glm::floor(cell));
    place.offsets[0] = grid_.Offset(CellIndex(0, at.x), CellIndex(1, at.y), CellIndex(2, at.z));
    place.shares[0] = 1.0;
    place.count = 1;
    return place;
  }
  const Between x = BetweenCells(0, cell.x);
  const Between y = BetweenCells(1, cell.y);
  const Between z = BetweenCells(2, cell.z);
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t i = corner & 1U;
    const std::size_t j = (corner >> 1U) & 1U;
    const std::size_t k = corner >> 2U;
    place.offsets[corner] = x.offsets[i] + y.offsets[j] + z.offsets[k];
    place.shares[corner] = x.shares[i] * y.shares[j] * z.shares[k];
  }
  place.count = 8;
  return place;
}

Medium::Between Medium::BetweenCells(int axis, double cell) const {
  // Points of the box lie at most half a cell below the first centre, so truncation rounds down.
  const double above = cell + 0.5;
  const int high = static_cast<int>(above);
  const double share = above - high;
  return {OffsetsFrom(axis, high - 1), {1.0 - share, share}};
}

Medium::OffsetPair Medium::OffsetsFrom(int axis, int cell) const {
  const std::size_t stride = strides_[axis];
  return {static_cast<std::size_t>(CellIndex(axis, cell)) * stride,
          static_cast<std::size_t>(CellIndex(axis, cell + 1)) * stride};
}

double Medium::Weigh(const std::vector<float>& values, const Place& place) {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(place.count); ++i) {
    sum += place.shares[i] * static_cast<double>(values[place.offsets[i]]);
  }
  return sum;
}

double Medium::MeanExtinction_per_m(const glm::ivec3& brick, const glm::dvec3& from_m,
                                    const glm::dvec3& to_m, Optics optics) const {
  const std::vector<float>& values = Of(optics).extinction_per_m;
  const glm::ivec3 first = first_cell_ + brick;
  const OffsetPair along_x = OffsetsFrom(0, first.x);
  const OffsetPair along_y = OffsetsFrom(1, first.y);
  const OffsetPair along_z = OffsetsFrom(2, first.z);
  const auto corner = [&](std::size_t x, std::size_t y, std::size_t z) {
    return static_cast<double>(values[along_x[x] + along_y[y] + along_z[z]]);
  };
  if (!linear_) return corner(0, 0, 0);
  // Values at the four corners of the brick with low x, and their slopes along x.
  const glm::dvec4 low(corner(0, 0, 0), corner(0, 1, 0), corner(0, 0, 1), corner(0, 1, 1));
  const glm::dvec4 slope =
      glm::dvec4(corner(1, 0, 0), corner(1, 1, 0), corner(1, 0, 1), corner(1, 1, 1)) - low;
  const auto at = [&](const glm::dvec3& share) {
    const glm::dvec4 edges = low + share.x * slope;
    const double below = edges.x + share.y * (edges.y - edges.x);
    const double above = edges.z + share.y * (edges.w - edges.z);
    return below + share.z * (above - below);
  };
  const glm::dvec3 from = (from_m - brick_low_m_) * cells_per_m_ - glm::dvec3(brick);
  const glm::dvec3 to = (to_m - brick_low_m_) * cells_per_m_ - glm::dvec3(brick);
  // A trilinear function is cubic along a line, for which Simpson's rule is exact.
  return std::max((at(from) + 4.0 * at(0.5 * (from + to)) + at(to)) / 6.0, 0.0);
}

double Medium::Extinction_per_m(const glm::dvec3& point_m, Optics optics) const {
  return Weigh(Of(optics).extinction_per_m, PlaceOf(point_m));
}

Scattering Medium::ScatteringAt(const glm::dvec3& point_m, double u, Optics optics) const {
  const std::vector<GroupOptics>& groups = Of(optics).groups;
  if (groups.size() == 1) return {groups[0].phase.get(), groups[0].albedo};
  const Place place = PlaceOf(point_m);
  double extinction = 0.0;
  double scattering = 0.0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const double value = Weigh(group_extinctions_per_m_[i], place) * groups[i].share;
    extinction += value;
    scattering += value * groups[i].choice_albedo;
  }
  if (scattering <= 0.0) return {};
  double left = u * scattering;
  const GroupOptics* chosen = nullptr;
  for (std::size_t i = 0; i < groups.size() && (chosen == nullptr || left > 0.0); ++i) {
    const double share =
        Weigh(group_extinctions_per_m_[i], place) * groups[i].share * groups[i].choice_albedo;
    if (share <= 0.0) continue;
    chosen = &groups[i];
    left -= share;
  }
  THUNDERHEAD_CHECK(chosen != nullptr, "a point that scatters has a group that does");
  // The weight is albedo times the group's share of extinction, divided by the probability of
  // choosing the group.
  return {chosen->phase.get(),
          chosen->albedo * (scattering / (extinction * chosen->choice_albedo))};
}

absl::StatusOr<std::shared_ptr<const Medium>> SlabMedium(double optical_depth,
                                                         const SampledPhase& phase, double albedo) {
  constexpr double kDepth_m = 1000.0;
  MediumDescription slab;
  slab.grid.cells = glm::ivec3(1);
  slab.grid.spacing_m = glm::dvec3(100.0 * kDepth_m, 100.0 * kDepth_m, kDepth_m);
  slab.high_m = slab.grid.HighCorner_m();
  slab.interpolation = Interpolation::kConstant;
  slab.sides = Sides::kPeriodic;
  slab.groups.push_back({{static_cast<float>(optical_depth / kDepth_m)},
                         glm::dvec3(albedo),
                         std::make_shared<const SampledPhase>(phase)});
  return Medium::Create(std::move(slab));
}

}  // namespace thunderhead::reference
