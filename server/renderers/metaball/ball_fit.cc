#include "renderers/metaball/ball_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/status.h"
#include "clouds/basis_operator.h"
#include "clouds/rbf_fit.h"
#include "glm/common.hpp"
#include "volume/coarsen.h"
#include "volume/extinction.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of cells for the fit. Storms with more cells are coarsened first. Balls are far
// larger than cells, and the cost of a fit grows with the number of cells.
constexpr double kMaxFittedCells = 2e6;

// FitOptions::overlap, the parameter u of Man's eq. 16 (clouds/metaballs.h). A larger value fits
// more closely. However, balls then extend farther beyond the cloud's edge, which makes drawing
// slower (docs/performance.md).
constexpr double kOverlap = 2.0;

glm::ivec3 CoarseningForFit(const volume::HydrometeorFields& fields) {
  const glm::dvec3 box(fields.condensate.high - fields.condensate.low);
  glm::ivec3 factor(1);
  const auto cells = [&] {
    const glm::dvec3 coarse = box / glm::dvec3(factor);
    return coarse.x * coarse.y * coarse.z;
  };
  while (cells() > kMaxFittedCells) {
    // Coarsens the grid along the axis with the shortest cells.
    const glm::dvec3 size_m = fields.grid.spacing_m * glm::dvec3(factor);
    if (size_m.z <= size_m.x && size_m.z <= size_m.y) {
      ++factor.z;
    } else if (size_m.x <= size_m.y) {
      ++factor.x;
    } else {
      ++factor.y;
    }
  }
  return factor;
}

// Returns the extinction of group number `group`, or of all groups if it is -1.
std::vector<float> ExtinctionOf(const volume::HydrometeorFields& fields, const Medium& medium,
                                int group) {
  std::vector<float> values(fields.grid.CellCount(), 0.0F);
  for (const volume::ExtinctionTerm& term : medium.terms) {
    if (group >= 0 && term.channel != group) continue;
    const volume::HydrometeorField& field = fields.fields[static_cast<std::size_t>(term.field)];
    if (field.concentration_kg_per_m3.empty()) continue;
    volume::AddExtinction(field, {term.mass_extinction_m2_per_kg, term.by_cell}, 0, values.size(),
                          values.data());
  }
  return values;
}

// Sets each ball's shares of the groups from the groups' extinctions, summed over the cells with
// the ball's field as weight.
void Share(const volume::HydrometeorFields& fields, const Medium& medium,
           const clouds::MetaballCloud& cloud, std::vector<Ball>* balls) {
  const clouds::BasisOperator basis(fields.grid, cloud.balls, cloud.basis, cloud.overlap, 1);
  std::vector<double> sums;
  for (std::size_t group = 0; group < medium.groups.size(); ++group) {
    basis.ApplyTransposed(ExtinctionOf(fields, medium, static_cast<int>(group)), &sums);
    for (std::size_t i = 0; i < balls->size(); ++i) {
      (*balls)[i].shares[group] = static_cast<float>(sums[i]);
    }
  }
  for (Ball& ball : *balls) {
    float sum = 0.0F;
    for (const float share : ball.shares) sum += share;
    for (float& share : ball.shares) share = sum > 0.0F ? share / sum : 0.0F;
  }
}

}  // namespace

BallBox BoxOf(const std::vector<Ball>& balls) {
  BallBox box;
  if (balls.empty()) return box;
  box = {glm::dvec3(1e30), glm::dvec3(-1e30)};
  for (const Ball& ball : balls) {
    box.low_m = glm::min(box.low_m, ball.middle_m - ball.radius_m);
    box.high_m = glm::max(box.high_m, ball.middle_m + ball.radius_m);
  }
  return box;
}

absl::StatusOr<BallCloud> FitBalls(const Medium& medium, const volume::HydrometeorFields& fields,
                                   int count) {
  if (fields.condensate.Empty() || medium.terms.empty()) return BallCloud{};
  const glm::ivec3 factor = CoarseningForFit(fields);
  if (factor != glm::ivec3(1)) return FitBalls(medium, volume::Coarsened(fields, factor), count);
  std::vector<float> values = ExtinctionOf(fields, medium, -1);
  const float negligible_per_m = volume::NegligibleExtinction_per_m(
      fields.grid, *std::max_element(values.begin(), values.end()));
  int worth = 0;
  for (float& value : values) {
    if (value <= negligible_per_m) value = 0.0F;
    worth += value > 0.0F ? 1 : 0;
  }
  if (worth == 0) return BallCloud{};
  clouds::FitOptions options;
  options.balls = std::min(count, worth);
  options.basis = clouds::Basis::kWyvill;
  options.non_negative = true;
  options.overlap = kOverlap;
  THUNDERHEAD_ASSIGN_OR_RETURN(clouds::FitResult fit,
                               clouds::Fit(fields.grid, values, options, {}, {}));
  std::erase_if(fit.cloud.balls, [](const clouds::Metaball& ball) { return !(ball.weight > 0.0); });
  BallCloud cloud;
  cloud.relative_error = fit.relative_error;
  for (const clouds::Metaball& ball : fit.cloud.balls) {
    cloud.balls.push_back({ball.centre_m,
                           clouds::Reach_m(fit.cloud.basis, fit.cloud.overlap, ball.sigma_m),
                           ball.weight,
                           {}});
  }
  Share(fields, medium, fit.cloud, &cloud.balls);
  return cloud;
}

bool BallFits::Same(const Key& a, const Key& b) {
  const auto same_term = [](const volume::ExtinctionTerm& x, const volume::ExtinctionTerm& y) {
    return x.field == y.field && x.channel == y.channel && x.by_cell == y.by_cell &&
           x.mass_extinction_m2_per_kg == y.mass_extinction_m2_per_kg;
  };
  // Owners are compared instead of addresses, because a later storm can have the same address.
  return !a.fields.owner_before(b.fields) && !b.fields.owner_before(a.fields) &&
         a.count == b.count &&
         std::equal(a.terms.begin(), a.terms.end(), b.terms.begin(), b.terms.end(), same_term);
}

std::shared_ptr<const BallCloud> BallFits::Find(const Key& key) {
  const std::lock_guard lock(mutex_);
  std::erase_if(kept_, [](const Kept& kept) { return kept.key.fields.expired(); });
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& kept) { return Same(kept.key, key); });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return found->balls;
}

bool BallFits::Has(const scene::Scene& scene,
                   const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  return Find({fields, scene::GroupedFieldsOf(scene, *fields).terms,
               std::get<scene::Metaballs>(scene.rendering.technique).count}) != nullptr;
}

absl::StatusOr<std::shared_ptr<const BallCloud>> BallFits::Get(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  const Medium medium = scene::GroupedFieldsOf(scene, *fields);
  const Key key{fields, medium.terms, std::get<scene::Metaballs>(scene.rendering.technique).count};
  if (auto kept = Find(key); kept != nullptr) return kept;
  const std::lock_guard fitting(fitting_);
  // Another thread may have fitted these balls in the meantime.
  if (auto kept = Find(key); kept != nullptr) return kept;
  THUNDERHEAD_ASSIGN_OR_RETURN(BallCloud cloud, FitBalls(medium, *fields, key.count));
  auto balls = std::make_shared<const BallCloud>(std::move(cloud));
  const std::lock_guard lock(mutex_);
  kept_.push_front({key, balls});
  if (kept_.size() > max_fits_) kept_.pop_back();
  return balls;
}

}  // namespace thunderhead::renderers
