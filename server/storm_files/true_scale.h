// Rewrites map projections in PROJ's notation, so that lengths in their plane are true at the
// middle of a domain. This code is text and arithmetic. PROJ only gives the figure of the Earth.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// The parameters of a projection in PROJ's notation, in their order.
class ProjectionWords {
 public:
  explicit ProjectionWords(std::string_view text);

  // Returns the text of a parameter's value. It is empty if the parameter is missing or has no
  // value.
  std::string Text(std::string_view name) const;
  std::optional<double> Number(std::string_view name) const;
  bool Has(std::string_view name) const;

  // Replaces or adds a parameter. Numbers are written with 12 digits.
  void Set(std::string_view name, const std::string& value);
  void Set(std::string_view name, double value);
  void Remove(std::string_view name);

  std::string Joined() const;

 private:
  std::vector<std::pair<std::string, std::string>> words_;
};

// Returns the parameters that give the Earth's size, such as "+R=6370000". They are empty if the
// projection has none.
std::string EarthOf(std::string_view projection);

// Returns whether the plane coordinates of the projection are degrees of longitude and latitude,
// possibly of a grid with a rotated pole.
bool IsInDegrees(const ProjectionWords& words);

// Returns whether the scale of the projection is the same in all directions at each place.
bool IsConformal(const ProjectionWords& words);

// Returns a projection that differs from `projection` only in its scale, which is 1 at `middle`.
// The latitude of the middle in a grid with a rotated pole is `middle_y_deg`. This works for lcc,
// merc, and polar stere in the hemisphere of its pole, and for eqc on a sphere. For other
// projections it returns `projection` itself. Formulas: Snyder 1987 (USGS Professional Paper 1395),
// equations 15-1 to 15-3 and 14-15, 15-8 and 15-9.
std::string WithTrueScaleAt(const std::string& projection, const volume::EarthPlace& middle,
                            double middle_y_deg);

}  // namespace thunderhead::storm_files
