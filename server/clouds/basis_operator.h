// The linear map A from the weights of metaballs to a field on a grid, and its transpose A^T. The
// matrix A is never stored. Instead, the values of each ball are computed row by row in the cells
// that the ball reaches. The result is the same for any number of threads.
#pragma once

#include <vector>

#include "clouds/metaballs.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

class BasisOperator {
 public:
  BasisOperator(const volume::RegularGrid& grid, const std::vector<Metaball>& balls, Basis basis,
                double overlap, int threads);

  // Computes A v, the weighted sum of all balls at every cell's centre. v is `weights`.
  void Apply(const std::vector<double>& weights, std::vector<float>* field) const;

  // Computes A^T r: for each ball, the sum over cells of the ball's value times the field's value.
  // r is `field`.
  void ApplyTransposed(const std::vector<float>& field, std::vector<double>* sums) const;

  // Returns the diagonal of A^T A: for each ball, the sum over cells of the ball's squared value.
  std::vector<double> SquaredNorms() const;

 private:
  // The box of cells that a ball reaches, and the index in tables_ at which the ball's values
  // begin. There is one value for each x, each y and each z of the box.
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
  // Values of each ball along each axis. For a Gaussian they are factors of the product, and for
  // Wyvill's field squared distances divided by R^2.
  std::vector<float> tables_;
  std::vector<std::vector<std::uint32_t>>
      slabs_;  // indices of the balls that reach each slab of layers
};

}  // namespace thunderhead::clouds
