#include "physics/optics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/status.h"
#include "glm/geometric.hpp"
#include "physics/phase_table.h"

namespace thunderhead::physics {
namespace {

// Returns the integral of f(angle) from `low_rad` to `high_rad` by Simpson's rule. For six correct
// digits, phase functions up to g = 0.99 need steps of about 0.1 degree.
template <typename F>
double IntegrateOverAngle(double low_rad, double high_rad, const F& f) {
  constexpr int kIntervals = 4096;
  const double step = (high_rad - low_rad) / kIntervals;
  double sum = f(low_rad) + f(high_rad);
  for (int i = 1; i < kIntervals; ++i) {
    sum += f(low_rad + i * step) * (i % 2 == 1 ? 4.0 : 2.0);
  }
  return sum * step / 3.0;
}

// Returns the index in kPhaseTables of the table for `phase`. For droplets it is the table with the
// nearest radius.
std::size_t TableIndexOf(const PhaseFunction& phase) {
  std::size_t nearest = kPhaseTables.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kPhaseTables.size(); ++i) {
    const PhaseTableName& table = kPhaseTables[i];
    if (table.kind != phase.kind) continue;
    const double ratio = table.droplet_radius_m > 0.0F
                             ? std::fmax(phase.droplet_radius_m, 1e-9F) / table.droplet_radius_m
                             : 1.0;
    const double distance = std::abs(std::log(ratio));
    if (distance >= least) continue;
    least = distance;
    nearest = i;
  }
  THUNDERHEAD_CHECK(nearest < kPhaseTables.size(), "phase kind without a table");
  return nearest;
}

const PhaseTable& TableOf(const PhaseFunction& phase) {
  static const std::vector<PhaseTable> tables = [] {
    std::vector<PhaseTable> loaded;
    for (const PhaseTableName& table : kPhaseTables) {
      absl::StatusOr<PhaseTable> embedded = EmbeddedPhaseTable(table.name);
      THUNDERHEAD_CHECK(embedded.ok(), embedded.status().ToString());
      loaded.push_back(*std::move(embedded));
    }
    return loaded;
  }();
  return tables[TableIndexOf(phase)];
}

template <typename F>
double Luminance(const F& value_of_channel) {
  return glm::dot(kLuminance,
                  glm::dvec3(value_of_channel(0), value_of_channel(1), value_of_channel(2)));
}

double HenyeyGreenstein(double g, double mu) {
  // The form with 1 - mu avoids cancellation in the forward peak.
  const double base = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - mu);
  return (1.0 - g) * (1.0 + g) / (base * std::sqrt(base));
}

// Cornette and Shanks, Applied Optics 31, 1992, eq. 8.
double CornetteShanks(double g, double mu) {
  return HenyeyGreenstein(g, mu) * 1.5 * (1.0 + mu * mu) / (2.0 + g * g);
}

double Rayleigh(double /*g*/, double mu) { return 0.75 * (1.0 + mu * mu); }

constexpr std::array kPhaseFormulas = {
    PhaseFormula{PhaseKind::kHenyeyGreenstein, true, HenyeyGreenstein},
    PhaseFormula{PhaseKind::kCornetteShanks, true, CornetteShanks},
    PhaseFormula{PhaseKind::kRayleigh, false, Rayleigh},
};

// Returns true if the kind is either a formula or a table, but not both.
constexpr bool HasOneForm(PhaseKind kind) {
  const bool formula = std::ranges::count(kPhaseFormulas, kind, &PhaseFormula::kind) == 1;
  const bool table = std::ranges::count(kPhaseTables, kind, &PhaseTableName::kind) > 0;
  return formula != table;
}
static_assert(std::ranges::all_of(kPhaseKindNames, HasOneForm, &PhaseKindName::kind));

bool IsFormula(const PhaseFunction& phase) { return FormulaOf(phase.kind) != nullptr; }

double FormulaValue(const PhaseFunction& phase, double mu) {
  return FormulaOf(phase.kind)->value(phase.asymmetry, mu);
}

}  // namespace

const PhaseFormula* FormulaOf(PhaseKind kind) {
  const auto* const formula = std::ranges::find(kPhaseFormulas, kind, &PhaseFormula::kind);
  return formula == kPhaseFormulas.end() ? nullptr : formula;
}

PhaseFunction PhaseOf(const ParticleOptics& optics) {
  PhaseFunction phase{optics.phase.kind, 0.0F, 0.0F};
  if (phase.kind == PhaseKind::kWaterDroplets) {
    phase.droplet_radius_m = optics.radius_m;
    phase.droplet_radius_m = kPhaseTables[TableIndexOf(phase)].droplet_radius_m;
  } else if (IsFormula(phase) && FormulaOf(phase.kind)->has_asymmetry) {
    phase.asymmetry = optics.phase.asymmetry;
  }
  return phase;
}

glm::dvec3 PhaseColors(const PhaseFunction& phase, double mu) {
  if (IsFormula(phase)) return glm::dvec3(FormulaValue(phase, mu));
  const PhaseTable& table = TableOf(phase);
  return {table.ValueAtCosine(mu, 0), table.ValueAtCosine(mu, 1), table.ValueAtCosine(mu, 2)};
}

double PhaseValue(const PhaseFunction& phase, double mu) {
  return IsFormula(phase) ? FormulaValue(phase, mu) : glm::dot(kLuminance, PhaseColors(phase, mu));
}

double CumulativePhase(const PhaseFunction& phase, double angle_rad) {
  if (!IsFormula(phase)) {
    const PhaseTable& table = TableOf(phase);
    return Luminance([&](std::size_t c) { return table.CumulativeShare(angle_rad, c); });
  }
  return 0.5 * IntegrateOverAngle(0.0, angle_rad, [&](double angle) {
           return FormulaValue(phase, std::cos(angle)) * std::sin(angle);
         });
}

double MeanCosine(const PhaseFunction& phase) {
  if (!IsFormula(phase)) {
    const PhaseTable& table = TableOf(phase);
    return Luminance([&](std::size_t c) { return table.Asymmetry(c); });
  }
  return 0.5 * IntegrateOverAngle(0.0, std::numbers::pi, [&](double angle) {
           return FormulaValue(phase, std::cos(angle)) * std::cos(angle) * std::sin(angle);
         });
}

DeltaScaling CutForwardPeak(const PhaseFunction& phase, double angle_rad) {
  const double cut_cosine = std::cos(angle_rad);
  if (!IsFormula(phase)) {
    const PhaseTable& table = TableOf(phase);
    return {Luminance([&](std::size_t c) { return table.CutShare(angle_rad, c); }), cut_cosine};
  }
  const double within = CumulativePhase(phase, angle_rad);
  const double held = 0.5 * FormulaValue(phase, cut_cosine) * (1.0 - cut_cosine);
  return {std::fmax(within - held, 0.0), cut_cosine};
}

}  // namespace thunderhead::physics
