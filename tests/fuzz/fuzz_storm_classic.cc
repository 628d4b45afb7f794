// Files of netCDF's classic formats, byte by byte. (HDF5 is left to the confined reader: its own
// parser is not ours to mend; hostile_files.cc.)
#include <cstdint>
#include <span>
#include <string>

#include "spdlog/spdlog.h"
#include "volume/netcdf_file.h"
#include "volume/storm_catalogue.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace volume = thunderhead::volume;
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  if (size < 4 || data[0] != 'C' || data[1] != 'D' || data[2] != 'F') return 0;
  volume::NetcdfFile::ReadFromMemory("wrfout", std::as_bytes(std::span(data, size)));
  static const volume::StormFormats formats = volume::StormFormats::BuiltIn();
  const auto file = volume::DescribeFile("wrfout", formats);
  if (!file.ok()) return 0;
  for (std::size_t record = 0; record < file->times.size() && record < 2; ++record) {
    const auto grid = file->reader->ReadVerticalGrid(record);
    static_cast<void>(file->reader->Read(record, std::nullopt, {}));
    if (grid.ok()) static_cast<void>(file->reader->Read(record, *grid, {}));
  }
  return 0;
}
