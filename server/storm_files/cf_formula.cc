#include "storm_files/cf_formula.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/cf_axes.h"
#include "storm_files/cf_terms.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr const char* kWhatIsNeeded =
    "add heights in m: a coordinate, an array of heights (altitude, HHL, z_ifc), or formula_terms";

absl::Status LacksTerm(const netcdf::NetcdfFile& file, const CfParametric& coordinate,
                       const char* term) {
  const std::string variable = CfTerm(coordinate.terms, term);
  return NoCfHeights(
      file, coordinate.name,
      absl::StrCat("(", coordinate.standard_name, ") needs the formula term ", term,
                   variable.empty() ? "" : absl::StrCat(" (", variable, ")"),
                   ", which the file lacks or which has unsuitable dimensions or units"));
}

// Returns the faces of a term: those in the file, or half-way between the middles.
std::vector<double> FacesOf(const CfTermValues& term, double lowest, double highest) {
  if (!term.faces.empty()) return term.faces;
  std::vector<double> faces = {lowest};
  for (std::size_t i = 1; i < term.middles.size(); ++i) {
    faces.push_back(0.5 * (term.middles[i - 1] + term.middles[i]));
  }
  faces.push_back(highest);
  return faces;
}

std::optional<CfColumnValue> ColumnValue(const netcdf::NetcdfFile& file, const std::string& name,
                                         const CfDimensions& dimensions, const char* unit) {
  if (!file.HasVariable(name)) return std::nullopt;
  const auto variable = Arrange(file, name, dimensions);
  const auto conversion = ConversionOf(file.TextOrEmpty(name, "units"), unit);
  if (!variable.ok() || !conversion.has_value() || variable->places[2] >= 0 ||
      variable->more != std::array<int, 3>{0, 0, 0}) {
    return std::nullopt;
  }
  return CfColumnValue{*variable, conversion->scale};
}

// A term b * surface, before its faces are known.
struct SurfaceValues {
  CfTermValues b;
  CfColumnValue surface;
};

// Returns whether a model must have levels below the lowest one of the file. That level has the
// distances `above_ground` from the ground and `step` from the next level. The lowest level of a
// model is about half a step above the ground.
bool BeginsFarAbove(double above_ground, double step) { return above_ground > step; }

// Keeps the faces of the terms only if all terms have faces. Otherwise removes them, and adds the
// assumption that faces are half-way between the middles of layers. Returns an error for a single
// layer, which has no such faces.
absl::Status AgreeOnFaces(const netcdf::NetcdfFile& file, const CfParametric& coordinate,
                          const std::vector<CfTermValues*>& terms,
                          std::vector<std::string>& assumptions) {
  if (std::ranges::none_of(terms, [](const CfTermValues* each) { return each->faces.empty(); })) {
    return absl::OkStatus();
  }
  if (terms.front()->middles.size() == 1) {
    return NoCfHeights(
        file, coordinate.name,
        "has one layer, and its terms have no bounds, so its thickness is not known");
  }
  for (CfTermValues* term : terms) term->faces.clear();
  assumptions.push_back(absl::StrCat("The interfaces between the layers of ", coordinate.name,
                                     " are half-way between their middles, because its terms have "
                                     "no bounds."));
  return absl::OkStatus();
}

// Returns the heights z = a + the sum of b * surface, with a in m. If the terms have no bounds, the
// lowest and the highest face are assumed. The lowest face is the ground, or half a step below the
// lowest level if that level is far above the ground. The highest face has the same height in all
// columns, half a step above the highest level.
absl::StatusOr<CfHeights> LinearHeights(const netcdf::NetcdfFile& file,
                                        const CfParametric& coordinate, CfTermValues a,
                                        std::vector<SurfaceValues> surfaces,
                                        std::vector<std::string>& assumptions) {
  std::vector<CfTermValues*> terms = {&a};
  for (SurfaceValues& each : surfaces) terms.push_back(&each.b);
  THUNDERHEAD_RETURN_IF_ERROR(AgreeOnFaces(file, coordinate, terms, assumptions));
  CfHeights heights;
  heights.kind = CfHeightKind::kLinear;
  heights.name = coordinate.name;
  heights.reversed = a.middles.front() > a.middles.back();
  const bool faces_fall = !a.faces.empty() && a.faces.front() > a.faces.back();
  for (CfTermValues* term : terms) {
    if (heights.reversed) std::ranges::reverse(term->middles);
    if (a.faces.empty() ? heights.reversed : faces_fall) std::ranges::reverse(term->faces);
  }
  const std::size_t last = a.middles.size() - 1;
  const double top = last > 0 ? 1.5 * a.middles[last] - 0.5 * a.middles[last - 1] : 0.0;
  const bool is_far = last > 0 && BeginsFarAbove(a.middles[0], a.middles[1] - a.middles[0]);
  const auto lowest = [&](const CfTermValues& term, double ground) {
    return is_far ? 1.5 * term.middles[0] - 0.5 * term.middles[1] : ground;
  };
  heights.a = FacesOf(a, lowest(a, 0.0), top);
  for (SurfaceValues& each : surfaces) {
    heights.surfaces.push_back(
        {FacesOf(each.b, lowest(each.b, 1.0), 0.0), std::move(each.surface)});
  }
  return heights;
}

// Reads z = a + b * orog (hybrid height), with a in m.
absl::StatusOr<CfHeights> ReadHybridHeight(const netcdf::NetcdfFile& file,
                                           const CfParametric& coordinate, const CfDimension& z,
                                           const std::optional<CfColumnValue>& terrain,
                                           std::vector<std::string>& assumptions) {
  for (const char* term : {"a", "b"}) {
    if (!file.HasVariable(CfTerm(coordinate.terms, term))) return LacksTerm(file, coordinate, term);
  }
  if (!terrain.has_value()) return LacksTerm(file, coordinate, "orog");
  const auto metres = MetresIn(file.TextOrEmpty(CfTerm(coordinate.terms, "a"), "units"));
  if (!metres.has_value()) return LacksTerm(file, coordinate, "a");
  THUNDERHEAD_ASSIGN_OR_RETURN(CfTermValues a, ReadCfTerm(file, coordinate, "a", z, *metres));
  THUNDERHEAD_ASSIGN_OR_RETURN(CfTermValues b, ReadCfTerm(file, coordinate, "b", z, 1.0));
  return LinearHeights(file, coordinate, std::move(a), {{std::move(b), *terrain}}, assumptions);
}

// Returns the only value of a variable, in m. Returns nothing if the variable has several values or
// a value that is not above 0.
std::optional<double> HeightOfTop(const netcdf::NetcdfFile& file, const std::string& name) {
  if (!file.HasVariable(name)) return std::nullopt;
  const auto values = file.ReadDoubles(name);
  const auto metres = MetresIn(file.TextOrEmpty(name, "units"));
  if (!values.ok() || values->size() != 1 || !metres.has_value()) return std::nullopt;
  const double top_m = values->front() * *metres;
  return top_m > 0.0 ? std::optional(top_m) : std::nullopt;
}

// Reads z = a ztop + b1 zsurf1 + b2 zsurf2 (smooth level vertical coordinate, SLEVE).
absl::StatusOr<CfHeights> ReadSleve(const netcdf::NetcdfFile& file, const CfParametric& coordinate,
                                    const CfDimensions& dimensions,
                                    std::vector<std::string>& assumptions) {
  const auto read = [&](const char* term, double scale) -> absl::StatusOr<CfTermValues> {
    if (!file.HasVariable(CfTerm(coordinate.terms, term))) return LacksTerm(file, coordinate, term);
    return ReadCfTerm(file, coordinate, term, dimensions.axes[2], scale);
  };
  const std::optional<double> top_m = HeightOfTop(file, CfTerm(coordinate.terms, "ztop"));
  if (!top_m.has_value()) return LacksTerm(file, coordinate, "ztop");
  THUNDERHEAD_ASSIGN_OR_RETURN(CfTermValues a, read("a", *top_m));
  std::vector<SurfaceValues> surfaces;
  for (const auto& [b, surface] : {std::pair{"b1", "zsurf1"}, std::pair{"b2", "zsurf2"}}) {
    THUNDERHEAD_ASSIGN_OR_RETURN(CfTermValues values, read(b, 1.0));
    auto column = ColumnValue(file, CfTerm(coordinate.terms, surface), dimensions, "m");
    if (!column.has_value()) return LacksTerm(file, coordinate, surface);
    surfaces.push_back({std::move(values), *std::move(column)});
  }
  return LinearHeights(file, coordinate, std::move(a), std::move(surfaces), assumptions);
}

// Returns z = s + ground (1 - s / top): terrain-following heights of Gal-Chen and Somerville.
absl::StatusOr<CfHeights> GalChenHeights(const netcdf::NetcdfFile& file,
                                         const CfParametric& coordinate, CfTermValues s,
                                         double top_m, CfColumnValue ground,
                                         std::vector<std::string>& assumptions) {
  CfTermValues b;
  for (const double each : s.middles) b.middles.push_back(1.0 - each / top_m);
  for (const double each : s.faces) b.faces.push_back(1.0 - each / top_m);
  return LinearHeights(file, coordinate, std::move(s), {{std::move(b), std::move(ground)}},
                       assumptions);
}

// Reads Meso-NH's z = s + orog (1 - s / height).
absl::StatusOr<CfHeights> ReadMesoNh(const netcdf::NetcdfFile& file, const CfParametric& coordinate,
                                     const CfDimensions& dimensions,
                                     std::vector<std::string>& assumptions) {
  const std::optional<double> top_m = HeightOfTop(file, CfTerm(coordinate.terms, "height"));
  if (!top_m.has_value()) return LacksTerm(file, coordinate, "height");
  auto ground = ColumnValue(file, CfTerm(coordinate.terms, "orog"), dimensions, "m");
  if (!ground.has_value()) return LacksTerm(file, coordinate, "orog");
  const std::string name = CfTerm(coordinate.terms, "s");
  if (!file.HasVariable(name)) return LacksTerm(file, coordinate, "s");
  const double metres = MetresIn(file.TextOrEmpty(name, "units")).value_or(1.0);
  THUNDERHEAD_ASSIGN_OR_RETURN(CfTermValues s,
                               ReadCfTerm(file, coordinate, "s", dimensions.axes[2], metres));
  return GalChenHeights(file, coordinate, std::move(s), *top_m, *std::move(ground), assumptions);
}

// The terms of a pressure a + b * surface pressure, with a in Pa.
struct PressureTerms {
  CfTermValues a;
  CfTermValues b;

  double Middle_Pa(std::size_t layer, double surface_Pa) const {
    return a.middles[layer] + b.middles[layer] * surface_Pa;
  }
  double Face_Pa(std::size_t face, double surface_Pa) const {
    return a.faces[face] + b.faces[face] * surface_Pa;
  }
};

absl::StatusOr<PressureTerms> ReadPressureTerms(const netcdf::NetcdfFile& file,
                                                const CfParametric& coordinate,
                                                const CfDimension& z) {
  const auto number = [&](const char* term) -> std::optional<double> {
    const std::string name = CfTerm(coordinate.terms, term);
    if (!file.HasVariable(name)) return std::nullopt;
    const auto values = file.ReadDoubles(name);
    const auto conversion = ConversionOf(file.TextOrEmpty(name, "units"), "Pa");
    if (!values.ok() || values->size() != 1 || !conversion.has_value()) return std::nullopt;
    return (*conversion)((*values)[0]);
  };
  const bool sigma = coordinate.standard_name == "atmosphere_sigma_coordinate";
  const char* const share = sigma ? "sigma" : "b";
  if (!file.HasVariable(CfTerm(coordinate.terms, share))) return LacksTerm(file, coordinate, share);
  PressureTerms terms;
  THUNDERHEAD_ASSIGN_OR_RETURN(terms.b, ReadCfTerm(file, coordinate, share, z, 1.0));
  if (sigma) {
    const auto top_Pa = number("ptop");
    if (!top_Pa.has_value()) return LacksTerm(file, coordinate, "ptop");
    // p = ptop + sigma (ps - ptop)
    for (const double each : terms.b.middles) terms.a.middles.push_back(*top_Pa * (1.0 - each));
    for (const double each : terms.b.faces) terms.a.faces.push_back(*top_Pa * (1.0 - each));
    return terms;
  }
  if (const std::string ap = CfTerm(coordinate.terms, "ap"); file.HasVariable(ap)) {
    const auto pascal = ConversionOf(file.TextOrEmpty(ap, "units"), "Pa");
    if (!pascal.has_value()) return LacksTerm(file, coordinate, "ap");
    THUNDERHEAD_ASSIGN_OR_RETURN(terms.a, ReadCfTerm(file, coordinate, "ap", z, pascal->scale));
    return terms;
  }
  if (!file.HasVariable(CfTerm(coordinate.terms, "a"))) return LacksTerm(file, coordinate, "ap");
  const auto p0_Pa = number("p0");
  if (!p0_Pa.has_value()) return LacksTerm(file, coordinate, "p0");
  THUNDERHEAD_ASSIGN_OR_RETURN(terms.a, ReadCfTerm(file, coordinate, "a", z, *p0_Pa));
  return terms;
}

// Reads p = ap + b * ps (hybrid sigma pressure) or its forms with p0 and ptop.
absl::StatusOr<CfHeights> ReadHybridPressure(const netcdf::NetcdfFile& file,
                                             const CfParametric& coordinate,
                                             const CfDimensions& dimensions,
                                             std::vector<std::string>& assumptions) {
  const std::size_t layers = dimensions.axes[2].length;
  THUNDERHEAD_ASSIGN_OR_RETURN(PressureTerms terms,
                               ReadPressureTerms(file, coordinate, dimensions.axes[2]));
  auto& [a, b] = terms;
  CfHeights heights;
  heights.kind = CfHeightKind::kPressure;
  heights.name = coordinate.name;
  heights.surface_pressure = ColumnValue(file, CfTerm(coordinate.terms, "ps"), dimensions, "Pa");
  if (!heights.surface_pressure.has_value()) return LacksTerm(file, coordinate, "ps");
  THUNDERHEAD_RETURN_IF_ERROR(AgreeOnFaces(file, coordinate, {&a, &b}, assumptions));
  // Pressure falls upwards.
  constexpr double kSurface_Pa = 1e5;
  heights.reversed = terms.Middle_Pa(0, kSurface_Pa) < terms.Middle_Pa(layers - 1, kSurface_Pa);
  if (heights.reversed) {
    for (auto* values : {&a.middles, &b.middles}) std::ranges::reverse(*values);
  }
  const bool has_faces = !a.faces.empty();
  if (has_faces && terms.Face_Pa(0, kSurface_Pa) < terms.Face_Pa(layers, kSurface_Pa)) {
    for (auto* values : {&a.faces, &b.faces}) std::ranges::reverse(*values);
  }
  // If the file has faces, the lowest one must be the ground, apart from rounding.
  constexpr double kRounding = 0.1;
  const bool is_far =
      has_faces ? kSurface_Pa - terms.Face_Pa(0, kSurface_Pa) >
                      kRounding * (terms.Face_Pa(0, kSurface_Pa) - terms.Face_Pa(1, kSurface_Pa))
                : BeginsFarAbove(kSurface_Pa - terms.Middle_Pa(0, kSurface_Pa),
                                 terms.Middle_Pa(0, kSurface_Pa) - terms.Middle_Pa(1, kSurface_Pa));
  if (is_far) {
    return NoCfHeights(file, coordinate.name,
                       "begins far above the ground, and the heights of its levels follow from all "
                       "levels below; give a file with all levels");
  }
  // Without bounds, the lowest face is the ground. The highest face is as far from the last middle
  // as the face below it.
  heights.a = FacesOf(a, 0.0, 0.0);
  heights.b = FacesOf(b, 1.0, 0.0);
  if (!has_faces) {
    heights.a.back() = std::max(0.0, 2.0 * a.middles[layers - 1] - heights.a[layers - 1]);
    heights.b.back() = std::max(0.0, 2.0 * b.middles[layers - 1] - heights.b[layers - 1]);
  }
  heights.a_middle = std::move(a.middles);
  heights.b_middle = std::move(b.middles);
  return heights;
}

absl::StatusOr<CfHeights> ReadParametric(const netcdf::NetcdfFile& file,
                                         const CfParametric& coordinate,
                                         const CfDimensions& dimensions,
                                         const std::optional<CfColumnValue>& terrain,
                                         std::vector<std::string>& assumptions) {
  if (coordinate.standard_name == "atmosphere_hybrid_height_coordinate") {
    auto orography = terrain;
    if (auto term = ColumnValue(file, CfTerm(coordinate.terms, "orog"), dimensions, "m")) {
      orography = term;
    }
    return ReadHybridHeight(file, coordinate, dimensions.axes[2], orography, assumptions);
  }
  if (coordinate.standard_name == "atmosphere_sleve_coordinate") {
    return ReadSleve(file, coordinate, dimensions, assumptions);
  }
  if (coordinate.standard_name.empty() && coordinate.terms.contains("s") &&
      coordinate.terms.contains("height")) {
    return ReadMesoNh(file, coordinate, dimensions, assumptions);
  }
  if (coordinate.standard_name == "atmosphere_hybrid_sigma_pressure_coordinate" ||
      coordinate.standard_name == "atmosphere_sigma_coordinate") {
    return ReadHybridPressure(file, coordinate, dimensions, assumptions);
  }
  return NoCfHeights(
      file, coordinate.name,
      absl::StrCat("is the ",
                   coordinate.standard_name.empty() ? std::string("coordinate of a model")
                                                    : coordinate.standard_name,
                   ", whose formula is not read here"));
}

// Returns whether CM1 wrote the file: it has CM1's version, or the coordinates of CM1's scalars and
// faces.
bool IsCm1(const netcdf::NetcdfFile& file) {
  for (const char* attribute : {"CM1 version", "CM1_version"}) {
    if (file.TextAttribute("", attribute).has_value()) return true;
  }
  return std::ranges::all_of(std::array{"xh", "xf", "yh", "yf", "zf"},
                             [&](const char* name) { return file.HasVariable(name); });
}

// Returns CM1's nominal heights at the faces, in m, or an empty array.
std::vector<double> NominalFaces_m(const netcdf::NetcdfFile& file) {
  const auto shape = file.Shape("zf");
  const auto metres = MetresIn(file.TextOrEmpty("zf", "units"));
  if (!shape.ok() || shape->size() != 1 || !metres.has_value()) return {};
  auto faces_m = file.ReadDoubles("zf");
  if (!faces_m.ok()) return {};
  for (double& each : *faces_m) each *= *metres;
  return *std::move(faces_m);
}

}  // namespace

absl::Status NoCfHeights(const netcdf::NetcdfFile& file, const std::string& name,
                         const std::string& why) {
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": the vertical coordinate ", name, " ", why, "; ", kWhatIsNeeded));
}

absl::StatusOr<std::optional<CfHeights>> ReadFormulaHeights(
    const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
    const std::optional<CfColumnValue>& terrain, std::vector<std::string>& assumptions) {
  const auto parametric = FindCfParametric(file, dimensions);
  if (!parametric.has_value()) return std::optional<CfHeights>();
  THUNDERHEAD_ASSIGN_OR_RETURN(CfHeights heights,
                               ReadParametric(file, *parametric, dimensions, terrain, assumptions));
  assumptions.push_back(
      heights.kind == CfHeightKind::kLinear
          ? absl::StrCat("The heights of the layers follow from ", heights.name,
                         " and the terrain.")
          : absl::StrCat("The heights of the layers follow from ", heights.name,
                         ", temperature and humidity by the hydrostatic equation."));
  return std::optional(std::move(heights));
}

absl::StatusOr<std::optional<CfHeights>> ReadCm1Heights(const netcdf::NetcdfFile& file,
                                                        const CfDimensions& dimensions,
                                                        const std::optional<CfColumnValue>& terrain,
                                                        std::vector<std::string>& assumptions) {
  const CfDimension& z = dimensions.axes[2];
  if (!terrain.has_value() || !IsCm1(file)) return std::optional<CfHeights>();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> ground,
                               file.ReadDoubles(terrain->variable.name));
  const auto is_flat = [](double height) { return height == 0.0 || std::isnan(height); };
  if (std::ranges::all_of(ground, is_flat)) return std::optional<CfHeights>();
  THUNDERHEAD_ASSIGN_OR_RETURN(CfAxis axis, ReadHeightAxis(file, z));
  CfTermValues nominal;
  nominal.faces = NominalFaces_m(file);
  std::optional<double> top_m = HeightOfTop(file, "ztop");
  if (!top_m.has_value() && !nominal.faces.empty()) {
    top_m = std::max(nominal.faces.front(), nominal.faces.back());
    assumptions.push_back(
        absl::StrFormat("The model's top is at %g m, the last value of zf.", *top_m));
  }
  if (!top_m.has_value()) {
    return NoCfHeights(
        file, z.coordinate,
        absl::StrCat("holds CM1's nominal heights, and over the terrain ", terrain->variable.name,
                     " they need the height of the model's top: add zhval, zf or "
                     "ztop"));
  }
  // If the file has no usable faces, takes those that the axis has around the nominal heights. The
  // axis has put them in ascending order.
  if (nominal.faces.size() != z.length + 1) nominal.faces = std::move(axis.faces);
  if (nominal.faces.front() > nominal.faces.back()) std::ranges::reverse(nominal.faces);
  for (std::size_t i = 0; i < z.length; ++i) {
    nominal.middles.push_back(0.5 * (nominal.faces[i] + nominal.faces[i + 1]));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(CfHeights heights,
                               GalChenHeights(file, {z.coordinate, "", {}, {}}, std::move(nominal),
                                              *top_m, *terrain, assumptions));
  heights.reversed = axis.reversed;
  assumptions.push_back(absl::StrCat("The heights of the layers follow from CM1's nominal heights ",
                                     z.coordinate, " and the terrain ", terrain->variable.name,
                                     "."));
  return std::optional(std::move(heights));
}

}  // namespace thunderhead::storm_files
