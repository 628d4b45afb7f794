#include "storm_files/cf_heights.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cf_height_array.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr const char* kWhatIsNeeded =
    "add heights in m: a coordinate, an array of heights (altitude, HHL, z_ifc), or formula_terms";

absl::Status NoHeights(const netcdf::NetcdfFile& file, const std::string& name,
                       const std::string& why) {
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": the vertical coordinate ", name, " ", why, "; ", kWhatIsNeeded));
}

using Terms = std::map<std::string, std::string>;

// Returns the variables of a formula_terms attribute by their terms.
Terms TermsOf(const std::string& attribute) {
  Terms terms;
  const std::vector<std::string> words = NamesIn(attribute);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (!absl::EndsWith(words[i], ":")) continue;
    terms[absl::AsciiStrToLower(absl::StripSuffix(words[i], ":"))] = words[i + 1];
  }
  return terms;
}

// The values of a term along z, in the order of the file.
struct TermValues {
  std::vector<double> middles;
  std::vector<double> faces;  // empty if the file has none
};

// Reads a term that is a number or lies along z. Its faces are its bounds, or the variable of the
// same term for the coordinate of the faces.
absl::StatusOr<TermValues> ReadTerm(const netcdf::NetcdfFile& file, const std::string& name,
                                    const std::string& name_at_faces, std::size_t layers,
                                    double scale) {
  TermValues term;
  THUNDERHEAD_ASSIGN_OR_RETURN(term.middles, file.ReadDoubles(name));
  if (term.middles.size() == 1) term.middles.resize(layers, term.middles.front());
  if (term.middles.size() != layers) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", name,
                                                   ", a formula term, has ", term.middles.size(),
                                                   " values for ", layers, " layers"));
  }
  if (!name_at_faces.empty() && file.HasVariable(name_at_faces)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(term.faces, file.ReadDoubles(name_at_faces));
    if (term.faces.size() == 1) term.faces.resize(layers + 1, term.faces.front());
    if (term.faces.size() != layers + 1) term.faces.clear();
  }
  if (term.faces.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(term.faces, ReadBounds(file, name, layers, 0.0));
  }
  for (double& value : term.middles) value *= scale;
  for (double& value : term.faces) value *= scale;
  return term;
}

// A parametric coordinate and, if the file has it, that of the faces between its layers.
struct Parametric {
  std::string name;
  std::string standard_name;
  Terms terms;
  Terms terms_at_faces;
};

std::optional<Parametric> FindParametric(const netcdf::NetcdfFile& file,
                                         const CfDimensions& dimensions) {
  const CfDimension& z = dimensions.axes[2];
  std::optional<Parametric> found;
  Terms at_faces;
  for (const std::string& name : file.Variables()) {
    const std::string terms = file.TextOrEmpty(name, "formula_terms");
    const auto on = file.Dimensions(name);
    const auto shape = file.Shape(name);
    if (terms.empty() || !on.ok() || !shape.ok() || on->size() != 1) continue;
    if ((*on)[0] == z.name && !found.has_value()) {
      found = Parametric{name, file.TextOrEmpty(name, "standard_name"), TermsOf(terms), {}};
      // Bounds have formula_terms of their own.
      const std::string bounds = file.TextOrEmpty(name, "bounds");
      if (at_faces.empty() && !bounds.empty() && file.HasVariable(bounds)) {
        found->terms_at_faces = TermsOf(file.TextOrEmpty(bounds, "formula_terms"));
      }
    } else if ((*shape)[0] == z.length + 1) {
      at_faces = TermsOf(terms);
    }
  }
  if (found.has_value() && !at_faces.empty()) found->terms_at_faces = at_faces;
  return found;
}

// Returns the variable of a term, or an empty text.
std::string Term(const Terms& terms, const char* name) {
  const auto found = terms.find(name);
  return found == terms.end() ? "" : found->second;
}

absl::Status LacksTerm(const netcdf::NetcdfFile& file, const Parametric& coordinate,
                       const char* term) {
  const std::string variable = Term(coordinate.terms, term);
  return NoHeights(file, coordinate.name,
                   absl::StrCat("(", coordinate.standard_name, ") needs the formula term ", term,
                                variable.empty() ? "" : absl::StrCat(" (", variable, ")"),
                                ", which the file lacks"));
}

// Returns the faces of a term: those in the file, or half-way between the middles.
std::vector<double> FacesOf(const TermValues& term, double lowest, double highest) {
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
  TermValues b;
  CfColumnValue surface;
};

// Returns whether levels begin so far above the ground that there must be others below. Then
// `above_ground`, the distance of the lowest level, is large against `step`, that to the next.
bool BeginsFarAbove(double above_ground, double step) {
  constexpr double kFar = 1.5;
  return above_ground > kFar * step;
}

// Returns z = a + the sum of b * surface, with a in m. The lowest face is the ground, unless the
// levels begin far above it. The highest is flat.
CfHeights LinearHeights(const Parametric& coordinate, TermValues a,
                        std::vector<SurfaceValues> surfaces) {
  CfHeights heights;
  heights.kind = CfHeightKind::kLinear;
  heights.name = coordinate.name;
  heights.reversed = a.middles.front() > a.middles.back();
  const auto upwards = [&](TermValues& term) {
    if (!heights.reversed) return;
    std::ranges::reverse(term.middles);
    std::ranges::reverse(term.faces);
  };
  upwards(a);
  const std::size_t last = a.middles.size() - 1;
  const double top =
      last > 0 ? 1.5 * a.middles[last] - 0.5 * a.middles[last - 1] : 2.0 * a.middles[last];
  const bool is_far = last > 0 && BeginsFarAbove(a.middles[0], a.middles[1] - a.middles[0]);
  const auto lowest = [&](const TermValues& term, double ground) {
    return is_far ? 1.5 * term.middles[0] - 0.5 * term.middles[1] : ground;
  };
  heights.a = FacesOf(a, lowest(a, 0.0), top);
  for (SurfaceValues& each : surfaces) {
    upwards(each.b);
    heights.surfaces.push_back(
        {FacesOf(each.b, lowest(each.b, 1.0), 0.0), std::move(each.surface)});
  }
  return heights;
}

// Reads z = a + b * orog (hybrid height), with a in m.
absl::StatusOr<CfHeights> ReadHybridHeight(const netcdf::NetcdfFile& file,
                                           const Parametric& coordinate, std::size_t layers,
                                           const std::optional<CfColumnValue>& terrain) {
  for (const char* term : {"a", "b"}) {
    if (!file.HasVariable(Term(coordinate.terms, term))) return LacksTerm(file, coordinate, term);
  }
  if (!terrain.has_value()) return LacksTerm(file, coordinate, "orog");
  const std::string a_name = Term(coordinate.terms, "a");
  const auto metres = MetresIn(file.TextOrEmpty(a_name, "units"));
  if (!metres.has_value()) return LacksTerm(file, coordinate, "a");
  THUNDERHEAD_ASSIGN_OR_RETURN(
      TermValues a, ReadTerm(file, a_name, Term(coordinate.terms_at_faces, "a"), layers, *metres));
  THUNDERHEAD_ASSIGN_OR_RETURN(TermValues b,
                               ReadTerm(file, Term(coordinate.terms, "b"),
                                        Term(coordinate.terms_at_faces, "b"), layers, 1.0));
  return LinearHeights(coordinate, std::move(a), {{std::move(b), *terrain}});
}

// Returns the only value of a term in m.
std::optional<double> HeightOfTop(const netcdf::NetcdfFile& file, const std::string& name) {
  if (!file.HasVariable(name)) return std::nullopt;
  const auto values = file.ReadDoubles(name);
  const auto metres = MetresIn(file.TextOrEmpty(name, "units"));
  if (!values.ok() || values->size() != 1 || !metres.has_value()) return std::nullopt;
  const double top_m = values->front() * *metres;
  return top_m > 0.0 ? std::optional(top_m) : std::nullopt;
}

// Reads z = a ztop + b1 zsurf1 + b2 zsurf2 (smooth level vertical coordinate, SLEVE).
absl::StatusOr<CfHeights> ReadSleve(const netcdf::NetcdfFile& file, const Parametric& coordinate,
                                    const CfDimensions& dimensions) {
  const std::size_t layers = dimensions.axes[2].length;
  const auto read = [&](const char* term, double scale) -> absl::StatusOr<TermValues> {
    const std::string name = Term(coordinate.terms, term);
    if (!file.HasVariable(name)) return LacksTerm(file, coordinate, term);
    return ReadTerm(file, name, Term(coordinate.terms_at_faces, term), layers, scale);
  };
  const std::optional<double> top_m = HeightOfTop(file, Term(coordinate.terms, "ztop"));
  if (!top_m.has_value()) return LacksTerm(file, coordinate, "ztop");
  THUNDERHEAD_ASSIGN_OR_RETURN(TermValues a, read("a", *top_m));
  std::vector<SurfaceValues> surfaces;
  for (const auto& [b, surface] : {std::pair{"b1", "zsurf1"}, std::pair{"b2", "zsurf2"}}) {
    THUNDERHEAD_ASSIGN_OR_RETURN(TermValues values, read(b, 1.0));
    auto column = ColumnValue(file, Term(coordinate.terms, surface), dimensions, "m");
    if (!column.has_value()) return LacksTerm(file, coordinate, surface);
    surfaces.push_back({std::move(values), *std::move(column)});
  }
  return LinearHeights(coordinate, std::move(a), std::move(surfaces));
}

// Reads Meso-NH's z = s + orog (1 - s / height). Its faces are half-way between the layers.
absl::StatusOr<CfHeights> ReadGalChen(const netcdf::NetcdfFile& file, const Parametric& coordinate,
                                      const CfDimensions& dimensions) {
  const std::optional<double> top_m = HeightOfTop(file, Term(coordinate.terms, "height"));
  if (!top_m.has_value()) return LacksTerm(file, coordinate, "height");
  auto ground = ColumnValue(file, Term(coordinate.terms, "orog"), dimensions, "m");
  if (!ground.has_value()) return LacksTerm(file, coordinate, "orog");
  const std::string name = Term(coordinate.terms, "s");
  if (!file.HasVariable(name)) return LacksTerm(file, coordinate, "s");
  const double metres = MetresIn(file.TextOrEmpty(name, "units")).value_or(1.0);
  THUNDERHEAD_ASSIGN_OR_RETURN(TermValues a,
                               ReadTerm(file, name, "", dimensions.axes[2].length, metres));
  TermValues b;
  for (const double each : a.middles) b.middles.push_back(1.0 - each / *top_m);
  for (const double each : a.faces) b.faces.push_back(1.0 - each / *top_m);
  return LinearHeights(coordinate, std::move(a), {{std::move(b), *std::move(ground)}});
}

// Reads p = ap + b * ps (hybrid sigma pressure) or its forms with p0 and ptop.
absl::StatusOr<CfHeights> ReadHybridPressure(const netcdf::NetcdfFile& file,
                                             const Parametric& coordinate,
                                             const CfDimensions& dimensions) {
  const std::size_t layers = dimensions.axes[2].length;
  const auto number = [&](const char* term) -> std::optional<double> {
    const std::string name = Term(coordinate.terms, term);
    if (!file.HasVariable(name)) return std::nullopt;
    const auto values = file.ReadDoubles(name);
    const auto conversion = ConversionOf(file.TextOrEmpty(name, "units"), "Pa");
    if (!values.ok() || values->size() != 1 || !conversion.has_value()) return std::nullopt;
    return (*conversion)((*values)[0]);
  };
  TermValues a;
  TermValues b;
  const bool sigma = coordinate.standard_name == "atmosphere_sigma_coordinate";
  const std::string b_name = Term(coordinate.terms, sigma ? "sigma" : "b");
  if (!file.HasVariable(b_name)) return LacksTerm(file, coordinate, sigma ? "sigma" : "b");
  THUNDERHEAD_ASSIGN_OR_RETURN(
      b,
      ReadTerm(file, b_name, Term(coordinate.terms_at_faces, sigma ? "sigma" : "b"), layers, 1.0));
  if (sigma) {
    const auto top_Pa = number("ptop");
    if (!top_Pa.has_value()) return LacksTerm(file, coordinate, "ptop");
    // p = ptop + sigma (ps - ptop)
    for (const double each : b.middles) a.middles.push_back(*top_Pa * (1.0 - each));
    for (const double each : b.faces) a.faces.push_back(*top_Pa * (1.0 - each));
  } else if (const std::string ap = Term(coordinate.terms, "ap"); file.HasVariable(ap)) {
    const auto pascal = ConversionOf(file.TextOrEmpty(ap, "units"), "Pa");
    if (!pascal.has_value()) return LacksTerm(file, coordinate, "ap");
    THUNDERHEAD_ASSIGN_OR_RETURN(
        a, ReadTerm(file, ap, Term(coordinate.terms_at_faces, "ap"), layers, pascal->scale));
  } else if (const std::string share = Term(coordinate.terms, "a"); file.HasVariable(share)) {
    const auto p0_Pa = number("p0");
    if (!p0_Pa.has_value()) return LacksTerm(file, coordinate, "p0");
    THUNDERHEAD_ASSIGN_OR_RETURN(
        a, ReadTerm(file, share, Term(coordinate.terms_at_faces, "a"), layers, *p0_Pa));
  } else {
    return LacksTerm(file, coordinate, "ap");
  }
  CfHeights heights;
  heights.kind = CfHeightKind::kPressure;
  heights.name = coordinate.name;
  heights.surface_pressure = ColumnValue(file, Term(coordinate.terms, "ps"), dimensions, "Pa");
  if (!heights.surface_pressure.has_value()) return LacksTerm(file, coordinate, "ps");
  // Pressure falls upwards.
  constexpr double kSurface_Pa = 1e5;
  const auto pressure_Pa = [&](std::size_t i) { return a.middles[i] + b.middles[i] * kSurface_Pa; };
  heights.reversed = pressure_Pa(0) < pressure_Pa(layers - 1);
  if (heights.reversed) {
    for (auto* values : {&a.middles, &a.faces, &b.middles, &b.faces}) std::ranges::reverse(*values);
  }
  const double above_ground_Pa =
      kSurface_Pa -
      (a.faces.empty() ? pressure_Pa(0) : a.faces.front() + b.faces.front() * kSurface_Pa);
  const double step_Pa = layers > 1 ? pressure_Pa(0) - pressure_Pa(1) : kSurface_Pa;
  if (BeginsFarAbove(above_ground_Pa, step_Pa)) {
    return NoHeights(file, coordinate.name,
                     "begins far above the ground, and the heights of its levels follow from all "
                     "levels below; give a file with all levels");
  }
  // The lowest face is the ground. The highest is as far from the last middle as the one below.
  heights.a = FacesOf(a, 0.0, 0.0);
  heights.b = FacesOf(b, 1.0, 0.0);
  if (a.faces.empty() && layers > 1) {
    heights.a.back() = std::max(0.0, 2.0 * a.middles[layers - 1] - heights.a[layers - 1]);
    heights.b.back() = std::max(0.0, 2.0 * b.middles[layers - 1] - heights.b[layers - 1]);
  }
  heights.a_middle = std::move(a.middles);
  heights.b_middle = std::move(b.middles);
  return heights;
}

absl::StatusOr<CfHeights> ReadParametric(const netcdf::NetcdfFile& file,
                                         const Parametric& coordinate,
                                         const CfDimensions& dimensions,
                                         const std::optional<CfColumnValue>& terrain) {
  if (coordinate.standard_name == "atmosphere_hybrid_height_coordinate") {
    auto orography = terrain;
    if (auto term = ColumnValue(file, Term(coordinate.terms, "orog"), dimensions, "m")) {
      orography = term;
    }
    return ReadHybridHeight(file, coordinate, dimensions.axes[2].length, orography);
  }
  if (coordinate.standard_name == "atmosphere_sleve_coordinate") {
    return ReadSleve(file, coordinate, dimensions);
  }
  if (coordinate.standard_name.empty() && !Term(coordinate.terms, "s").empty() &&
      !Term(coordinate.terms, "height").empty()) {
    return ReadGalChen(file, coordinate, dimensions);
  }
  if (coordinate.standard_name == "atmosphere_hybrid_sigma_pressure_coordinate" ||
      coordinate.standard_name == "atmosphere_sigma_coordinate") {
    return ReadHybridPressure(file, coordinate, dimensions);
  }
  return NoHeights(
      file, coordinate.name,
      absl::StrCat("is the ",
                   coordinate.standard_name.empty() ? std::string("coordinate of a model")
                                                    : coordinate.standard_name,
                   ", whose formula is not read here"));
}

std::string NameOfPath(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// Returns what a vertical coordinate counts that is not metres, or nothing if it is a height.
std::optional<std::string> WhyNoHeight(const netcdf::NetcdfFile& file, const std::string& name) {
  const CfDescription described = DescribeCf(file, name);
  const std::string& standard = described.standard_name;
  if (absl::StrContains(standard, "sigma") || absl::StrContains(standard, "atmosphere_")) {
    return absl::StrCat("holds values of ", standard, " without usable formula_terms");
  }
  if (ConversionOf(described.units, "Pa").has_value()) return "holds pressures, not heights";
  if (ConversionOf(described.units, "K").has_value()) return "holds temperatures, not heights";
  const bool length = !HasNoUnits(described.units) && MetresIn(described.units).has_value();
  if (length) return std::nullopt;
  const std::string lower = absl::AsciiStrToLower(name);
  const std::string long_name = absl::AsciiStrToLower(file.TextOrEmpty(name, "long_name"));
  const bool plain_height =
      HasNoUnits(described.units) && standard.empty() &&
      OneOf(lower, {"z", "zh", "zc", "zt", "zm", "zu_3d", "altitude", "alt"}) &&
      !absl::StrContains(long_name, "level") && !absl::StrContains(long_name, "eta");
  if (plain_height) return std::nullopt;
  if (CountsLevels(described)) {
    return absl::StrCat("has ",
                        HasNoUnits(described.units) ? std::string("no units")
                                                    : absl::StrCat("units '", described.units, "'"),
                        ", so it holds numbers of levels (or eta), not heights");
  }
  return std::nullopt;  // another unit, which ReadHeightAxis reports
}

// Reads an axis of heights above sea level or above the surface.
absl::StatusOr<CfHeights> ReadHeightsOfAxis(const netcdf::NetcdfFile& file,
                                            const CfDimension& dimension,
                                            const std::optional<CfColumnValue>& terrain,
                                            std::vector<std::string>& assumptions) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfAxis axis, ReadHeightAxis(file, dimension));
  CfHeights heights;
  heights.name = dimension.coordinate;
  heights.reversed = axis.reversed;
  heights.faces_m = std::move(axis.faces);
  const CfDescription described = DescribeCf(file, dimension.coordinate);
  if (HasNoUnits(described.units)) {
    assumptions.push_back(absl::StrCat(described.name, " has no units; it is taken to be in m."));
    spdlog::warn("{}: {} has no units; taken to be in m", file.Path(), described.name);
  }
  if (!IsAboveGround(file, dimension.coordinate, described)) return heights;
  if (terrain.has_value()) {
    heights.kind = CfHeightKind::kAboveGround;
    assumptions.push_back(absl::StrCat("The heights ", described.name,
                                       " are above the surface, by their name; the terrain ",
                                       terrain->variable.name, " is added."));
  } else {
    assumptions.push_back(absl::StrCat("The heights ", described.name,
                                       " are above the surface, which is taken to be at sea level "
                                       "because the file has no terrain (surface_altitude)."));
  }
  return heights;
}

}  // namespace

absl::StatusOr<CfHeights> ReadCfHeights(const netcdf::NetcdfFile& file,
                                        const netcdf::NetcdfFile* heights_file,
                                        const CfDimensions& dimensions,
                                        const std::optional<CfColumnValue>& terrain,
                                        std::vector<std::string>& assumptions) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfHeightArray array, FindHeightArray(file, dimensions, file));
  if (!array.heights.has_value() && heights_file != nullptr) {
    THUNDERHEAD_ASSIGN_OR_RETURN(array, FindHeightArray(*heights_file, dimensions, file));
  }
  if (array.heights.has_value()) {
    const bool is_elsewhere = array.heights->array->of_heights_file;
    assumptions.push_back(absl::StrCat(
        "The heights of the layers are those of ", array.heights->name,
        is_elsewhere ? absl::StrCat(" in ", NameOfPath(heights_file->Path())) : "", "."));
    std::ranges::copy(array.assumptions, std::back_inserter(assumptions));
    if (array.heights->ground.has_value() && !terrain.has_value()) {
      assumptions.push_back(absl::StrCat("The ground is the lowest half level of ",
                                         array.heights->name,
                                         ", because the file has no other height of it."));
    }
    return *std::move(array.heights);
  }
  if (const auto parametric = FindParametric(file, dimensions); parametric.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(CfHeights heights,
                                 ReadParametric(file, *parametric, dimensions, terrain));
    assumptions.push_back(
        heights.kind == CfHeightKind::kLinear
            ? absl::StrCat("The heights of the layers follow from ", heights.name,
                           " and the terrain.")
            : absl::StrCat("The heights of the layers follow from ", heights.name,
                           ", temperature and humidity by the hydrostatic equation."));
    return heights;
  }
  const CfDimension& z = dimensions.axes[2];
  const bool has_heights = !z.coordinate.empty() && !WhyNoHeight(file, z.coordinate).has_value();
  if (!has_heights && !array.unread.ok()) return array.unread;
  if (z.coordinate.empty()) {
    return NoHeights(file, z.name,
                     z.name == "nVertLevels"
                         ? "has no heights (MPAS writes them to zgrid in the init or static file: "
                           "add it, for example with ncks -A -v zgrid)"
                         : "has no coordinate variable, so the heights are not known");
  }
  // COSMO and ICON number their levels and keep the heights in HHL, often in another file.
  if (const auto why = WhyNoHeight(file, z.coordinate); why.has_value()) {
    const std::string lower = absl::AsciiStrToLower(z.coordinate);
    const bool numbers = absl::StrContains(lower, "height") || absl::StrContains(lower, "lev") ||
                         absl::StrContains(lower, "generalv");
    return NoHeights(file, z.coordinate,
                     numbers ? absl::StrCat(*why,
                                            " (COSMO and ICON write them to HHL or z_ifc, "
                                            "often in a separate file: merge it)")
                             : *why);
  }
  return ReadHeightsOfAxis(file, z, terrain, assumptions);
}

std::optional<CfColumnValue> FindTerrain(const netcdf::NetcdfFile& file,
                                         const CfDimensions& dimensions,
                                         std::vector<std::string>& assumptions) {
  std::string unread;
  for (const bool by_name : {false, true}) {
    for (const std::string& name : file.Variables()) {
      const CfDescription described = DescribeCf(file, name);
      const bool altitude = described.standard_name == "surface_altitude";
      const bool geopotential = described.standard_name == "surface_geopotential";
      const bool model = described.standard_name.empty() &&
                         OneOf(name, {"zs", "ZS", "hsurf", "HSURF", "HGT", "hgt", "orog", "topo",
                                      "FIS", "PHIS", "topography_c", "zsurf"});
      if (by_name ? !model : !altitude && !geopotential) continue;
      const auto variable = Arrange(file, name, dimensions);
      const bool fits = variable.ok() && variable->places[0] >= 0 && variable->places[1] >= 0 &&
                        variable->places[2] < 0 && variable->more == std::array<int, 3>{0, 0, 0};
      const auto scale = HeightScale(described.units);
      if (fits && scale.has_value()) return CfColumnValue{*variable, *scale};
      if (!altitude) continue;
      unread = name;
      spdlog::warn("{}: {} (units '{}') is not read; it must be on the fields' x and y, in m or km",
                   file.Path(), name, described.units);
    }
  }
  if (!unread.empty()) {
    assumptions.push_back(absl::StrCat("The ground is at sea level, because the terrain ", unread,
                                       " is not on the fields' x and y in a unit of length."));
  }
  return std::nullopt;
}

}  // namespace thunderhead::storm_files
