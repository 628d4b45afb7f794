#include "storm_files/grib_parts.h"

#include <cstdint>
#include <set>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "storm_files/grib_parameters.h"

namespace thunderhead::storm_files {
namespace {

std::string PartText(const grib::Field& field) {
  const std::string_view grid(reinterpret_cast<const char*>(field.grid->data()),
                              field.grid->size());
  const std::string member = GribMemberOf(field);
  return absl::StrCat(GribRunOf(field.origin), member.empty() ? "" : ", ", member, ", grid ",
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

}  // namespace

std::string GribRunOf(const grib::Origin& origin) {
  return absl::StrCat(absl::FormatTime("%Y-%m-%d %H:%M UTC", origin.reference, absl::UTCTimeZone()),
                      ", centre ", origin.centre, "/", origin.subcentre);
}

std::string GribMemberOf(const grib::Field& field) {
  return field.member.has_value() ? absl::StrFormat("mem%02d", *field.member) : "";
}

absl::StatusOr<GribPart> GribPartOf(const grib::Index& index) {
  std::set<absl::Time> times;
  std::set<double> amount_levels;
  std::set<double> temperature_levels;
  std::set<std::string> parts;
  bool is_invariant = true;
  for (const grib::Field& field : index.fields) {
    const GribKind kind = MeaningOf(field.parameter).kind;
    if (!field.is_instant || kind == GribKind::kNone) continue;
    parts.insert(PartText(field));
    if (kind == GribKind::kAmount) amount_levels.insert(field.first.value);
    if (kind == GribKind::kTemperature) temperature_levels.insert(field.first.value);
    if (IsInvariant(field, kind)) continue;
    is_invariant = false;
    times.insert(field.Valid());
  }
  if (parts.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(index.path,
                     ": has no field that a storm needs: hydrometeors, temperature, humidity, "
                     "pressure, heights or wind at one time; give a file with some"));
  }
  GribPart part;
  part.times.assign(times.begin(), times.end());
  if (amount_levels.size() > 1 && temperature_levels.size() > 1) {
    part.kind = GribPartKind::kWhole;
    return part;
  }
  part.kind = is_invariant ? GribPartKind::kInvariant : GribPartKind::kFields;
  part.of = *parts.begin();
  if (parts.size() == 1) return part;
  return absl::InvalidArgumentError(
      absl::StrCat(index.path,
                   ": is a part of a time, but has fields of several runs, members or "
                   "grids; put each into a separate file"));
}

}  // namespace thunderhead::storm_files
