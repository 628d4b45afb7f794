#include "storm_files/cf_arrange.h"

#include <algorithm>
#include <initializer_list>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/status.h"
#include "storm_files/cf_members.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

using Names = std::vector<std::string>;

bool ListHas(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::optional<std::size_t> PlaceIn(const Names& names, const std::string& name) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? std::nullopt
                           : std::optional(static_cast<std::size_t>(at - names.begin()));
}

// Returns the auxiliary coordinates of the field along one dimension, such as CM1's xh(ni). Those
// that the field lists come first.
Names CoordinatesAlong(const netcdf::NetcdfFile& file, const std::string& field,
                       const std::string& dimension) {
  const Names listed = NamesIn(file.TextOrEmpty(field, "coordinates"));
  Names along;
  for (const std::string& name : file.Variables()) {
    const auto on = file.Dimensions(name);
    if (!on.ok() || *on != Names{dimension}) continue;
    along.insert(ListHas(listed, name) ? along.begin() : along.end(), name);
  }
  return along;
}

// Returns whether the field's columns have places one by one, along a single dimension.
bool IsUnstructured(const netcdf::NetcdfFile& file, const std::string& field,
                    const CfDimension& dimension) {
  if (dimension.length == 1) return false;
  const std::string lower = absl::AsciiStrToLower(dimension.name);
  for (const char* name : {"ncells", "cell", "cells", "n_face", "nmesh2d_face"}) {
    if (lower == name) return true;
  }
  bool latitude = false;
  bool longitude = false;
  for (const std::string& name : CoordinatesAlong(file, field, dimension.name)) {
    const CfDescription described = DescribeCf(file, name);
    latitude |= described.standard_name == "latitude" || name == "lat" || name == "clat";
    longitude |= described.standard_name == "longitude" || name == "lon" || name == "clon";
  }
  return latitude && longitude;
}

// Returns the direction of a dimension, or nothing if it is not known. Sets the dimension's
// coordinate variable.
std::optional<CfDirection> FindDirection(const netcdf::NetcdfFile& file, const std::string& field,
                                         CfDimension& dimension) {
  if (file.HasVariable(dimension.name)) {
    dimension.coordinate = dimension.name;
    const CfDescription described = DescribeCf(file, dimension.name);
    if (const auto direction = DirectionOf(described)) return direction;
    if (ConversionOf(described.units, "Pa").has_value()) return CfDirection::kZ;
  }
  for (const std::string& name : CoordinatesAlong(file, field, dimension.name)) {
    const auto direction = DirectionOf(DescribeCf(file, name));
    if (!direction.has_value()) continue;
    // A field's own values along a dimension, such as a profile, are no coordinate.
    const std::string standard_name = file.TextOrEmpty(name, "standard_name");
    if (standard_name.empty() && QuantityOf(DescribeCf(file, name)).has_value()) continue;
    dimension.coordinate = name;
    return direction;
  }
  return DirectionOf({dimension.name, "", "", "", "", ""});
}

// Returns the two dimensions of a longitude, in the file's order, if both are in `among`: the
// field's dimensions whose direction is not known yet.
std::optional<Names> DimensionsOfLongitude(const netcdf::NetcdfFile& file, const Names& among) {
  for (const std::string& name : file.Variables()) {
    const CfDescription described = DescribeCf(file, name);
    const bool longitude = described.standard_name == "longitude" ||
                           DegreesIn(described.units, CfDirection::kX).has_value();
    if (!longitude ||
        (described.standard_name != "longitude" && !described.standard_name.empty())) {
      continue;
    }
    auto on = file.Dimensions(name);
    const auto shape = file.Shape(name);
    if (!on.ok() || !shape.ok()) continue;
    for (std::size_t i = on->size(); i-- > 0;) {
      if ((*shape)[i] == 1 && !ListHas(among, (*on)[i])) on->erase(on->begin() + i);
    }
    if (on->size() == 2 && ListHas(among, (*on)[0]) && ListHas(among, (*on)[1])) return *on;
  }
  return std::nullopt;
}

// Returns whether a dimension holds the points of spectral elements, as in CAM-SE. They are points
// of a quadrature, not cells.
bool IsSpectral(const CfDimension& dimension) {
  return dimension.length != 1 && absl::AsciiStrToLower(dimension.name) == "ncol";
}

absl::Status NoCells(const netcdf::NetcdfFile& file, const std::string& field,
                     const std::string& dimension) {
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", field, " lies on the points '", dimension,
      "' of spectral elements, which are not cells and are not read; remap it to a regular grid of "
      "longitude and latitude first, for example with cdo remapcon or with ncremap"));
}

// Returns the error for a dimension that is not known as x, y, z or time. It may still be one of
// them if `may_be_axis`.
absl::Status ExtraDimension(const netcdf::NetcdfFile& file, const std::string& variable,
                            const std::string& dimension, std::size_t length, bool may_be_axis) {
  std::string message = absl::StrCat(
      file.Path(), ": ", variable, " has a dimension ", dimension, " of ", length,
      " in addition to x, y, z and time, and each storm needs a file of its own; extract one, for "
      "example with ncks -d ",
      dimension, ",0 in.nc out.nc");
  if (may_be_axis) {
    absl::StrAppend(&message, "; if ", dimension,
                    " is x, y, z or time, give its coordinate variable the attribute axis "
                    "(X, Y, Z or T)");
  }
  return absl::InvalidArgumentError(message);
}

}  // namespace

std::vector<std::string> NamesIn(const std::string& attribute) {
  return absl::StrSplit(attribute, absl::ByAnyChar(" \t\n,"), absl::SkipEmpty());
}

CfDescription DescribeCf(const netcdf::NetcdfFile& file, const std::string& variable) {
  const auto text = [&](const char* attribute) { return file.TextOrEmpty(variable, attribute); };
  return {variable,     text("standard_name"), text("units"),
          text("axis"), text("positive"),      text("long_name")};
}

absl::StatusOr<CfDimensions> FindDimensions(const netcdf::NetcdfFile& file,
                                            const std::string& field) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Names names, file.Dimensions(field));
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(field));
  CfDimensions found;
  std::array<bool, 4> has{};  // x, y, z, time
  Names unknown;
  const auto take = [&](CfDirection direction, const CfDimension& dimension) {
    const auto at = static_cast<std::size_t>(direction);
    if (has[at]) return false;
    has[at] = true;
    if (direction == CfDirection::kTime) {
      found.time = dimension.name;
    } else {
      found.axes[at] = dimension;
    }
    return true;
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    CfDimension dimension{names[i], "", shape[i]};
    if (IsSpectral(dimension)) return NoCells(file, field, names[i]);
    if (!has[0] && !has[1] && IsUnstructured(file, field, dimension)) {
      take(CfDirection::kX, dimension);
      take(CfDirection::kY, {dimension.name, "", 1});
      found.unstructured = true;
      continue;
    }
    const auto direction = FindDirection(file, field, dimension);
    if (direction.has_value() && take(*direction, dimension)) continue;
    if (shape[i] == 1 && direction.has_value()) continue;
    unknown.push_back(names[i]);
  }
  const auto length_of = [&](const std::string& name) { return shape[*PlaceIn(names, name)]; };
  if (!has[0] && !has[1]) {
    if (const auto on = DimensionsOfLongitude(file, unknown); on.has_value()) {
      take(CfDirection::kY, {(*on)[0], "", length_of((*on)[0])});
      take(CfDirection::kX, {(*on)[1], "", length_of((*on)[1])});
      std::erase_if(unknown, [&](const std::string& name) { return ListHas(*on, name); });
    }
  }
  for (const std::string& name : unknown) {
    if (length_of(name) == 1) continue;
    if (found.member.empty() && IsMemberDimension(file, name)) {
      found.member = name;
      found.members = length_of(name);
      continue;
    }
    return ExtraDimension(file, field, name, length_of(name), !(has[0] && has[1] && has[2]));
  }
  if (has[0] && has[1] && has[2]) return found;
  const char* lacking = !has[0] ? "x" : !has[1] ? "y" : "z";
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": none of the dimensions (", absl::StrJoin(names, ", "), ") of ",
                   field, " is known as ", lacking,
                   "; name it so, or give its coordinate variable the attribute axis"));
}

absl::StatusOr<CfVariable> Arrange(const netcdf::NetcdfFile& file, const std::string& variable,
                                   const CfDimensions& on) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Names names, file.Dimensions(variable));
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(variable));
  CfVariable arranged;
  arranged.name = variable;
  arranged.dimensions = static_cast<int>(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto place = static_cast<int>(i);
    if (!on.time.empty() && names[i] == on.time) {
      arranged.time = place;
      continue;
    }
    if (!on.member.empty() && names[i] == on.member) {
      arranged.member = place;
      continue;
    }
    const auto axis =
        std::ranges::find(on.axes, names[i], [](const CfDimension& each) { return each.name; });
    if (axis != on.axes.end()) {
      arranged.places[static_cast<std::size_t>(axis - on.axes.begin())] = place;
      if (on.unstructured && axis == on.axes.begin()) arranged.places[1] = place;
      continue;
    }
    if (shape[i] == 1) continue;
    // This is none of the fields' dimensions. If it has the direction of one of them and is longer
    // by 1, it holds the faces between the cells.
    CfDimension dimension{names[i], "", shape[i]};
    const auto direction = FindDirection(file, variable, dimension);
    const auto at = static_cast<std::size_t>(direction.value_or(CfDirection::kTime));
    if (at > 2 || shape[i] != on.axes[at].length + 1 || arranged.places[at] >= 0) {
      if (at <= 2 && shape[i] == on.axes[at].length && arranged.places[at] < 0) {
        return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", variable, " lies on ",
                                                       names[i], " where the fields lie on ",
                                                       on.axes[at].name, "; put all on one grid"));
      }
      return ExtraDimension(file, variable, names[i], shape[i], false);
    }
    arranged.places[at] = place;
    arranged.more[at] = 1;
  }
  return arranged;
}

absl::StatusOr<std::vector<float>> ReadOnAxes(const netcdf::NetcdfFile& file,
                                              const CfVariable& variable, const CfOrder& order,
                                              std::size_t record) {
  const auto rank = static_cast<std::size_t>(variable.dimensions);
  std::vector<std::size_t> start(rank, 0);
  std::vector<std::size_t> count(rank, 1);
  std::array<std::size_t, 3> lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lengths[axis] = order.cells[axis] + static_cast<std::size_t>(variable.more[axis]);
    // The cells of an unstructured grid are both x and y, with one row of y.
    if (variable.places[axis] < 0) continue;
    std::size_t& along = count[static_cast<std::size_t>(variable.places[axis])];
    along = std::max(along, lengths[axis]);
  }
  if (variable.places[2] >= 0) {
    start[static_cast<std::size_t>(variable.places[2])] = variable.first_level;
  }
  if (variable.time >= 0) start[static_cast<std::size_t>(variable.time)] = record;
  if (variable.member >= 0) start[static_cast<std::size_t>(variable.member)] = order.member;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> read,
                               file.ReadPart(variable.name, start, count));
  // Strides of x, y and z in the array that was read. A reversed axis is traversed from its end.
  std::array<std::ptrdiff_t, 3> strides{};
  std::ptrdiff_t origin = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (variable.places[axis] < 0) continue;
    std::ptrdiff_t stride = 1;
    for (auto i = static_cast<std::size_t>(variable.places[axis]) + 1; i < rank; ++i) {
      stride *= static_cast<std::ptrdiff_t>(count[i]);
    }
    if (order.reversed[axis]) origin += stride * (static_cast<std::ptrdiff_t>(lengths[axis]) - 1);
    strides[axis] = order.reversed[axis] ? -stride : stride;
  }
  std::vector<float> values(lengths[0] * lengths[1] * lengths[2]);
  std::size_t to = 0;
  for (std::size_t z = 0; z < lengths[2]; ++z) {
    for (std::size_t y = 0; y < lengths[1]; ++y) {
      std::ptrdiff_t from = origin + static_cast<std::ptrdiff_t>(z) * strides[2] +
                            static_cast<std::ptrdiff_t>(y) * strides[1];
      for (std::size_t x = 0; x < lengths[0]; ++x, from += strides[0]) {
        values[to++] = read[static_cast<std::size_t>(from)];
      }
    }
  }
  return values;
}

}  // namespace thunderhead::storm_files
