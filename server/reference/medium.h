// The scattering medium of the path tracer: extinction on a grid for each group of fields with the
// same optics. A lattice of bricks holds local upper bounds of the extinction (majorants) for
// null-collision sampling. This code does not depend on light sources or files.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"
#include "reference/philox.h"
#include "reference/sampled_phase.h"
#include "volume/grid.h"

namespace thunderhead::reference {

// The extinction between cell centres. kLinear interpolates it linearly, as the renderers draw it.
// Beyond the outer centres, this extinction is that of the nearest cell. kConstant makes the
// extinction constant in each cell.
enum class Interpolation { kLinear, kConstant };

// The space beyond the sides of the box: empty, or periodic copies of the box.
enum class Sides { kOpen, kPeriodic };

// The optics of a medium: the exact ones, or those of a similar medium that scatters light less
// often. After a few scatterings, light is nearly the same in both. The similar optics follow the
// scaling of delta-Eddington (Joseph, Wiscombe and Weinman 1976). For a group of asymmetry g, a
// share g^2 of the scattered light counts as not scattered. The rest is scattered by Henyey and
// Greenstein's function of g / (1 + g). In the similar medium sunlight reaches deeper, and paths
// are shorter.
enum class Optics { kExact, kSimilar };

// The result of delta scaling, in which a share of the scattered light counts as not scattered.
struct DeltaScaled {
  double extinction = 1.0;  // scaled extinction / original extinction
  glm::dvec3 albedo{1.0};
};

// Returns the scaled optics for a group of the given albedo. The colour with the largest albedo is
// absorbed as much as before. Extinction is the same for all colours. Colours with a smaller albedo
// above 0 are therefore absorbed slightly less than before.
DeltaScaled ScaleForward(const glm::dvec3& albedo, double forward_share);

// Fields with the same optics.
struct ScatteringGroup {
  std::vector<float> extinction_per_m;  // grid.CellCount() values, x varies fastest
  glm::dvec3 albedo{1.0};               // single-scattering albedo in red, green, blue
  std::shared_ptr<const SampledPhase> phase;
};

struct MediumDescription {
  volume::RegularGrid grid;
  // The box outside which extinction is zero. It lies within the grid's box. If sides are periodic,
  // it equals the grid's box in x and y.
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
  Interpolation interpolation = Interpolation::kLinear;
  Sides sides = Sides::kOpen;
  std::vector<ScatteringGroup> groups;  // without groups, the medium is empty space
  bool similar = false;                 // if true, Create also computes the optics Optics::kSimilar
};

// The result of a collision with a particle of a randomly chosen group. The weight makes the choice
// of the group unbiased.
struct Scattering {
  const SampledPhase* phase = nullptr;  // null if the light is absorbed
  glm::dvec3 weight{0.0};
};

// A group's optics, either exact or similar.
struct GroupOptics {
  double share = 1.0;  // extinction in these optics / exact extinction
  glm::dvec3 albedo;
  double choice_albedo;  // albedo averaged over colours, used to choose a collision's group
  std::shared_ptr<const SampledPhase> phase;
};

class Medium {
 public:
  // Creates a medium. Returns INVALID_ARGUMENT if an extinction is negative or not finite, an
  // albedo is outside 0 to 1, sizes disagree, or the box has no volume.
  static absl::StatusOr<std::shared_ptr<const Medium>> Create(MediumDescription description);

  const glm::dvec3& Low_m() const { return low_m_; }
  const glm::dvec3& High_m() const { return high_m_; }
  bool Periodic() const { return periodic_; }

  // Returns the total extinction at a point of the box. If the medium is periodic, only the point's
  // height must be in the box.
  double Extinction_per_m(const glm::dvec3& point_m, Optics optics = Optics::kExact) const;

  // Returns the mean extinction between two points of `brick`. Brick indices continue beyond the
  // sides of a periodic medium.
  double MeanExtinction_per_m(const glm::ivec3& brick, const glm::dvec3& from_m,
                              const glm::dvec3& to_m, Optics optics = Optics::kExact) const;

  // Samples the group with which light collides at `point_m`. `u` is a uniform random number in (0,
  // 1). The probability of a group is proportional to its scattering.
  Scattering ScatteringAt(const glm::dvec3& point_m, double u,
                          Optics optics = Optics::kExact) const;

  // The lattice of bricks covers the box. A brick's majorant is an upper bound of the extinction in
  // it.
  const glm::ivec3& Bricks() const { return bricks_; }
  const glm::dvec3& BrickLow_m() const { return brick_low_m_; }  // lower corner of the first brick
  const glm::dvec3& BrickSize_m() const { return grid_.spacing_m; }
  const glm::dvec3& BricksPerM() const { return cells_per_m_; }
  // Returns the majorant of `brick`, which must lie in the lattice.
  double Majorant_per_m(const glm::ivec3& brick, Optics optics = Optics::kExact) const {
    return Of(optics).majorants_per_m[BrickOffset(brick)];
  }
  bool HasSimilar() const { return !similar_.extinction_per_m.empty(); }
  // The arrays behind these functions, for code that evaluates the medium elsewhere
  // (device_paths/).
  const volume::RegularGrid& Grid() const { return grid_; }
  bool Linear() const { return linear_; }
  const glm::ivec3& FirstCell() const { return first_cell_; }  // first cell of the first brick
  const std::vector<float>& Extinctions_per_m(Optics optics) const {
    return Of(optics).extinction_per_m;
  }
  const std::vector<float>& Majorants_per_m(Optics optics) const {
    return Of(optics).majorants_per_m;
  }
  // Returns the groups. The vector can be empty.
  const std::vector<GroupOptics>& Groups(Optics optics) const { return Of(optics).groups; }
  // Returns the extinctions of each group in exact optics. The vector is empty if there is a single
  // group.
  const std::vector<std::vector<float>>& GroupExtinctions_per_m() const {
    return group_extinctions_per_m_;
  }
  // Returns true if all bricks of this layer are empty.
  bool EmptyLayer(int z) const { return empty_layers_[static_cast<std::size_t>(z)] != 0; }

 private:
  // The cells around a point, at most eight, with their interpolation weights.
  struct Place {
    std::array<std::size_t, 8> offsets;
    std::array<double, 8> shares;
    int count = 0;
  };
  // For two neighbouring cells along an axis, the axis' part of their offsets in an array of
  // values.
  using OffsetPair = std::array<std::size_t, 2>;
  // The two neighbouring cells along an axis, with their interpolation weights.
  struct Between {
    OffsetPair offsets;
    std::array<double, 2> shares;
  };
  struct Lattice {
    std::vector<GroupOptics> groups;
    std::vector<float> extinction_per_m;  // total extinction
    std::vector<float> majorants_per_m;   // upper bound of the extinction in each brick
  };
  struct CellRange {
    int first = 0;
    int last = 0;
  };

  explicit Medium(MediumDescription description);
  const Lattice& Of(Optics optics) const { return optics == Optics::kExact ? exact_ : similar_; }
  void AddSimilar();
  void BuildBricks();
  void FindEmptyLayers();
  void BuildMajorants(Lattice* lattice) const;
  CellRange CellsOfBrick(int axis, int brick) const;
  int CellIndex(int axis, int cell) const;
  double LargestIn(const Lattice& lattice, const CellRange& x, const CellRange& y,
                   const CellRange& z) const;
  Place PlaceOf(const glm::dvec3& point_m) const;
  Between BetweenCells(int axis, double cell) const;
  OffsetPair OffsetsFrom(int axis, int cell) const;
  static double Weigh(const std::vector<float>& values, const Place& place);
  std::size_t BrickOffset(const glm::ivec3& brick) const {
    return (static_cast<std::size_t>(brick.z) * static_cast<std::size_t>(bricks_.y) +
            static_cast<std::size_t>(brick.y)) *
               static_cast<std::size_t>(bricks_.x) +
           static_cast<std::size_t>(brick.x);
  }

  volume::RegularGrid grid_;
  glm::dvec3 low_m_;
  glm::dvec3 high_m_;
  bool linear_;
  bool periodic_;
  // Offsets in an array between neighbouring cells along each axis.
  glm::vec<3, std::size_t> strides_;
  std::vector<std::vector<float>> group_extinctions_per_m_;  // empty with a single group
  Lattice exact_;
  Lattice similar_;  // empty unless MediumDescription::similar
  glm::ivec3 bricks_{0};
  glm::ivec3 first_cell_{0};  // first cell of the first brick
  glm::dvec3 brick_low_m_{0.0};
  glm::dvec3 cells_per_m_{0.0};
  std::vector<char> empty_layers_;
};

// Creates a plane-parallel layer with a depth of 1 km, the given `optical_depth` and no sides.
absl::StatusOr<std::shared_ptr<const Medium>> SlabMedium(double optical_depth,
                                                         const SampledPhase& phase, double albedo);

}  // namespace thunderhead::reference
