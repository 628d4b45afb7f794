#include "storm_files/cf_metadata.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cell_methods.h"
#include "storm_files/cf_air.h"
#include "storm_files/cf_cells.h"
#include "storm_files/cf_checks.h"
#include "storm_files/cf_members.h"
#include "storm_files/cf_models.h"
#include "storm_files/cf_other_water.h"
#include "storm_files/cf_times.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

std::vector<CfDescription> Describe(const netcdf::NetcdfFile& file) {
  std::vector<CfDescription> descriptions;
  for (const std::string& name : file.Variables()) descriptions.push_back(DescribeCf(file, name));
  return descriptions;
}

absl::Status CheckQuantityUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                                const CfQuantity& quantity) {
  if (quantity.known_units) return absl::OkStatus();
  if (const std::string advice = AdviceOnUnits(file);
      HasNoUnits(variable.units) && !advice.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", variable.name, " has no units; ", advice));
  }
  return WrongUnits(
      file, variable,
      quantity.quantity == volume::Quantity::kExtinction ? "'m-1'" : "'kg kg-1' or 'kg m-3'");
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

bool HoldsAnyOf(const std::vector<CfField>& fields, MixedWater mixed) {
  const std::vector<physics::Hydrometeor> hydrometeors = HydrometeorsIn(mixed);
  return std::ranges::any_of(fields, [&](const CfField& field) {
    return std::ranges::find(hydrometeors, field.quantity.hydrometeor) != hydrometeors.end();
  });
}

// Returns the only field of cloud ice, if the fields have cloud ice and no cloud water.
const CfField* IceWithoutCloud(const std::vector<CfField>& fields) {
  const CfField* ice = nullptr;
  for (const CfField& field : fields) {
    if (field.quantity.hydrometeor == physics::Hydrometeor::kCloud) return nullptr;
    if (field.quantity.hydrometeor == physics::Hydrometeor::kIce) ice = &field;
  }
  return ice;
}

// Adds the hydrometeors that share a variable, unless the file also has one of them alone.
void AddMixtures(const std::vector<CfField>& mixtures, CfMetadata* metadata) {
  std::vector<CfField>& fields = metadata->fields;
  for (const CfField& mixture : mixtures) {
    const std::string& name = mixture.variable.name;
    const CfField* const ice =
        mixture.quantity.liquid_next_to_ice ? IceWithoutCloud(fields) : nullptr;
    if (ice != nullptr) {
      metadata->assumptions.push_back(absl::StrCat(name, " is taken as cloud water alone, because ",
                                                   ice->variable.name, " is the cloud ice."));
      CfField cloud = mixture;
      cloud.quantity.hydrometeor = physics::Hydrometeor::kCloud;
      cloud.quantity.mixed = MixedWater::kNone;
      fields.push_back(std::move(cloud));
      continue;
    }
    if (HoldsAnyOf(fields, mixture.quantity.mixed)) {
      metadata->assumptions.push_back(
          absl::StrCat(name, " is left out, because the file also has the hydrometeors in it."));
      continue;
    }
    for (const physics::Hydrometeor hydrometeor : HydrometeorsIn(mixture.quantity.mixed)) {
      fields.push_back(mixture);
      fields.back().quantity.hydrometeor = hydrometeor;
    }
  }
}

bool IsStratiform(const netcdf::NetcdfFile& file, const std::string& variable) {
  return absl::StrContains(file.TextOrEmpty(variable, "standard_name"), "stratiform");
}

// Leaves out variances and the like of hydrometeors whose amounts the file also has.
void LeaveOutSpreads(const netcdf::NetcdfFile& file, std::vector<CfDescription>& candidates,
                     std::vector<std::string>& assumptions) {
  const std::vector<CfDescription> all = candidates;
  std::erase_if(candidates, [&](const CfDescription& spread) {
    if (!HoldsNoAmount(file, spread.name)) return false;
    const bool has_amounts = std::ranges::any_of(all, [&](const CfDescription& other) {
      return QuantityOf(other)->hydrometeor == QuantityOf(spread)->hydrometeor &&
             !HoldsNoAmount(file, other.name);
    });
    if (!has_amounts) return false;
    assumptions.push_back(absl::StrCat(spread.name, " is left out, because its cell_methods say ",
                                       "that its values are no amounts."));
    return true;
  });
}

// Adds an assumption for each variable on the fields' axes that holds water and is not shown.
void NameOtherWater(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                    CfMetadata* metadata) {
  for (const CfDescription& variable : variables) {
    const std::optional<std::string> why = WhyWaterIsNotShown(variable);
    if (!why.has_value() || !LiesOnAllAxes(file, variable.name, *metadata)) continue;
    metadata->assumptions.push_back(
        absl::StrCat(variable.name, " is left out, because ", *why, "."));
  }
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
  LeaveOutSpreads(file, candidates, metadata->assumptions);
  THUNDERHEAD_RETURN_IF_ERROR(FindAxes(file, candidates, metadata));
  std::vector<CfField> mixtures;
  std::vector<std::string> used;
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
    used.push_back(variable.name);
    if (quantity.mixed != MixedWater::kNone) {
      mixtures.push_back({std::move(arranged), quantity});
      continue;
    }
    const auto same = [&](const CfField& field) {
      return field.quantity.hydrometeor == quantity.hydrometeor &&
             (field.quantity.quantity == volume::Quantity::kExtinction) ==
                 (quantity.quantity == volume::Quantity::kExtinction);
    };
    CfField found{std::move(arranged), quantity};
    if (const auto first = std::ranges::find_if(fields, same); first != fields.end()) {
      // Stratiform cloud is only a part of the cloud.
      if (IsStratiform(file, first->variable.name) && !IsStratiform(file, variable.name)) {
        std::swap(*first, found);
      }
      metadata->assumptions.push_back(
          absl::StrCat(found.variable.name, " is left out, because ", first->variable.name,
                       " is shown as ", std::string(physics::NameOf(quantity.hydrometeor)), "."));
      continue;
    }
    fields.push_back(std::move(found));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckScaleFactors(file, used, metadata->assumptions));
  THUNDERHEAD_RETURN_IF_ERROR(CheckCellMethods(file, used, metadata->assumptions));
  AddMixtures(mixtures, metadata);
  const auto extinction = std::ranges::find_if(fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kExtinction;
  });
  if (extinction != fields.end() && fields.size() > 1) {
    metadata->assumptions.push_back("Only the extinction is used, not the hydrometeors.");
    fields = {CfField(*extinction)};
  } else if (extinction == fields.end()) {
    NameOtherWater(file, variables, metadata);
  }
  std::ranges::stable_sort(fields, {}, [](const CfField& field) {
    return physics::IndexOf(field.quantity.hydrometeor);
  });
  return absl::OkStatus();
}

// Returns the error for a file without fields. It names a variable with water that is not shown.
absl::Status NoFields(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables) {
  std::string other;
  for (const CfDescription& variable : variables) {
    const std::optional<std::string> why = WhyWaterIsNotShown(variable);
    const auto shape = file.Shape(variable.name);
    if (!why.has_value() || !shape.ok() || shape->size() < 3) continue;
    other = absl::StrCat(" (", variable.name, " is none, because ", *why, ")");
    break;
  }
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": no variable on x, y and z is a hydrometeor", other,
                   "; add one with its standard name, e.g. "
                   "mass_concentration_of_cloud_liquid_water_in_air, or 'extinction' (m-1)"));
}

// Places the cells of an unstructured grid, in one row.
absl::Status ReadCells(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  const auto& [cells, row, layers] = metadata->dimensions.axes;
  THUNDERHEAD_ASSIGN_OR_RETURN(
      metadata->places,
      PlaceCells(file, metadata->fields.front().variable.name, metadata->dimensions));
  metadata->x.dimension = cells.name;
  metadata->x.unit = CfAxisUnit::kNone;
  metadata->x.cells = static_cast<int>(cells.length);
  metadata->y = metadata->x;
  metadata->y.cells = 1;
  metadata->order.cells = {cells.length, 1, layers.length};
  return absl::OkStatus();
}

// Reads the horizontal axes. The only cell of an axis is assumed to be as wide as the cells along
// the other axis, if it has no bounds.
absl::Status ReadColumns(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  if (metadata->dimensions.unstructured) return ReadCells(file, metadata);
  const auto& [x_on, y_on, z_on] = metadata->dimensions.axes;
  const auto read = [&](const CfDimension& on, CfDirection direction, double single,
                        CfAxis* axis) -> absl::Status {
    THUNDERHEAD_ASSIGN_OR_RETURN(*axis, ReadHorizontalAxis(file, on, direction, single));
    return absl::OkStatus();
  };
  double single = 0.0;
  if (y_on.length == 1 && x_on.length > 1 && read(x_on, CfDirection::kX, 0.0, &metadata->x).ok()) {
    single = metadata->x.Spacing();
  }
  THUNDERHEAD_RETURN_IF_ERROR(read(y_on, CfDirection::kY, single, &metadata->y));
  THUNDERHEAD_RETURN_IF_ERROR(
      read(x_on, CfDirection::kX, y_on.length > 1 ? metadata->y.Spacing() : 0.0, &metadata->x));
  for (const CfAxis* axis : {&metadata->x, &metadata->y}) {
    std::ranges::copy(axis->assumptions, std::back_inserter(metadata->assumptions));
  }
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
    if (!wind.has_value() || HoldsNoAmount(file, variable.name)) continue;
    const auto shape = file.Shape(variable.name);
    if (!shape.ok() || shape->size() < RankOf(*metadata)) continue;
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

// Decides whether an array of heights counts from the ground, if its name does not say so. It does
// if a height is below the terrain somewhere.
absl::Status CheckArrayAgainstTerrain(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  CfHeights& heights = metadata->heights;
  if (!heights.array.has_value() || heights.above_ground || !metadata->terrain.has_value() ||
      (heights.name != "zhval" && heights.name != "zh" && heights.name != "height") ||
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

// Returns the name of the only group with fields, or an empty text for the root. Returns
// INVALID_ARGUMENT if several groups have fields.
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
  return std::ranges::any_of(Describe(file), [&](const CfDescription& variable) {
    if (QuantityOf(variable).has_value()) return true;
    // The error about such a file names the water that is not shown.
    const auto shape = file.Shape(variable.name);
    return shape.ok() && shape->size() >= 3 && IsStandardNameOfWater(variable.standard_name);
  });
}

absl::StatusOr<CfMetadata> ReadCfMetadata(const netcdf::NetcdfFile& root,
                                          const netcdf::NetcdfFile* heights_file) {
  THUNDERHEAD_RETURN_IF_ERROR(base::Annotate(LoadUnits(), root.Path()));
  CfMetadata metadata;
  metadata.path = root.Path();
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.group, GroupWithFields(root));
  THUNDERHEAD_ASSIGN_OR_RETURN(const netcdf::NetcdfFile file,
                               netcdf::NetcdfFile::Open(root.Path(), metadata.group));
  const std::vector<CfDescription> variables = Describe(file);
  THUNDERHEAD_RETURN_IF_ERROR(FindFields(file, variables, &metadata));
  if (metadata.fields.empty()) return NoFields(file, variables);
  if (const CfDimensions& on = metadata.dimensions; !on.member.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(metadata.members, MemberNames(file, on.member, on.members));
  }
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(file, &metadata));
  metadata.terrain = FindTerrain(file, metadata.dimensions, metadata.assumptions);
  if (heights_file != nullptr) {
    metadata.heights_path = heights_file->Path();
    if (!metadata.terrain.has_value()) {
      metadata.terrain = FindTerrain(*heights_file, metadata.dimensions, metadata.assumptions);
      if (metadata.terrain.has_value()) metadata.terrain->variable.of_heights_file = true;
    }
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      metadata.heights, ReadCfHeights(file, heights_file, metadata.dimensions, metadata.terrain,
                                      metadata.assumptions));
  metadata.order.reversed[2] = metadata.heights.reversed;
  if (const auto& surfaces = metadata.heights.surfaces;
      !metadata.terrain.has_value() && surfaces.size() == 1) {
    metadata.terrain = surfaces.front().surface;
  }
  if (!metadata.terrain.has_value()) metadata.terrain = metadata.heights.ground;
  THUNDERHEAD_RETURN_IF_ERROR(CheckArrayAgainstTerrain(file, &metadata));
  THUNDERHEAD_RETURN_IF_ERROR(FindCfAir(file, variables, &metadata));
  ApplyModel(file, metadata);
  FindWind(file, variables, &metadata);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      CfTimes times,
      ReadCfTimes(file, metadata.fields.front().variable.name, metadata.dimensions.time));
  metadata.times = std::move(times.times);
  metadata.run_start = times.run_start;
  metadata.calendar = times.calendar;
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
