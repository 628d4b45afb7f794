#include "netcdf/netcdf_writer.h"

#include <netcdf_mem.h>

#include <cstdlib>
#include <memory>

namespace thunderhead::netcdf {
namespace {

// Compression level of zlib. Higher levels save little.
constexpr int kCompression = 4;

}  // namespace

NetcdfWriter::NetcdfWriter(const std::string& name) {
  Keep(nc_create_mem(name.c_str(), NC_NETCDF4, 0, &file_));
  open_ = Good();
}

int NetcdfWriter::Dimension(const char* name, std::size_t length) {
  int dimension = 0;
  if (Good()) Keep(nc_def_dim(file_, name, length, &dimension));
  return dimension;
}

int NetcdfWriter::Variable(const char* name, nc_type type, const std::vector<int>& dimensions) {
  int variable = 0;
  const int rank = static_cast<int>(dimensions.size());
  if (Good()) Keep(nc_def_var(file_, name, type, rank, dimensions.data(), &variable));
  if (Good() && rank > 1) Keep(nc_def_var_deflate(file_, variable, 1, 1, kCompression));
  return variable;
}

void NetcdfWriter::Text(int variable, const char* name, const std::string& text) {
  if (Good()) Keep(nc_put_att_text(file_, variable, name, text.size(), text.c_str()));
}

void NetcdfWriter::Numbers(int variable, const char* name, absl::Span<const double> numbers) {
  if (!Good()) return;
  Keep(nc_put_att_double(file_, variable, name, NC_DOUBLE, numbers.size(), numbers.data()));
}

void NetcdfWriter::Fill(int variable, float value) {
  if (Good()) Keep(nc_put_att_float(file_, variable, _FillValue, NC_FLOAT, 1, &value));
}

void NetcdfWriter::EndDefinitions() {
  if (Good()) Keep(nc_enddef(file_));
}

void NetcdfWriter::Values(int variable, absl::Span<const float> values) {
  if (Good()) Keep(nc_put_var_float(file_, variable, values.data()));
}

void NetcdfWriter::Values(int variable, absl::Span<const double> values) {
  if (Good()) Keep(nc_put_var_double(file_, variable, values.data()));
}

std::string NetcdfWriter::Take() {
  if (!open_) return "";
  open_ = false;
  NC_memio memory{};
  Keep(nc_close_memio(file_, &memory));
  const std::unique_ptr<void, decltype(&std::free)> owned(memory.memory, &std::free);
  if (!Good()) return "";
  return {static_cast<const char*>(memory.memory), memory.size};
}

}  // namespace thunderhead::netcdf
