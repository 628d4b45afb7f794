#include "storm_files/cloud_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "storm_files/date_time.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/layer_source.h"
#include "storm_files/text_start.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

constexpr double kMetresPerKm = 1e3;
constexpr double kMetresPerUm = 1e-6;
// Grams to kilograms, and 1/km to 1/m.
constexpr double kAmountScale = 1e-3;
constexpr std::size_t kMostTypes = 16;

// The particles of one type at a grid point, in the units of the file.
struct CloudParticles {
  int type = 0;  // 0 if the layout has no types
  double amount = 0.0;
  double radius_um = 0.0;
};

struct CloudRow {
  glm::ivec3 index{0};
  std::vector<CloudParticles> particles;
};

absl::StatusOr<double> ReadAmount(NumberText& text) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const double amount, text.Number("a value"));
  if (std::isnan(amount) || std::abs(amount) < std::numeric_limits<float>::max()) return amount;
  return text.Error(absl::StrCat("has the value ", amount, "; correct it"));
}

absl::Status ReadComponents(NumberText& text, CloudRow& row) {
  constexpr int kMost = 100;
  THUNDERHEAD_ASSIGN_OR_RETURN(const int count, text.Integer("the number of components", 0, kMost));
  for (int i = 0; i < count; ++i) {
    CloudParticles& particles = row.particles.emplace_back();
    THUNDERHEAD_ASSIGN_OR_RETURN(particles.type, text.Integer("a type of particles", 0, 1'000'000));
    THUNDERHEAD_ASSIGN_OR_RETURN(particles.amount, ReadAmount(text));
    THUNDERHEAD_ASSIGN_OR_RETURN(particles.radius_um, ReadAmount(text));
  }
  return absl::OkStatus();
}

absl::Status ReadValues(NumberText& text, const CloudColumns& columns, CloudRow& row) {
  CloudParticles& particles = row.particles.emplace_back();
  for (int i = 0; i < columns.values; ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double value, ReadAmount(text));
    if (i == columns.amount_at) particles.amount = value;
    if (i == columns.radius_at) particles.radius_um = value;
  }
  if (!columns.has_series) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(const int terms,
                               text.Integer("the length of a series", 0, kMostSeriesTerms));
  return text.SkipNumbers(terms, "a term of the series");
}

// Reads the next line with a grid point, whose indices count from 0 or 1. Returns false at the end.
absl::StatusOr<bool> ReadRow(NumberText& text, const CloudHeader& header, CloudRow& row) {
  row.particles.clear();
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, text.NextLine());
  if (!found) return false;
  constexpr std::string_view kNames[] = {"the index along x", "the index along y",
                                         "the index along z"};
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == 1 && !header.columns.has_y) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(row.index[axis],
                                 text.Integer(kNames[axis], 0, header.cells[axis]));
  }
  THUNDERHEAD_RETURN_IF_ERROR(header.columns.has_components
                                  ? ReadComponents(text, row)
                                  : ReadValues(text, header.columns, row));
  if (!text.AtNumber()) return true;
  return text.Error(
      "has more numbers than the layout of this file; check its kind and its columns");
}

// The levels at which a type of particles occurs, by the index in the file.
using TypeLevels = std::vector<bool>;

// Facts about a whole text, collected in one pass over its lines.
struct CloudScan {
  std::map<int, TypeLevels> types;
  std::optional<std::size_t> line_with_zero;     // first line with an index 0
  std::optional<std::size_t> line_with_highest;  // first line with an index as large as the grid
};

absl::Status ScanRow(const CloudRow& row, const CloudHeader& header, const NumberText& text,
                     CloudScan& scan) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == 1 && !header.columns.has_y) continue;
    if (row.index[axis] == 0 && !scan.line_with_zero.has_value()) {
      scan.line_with_zero = text.LineNumber();
    }
    if (row.index[axis] == header.cells[axis] && !scan.line_with_highest.has_value()) {
      scan.line_with_highest = text.LineNumber();
    }
  }
  if (scan.line_with_zero.has_value() && scan.line_with_highest.has_value()) {
    return text.Error(
        absl::StrCat("the indices of the lines before count from 0 to the size of the grid (line ",
                     *scan.line_with_zero, " has an index 0, and line ", *scan.line_with_highest,
                     " an index as large as the grid); count from 0 or from 1"));
  }
  for (const CloudParticles& particles : row.particles) {
    TypeLevels& levels = scan.types[particles.type];
    if (scan.types.size() > kMostTypes) {
      return text.Error(absl::StrCat("has the type ", particles.type, ", but more than ",
                                     kMostTypes, " types cannot be read; leave types out"));
    }
    levels.resize(static_cast<std::size_t>(header.cells.z) + 1, false);
    if (particles.amount > 0.0) levels[static_cast<std::size_t>(row.index.z)] = true;
  }
  return absl::OkStatus();
}

// A type of particles, and the hydrometeor that it is.
struct CloudKind {
  int type = 0;
  Hydrometeor hydrometeor = Hydrometeor::kCloud;
};

// A text that was read and checked once. It does not change.
struct CloudStorm {
  std::string path;
  CloudDialect dialect;
  CloudHeader header;
  int first_index = 0;
  std::vector<double> faces_m;   // between layers
  std::vector<CloudKind> kinds;  // in the order of physics::kHydrometeors
};

// Returns whether particles of any type occur at a level, which counts from 0.
bool HasParticles(const CloudScan& scan, int level, int first_index) {
  return std::ranges::any_of(scan.types, [&](const auto& type) {
    return !type.second.empty() && type.second[static_cast<std::size_t>(level + first_index)];
  });
}

// Returns the faces between layers. A layer reaches half-way to the neighbouring grid points. The
// programs let the fields vary linearly between grid points, and end the medium at the first and
// the last of them. The first and the last layer are therefore half as thick, and each column keeps
// its mass. If they have no particles, they have their whole thickness, as in CF files.
std::vector<double> FacesOf(const CloudHeader& header, const CloudScan& scan, int first_index) {
  const std::vector<double>& z_m = header.heights_m;
  if (header.heights_are_faces) return z_m;
  const std::size_t count = z_m.size();
  std::vector<double> faces_m(count + 1);
  for (std::size_t i = 1; i < count; ++i) faces_m[i] = 0.5 * (z_m[i - 1] + z_m[i]);
  const bool low = HasParticles(scan, 0, first_index);
  const bool high = HasParticles(scan, header.cells.z - 1, first_index);
  faces_m.front() = low ? z_m.front() : 1.5 * z_m[0] - 0.5 * z_m[1];
  faces_m.back() = high ? z_m.back() : 1.5 * z_m[count - 1] - 0.5 * z_m[count - 2];
  return faces_m;
}

// Returns the temperature of a layer, which counts from 0.
double LayerTemperature_K(const CloudHeader& header, std::size_t layer) {
  const std::vector<double>& each_K = header.temperature_K;
  return header.heights_are_faces ? 0.5 * (each_K[layer] + each_K[layer + 1]) : each_K[layer];
}

// Returns the hydrometeor that a type of particles is, by the temperatures at which it occurs. The
// file has only the number of the type. No water is liquid below -40 C, and no ice lasts above 0 C.
// Returns nothing if that does not decide.
std::optional<Hydrometeor> KindByTemperature(const CloudHeader& header, const TypeLevels& levels,
                                             int first_index) {
  constexpr double kAllIce_K = 233.15;
  constexpr double kMelting_K = 273.15;
  bool is_ice = false;
  bool is_water = false;
  for (std::size_t layer = 0; layer < static_cast<std::size_t>(header.cells.z); ++layer) {
    if (!levels[layer + static_cast<std::size_t>(first_index)]) continue;
    is_ice = is_ice || LayerTemperature_K(header, layer) < kAllIce_K;
    is_water = is_water || LayerTemperature_K(header, layer) > kMelting_K;
  }
  if (is_ice == is_water) return std::nullopt;
  return is_ice ? Hydrometeor::kIce : Hydrometeor::kCloud;
}

absl::Status FindKinds(const CloudScan& scan, CloudStorm& storm,
                       std::vector<std::string>& assumptions) {
  if (!storm.header.columns.has_components) {
    storm.kinds = {CloudKind{}};
    return absl::OkStatus();
  }
  for (const auto& [type, levels] : scan.types) {
    std::optional<Hydrometeor> kind = KindByTemperature(storm.header, levels, storm.first_index);
    const bool is_known = kind.has_value();
    if (scan.types.size() == 1 && !is_known) kind = Hydrometeor::kCloud;
    if (!kind.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat(
          storm.path, ": its types of particles have only numbers, and the temperatures at which ",
          "type ", type, " occurs do not tell whether it is water or ice; write a CF netCDF file ",
          "with one variable for each hydrometeor"));
    }
    if (std::ranges::find(storm.kinds, *kind, &CloudKind::hydrometeor) != storm.kinds.end()) {
      return absl::InvalidArgumentError(absl::StrCat(
          storm.path, ": its types of particles have only numbers, and by their temperatures ",
          "several are ", *kind == Hydrometeor::kIce ? "ice" : "water",
          "; write a CF netCDF file with one variable for each hydrometeor"));
    }
    storm.kinds.push_back({type, *kind});
    assumptions.push_back(
        absl::StrCat("Particles of type ", type, " are taken as ",
                     *kind == Hydrometeor::kIce ? "cloud ice, because some are colder than -40 C."
                     : is_known                 ? "cloud water, because some are warmer than 0 C."
                                                : "cloud water, because there is no other type."));
  }
  std::ranges::sort(storm.kinds, {}, &CloudKind::hydrometeor);
  return absl::OkStatus();
}

// Returns the first index of the grid points.
int FirstIndex(const CloudScan& scan, const CloudDialect& dialect, const CloudHeader& header,
               std::vector<std::string>& assumptions) {
  if (scan.line_with_zero.has_value()) {
    assumptions.emplace_back("Indices count from 0, because the index 0 occurs.");
    return 0;
  }
  if (scan.line_with_highest.has_value()) {
    assumptions.emplace_back("Indices count from 1, because one is as large as the grid.");
    return 1;
  }
  assumptions.push_back(absl::StrCat("Indices count from ", header.first_index, ", as in ",
                                     std::string(dialect.program),
                                     ", because none is 0 or as large as the grid."));
  return header.first_index;
}

class CloudSource final : public LayerSource {
 public:
  CloudSource(std::shared_ptr<const CloudStorm> storm,
              std::shared_ptr<const base::ByteSource> bytes);

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override;
  absl::StatusOr<LayerState> Air() override { return LayerState(); }
  absl::StatusOr<LayerAmounts> Amounts(std::size_t field) override;

 private:
  absl::StatusOr<std::size_t> Place(const NumberText& text, const CloudRow& row) const;

  const std::shared_ptr<const CloudStorm> storm_;
  const std::shared_ptr<const base::ByteSource> bytes_;
  LayerDomain domain_;
};

CloudSource::CloudSource(std::shared_ptr<const CloudStorm> storm,
                         std::shared_ptr<const base::ByteSource> bytes)
    : storm_(std::move(storm)), bytes_(std::move(bytes)) {
  const CloudHeader& header = storm_->header;
  domain_.path = storm_->path;
  domain_.time = StartWithoutDate();
  domain_.cells = header.cells;
  domain_.dx_m = header.dx_m;
  domain_.dy_m = header.dy_m;
  domain_.fixed_heights = true;
  domain_.heights_from = "its heights";
  const bool has_radii = header.columns.has_components || header.columns.radius_at >= 0;
  for (const CloudKind& kind : storm_->kinds) {
    LayerField& field = domain_.fields.emplace_back();
    field.hydrometeor = kind.hydrometeor;
    field.variable = header.variable;
    field.quantity = header.quantity;
    if (has_radii) field.sizes = {"reff", false};
  }
}

absl::StatusOr<std::vector<float>> CloudSource::InterfaceHeights_m() {
  THUNDERHEAD_RETURN_IF_ERROR(base::CountThatFits(absl::StrCat(domain_.path, ": its heights"),
                                                  {storm_->faces_m.size(), domain_.Columns()},
                                                  sizeof(float))
                                  .status());
  std::vector<float> heights_m;
  heights_m.reserve(storm_->faces_m.size() * domain_.Columns());
  for (const double face_m : storm_->faces_m) {
    heights_m.insert(heights_m.end(), domain_.Columns(), static_cast<float>(face_m));
  }
  return heights_m;
}

// Returns the index of a line's grid point in the arrays. The file may have changed since its
// indices were checked.
absl::StatusOr<std::size_t> CloudSource::Place(const NumberText& text, const CloudRow& row) const {
  std::size_t place = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const bool is_given = axis != 1 || storm_->header.columns.has_y;
    const int index = is_given ? row.index[axis] - storm_->first_index : 0;
    if (index < 0 || index >= domain_.cells[axis]) {
      return text.Error("was changed while the file was read; try again");
    }
    place = place * static_cast<std::size_t>(domain_.cells[axis]) + static_cast<std::size_t>(index);
  }
  return place;
}

absl::StatusOr<LayerAmounts> CloudSource::Amounts(std::size_t field) {
  const bool has_radii = !domain_.fields[field].sizes.name.empty();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::size_t count,
      base::CountThatFits(absl::StrCat(domain_.path, ": ", domain_.fields[field].variable),
                          {domain_.Columns(), static_cast<std::size_t>(domain_.cells.z)},
                          sizeof(float) * (has_radii ? 2 : 1)));
  NumberText text(bytes_, storm_->dialect.comments);
  THUNDERHEAD_ASSIGN_OR_RETURN(const CloudHeader header, storm_->dialect.read_header(text));
  if (header.cells != domain_.cells)
    return text.Error("was changed since it was listed; try again");
  LayerAmounts read;
  read.amounts.resize(count, 0.0F);
  if (has_radii) read.sizes.resize(count, std::nanf(""));
  CloudRow row;
  while (true) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, ReadRow(text, storm_->header, row));
    if (!found) return read;
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t place, Place(text, row));
    for (const CloudParticles& particles : row.particles) {
      if (particles.type != storm_->kinds[field].type) continue;
      read.amounts[place] = static_cast<float>(particles.amount * kAmountScale);
      if (has_radii) read.sizes[place] = static_cast<float>(particles.radius_um * kMetresPerUm);
    }
  }
}

std::vector<std::string> HeaderAssumptions(const CloudHeader& header) {
  const CloudColumns& columns = header.columns;
  const bool has_radii = columns.has_components || columns.radius_at >= 0;
  const bool is_mass = header.quantity == volume::Quantity::kMassConcentration;
  return {
      !is_mass    ? "Distances are in km and extinction in km-1."
      : has_radii ? "Distances are in km, masses in g m-3 and radii in um."
                  : "Distances are in km and masses in g m-3.",
      header.heights_are_faces
          ? absl::StrCat("Its ", header.heights_m.size(), " heights are the faces of layers.")
          : absl::StrCat("Its ", header.heights_m.size(),
                         " heights are those of grid points, half-way between which layers end."),
      "The x axis is taken as east, and the y axis as north."};
}

// Returns StormFile::run.
std::string CloudRunOf(const CloudStorm& storm) {
  return absl::StrCat(storm.header.about, " ", storm.faces_m.front(), " ", storm.faces_m.back());
}

}  // namespace

absl::Status ReadCloudSize(NumberText& text, CloudHeader& header) {
  for (int axis = 0; axis < 3; ++axis) {
    THUNDERHEAD_ASSIGN_OR_RETURN(header.cells[axis],
                                 text.Integer("the size of the grid", 1, kMostGridPoints));
  }
  return absl::OkStatus();
}

absl::Status ReadCloudSpacing(NumberText& text, CloudHeader& header) {
  for (double* spacing_m : {&header.dx_m, &header.dy_m}) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double spacing_km,
                                 text.NumberOnAnyLine("the distance between columns"));
    constexpr double kLongest_km = 1000.0;
    if (!(spacing_km > 0.0 && spacing_km <= kLongest_km)) {
      return text.Error(
          absl::StrCat("has ", spacing_km, " km between columns; give the distance in km"));
    }
    *spacing_m = spacing_km * kMetresPerKm;
  }
  return absl::OkStatus();
}

absl::Status ReadCloudHeights(NumberText& text, bool may_have_faces, CloudHeader& header) {
  const auto layers = static_cast<std::size_t>(header.cells.z);
  while (header.heights_m.size() < layers ||
         (header.heights_m.size() == layers && may_have_faces && text.AtNumber())) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double height_km, text.NumberOnAnyLine("a height"));
    constexpr double kLowest_km = -1.0;
    constexpr double kHighest_km = 150.0;
    if (!(height_km >= kLowest_km && height_km <= kHighest_km)) {
      return text.Error(
          absl::StrCat("has the height ", height_km, " km; give heights in km, from -1 to 150"));
    }
    if (!header.heights_m.empty() && height_km * kMetresPerKm <= header.heights_m.back()) {
      return text.Error(absl::StrCat("has the height ", height_km,
                                     " km after a higher or equal one; give them upwards"));
    }
    header.heights_m.push_back(height_km * kMetresPerKm);
  }
  if (text.AtNumber()) {
    return text.Error(absl::StrCat("has more heights than the ", layers, " levels",
                                   may_have_faces ? " or their faces" : "", "; correct it"));
  }
  header.heights_are_faces = header.heights_m.size() > layers;
  if (header.heights_m.size() >= 2) return absl::OkStatus();
  return text.Error("has one height only, so the layer has no thickness; give two levels");
}

absl::StatusOr<StormFile> DescribeCloudText(std::shared_ptr<const base::ByteSource> bytes,
                                            const CloudDialect& dialect) {
  auto storm = std::make_shared<CloudStorm>();
  storm->path = bytes->Path();
  storm->dialect = dialect;
  NumberText text(std::move(bytes), dialect.comments);
  THUNDERHEAD_ASSIGN_OR_RETURN(storm->header, dialect.read_header(text));
  const CloudHeader& header = storm->header;
  CloudScan scan;
  CloudRow row;
  while (true) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, ReadRow(text, header, row));
    if (!found) break;
    THUNDERHEAD_RETURN_IF_ERROR(ScanRow(row, header, text, scan));
  }
  if (scan.types.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(storm->path, ": lists no grid point; write the file again"));
  }
  StormFile file;
  file.path = storm->path;
  file.assumptions = header.assumptions;
  std::ranges::move(HeaderAssumptions(header), std::back_inserter(file.assumptions));
  storm->first_index = FirstIndex(scan, dialect, header, file.assumptions);
  THUNDERHEAD_RETURN_IF_ERROR(FindKinds(scan, *storm, file.assumptions));
  storm->faces_m = FacesOf(header, scan, storm->first_index);
  file.cells = header.cells;
  file.dx_m = header.dx_m;
  file.dy_m = header.dy_m;
  file.times = {StartWithoutDate()};
  for (const CloudKind& kind : storm->kinds) file.fields.push_back(kind.hydrometeor);
  file.about = header.about;
  file.run = CloudRunOf(*storm);
  file.reader = MakeRecordReader([storm = std::shared_ptr<const CloudStorm>(std::move(storm))](
                                     std::size_t) -> absl::StatusOr<std::unique_ptr<LayerSource>> {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const base::ByteSource> opened,
                                 base::OpenBytes(storm->path));
    return std::make_unique<CloudSource>(storm, std::move(opened));
  });
  return file;
}

}  // namespace thunderhead::storm_files
