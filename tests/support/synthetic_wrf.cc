#include "tests/support/synthetic_wrf.h"

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/status.h"
#include "glm/trigonometric.hpp"
#include "tests/support/earth_formulas.h"

namespace thunderhead::testing {
namespace {

constexpr double kGravity_m_per_s2 = 9.81;
constexpr int kDateLength = 19;

void Succeed(int code) { THUNDERHEAD_CHECK(code == NC_NOERR, nc_strerror(code)); }

using Value = std::function<double(const WrfCell&)>;

struct Packing {
  double scale = 1.0;
  double offset = 0.0;
};

class Writer {
 public:
  Writer(const SyntheticWrf& file, const std::string& path) : file_(file) {
    static const std::map<WrfFormat, int> kModes = {{WrfFormat::kNetcdf4, NC_NETCDF4},
                                                    {WrfFormat::kClassic, 0},
                                                    {WrfFormat::kOffset64, NC_64BIT_OFFSET},
                                                    {WrfFormat::kCdf5, NC_64BIT_DATA}};
    Succeed(nc_create(path.c_str(), NC_CLOBBER | kModes.at(file.format), &id_));
    Dimension("Time", NC_UNLIMITED);
    Dimension("DateStrLen", kDateLength);
    Dimension("south_north", file.ny);
    Dimension("west_east", file.nx);
    Dimension("bottom_top", file.levels);
    Dimension("bottom_top_stag", file.levels + 1);
    Dimension("one_time", 1);
    Dimension("one_level_short", std::max(1, file.levels - 1));
    Attributes();
  }
  ~Writer() { Succeed(nc_close(id_)); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void Times() {
    if (file_.omitted.contains("Times")) return;
    int variable = 0;
    const int dimensions[] = {dimensions_.at("Time"), dimensions_.at("DateStrLen")};
    const bool once = file_.without_time.contains("Times");
    Define([&] {
      Succeed(
          nc_def_var(id_, "Times", NC_CHAR, once ? 1 : 2, dimensions + (once ? 1 : 0), &variable));
    });
    if (once) {
      Succeed(nc_put_var_text(id_, variable, file_.times.front().c_str()));
      return;
    }
    const std::size_t written = file_.times.size() - file_.times_left_blank;
    for (std::size_t record = 0; record < written; ++record) {
      const std::size_t start[] = {record, 0};
      const std::size_t count[] = {1, kDateLength};
      Succeed(nc_put_vara_text(id_, variable, start, count, file_.times[record].c_str()));
    }
  }

  void LevelCoordinate() {
    if (file_.level_coordinate.empty()) return;
    int variable = 0;
    const int dimension = dimensions_.at("bottom_top");
    const std::string name = DimensionName("bottom_top");
    Define([&] {
      Succeed(nc_def_var(id_, name.c_str(), NC_DOUBLE, 1, &dimension, &variable));
      Texts(variable, name);
    });
    Succeed(nc_put_var_double(id_, variable, file_.level_coordinate.data()));
  }

  void Minutes() {
    if (file_.minutes.empty()) return;
    int variable = 0;
    const int dimension = dimensions_.at("Time");
    const auto units = file_.units.find("XTIME");
    Define([&] {
      Succeed(nc_def_var(id_, "XTIME", NC_FLOAT, 1, &dimension, &variable));
      Text(variable, "units", units == file_.units.end() ? "" : units->second);
      Texts(variable, "XTIME");
    });
    const std::size_t start = 0;
    const std::size_t count = file_.minutes.size();
    Succeed(nc_put_vara_double(id_, variable, &start, &count, file_.minutes.data()));
  }

  // Writes a field with the value of every cell. If `level_dimension` is empty, the field is
  // two-dimensional.
  void Field(const std::string& name, const std::string& level_dimension, const std::string& units,
             const Value& value) {
    if (file_.omitted.contains(name)) return;
    std::vector<std::string> names = {"Time", level_dimension, "south_north", "west_east"};
    if (level_dimension.empty()) names.erase(names.begin() + 1);
    if (file_.one_level_short.contains(name)) names[1] = "one_level_short";
    const bool once = file_.without_time.contains(name);
    if (once) names.erase(names.begin());
    const bool own_time = file_.at_one_time.contains(name);
    if (own_time) names.front() = "one_time";
    const Packing packing = PackingOf(name);
    const int variable = DeclareField(name, names, units, packing);
    if (file_.unwritten.contains(name)) return;
    std::size_t levels = 1;
    if (!level_dimension.empty())
      Succeed(nc_inq_dimlen(id_, dimensions_.at(names[once ? 0 : 1]), &levels));
    const int records = once || own_time ? 1 : static_cast<int>(file_.times.size());
    for (int record = 0; record < records; ++record) {
      const std::vector<double> values =
          Record(name, static_cast<int>(levels), record, packing, value);
      std::vector<std::size_t> start(names.size(), 0);
      std::vector<std::size_t> count = {1, levels, static_cast<std::size_t>(file_.ny),
                                        static_cast<std::size_t>(file_.nx)};
      if (level_dimension.empty()) count.erase(count.begin() + 1);
      if (once) {
        count.erase(count.begin());
      } else {
        start[0] = record;
      }
      // The values are converted to float here, because netCDF refuses to convert infinities.
      const std::vector<float> narrow(values.begin(), values.end());
      Succeed(nc_put_vara_float(id_, variable, start.data(), count.data(), narrow.data()));
    }
  }

 private:
  std::string DimensionName(const std::string& name) const {
    const auto renamed = file_.renamed_dimensions.find(name);
    return renamed == file_.renamed_dimensions.end() ? name : renamed->second;
  }

  void Dimension(const std::string& name, std::size_t length) {
    Succeed(nc_def_dim(id_, DimensionName(name).c_str(), length, &dimensions_[name]));
  }

  // Writes the text attributes of a variable.
  void Texts(int variable, const std::string& name) {
    const auto texts = file_.texts.find(name);
    if (texts == file_.texts.end()) return;
    for (const auto& [attribute, text] : texts->second) Text(variable, attribute.c_str(), text);
  }

  void Text(int variable, const char* name, const std::string& text) {
    if (variable == NC_GLOBAL && file_.omitted.contains(name)) return;
    Succeed(nc_put_att_text(id_, variable, name, text.size(), text.data()));
  }

  void Number(const char* name, double value) {
    if (file_.omitted.contains(name)) return;
    Succeed(nc_put_att_double(id_, NC_GLOBAL, name, NC_FLOAT, 1, &value));
  }

  void Attributes() {
    Text(NC_GLOBAL, "TITLE", " OUTPUT FROM WRF V4.5 MODEL");
    Text(NC_GLOBAL, "SIMULATION_START_DATE", file_.simulation_start);
    Number("DX", file_.dx_m);
    Number("DY", file_.dy_m);
    Number("MAP_PROJ", file_.map_projection);
    for (const auto& [name, number] : file_.numbers) Number(name.c_str(), number);
    Number("GRID_ID", file_.domain);
    Texts(NC_GLOBAL, "");
    if (file_.microphysics != 0) Number("MP_PHYSICS", file_.microphysics);
    if (file_.hail_option != 0) Number("HAIL_OPT", file_.hail_option);
    if (!file_.land_use_table.empty()) Text(NC_GLOBAL, "MMINLU", file_.land_use_table);
    if (file_.land_use_classes != 0) Number("NUM_LAND_CAT", file_.land_use_classes);
  }

  // Classic files have a define mode and a data mode. netCDF-4 switches between them automatically.
  template <typename Declare>
  void Define(Declare declare) {
    if (defined_) Succeed(nc_redef(id_));
    declare();
    Succeed(nc_enddef(id_));
    defined_ = true;
  }

  Packing PackingOf(const std::string& name) const {
    if (!file_.packed.contains(name)) return {};
    return name == "QCLOUD" || name == "QRAIN" ? Packing{1e-6, 0.01} : Packing{10.0, 1000.0};
  }

  int DeclareField(const std::string& name, const std::vector<std::string>& names,
                   const std::string& units, const Packing& packing) {
    std::vector<int> dimensions;
    dimensions.reserve(names.size());
    for (const std::string& dimension : names) dimensions.push_back(dimensions_.at(dimension));
    const bool packed = file_.packed.contains(name);
    const nc_type type = packed ? NC_SHORT : NC_FLOAT;
    const auto other_units = file_.units.find(name);
    const auto renamed = file_.renamed.find(name);
    const std::string written = renamed == file_.renamed.end() ? name : renamed->second;
    int variable = 0;
    Define([&] {
      Succeed(nc_def_var(id_, written.c_str(), type, static_cast<int>(dimensions.size()),
                         dimensions.data(), &variable));
      Text(variable, "units", other_units == file_.units.end() ? units : other_units->second);
      Texts(variable, name);
      if (packed) {
        Succeed(nc_put_att_double(id_, variable, "scale_factor", NC_DOUBLE, 1, &packing.scale));
        Succeed(nc_put_att_double(id_, variable, "add_offset", NC_DOUBLE, 1, &packing.offset));
      }
      if (const auto fill = file_.fill_values.find(name); fill != file_.fill_values.end()) {
        Succeed(nc_put_att_double(id_, variable, "_FillValue", type, 1, &fill->second));
      }
    });
    return variable;
  }

  std::vector<double> Record(const std::string& name, int levels, int record,
                             const Packing& packing, const Value& value) const {
    std::vector<double> values;
    for (int level = 0; level < levels; ++level) {
      for (int y = 0; y < file_.ny; ++y) {
        for (int x = 0; x < file_.nx; ++x) {
          const double stored = (value({x, y, level, record}) - packing.offset) / packing.scale;
          values.push_back(file_.packed.contains(name) ? std::round(stored) : stored);
        }
      }
    }
    for (const StoredValue& stored : file_.stored_values) {
      if (stored.variable != name || stored.cell.record != record) continue;
      const int at = (stored.cell.level * file_.ny + stored.cell.y) * file_.nx + stored.cell.x;
      values[at] = stored.value;
    }
    return values;
  }

  const SyntheticWrf& file_;
  int id_ = 0;
  bool defined_ = false;
  std::map<std::string, int> dimensions_;
};

}  // namespace

double InterfaceHeight_m(const SyntheticWrf& file, const WrfCell& cell) {
  if (file.interface_height_m) return file.interface_height_m(cell);
  const double terrain_m = file.terrain_m ? file.terrain_m(cell.x, cell.y) : 0.0;
  return terrain_m + (file.top_m - terrain_m) * cell.level / file.levels;
}

void WriteWrf(const SyntheticWrf& file, const std::string& path) {
  Writer writer(file, path);
  writer.Times();
  writer.Minutes();
  writer.LevelCoordinate();
  // As in WRF, the state is the sum of a base that is constant in time and a perturbation.
  const auto base_geopotential = [&](const WrfCell& cell) {
    WrfCell first = cell;
    first.record = 0;
    return kGravity_m_per_s2 * 0.9 * InterfaceHeight_m(file, first);
  };
  const double base_pressure_Pa = 0.95 * file.pressure_Pa;
  writer.Field("PHB", "bottom_top_stag", "m2 s-2", base_geopotential);
  writer.Field("PH", "bottom_top_stag", "m2 s-2", [&](const WrfCell& cell) {
    return kGravity_m_per_s2 * InterfaceHeight_m(file, cell) - base_geopotential(cell);
  });
  writer.Field("PB", "bottom_top", "Pa", [&](const WrfCell&) { return base_pressure_Pa; });
  writer.Field("P", "bottom_top", "Pa",
               [&](const WrfCell&) { return file.pressure_Pa - base_pressure_Pa; });
  writer.Field("T", "bottom_top", "K", [&](const WrfCell& cell) {
    const double theta_K = file.potential_temperature_at_K ? file.potential_temperature_at_K(cell)
                                                           : file.potential_temperature_K;
    return theta_K - 300.0;
  });
  writer.Field("QVAPOR", "bottom_top", "kg kg-1",
               [&](const WrfCell&) { return file.vapour_kg_per_kg; });
  writer.Field("HGT", "", "m", [&](const WrfCell& cell) {
    return file.terrain_m ? file.terrain_m(cell.x, cell.y) : 0.0;
  });
  const double per_row_deg = glm::degrees(file.dy_m / kEarth_m);
  const double middle_deg = file.latitude_deg + 0.5 * (file.ny - 1) * per_row_deg;
  const double per_column_deg =
      glm::degrees(file.dx_m / (kEarth_m * std::cos(glm::radians(middle_deg))));
  if (!file.columns.contains("XLAT"))
    writer.Field("XLAT", "", "degree_north", [&](const WrfCell& cell) {
      return file.latitude_deg + per_row_deg * cell.y + file.north_per_record_deg * cell.record;
    });
  if (!file.columns.contains("XLONG"))
    writer.Field("XLONG", "", "degree_east", [&](const WrfCell& cell) {
      return file.longitude_deg + per_column_deg * cell.x + file.east_per_record_deg * cell.record;
    });
  for (const auto& [name, value] : file.columns) writer.Field(name, "", "", value);
  for (const auto& [name, value] : file.mixing_ratios) {
    writer.Field(name, "bottom_top", "kg kg-1", value);
  }
}

}  // namespace thunderhead::testing
