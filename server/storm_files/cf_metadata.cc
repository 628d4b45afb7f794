#include "storm_files/cf_metadata.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cf_times.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

std::vector<CfDescription> Describe(const netcdf::NetcdfFile& file) {
  std::vector<CfDescription> descriptions;
  for (const std::string& name : file.Variables()) descriptions.push_back(DescribeCf(file, name));
  return descriptions;
}

absl::Status WrongUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                        const std::string& wanted) {
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable.name,
      variable.units.empty() ? " has no units" : absl::StrCat(" has units '", variable.units, "'"),
      " where ", wanted, " is needed; convert it, or add its units attribute"));
}

absl::Status CheckQuantityUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                                const CfQuantity& quantity) {
  if (quantity.known_units) return absl::OkStatus();
  return WrongUnits(
      file, variable,
      quantity.quantity == volume::Quantity::kExtinction ? "'m-1'" : "'kg kg-1' or 'kg m-3'");
}

bool OnAllAxes(const CfVariable& variable) {
  return std::ranges::none_of(variable.places, [](int place) { return place < 0; });
}

bool OnCells(const CfVariable& variable) { return variable.more == std::array<int, 3>{0, 0, 0}; }

// Returns how a variable lies on the fields' cells. An error says why it cannot be used.
absl::StatusOr<CfVariable> ArrangeOnCells(const netcdf::NetcdfFile& file,
                                          const std::string& variable, const CfMetadata& metadata) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged, Arrange(file, variable, metadata.dimensions));
  if (OnAllAxes(arranged) && OnCells(arranged)) return arranged;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable, " does not lie on ", metadata.dimensions.axes[0].name, ", ",
      metadata.dimensions.axes[1].name, " and ", metadata.dimensions.axes[2].name, ", as ",
      metadata.fields.front().variable.name, " does; put all on one grid"));
}

// Finds the axes of the first variable that has them all. The error is that of the first variable.
absl::Status FindAxes(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& candidates,
                      CfMetadata* metadata) {
  absl::Status first;
  for (const CfDescription& variable : candidates) {
    auto dimensions = FindDimensions(file, variable.name);
    if (dimensions.ok()) {
      metadata->dimensions = *std::move(dimensions);
      return absl::OkStatus();
    }
    first.Update(dimensions.status());
  }
  return first;
}

// Returns whether a variable lacks an axis, like a column total or a profile.
bool HasFewerAxes(const netcdf::NetcdfFile& file, const std::string& variable,
                  const CfMetadata& metadata) {
  const auto arranged = Arrange(file, variable, metadata.dimensions);
  return arranged.ok() && !OnAllAxes(*arranged);
}

// Finds the hydrometeors, or the extinction alone if there is one, because it includes all of them.
absl::Status FindFields(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                        CfMetadata* metadata) {
  std::vector<CfField>& fields = metadata->fields;
  std::vector<CfDescription> candidates;
  for (const CfDescription& variable : variables) {
    const auto shape = file.Shape(variable.name);
    // Variables without a height axis, such as column totals, may have the same names.
    if (QuantityOf(variable).has_value() && shape.ok() && shape->size() >= 2) {
      candidates.push_back(variable);
    }
  }
  if (candidates.empty()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(FindAxes(file, candidates, metadata));
  for (const CfDescription& variable : candidates) {
    const CfQuantity quantity = *QuantityOf(variable);
    if (HasFewerAxes(file, variable.name, *metadata)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(CheckQuantityUnits(file, variable, quantity));
    THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged,
                                 Arrange(file, variable.name, metadata->dimensions));
    if (!OnCells(arranged)) {
      return absl::InvalidArgumentError(
          absl::StrCat(file.Path(), ": ", variable.name, " lies on the faces between the cells of ",
                       candidates.front().name, "; put all on one grid"));
    }
    const auto same = [&](const CfField& field) {
      return field.quantity.hydrometeor == quantity.hydrometeor &&
             (field.quantity.quantity == volume::Quantity::kExtinction) ==
                 (quantity.quantity == volume::Quantity::kExtinction);
    };
    if (const auto first = std::ranges::find_if(fields, same); first != fields.end()) {
      metadata->assumptions.push_back(absl::StrCat(variable.name, " is left out, because ",
                                                   first->variable.name, " says the same."));
      continue;
    }
    fields.push_back({std::move(arranged), quantity});
  }
  const auto extinction = std::ranges::find_if(fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kExtinction;
  });
  if (extinction != fields.end() && fields.size() > 1) {
    metadata->assumptions.push_back("Only the extinction is used, not the hydrometeors.");
    fields = {CfField(*extinction)};
  }
  std::ranges::stable_sort(fields, {}, [](const CfField& field) {
    return physics::IndexOf(field.quantity.hydrometeor);
  });
  return absl::OkStatus();
}

bool Has(const CfMetadata& metadata, AirVariable variable) {
  return std::ranges::any_of(
      metadata.air, [variable](const CfAirField& field) { return field.air.variable == variable; });
}

// Takes the variables of the air. First those on all axes are taken, and then profiles along z for
// what is still missing, such as the base state of an anelastic model.
absl::Status TakeAir(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                     bool profiles, CfMetadata* metadata) {
  for (const CfDescription& variable : variables) {
    const std::optional<CfAir> air = AirVariableOf(variable);
    if (!air.has_value() || Has(*metadata, air->variable)) continue;
    const auto shape = file.Shape(variable.name);
    const auto arranged = Arrange(file, variable.name, metadata->dimensions);
    if (!shape.ok() || (!profiles && shape->size() < 3)) continue;
    if (profiles && (!arranged.ok() || arranged->places[2] < 0 || arranged->places[0] >= 0 ||
                     arranged->places[1] >= 0 || !OnCells(*arranged))) {
      continue;
    }
    if (!profiles && HasFewerAxes(file, variable.name, *metadata)) continue;
    if (!air->known_units) return WrongUnits(file, variable, "kg m-3, Pa, K or kg kg-1");
    if (HasNoUnits(variable.units)) {
      spdlog::warn("{}: {} has no units; taken to be in kg m-3, Pa, K or kg kg-1", file.Path(),
                   variable.name);
      metadata->assumptions.push_back(absl::StrCat(
          variable.name, " has no units; it is taken to be in kg m-3, Pa, K or kg kg-1."));
    }
    if (profiles) {
      metadata->assumptions.push_back(
          absl::StrCat("The air's ", variable.name, " is the same in all columns."));
      metadata->air.push_back({*arranged, *air});
      continue;
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable on_cells,
                                 ArrangeOnCells(file, variable.name, *metadata));
    metadata->air.push_back({std::move(on_cells), *air});
  }
  return absl::OkStatus();
}

// Finds the variables needed to convert mixing ratios to masses per volume, and to compute heights.
absl::Status FindAir(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                     CfMetadata* metadata) {
  const auto ratio = std::ranges::find_if(metadata->fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kMixingRatio;
  });
  const bool hydrostatic = metadata->heights.kind == CfHeightKind::kPressure;
  if (ratio == metadata->fields.end() && !hydrostatic) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(TakeAir(file, variables, false, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(TakeAir(file, variables, true, metadata));
  const bool warm = Has(*metadata, AirVariable::kTemperature) ||
                    Has(*metadata, AirVariable::kPotentialTemperature);
  if (hydrostatic && !warm) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": the heights of ", metadata->heights.name,
        " follow from pressure and temperature, and the file lacks air_temperature (K); add it, or "
        "an array of heights"));
  }
  if (ratio == metadata->fields.end()) return absl::OkStatus();
  const bool pressure = hydrostatic || Has(*metadata, AirVariable::kPressure);
  if (Has(*metadata, AirVariable::kDensity) || (pressure && warm)) return absl::OkStatus();
  const auto deviation = std::ranges::find_if(variables, [](const CfDescription& variable) {
    return absl::StrContains(variable.standard_name, "difference_of_air_pressure") ||
           (variable.standard_name.empty() &&
            (variable.name == "PP" || variable.name == "pp" || variable.name == "prspert"));
  });
  const std::string reason =
      deviation == variables.end()
          ? ""
          : absl::StrCat(" (", deviation->name,
                         " is only the deviation from a reference pressure: write the whole "
                         "pressure too)");
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", ratio->variable.name, " is per kg of air, and the file lacks the air's ",
      "density", reason, "; add air_density (kg m-3), or air_pressure (Pa) with air_temperature ",
      "(K), or give masses in kg m-3"));
}

// Reads the horizontal axes. If the domain is only one cell wide along one axis, that width is
// assumed to be the cell size along the other axis.
absl::Status ReadColumns(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  const auto& [x_on, y_on, z_on] = metadata->dimensions.axes;
  const auto read = [&](const CfDimension& on, CfDirection direction, double single,
                        CfAxis* axis) -> absl::Status {
    THUNDERHEAD_ASSIGN_OR_RETURN(*axis, ReadHorizontalAxis(file, on, direction, single));
    return absl::OkStatus();
  };
  double single = 0.0;
  if (y_on.length == 1 && read(x_on, CfDirection::kX, 0.0, &metadata->x).ok()) {
    single = metadata->x.Spacing();
  }
  THUNDERHEAD_RETURN_IF_ERROR(read(y_on, CfDirection::kY, single, &metadata->y));
  THUNDERHEAD_RETURN_IF_ERROR(read(x_on, CfDirection::kX, metadata->y.Spacing(), &metadata->x));
  const std::string& field = metadata->fields.front().variable.name;
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata->places, PlaceColumns(file, field, metadata->dimensions, {},
                                                              metadata->x, metadata->y));
  metadata->order.cells = {x_on.length, y_on.length, z_on.length};
  metadata->order.reversed = {metadata->x.reversed, metadata->y.reversed, false};
  return absl::OkStatus();
}

// Places the columns at each record, if they move.
absl::Status ReadMoves(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  const std::string& field = metadata->fields.front().variable.name;
  std::vector<std::shared_ptr<const CfPlaces>> moved(metadata->times.size());
  bool moves = false;
  for (std::size_t record = 1; record < moved.size(); ++record) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        std::optional<CfPlaces> places,
        PlaceColumnsAgain(file, field, metadata->dimensions, metadata->places, record, metadata->x,
                          metadata->y));
    if (!places.has_value() || places->even == nullptr) continue;
    moved[record] = std::make_shared<const CfPlaces>(*std::move(places));
    moves = true;
  }
  if (!moves) return absl::OkStatus();
  metadata->moved = std::move(moved);
  metadata->assumptions.push_back(
      "The domain moves, and each time is shown at its own place, with its own distances and map "
      "projection.");
  return absl::OkStatus();
}

// Returns the dimensions of a variable of wind or turbulent energy. Each component may lie on the
// cells or on the faces along its own direction. An error says why the variable cannot be used.
absl::StatusOr<CfVariable> ArrangeWind(const netcdf::NetcdfFile& file,
                                       const CfDescription& variable, const CfWind& wind,
                                       const CfMetadata& metadata) {
  if (!wind.known_units) {
    return WrongUnits(file, variable,
                      wind.variable == WindVariable::kTurbulentEnergy ? "m2 s-2" : "m s-1");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged,
                               Arrange(file, variable.name, metadata.dimensions));
  std::array<int, 3> allowed = {0, 0, 0};
  if (wind.variable == WindVariable::kEastward) allowed[0] = 1;
  if (wind.variable == WindVariable::kNorthward) allowed[1] = 1;
  if (wind.variable == WindVariable::kUpward || wind.variable == WindVariable::kTurbulentEnergy) {
    allowed[2] = 1;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (arranged.places[axis] >= 0 && arranged.more[axis] <= allowed[axis]) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", variable.name, " does not lie on the fields' own grid"));
  }
  return arranged;
}

// Finds the wind and the turbulent energy, if the file has them on the fields' own grid.
void FindWind(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
              CfMetadata* metadata) {
  const auto find = [&](WindVariable wind) {
    return std::ranges::find_if(
        metadata->wind, [wind](const CfWindField& field) { return field.wind.variable == wind; });
  };
  for (const CfDescription& variable : variables) {
    const std::optional<CfWind> wind = WindVariableOf(variable);
    if (!wind.has_value()) continue;
    const auto shape = file.Shape(variable.name);
    if (!shape.ok() || shape->size() < 3) continue;
    absl::StatusOr<CfVariable> arranged = ArrangeWind(file, variable, *wind, *metadata);
    if (!arranged.ok()) {
      spdlog::warn("the motion of the air is read without {}: {}", variable.name,
                   std::string(arranged.status().message()));
      continue;
    }
    const auto held = find(wind->variable);
    if (held == metadata->wind.end()) {
      metadata->wind.push_back({*std::move(arranged), *wind});
    } else if (!OnCells(held->variable) && OnCells(*arranged)) {
      *held = {*std::move(arranged), *wind};
    }
  }
  const auto has = [&](WindVariable wind) { return find(wind) != metadata->wind.end(); };
  if (has(WindVariable::kEastward) && has(WindVariable::kNorthward) && has(WindVariable::kUpward)) {
    return;
  }
  std::erase_if(metadata->wind, [](const CfWindField& field) {
    return field.wind.variable != WindVariable::kTurbulentEnergy;
  });
}

// Finds out whether an array of heights of which its name does not say so is above the ground: then
// it is below the terrain somewhere.
absl::Status CheckArrayAgainstTerrain(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  CfHeights& heights = metadata->heights;
  if (!heights.array.has_value() || heights.above_ground || !metadata->terrain.has_value() ||
      (heights.name != "zhval" && heights.name != "height") ||
      !file.TextOrEmpty(heights.name, "standard_name").empty()) {
    return absl::OkStatus();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> array,
                               ReadOnAxes(file, *heights.array, metadata->order, 0));
  CfOrder flat = metadata->order;
  flat.cells[2] = 1;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> terrain,
                               ReadOnAxes(file, metadata->terrain->variable, flat, 0));
  constexpr double kSlack_m = 1.0;
  for (std::size_t i = 0; i < terrain.size(); ++i) {
    const double lowest_m = array[i] * heights.scale;
    if (lowest_m >= terrain[i] * metadata->terrain->scale - kSlack_m) continue;
    heights.above_ground = true;
    metadata->assumptions.push_back(absl::StrCat(
        "The heights ", heights.name, " are above the ground, because they are below the terrain ",
        metadata->terrain->variable.name, " otherwise."));
    break;
  }
  return absl::OkStatus();
}

// Returns the only group with fields, or the root.
absl::StatusOr<std::string> GroupWithFields(const netcdf::NetcdfFile& file) {
  const auto has_fields = [](const netcdf::NetcdfFile& group) {
    return std::ranges::any_of(Describe(group), [](const CfDescription& variable) {
      return QuantityOf(variable).has_value();
    });
  };
  if (has_fields(file)) return std::string();
  std::vector<std::string> found;
  for (const std::string& name : file.Groups()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const netcdf::NetcdfFile group,
                                 netcdf::NetcdfFile::Open(file.Path(), name));
    const bool inner = !found.empty() && absl::StartsWith(name, found.back() + "/");
    if (!inner && has_fields(group)) found.push_back(name);
  }
  if (found.size() <= 1) return found.empty() ? std::string() : found.front();
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": several groups have hydrometeors (", absl::StrJoin(found, ", "),
                   "); write one of them to a file of its own, for example with ncks -g"));
}

}  // namespace

bool LooksLikeCf(const netcdf::NetcdfFile& file) {
  const auto group = GroupWithFields(file);
  if (!group.ok() || !group->empty()) return true;
  return std::ranges::any_of(Describe(file), [](const CfDescription& variable) {
    return QuantityOf(variable).has_value();
  });
}

absl::StatusOr<CfMetadata> ReadCfMetadata(const netcdf::NetcdfFile& root) {
  THUNDERHEAD_RETURN_IF_ERROR(base::Annotate(LoadUnits(), root.Path()));
  CfMetadata metadata;
  metadata.path = root.Path();
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.group, GroupWithFields(root));
  THUNDERHEAD_ASSIGN_OR_RETURN(const netcdf::NetcdfFile file,
                               netcdf::NetcdfFile::Open(root.Path(), metadata.group));
  const std::vector<CfDescription> variables = Describe(file);
  THUNDERHEAD_RETURN_IF_ERROR(FindFields(file, variables, &metadata));
  if (metadata.fields.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(),
                     ": no variable on x, y and z is a hydrometeor (by standard name, e.g. "
                     "mass_concentration_of_cloud_liquid_water_in_air) or 'extinction' (m-1); "
                     "add one"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(file, &metadata));
  metadata.terrain = FindTerrain(file, metadata.dimensions, metadata.assumptions);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      metadata.heights,
      ReadCfHeights(file, metadata.dimensions, metadata.terrain, metadata.assumptions));
  metadata.order.reversed[2] = metadata.heights.reversed;
  THUNDERHEAD_RETURN_IF_ERROR(CheckArrayAgainstTerrain(file, &metadata));
  THUNDERHEAD_RETURN_IF_ERROR(FindAir(file, variables, &metadata));
  FindWind(file, variables, &metadata);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      CfTimes times,
      ReadCfTimes(file, metadata.fields.front().variable.name, metadata.dimensions.time));
  metadata.times = std::move(times.times);
  THUNDERHEAD_RETURN_IF_ERROR(ReadMoves(file, &metadata));
  for (std::vector<std::string>* more : {&metadata.places.assumptions, &times.assumptions}) {
    metadata.assumptions.insert(metadata.assumptions.end(), more->begin(), more->end());
  }
  metadata.source = file.TextAttribute("", "title").value_or("");
  if (metadata.source.empty()) metadata.source = file.TextAttribute("", "source").value_or("");
  if (const auto cm1 = file.TextAttribute("", "CM1 version"); cm1 && metadata.source.empty()) {
    metadata.source = absl::StrCat("CM1 ", *cm1);
  }
  return metadata;
}

}  // namespace thunderhead::storm_files
