#include "netcdf/filters.h"

#include <netcdf.h>
#include <netcdf_filter.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "absl/strings/str_cat.h"

namespace thunderhead::netcdf {
namespace {

// HDF5's registered filters that models and tools use, and the packages with their plug-ins.
struct Filter {
  unsigned id;
  const char* name;
  const char* package;
};
constexpr std::array kFilters = {
    Filter{4, "szip", "Debian package libsz2"},
    Filter{307, "bzip2", "Debian package hdf5-filter-plugin"},
    Filter{32000, "LZF", "Debian package hdf5-plugin-lzf"},
    Filter{32001, "Blosc", "Debian package hdf5-filter-plugin-blosc-serial"},
    Filter{32004, "LZ4", "Debian package hdf5-filter-plugin"},
    Filter{32008, "Bitshuffle", "Debian package hdf5-filter-plugin"},
    Filter{32013, "ZFP", "Debian package hdf5-filter-plugin-zfp-serial"},
    Filter{32015, "Zstandard", "Python package hdf5plugin"},
    Filter{32017, "SZ", "Python package hdf5plugin"},
    Filter{32022, "BitGroom", "the netCDF library's own plug-ins"},
    Filter{32023, "Granular BitRound", "the netCDF library's own plug-ins"},
    Filter{32026, "Blosc2", "Python package hdf5plugin"},
};

}  // namespace

std::string NameOfFilter(unsigned id) {
  const auto known = std::ranges::find(kFilters, id, &Filter::id);
  if (known == kFilters.end()) return absl::StrCat("of number ", id, " in HDF5's registry");
  return absl::StrCat(known->name, " (HDF5 filter ", id, "; ", known->package, ")");
}

std::string LackingFilter(int group, int variable) {
  constexpr std::size_t kMost = 32;  // HDF5's limit of filters per variable (H5Z_MAX_NFILTERS)
  std::size_t count = 0;
  std::array<unsigned, kMost> ids{};
  if (nc_inq_var_filter_ids(group, variable, &count, nullptr) != NC_NOERR || count > kMost ||
      nc_inq_var_filter_ids(group, variable, &count, ids.data()) != NC_NOERR) {
    return "";
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (nc_inq_filter_avail(group, ids[i]) != NC_NOERR) return NameOfFilter(ids[i]);
  }
  return "";
}

}  // namespace thunderhead::netcdf
