// The scattering medium: extinction on a grid for each group of fields with the same optics, and a
// lattice of bricks with their local maxima (majorants) for null-collision sampling. Knows no light
// and no files.
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

// Extinction between cell centres: interpolated linearly, as the renderers draw it (beyond the
// outer centres it is that of the nearest cell), or constant in each cell.
enum class Interpolation { kLinear, kConstant };

// Beyond the sides of the box: empty space, or periodic copies of the box.
enum class Sides { kOpen, kPeriodic };

// The medium itself, or one to which light that has been scattered a few times is nearly the same,
// by the scaling of delta-Eddington (Joseph, Wiscombe and Weinman 1976): of the light that a group
// of asymmetry g scatters, a share of g^2 counts as not scattered, and the rest is scattered by
// Henyey and Greenstein's function of g / (1 + g). Sunlight reaches deeper there, and paths are
// shorter.
enum class Optics { kExact, kSimilar };

// Delta scaling: a share of the light that is scattered counts as not scattered.
struct DeltaScaled {
  double extinction = 1.0;  // a factor
  glm::dvec3 albedo{1.0};
};

// The colour with the largest albedo is absorbed as much as before. Extinction is the same for all
// colours, so one between that and black is absorbed a little less.
DeltaScaled ScaleForward(const glm::dvec3& albedo, double forward_share);

// Fields with the same optics.
struct ScatteringGroup {
  std::vector<float> extinction_per_m;  // grid.CellCount() values, x fastest
  glm::dvec3 albedo{1.0};               // single-scattering, red, green, blue
  std::shared_ptr<const SampledPhase> phase;
};

struct MediumDescription {
  volume::RegularGrid grid;
  // The box outside of which extinction is zero; within the grid's. Spans it in x and y if sides
  // are periodic.
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
  Interpolation interpolation = Interpolation::kLinear;
  Sides sides = Sides::kOpen;
  std::vector<ScatteringGroup> groups;  // may be none: empty space
  bool similar = false;                 // whether Optics::kSimilar is asked for
};

// A collision with a particle of a randomly chosen group, with the weight that makes the choice
// unbiased.
struct Scattering {
  const SampledPhase* phase = nullptr;  // null if the light is absorbed
  glm::dvec3 weight{0.0};
};

// Of a group in one of the two optics.
struct GroupOptics {
  double share = 1.0;  // of the group's extinction
  glm::dvec3 albedo;
  double choice_albedo;  // mean over colours, by which a collision's group is chosen
  std::shared_ptr<const SampledPhase> phase;
};

class Medium {
 public:
  // Fails if an extinction is negative or not finite, an albedo outside 0 to 1, or sizes disagree.
  static absl::StatusOr<std::shared_ptr<const Medium>> Create(MediumDescription description);

  const glm::dvec3& Low_m() const { return low_m_; }
  const glm::dvec3& High_m() const { return high_m_; }
  bool Periodic() const { return periodic_; }

  // Total extinction at a point of the box; if periodic, of the box's range of heights.
  double Extinction_per_m(const glm::dvec3& point_m, Optics optics = Optics::kExact) const;

  // The mean extinction between two points of `brick`, which beyond a periodic medium's sides goes
  // on counting.
  double MeanExtinction_per_m(const glm::ivec3& brick, const glm::dvec3& from_m,
                              const glm::dvec3& to_m, Optics optics = Optics::kExact) const;

  // The group of a collision at `point_m`, chosen by `u` (uniform over (0, 1)) with a probability
  // in proportion to its scattering.
  Scattering ScatteringAt(const glm::dvec3& point_m, double u,
                          Optics optics = Optics::kExact) const;

  // The lattice of bricks that covers the box; a brick's majorant bounds extinction in it.
  const glm::ivec3& Bricks() const { return bricks_; }
  const glm::dvec3& BrickLow_m() const { return brick_low_m_; }  // the first one's lower corner
  const glm::dvec3& BrickSize_m() const { return grid_.spacing_m; }
  const glm::dvec3& BricksPerM() const { return cells_per_m_; }
  // `brick` lies in the lattice.
  double Majorant_per_m(const glm::ivec3& brick, Optics optics = Optics::kExact) const {
    return Of(optics).majorants_per_m[BrickOffset(brick)];
  }
  bool HasSimilar() const { return !similar_.extinction_per_m.empty(); }
  // The arrays behind these functions, for code that computes the same elsewhere (device_paths/).
  const volume::RegularGrid& Grid() const { return grid_; }
  bool Linear() const { return linear_; }
  const glm::ivec3& FirstCell() const { return first_cell_; }  // of the first brick
  const std::vector<float>& Extinctions_per_m(Optics optics) const {
    return Of(optics).extinction_per_m;
  }
  const std::vector<float>& Majorants_per_m(Optics optics) const {
    return Of(optics).majorants_per_m;
  }
  // May be none.
  const std::vector<GroupOptics>& Groups(Optics optics) const { return Of(optics).groups; }
  // Of each group, in exact optics; empty with a single one.
  const std::vector<std::vector<float>>& GroupExtinctions_per_m() const {
    return group_extinctions_per_m_;
  }
  // True if all bricks of this height are empty.
  bool EmptyLayer(int z) const { return empty_layers_[static_cast<std::size_t>(z)] != 0; }

 private:
  // The eight (or fewer) cells around a point with their interpolation weights.
  struct Place {
    std::array<std::size_t, 8> offsets;
    std::array<double, 8> shares;
    int count = 0;
  };
  // Parts of the offset of a value in its array: those of two neighbouring cells along an axis.
  using OffsetPair = std::array<std::size_t, 2>;
  // The two cells along an axis.
  struct Between {
    OffsetPair offsets;
    std::array<double, 2> shares;
  };
  struct Lattice {
    std::vector<GroupOptics> groups;
    std::vector<float> extinction_per_m;  // total
    std::vector<float> majorants_per_m;   // of bricks
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
  glm::vec<3, std::size_t> strides_;                         // between neighbours along each axis
  std::vector<std::vector<float>> group_extinctions_per_m_;  // empty with a single group
  Lattice exact_;
  Lattice similar_;  // empty unless asked for
  glm::ivec3 bricks_{0};
  glm::ivec3 first_cell_{0};  // of the first brick
  glm::dvec3 brick_low_m_{0.0};
  glm::dvec3 cells_per_m_{0.0};
  std::vector<char> empty_layers_;
};

// A plane-parallel layer 1 km deep, without sides, of optical depth `optical_depth`.
absl::StatusOr<std::shared_ptr<const Medium>> SlabMedium(double optical_depth,
                                                         const SampledPhase& phase, double albedo);

}  // namespace thunderhead::reference
