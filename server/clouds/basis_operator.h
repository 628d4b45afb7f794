// The linear map from metaballs' weights to a field on a grid, and its transpose. They are applied
// without storing a matrix, row by row of the cells that each ball reaches. The result is the same
// for any number of threads.
#pragma once

#include <vector>

#include "clouds/metaballs.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

class BasisOperator {
 public:
  BasisOperator(const volume::RegularGrid& grid, const std::vector<Metaball>& balls, Basis basis,
                double overlap, int threads);

  // Computes the sum of all balls at every cell's centre: A v.
  void Apply(const std::vector<double>& weights, std::vector<float>* field) const;

  // Computes for each ball the sum over cells of its value times the field's: A^T r.
  void ApplyTransposed(const std::vector<float>& field, std::vector<double>* sums) const;

  // Returns for each ball the sum over cells of its squared value: the diagonal of A^T A.
  std::vector<double> SquaredNorms() const;

 private:
  // The box of cells that a ball reaches, and the start of its tables. They hold one value for each
  // x, y and z in the box.
  struct Footprint {
    glm::ivec3 low{0};
    glm::ivec3 high{0};  // one past the last
    glm::dvec3 centre_cells{0.0};
    double reach_m = 0.0;
    std::size_t tables = 0;

    bool Empty() const { return high.x <= low.x || high.y <= low.y || high.z <= low.z; }
  };

  void AddFootprint(const Metaball& ball);
  template <typename Row>
  void ForRows(const Footprint& ball, int first_z, int last_z, const Row& row) const;
  template <typename Sum>
  std::vector<double> SumOverRows(const Sum& sum) const;

  volume::RegularGrid grid_;
  Basis basis_;
  double overlap_;
  int threads_;
  std::vector<Footprint> footprints_;
  // Values along each axis: for a Gaussian its factor, for Wyvill's field the squared distance over
  // R^2.
  std::vector<float> tables_;
  std::vector<std::vector<std::uint32_t>>
      slabs_;  // indices of the balls that reach each slab of layers
};

}  // namespace thunderhead::clouds
