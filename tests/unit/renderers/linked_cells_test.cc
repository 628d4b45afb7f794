// Tests of the linear system of the diffusion equation, and of the numbering of the cells that it
// contains: non-empty cells and their neighbours.
#include "renderers/light_volume/linked_cells.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "glm/common.hpp"
#include "gtest/gtest.h"
#include "renderers/light_volume/numbered_cells.h"

namespace thunderhead::renderers {
namespace {

constexpr float kLightPerM = 0.01F;

// Returns a box in which each cell is filled with probability `filled`.
DiffusionCells RandomCells(const glm::ivec3& size, double filled) {
  std::mt19937 random(7);
  std::bernoulli_distribution holds(filled);
  DiffusionCells cells;
  cells.size = size;
  cells.cell_m = glm::dvec3(500.0);
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    cells.light_per_m.push_back(holds(random) ? kLightPerM : 0.0F);
  }
  cells.transport_per_m = cells.light_per_m;
  cells.absorption_per_m.assign(cells.light_per_m.size(), 0.0F);
  return cells;
}

TEST(NumberedCells, AreThoseThatHoldAnythingColumnByColumn) {
  const DiffusionCells box = RandomCells({5, 4, 6}, 0.4);
  const NumberedCells numbered(box);
  std::set<std::size_t> seen;
  for (std::size_t n = 0; n < numbered.Count(); ++n) {
    const std::size_t cell = numbered.CellOf(n);
    EXPECT_EQ(box.light_per_m[cell], kLightPerM);
    EXPECT_EQ(numbered.NumberOf(cell), static_cast<std::int32_t>(n));
    seen.insert(cell);
    if (n == 0) continue;
    const glm::ivec3 here = box.CellAt(cell);
    const glm::ivec3 before = box.CellAt(numbered.CellOf(n - 1));
    EXPECT_LT(std::tuple(before.y, before.x, before.z), std::tuple(here.y, here.x, here.z));
  }
  for (std::size_t i = 0; i < box.light_per_m.size(); ++i) {
    EXPECT_EQ(numbered.IsEmpty(i), !seen.contains(i)) << i;
  }
}

TEST(NumberedCells, SpreadToEmptyOnesTheMeanOfTheirNeighbours) {
  const DiffusionCells box = RandomCells({7, 6, 5}, 0.08);
  const NumberedCells numbered(box);
  std::vector<float> by_number(numbered.Count());
  for (std::size_t n = 0; n < by_number.size(); ++n) by_number[n] = static_cast<float>(n + 1);
  std::vector<float> values(numbered.AllCells(), 0.0F);
  numbered.SetByCell(by_number, &values);
  numbered.Spread(&values);
  for (const NumberedCells::Valued& cell : numbered.WithValues()) {
    const auto i = static_cast<std::size_t>(cell.cell);
    EXPECT_EQ(cell.number, numbered.NumberOf(i));
    EXPECT_NE(values[i], 0.0F);
  }
  EXPECT_EQ(values.size() - numbered.WithValues().size(),
            static_cast<std::size_t>(std::ranges::count(values, 0.0F)));
  int fringe = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!numbered.IsEmpty(i)) {
      EXPECT_EQ(values[i], by_number[static_cast<std::size_t>(numbered.NumberOf(i))]);
      continue;
    }
    float sum = 0.0F;
    int count = 0;
    for (std::size_t n = 0; n < numbered.Count(); ++n) {
      const glm::ivec3 away = glm::abs(box.CellAt(numbered.CellOf(n)) - box.CellAt(i));
      if (std::max({away.x, away.y, away.z}) > 1) continue;
      sum += by_number[n];
      ++count;
    }
    EXPECT_FLOAT_EQ(values[i], count == 0 ? 0.0F : sum / static_cast<float>(count)) << i;
    if (count > 0) ++fringe;
  }
  EXPECT_GT(fringe, 50);
}

// Random conductances between the cells of a box, and from its outer cells to the outside.
struct System {
  std::vector<Links> down, up;
  std::vector<float> loss;

  System(const DiffusionCells& box, const NumberedCells& numbered)
      : down(numbered.Count()), up(numbered.Count()), loss(numbered.Count()) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> value(0.1F, 10.0F);
    for (std::size_t n = 0; n < numbered.Count(); ++n) {
      loss[n] = 0.01F * value(random);
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          glm::ivec3 next = box.CellAt(numbered.CellOf(n));
          next[axis] += step;
          const std::int32_t to =
              box.Contains(next) ? numbered.NumberOf(box.Offset(next)) : NumberedCells::kNone;
          Links& links = step < 0 ? down[n] : up[n];
          links.to[axis] = to;
          // A downward link has the upward conductance of the cell below, whose number is lower.
          links.conductance[axis] = to != NumberedCells::kNone && step < 0
                                        ? up[static_cast<std::size_t>(to)].conductance[axis]
                                        : value(random);
        }
      }
    }
  }

  // Returns the light that must be put into cell `n` for the cells to have `values`.
  double Needed(std::size_t n, const std::vector<float>& values) const {
    double sum = static_cast<double>(loss[n]) * values[n];
    for (const Links* links : {&down[n], &up[n]}) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t to = links->to[axis];
        const float there =
            to == NumberedCells::kNone ? 0.0F : values[static_cast<std::size_t>(to)];
        sum += static_cast<double>(links->conductance[axis]) * (values[n] - there);
      }
    }
    return sum;
  }
};

TEST(LinkedCells, SolveIsTheInverseOfTheirExchange) {
  // There are more cells than in a block and a share, so several are processed.
  const DiffusionCells box = RandomCells({30, 30, 20}, 0.7);
  const NumberedCells numbered(box);
  ASSERT_GT(numbered.Blocks().size(), 3U);
  const System system(box, numbered);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> value(-1.0F, 1.0F);
  std::vector<float> expected(numbered.Count());
  for (float& v : expected) v = value(random);
  std::vector<float> right(expected.size());
  for (std::size_t n = 0; n < right.size(); ++n) {
    right[n] = static_cast<float>(system.Needed(n, expected));
  }
  LinkedCells linked(system.down, system.up, system.loss, numbered.Blocks());
  std::vector<float> solution(expected.size(), 0.0F);
  const int iterations = linked.Solve(right, 1e-6, &solution);
  EXPECT_GT(iterations, 2);
  EXPECT_LT(iterations, 100);
  float worst = 0.0F;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    worst = std::max(worst, std::abs(solution[n] - expected[n]));
  }
  EXPECT_LT(worst, 1e-4F);
  // The solver starts from the solution, so it needs no iteration.
  EXPECT_EQ(linked.Solve(right, 1e-5, &solution), 0);
}

}  // namespace
}  // namespace thunderhead::renderers
