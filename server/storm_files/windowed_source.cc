#include "storm_files/windowed_source.h"

#include <algorithm>
#include <utility>

#include "base/status.h"
#include "glm/common.hpp"

namespace thunderhead::storm_files {
namespace {

// Returns the values of the columns in `box`, for any number of levels of `columns` columns.
std::vector<float> Cropped(std::vector<float> values, const glm::ivec2& columns,
                           const ColumnWindow& box) {
  if (values.empty() || box.columns == columns) return values;
  const auto row = static_cast<std::size_t>(columns.x);
  const std::size_t rows = values.size() / row;
  const auto all_rows = static_cast<std::size_t>(columns.y);
  std::size_t to = 0;
  // The cropped values move towards the start of the same array, so no second one is needed.
  for (std::size_t y = 0; y < rows; ++y) {
    const auto in_level = static_cast<int>(y % all_rows);
    if (in_level < box.low.y || in_level >= box.low.y + box.columns.y) continue;
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(y * row) + box.low.x;
    std::copy(from, from + box.columns.x, values.begin() + static_cast<std::ptrdiff_t>(to));
    to += static_cast<std::size_t>(box.columns.x);
  }
  values.resize(to);
  values.shrink_to_fit();
  return values;
}

// Returns the model's columns between which the even columns of the window are interpolated.
ColumnWindow ModelColumnsFor(const EvenColumns& even, const ColumnWindow& window) {
  glm::ivec2 low = even.model_columns;
  glm::ivec2 high(0);
  for (int y = window.low.y; y < window.low.y + window.columns.y; ++y) {
    for (int x = window.low.x; x < window.low.x + window.columns.x; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(even.columns.x) +
                      static_cast<std::size_t>(x);
      const auto south_west = static_cast<int>(even.from[at].south_west);
      const glm::ivec2 column(south_west % even.model_columns.x, south_west / even.model_columns.x);
      low = glm::min(low, column);
      high = glm::max(high, glm::min(column + 1, even.model_columns - 1));
    }
  }
  return {low, high - low + 1};
}

// Returns the even columns of the window. Their places are among the model's columns in `box`.
std::shared_ptr<const EvenColumns> Windowed(const EvenColumns& even, const ColumnWindow& window,
                                            const ColumnWindow& box) {
  auto windowed = std::make_shared<EvenColumns>(even);
  windowed->columns = window.columns;
  windowed->model_columns = box.columns;
  windowed->from.clear();
  // The areas are those of the whole domain, so the sum over the window cannot be compared.
  windowed->model_areas.clear();
  for (int y = window.low.y; even.Resampled() && y < window.low.y + window.columns.y; ++y) {
    const auto row = even.from.begin() + static_cast<std::ptrdiff_t>(y) * even.columns.x;
    for (int x = window.low.x; x < window.low.x + window.columns.x; ++x) {
      FromColumn from = row[x];
      const auto column = static_cast<int>(from.south_west);
      const glm::ivec2 in_box(column % even.model_columns.x - box.low.x,
                              column / even.model_columns.x - box.low.y);
      from.south_west = static_cast<std::uint32_t>(in_box.y * box.columns.x + in_box.x);
      windowed->from.push_back(from);
    }
  }
  return windowed;
}

class WindowedSource final : public LayerSource {
 public:
  WindowedSource(LayerSource& whole, const ColumnWindow& window)
      : whole_(whole), columns_(whole.Domain().cells), domain_(whole.Domain()) {
    const EvenColumns* const resampling = domain_.Resampling();
    if (resampling == nullptr) {
      box_ = window;
    } else if (resampling->unstructured) {
      // The cells of an unstructured grid are in one row, in any order. All of them are kept.
      box_ = {glm::ivec2(0), columns_};
    } else {
      box_ = ModelColumnsFor(*resampling, window);
    }
    const glm::dvec2 middle =
        glm::dvec2(window.low) + 0.5 * glm::dvec2(window.columns - domain_.StormColumns());
    domain_.middle_m = domain_.StormSpacing_m() * middle;
    domain_.cells = {box_.columns, domain_.cells.z};
    if (domain_.even != nullptr) domain_.even = Windowed(*domain_.even, window, box_);
  }

  const LayerDomain& Domain() const override { return domain_; }

  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override {
    return CroppedOrError(whole_.InterfaceHeights_m());
  }

  absl::StatusOr<LayerState> Air() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(LayerState state, whole_.Air());
    for (std::vector<float>* values :
         {&state.pressure_Pa, &state.potential_temperature_K, &state.vapour_kg_per_kg,
          &state.temperature_K, &state.air_density_kg_per_m3}) {
      Crop(*values);
    }
    return state;
  }

  absl::StatusOr<LayerAmounts> Amounts(std::size_t field) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(LayerAmounts amounts, whole_.Amounts(field));
    Crop(amounts.amounts);
    Crop(amounts.sizes);
    return amounts;
  }

  absl::StatusOr<std::vector<float>> Terrain_m() override {
    return CroppedOrError(whole_.Terrain_m());
  }

  absl::StatusOr<volume::LandColumns> Land() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::LandColumns land, whole_.Land());
    for (std::vector<float>* values :
         {&land.land_use, &land.water, &land.albedo, &land.green_percent, &land.snow_share}) {
      Crop(*values);
    }
    return land;
  }

  absl::StatusOr<LayerEnergy> TurbulentEnergy() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(LayerEnergy energy, whole_.TurbulentEnergy());
    Crop(energy.energy_m2_per_s2);
    return energy;
  }

  absl::StatusOr<ModelWind> Wind() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(ModelWind wind, whole_.Wind());
    // A cell has two faces along x and two along y.
    const int faces = wind.on_faces ? 1 : 0;
    Crop(wind.u_m_per_s, {faces, 0});
    Crop(wind.v_m_per_s, {0, faces});
    Crop(wind.w_m_per_s);
    wind.cells = {box_.columns, wind.cells.z};
    return wind;
  }

 private:
  // Keeps the values of the window's columns, and of `more` columns east and north of them.
  void Crop(std::vector<float>& values, const glm::ivec2& more = glm::ivec2(0)) const {
    values = Cropped(std::move(values), columns_ + more, {box_.low, box_.columns + more});
  }

  absl::StatusOr<std::vector<float>> CroppedOrError(
      absl::StatusOr<std::vector<float>> values) const {
    if (values.ok()) Crop(*values);
    return values;
  }

  LayerSource& whole_;
  const glm::ivec2 columns_;  // of `whole_`
  LayerDomain domain_;
  ColumnWindow box_;  // the columns of `whole_` that are kept
};

}  // namespace

std::unique_ptr<LayerSource> MakeWindowedSource(LayerSource& whole, const ColumnWindow& window) {
  return std::make_unique<WindowedSource>(whole, window);
}

}  // namespace thunderhead::storm_files
