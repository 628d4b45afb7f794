// Test cases with extreme file contents (empty, negative and missing values), and over the whole
// range of half floats.
#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "base/half_float.h"
#include "glm/gtc/packing.hpp"
#include "measure/extremes_internal.h"
#include "storm_files/field_scan.h"

namespace thunderhead::measure::internal {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Returns one layer of air, 1 m thick and with a density of 1 kg/m3. It has a column for each of
// `values`.
storm_files::LayerAir AirOver(const std::vector<float>& values) {
  storm_files::LayerAir air;
  air.levels = 1;
  air.columns = values.size();
  air.interface_height_m.assign(values.size(), 0.0F);
  air.interface_height_m.resize(2 * values.size(), 1.0F);
  air.dry_air_density_kg_per_m3.assign(values.size(), 1.0F);
  return air;
}

// Reads mixing ratios as from a file. Checks how many values are negative or missing, and that only
// valid values remain.
Extreme MixingRatios(const std::string& name, const std::vector<float>& values, int negative,
                     int missing, float left_kg_per_m3) {
  return {name, [=](Probe&) -> absl::StatusOr<Verdict> {
            std::vector<float> held = values;
            const storm_files::LayerAir air = AirOver(held);
            const volume::FieldStatistics found =
                storm_files::AmountToConcentration(air, air.dry_air_density_kg_per_m3, held);
            float left = 0.0F;
            bool usable = true;
            for (const float value : held) {
              usable = usable && std::isfinite(value) && value >= 0.0F;
              left += value;
            }
            const auto text = [](std::int64_t below, std::int64_t none, float sum) {
              return absl::StrFormat("%d negative, %d missing, %g kg/m3", below, none, sum);
            };
            return Verdict{text(negative, missing, left_kg_per_m3),
                           text(found.negative_cells, found.missing_cells, left),
                           usable && found.negative_cells == negative &&
                               found.missing_cells == missing && left == left_kg_per_m3};
          }};
}

Extreme HalfFloats() {
  return {"half floats: relative error from 6.1e-5 to 65504",
          [](Probe&) -> absl::StatusOr<Verdict> {
            constexpr int kValues = 56000;  // values evenly spaced in the logarithm
            const double span = std::log(65500.0 / 6.2e-5);
            double worst = 0.0;
            for (int i = 0; i <= kValues; ++i) {
              const auto single = static_cast<float>(6.2e-5 * std::exp(span * i / kValues));
              const float half = glm::unpackHalf1x16(base::HalfFromFloat(single));
              worst = std::max(worst, std::abs(static_cast<double>(half) / single - 1.0));
            }
            return AtMost(worst, 0x1p-11);
          }};
}

}  // namespace

void AppendInputExtremes(std::vector<Extreme>* extremes) {
  extremes->push_back(MixingRatios("file: mixing ratio 0", {0.0F, 0.0F}, 0, 0, 0.0F));
  extremes->push_back(
      MixingRatios("file: tiny negatives from advection", {-1e-13F, 0.5F, -3e-20F}, 2, 0, 0.5F));
  extremes->push_back(MixingRatios("file: not a number", {kNotANumber, 0.25F}, 0, 1, 0.25F));
  extremes->push_back(MixingRatios("file: infinite", {kInfinity, 0.25F, -kInfinity}, 0, 2, 0.25F));
  extremes->push_back(MixingRatios("file: -999 for missing", {-999.0F, 0.25F}, 0, 1, 0.25F));
  extremes->push_back(HalfFloats());
}

}  // namespace thunderhead::measure::internal
