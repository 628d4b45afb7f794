#include "storm_files/grib_parts.h"

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "storm_files/grib_parameters.h"

namespace thunderhead::storm_files {
namespace {

std::string PartText(const grib::Field& field) {
  const std::string_view grid(reinterpret_cast<const char*>(field.grid->data()),
                              field.grid->size());
  return absl::StrCat(GribRunOf(field.origin), ", grid ",
                      absl::BytesToHexString(absl::string_view(grid.data(), grid.size())));
}

// Returns whether the field does not change with time: a height on levels, the ground's height, or
// the places of cells.
bool IsInvariant(const grib::Field& field, GribKind kind) {
  constexpr int kAtGround = 1;
  return kind == GribKind::kGeometricHeight || kind == GribKind::kCellLatitude ||
         kind == GribKind::kCellLongitude ||
         ((kind == GribKind::kGeopotential || kind == GribKind::kGeopotentialHeight) &&
          field.first.type == kAtGround);
}

// Returns the error for a forecast time whose unit has no known length.
absl::Status RefuseUnit(const std::string& path, const grib::Field& field) {
  constexpr int kMonth = 3;
  constexpr int kCentury = 7;
  const int unit = *field.unknown_unit;
  const char* what = unit == kMonth                      ? "months, whose lengths differ"
                     : unit > kMonth && unit <= kCentury ? "years, whose lengths differ"
                                                         : "a unit that is not known";
  return absl::InvalidArgumentError(absl::StrCat(
      path, ": the field ", grib::NumbersOf(field.parameter), " in the GRIB message at byte ",
      field.message_offset, " has its forecast time in ", what, " (code table 4.4, unit ", unit,
      "); give it in hours, for example with grib_set -s "
      "indicatorOfUnitOfTimeRange=1,forecastTime=HOURS"));
}

}  // namespace

std::string GribRunOf(const grib::Origin& origin) {
  return absl::StrCat(absl::FormatTime("%Y-%m-%d %H:%M UTC", origin.reference, absl::UTCTimeZone()),
                      ", centre ", origin.centre, "/", origin.subcentre);
}

std::string GribMemberOf(std::optional<int> member) {
  return member.has_value() ? absl::StrFormat("mem%02d", *member) : "";
}

absl::StatusOr<std::vector<GribPart>> GribPartsOf(const grib::Index& index) {
  std::set<double> amount_levels;
  std::set<double> temperature_levels;
  struct Contents {
    std::set<absl::Time> times;
    bool is_invariant = true;
  };
  using ByMember = std::map<std::string, Contents>;
  std::map<std::string, ByMember> parts;
  // The text of a grid may be long, and many fields of a message may share one.
  const grib::Field* last = nullptr;
  ByMember* parts_of_last = nullptr;
  for (const grib::Field& field : index.fields) {
    const GribKind kind = MeaningOf(field.parameter).kind;
    if (field.unknown_unit.has_value() && kind != GribKind::kNone) {
      return RefuseUnit(index.path, field);
    }
    if (!field.is_instant || kind == GribKind::kNone || IsOfLand(kind)) continue;
    if (kind == GribKind::kAmount) amount_levels.insert(field.first.value);
    if (kind == GribKind::kTemperature) temperature_levels.insert(field.first.value);
    if (last == nullptr || last->grid != field.grid || last->origin != field.origin) {
      parts_of_last = &parts[PartText(field)];
    }
    last = &field;
    Contents& part = (*parts_of_last)[GribMemberOf(field.member)];
    if (IsInvariant(field, kind)) continue;
    part.is_invariant = false;
    part.times.insert(field.Valid());
  }
  if (parts.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(index.path,
                     ": has no field that a storm needs: hydrometeors, temperature, humidity, "
                     "pressure, heights or wind at one time; give a file with some"));
  }
  if (amount_levels.size() > 1 && temperature_levels.size() > 1) {
    return std::vector<GribPart>{{.kind = GribPartKind::kWhole}};
  }
  std::vector<GribPart> found;
  for (const auto& [of, members] : parts) {
    for (const auto& [member, part] : members) {
      found.push_back({.kind = part.is_invariant ? GribPartKind::kInvariant : GribPartKind::kFields,
                       .of = of,
                       .member = member,
                       .times = {part.times.begin(), part.times.end()}});
    }
  }
  return found;
}

}  // namespace thunderhead::storm_files
