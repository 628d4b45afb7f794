#include "tests/support/synthetic_cf.h"

#include <netcdf.h>

#include <string>
#include <utility>

#include "base/status.h"

namespace thunderhead::testing {
namespace {

void Must(int code) { THUNDERHEAD_CHECK(code == NC_NOERR, nc_strerror(code)); }

void PutAttributes(int file, int variable, const std::map<std::string, std::string>& attributes) {
  for (const auto& [name, text] : attributes) {
    Must(nc_put_att_text(file, variable, name.c_str(), text.size(), text.c_str()));
  }
}

std::vector<double> Values(const SyntheticCf& file, const CfContent& content) {
  std::vector<std::size_t> lengths;
  for (const std::string& dimension : content.dimensions) {
    for (const CfCoordinate& coordinate : file.coordinates) {
      if (coordinate.name == dimension) lengths.push_back(coordinate.values.size());
    }
  }
  THUNDERHEAD_CHECK(lengths.size() == content.dimensions.size(), content.name);
  std::size_t total = 1;
  for (const std::size_t length : lengths) total *= length;
  std::vector<double> values;
  for (std::size_t i = 0; i < total; ++i) {
    std::map<std::string, std::size_t> at;
    std::size_t rest = i;
    for (std::size_t d = lengths.size(); d-- > 0;) {
      at[content.dimensions[d]] = rest % lengths[d];
      rest /= lengths[d];
    }
    values.push_back(content.value(at));
  }
  return values;
}

}  // namespace

void WriteCf(const SyntheticCf& file, const std::string& path) {
  int id = 0;
  Must(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &id));
  PutAttributes(id, NC_GLOBAL, file.attributes);
  std::map<std::string, int> dimensions;
  int two = -1;
  for (const CfCoordinate& coordinate : file.coordinates) {
    Must(nc_def_dim(id, coordinate.name.c_str(), coordinate.values.size(),
                    &dimensions[coordinate.name]));
  }
  std::vector<std::pair<int, std::vector<double>>> contents;
  for (const CfCoordinate& coordinate : file.coordinates) {
    if (!coordinate.written) continue;
    int variable = 0;
    const int dimension = dimensions[coordinate.name];
    Must(nc_def_var(id, coordinate.name.c_str(), NC_DOUBLE, 1, &dimension, &variable));
    PutAttributes(id, variable, coordinate.attributes);
    contents.emplace_back(variable, coordinate.values);
    if (coordinate.faces.empty()) continue;
    if (two < 0) Must(nc_def_dim(id, "bounds", 2, &two));
    const std::string name = coordinate.name + "_bounds";
    PutAttributes(id, variable, {{"bounds", name}});
    const int both[2] = {dimension, two};
    Must(nc_def_var(id, name.c_str(), NC_DOUBLE, 2, both, &variable));
    PutAttributes(id, variable, file.bounds_attributes);
    std::vector<double> pairs;
    for (std::size_t i = 0; i + 1 < coordinate.faces.size(); ++i) {
      pairs.push_back(coordinate.faces[i]);
      pairs.push_back(coordinate.faces[i + 1]);
    }
    contents.emplace_back(variable, pairs);
  }
  for (const CfContent& content : file.variables) {
    std::vector<int> on;
    for (const std::string& dimension : content.dimensions) on.push_back(dimensions[dimension]);
    int variable = 0;
    Must(nc_def_var(id, content.name.c_str(), NC_FLOAT, static_cast<int>(on.size()), on.data(),
                    &variable));
    PutAttributes(id, variable, content.attributes);
    contents.emplace_back(variable, Values(file, content));
  }
  for (const auto& [name, attributes] : file.number_attributes) {
    int variable = NC_GLOBAL;
    if (!name.empty()) Must(nc_inq_varid(id, name.c_str(), &variable));
    for (const auto& [attribute, number] : attributes) {
      Must(nc_put_att_double(id, variable, attribute.c_str(), NC_DOUBLE, 1, &number));
    }
  }
  Must(nc_enddef(id));
  for (const auto& [variable, values] : contents) {
    Must(nc_put_var_double(id, variable, values.data()));
  }
  Must(nc_close(id));
}

std::vector<double> Middles(std::size_t count, double low, double spacing) {
  std::vector<double> middles;
  for (std::size_t i = 0; i < count; ++i) {
    middles.push_back(low + (static_cast<double>(i) + 0.5) * spacing);
  }
  return middles;
}

SyntheticCf ExtinctionFile(std::size_t nx, std::size_t ny, std::size_t nz, double dx_m, double dy_m,
                           double dz_m,
                           std::function<double(std::size_t, std::size_t, std::size_t)> value) {
  SyntheticCf file;
  file.coordinates = {{"x", Middles(nx, 0.0, dx_m), {{"units", "m"}}, {}},
                      {"y", Middles(ny, 0.0, dy_m), {{"units", "m"}}, {}},
                      {"z", Middles(nz, 0.0, dz_m), {{"units", "m"}}, {}}};
  // A single layer has no thickness without bounds.
  if (nz == 1) file.coordinates[2].faces = {0.0, dz_m};
  file.variables = {{"extinction",
                     {"z", "y", "x"},
                     {{"units", "m-1"}},
                     [value = std::move(value)](const auto& at) {
                       return value(at.at("x"), at.at("y"), at.at("z"));
                     }}};
  return file;
}

}  // namespace thunderhead::testing
