#include "netcdf/classic_file_size.h"

#include <netcdf.h>

#include <algorithm>
#include <limits>
#include <string>

namespace thunderhead::netcdf {
namespace {

std::uintmax_t Padded(std::uintmax_t bytes) { return (bytes + 3) / 4 * 4; }

// The sizes in bytes of the numbers in a header. Counts and lengths are wider in CDF-5, and file
// offsets are wider from CDF-2 on.
struct HeaderWidths {
  std::uintmax_t count;
  std::uintmax_t offset;
};

// Returns the product of `a` and `b`, limited so that sums of products cannot overflow. This is
// necessary because a damaged header can contain any size.
std::uintmax_t BoundedProduct(std::uintmax_t a, std::uintmax_t b) {
  constexpr std::uintmax_t kMax = std::numeric_limits<std::int64_t>::max() / 4096;
  std::uintmax_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? kMax : std::min(product, kMax);
}

std::uintmax_t NameSize(const char* name, const HeaderWidths& widths) {
  return widths.count + Padded(std::char_traits<char>::length(name));
}

std::uintmax_t TypeSize(int handle, nc_type type) {
  std::size_t size = 0;
  nc_inq_type(handle, type, nullptr, &size);
  return size;
}

// Returns the size of a list of attributes: tag and count, then name, type, length and values of
// each.
std::uintmax_t AttributesSize(int handle, int variable, int attributes,
                              const HeaderWidths& widths) {
  std::uintmax_t bytes = 4 + widths.count;
  for (int i = 0; i < attributes; ++i) {
    char name[NC_MAX_NAME + 1];
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_attname(handle, variable, i, name) != NC_NOERR ||
        nc_inq_att(handle, variable, name, &type, &length) != NC_NOERR) {
      continue;
    }
    bytes += NameSize(name, widths) + 4 + widths.count +
             Padded(BoundedProduct(length, TypeSize(handle, type)));
  }
  return bytes;
}

struct VariableSizes {
  std::uintmax_t header = 0;
  std::uintmax_t data = 0;  // size of the values; for a variable with records, of one record
  bool has_records = false;
};

VariableSizes SizesOf(int handle, int variable, int record_dimension, const HeaderWidths& widths) {
  VariableSizes sizes;
  char name[NC_MAX_NAME + 1];
  nc_type type = NC_NAT;
  int rank = 0;
  int dimensions[NC_MAX_VAR_DIMS];
  int attributes = 0;
  if (nc_inq_var(handle, variable, name, &type, &rank, dimensions, &attributes) != NC_NOERR) {
    return sizes;
  }
  sizes.header = NameSize(name, widths) + widths.count + rank * widths.count +
                 AttributesSize(handle, variable, attributes, widths) + 4 + widths.count +
                 widths.offset;
  sizes.has_records = rank > 0 && dimensions[0] == record_dimension;
  std::uintmax_t cells = 1;
  for (int i = sizes.has_records ? 1 : 0; i < rank; ++i) {
    std::size_t length = 0;
    nc_inq_dimlen(handle, dimensions[i], &length);
    cells = BoundedProduct(cells, length);
  }
  sizes.data = Padded(BoundedProduct(cells, TypeSize(handle, type)));
  return sizes;
}

}  // namespace

std::uintmax_t ClassicFileSize(int handle) {
  int format = 0;
  if (nc_inq_format(handle, &format) != NC_NOERR) return 0;
  if (format == NC_FORMAT_NETCDF4 || format == NC_FORMAT_NETCDF4_CLASSIC) return 0;
  const HeaderWidths widths{.count = format == NC_FORMAT_CDF5 ? 8U : 4U,
                            .offset = format == NC_FORMAT_CLASSIC ? 4U : 8U};
  int dimensions = 0;
  int variables = 0;
  int attributes = 0;
  int record_dimension = -1;
  nc_inq(handle, &dimensions, &variables, &attributes, &record_dimension);

  std::uintmax_t bytes = 4 + widths.count;  // magic number, number of records
  bytes += 4 + widths.count;                // head of the list of dimensions
  for (int i = 0; i < dimensions; ++i) {
    char name[NC_MAX_NAME + 1];
    if (nc_inq_dimname(handle, i, name) == NC_NOERR) bytes += NameSize(name, widths) + widths.count;
  }
  bytes += AttributesSize(handle, NC_GLOBAL, attributes, widths);
  bytes += 4 + widths.count;  // head of the list of variables
  std::size_t records = 0;
  if (record_dimension >= 0) nc_inq_dimlen(handle, record_dimension, &records);
  std::uintmax_t data = 0;
  int record_variables = 0;
  for (int variable = 0; variable < variables; ++variable) {
    const VariableSizes sizes = SizesOf(handle, variable, record_dimension, widths);
    bytes += sizes.header;
    data += sizes.has_records ? BoundedProduct(sizes.data, records) : sizes.data;
    record_variables += sizes.has_records ? 1 : 0;
  }
  // A complete file may lack the padding after its last value. If there is only one record
  // variable, its records have no padding in between.
  const std::uintmax_t slack = 3 * (record_variables == 1 ? records + 1 : 1);
  return bytes + data - (data < slack ? data : slack);
}

}  // namespace thunderhead::netcdf
