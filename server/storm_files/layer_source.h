// One time of a storm on the model's own layers, described by meaning instead of by file format.
// Each format implements LayerSource. ReadOnHeights (fields_on_heights.h) turns every source into
// fields on even heights, so units, moist or dry air, negative and missing values are handled in
// one place.
//
// All arrays have x (west to east) running fastest, then y (south to north), then layers upwards.
// Missing values are NaN. Errors name the file, the variable and what to do.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "physics/size_distributions.h"
#include "storm_files/even_columns.h"
#include "storm_files/layer_air.h"
#include "storm_files/wind_motion.h"
#include "volume/hydrometeor_fields.h"
#include "volume/land_surface.h"
#include "volume/particle_sizes.h"

namespace thunderhead::storm_files {

// The air of which a mass ratio is a share.
enum class AirMass {
  kDry,    // kg per kg of dry air: a mixing ratio
  kWhole,  // kg per kg of dry air, vapour and condensate together: a specific content
};

// The variables that a source has for one hydrometeor.
struct LayerField {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  std::string variable;  // the name in the file
  volume::Quantity quantity = volume::Quantity::kMixingRatio;
  AirMass per = AirMass::kDry;  // for Quantity::kMixingRatio
  volume::SizeVariable sizes;   // the variable of the particles' sizes; its name is empty if none
};

struct LayerDomain {
  std::string path;        // the file's path, for errors
  std::size_t record = 0;  // the record's index in the file, for errors
  absl::Time time;         // the valid time
  glm::ivec3 cells{0};     // columns west-east and south-north, and layers
  double dx_m = 0.0;       // mean true distance between neighbouring columns along x
  double dy_m = 0.0;       // mean true distance between neighbouring columns along y
  // The middle of the storm's columns relative to the middle of the whole domain; not 0 if the
  // source has a window of it only.
  glm::dvec2 middle_m{0.0};
  // The columns that ReadOnHeights gives the storm. If it is null, the source's own columns are
  // even, and dx_m and dy_m are their distances.
  std::shared_ptr<const EvenColumns> even;
  bool on_terrain = false;     // true if the lowest interface is the ground
  bool fixed_heights = false;  // true if the heights are the same at all times
  std::string heights_from;    // the variables of the heights, for errors
  std::string ground_from;     // the variable of the ground's height, for errors; empty if none
  std::string air_from;        // the variables of pressure and temperature or density, for errors
  std::string vapour_from;     // the variable of the air's vapour, for errors; empty if none
  physics::Microphysics microphysics = physics::Microphysics::kUnknown;
  std::vector<LayerField> fields;  // in the order of physics::kHydrometeors

  std::size_t Columns() const {
    return static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y);
  }
  // Returns the columns to which the source's are resampled, or null if they stay as they are.
  const EvenColumns* Resampling() const {
    return even != nullptr && even->Resampled() ? even.get() : nullptr;
  }
  // Returns the number of the storm's columns along x and along y.
  glm::ivec2 StormColumns() const {
    return Resampling() != nullptr ? even->columns : glm::ivec2(cells);
  }
  // Returns the distances between the storm's columns.
  glm::dvec2 StormSpacing_m() const {
    return Resampling() != nullptr ? glm::dvec2(even->dx_m, even->dy_m) : glm::dvec2(dx_m, dy_m);
  }
};

// The amounts of one hydrometeor, and the sizes of its particles.
struct LayerAmounts {
  std::vector<float> amounts;  // in the unit of LayerField::quantity, one value for each cell
  std::vector<float> sizes;    // radius in m or number per kg, as LayerField::sizes says; may be
                               // empty
};

// The turbulent kinetic energy of eddies that the model does not resolve.
struct LayerEnergy {
  std::string variable;  // empty if the file has none
  std::vector<float> energy_m2_per_s2;
};

// A source reads from its file when a function is called, and keeps as little as it can, because a
// time of a large domain fills gigabytes. Each function is called once or, for Amounts, at most
// twice. It is used by one thread at a time.
class LayerSource {
 public:
  virtual ~LayerSource() = default;

  virtual const LayerDomain& Domain() const = 0;

  // Returns the heights above mean sea level of the interfaces between layers, (layers + 1) values
  // for each column.
  virtual absl::StatusOr<std::vector<float>> InterfaceHeights_m() = 0;

  // Returns the state of the air. It is called only if a field is a mass ratio, and after
  // InterfaceHeights_m.
  virtual absl::StatusOr<LayerState> Air() = 0;

  // Returns the amounts of Domain().fields[field].
  virtual absl::StatusOr<LayerAmounts> Amounts(std::size_t field) = 0;

  // Returns the height of the ground above mean sea level in each column. It is empty if the file
  // has none.
  virtual absl::StatusOr<std::vector<float>> Terrain_m() { return std::vector<float>(); }

  // Returns the land cover. Its `land_use` is empty if the file has none.
  virtual absl::StatusOr<volume::LandColumns> Land() { return volume::LandColumns(); }

  virtual absl::StatusOr<LayerEnergy> TurbulentEnergy() { return LayerEnergy(); }

  // Returns the wind along the source's own axes, or to the east and north if the wind says so. Its
  // arrays are empty if the file has none.
  virtual absl::StatusOr<ModelWind> Wind() { return ModelWind(); }
};

}  // namespace thunderhead::storm_files
