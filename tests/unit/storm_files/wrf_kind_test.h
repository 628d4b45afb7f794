// Support for tests of the kinds of WRF files: writes a file, describes it and reads one time.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "absl/strings/str_join.h"
#include "storm_files/storm_format.h"
#include "storm_files/wrf_reader.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {

// The density of SyntheticWrf's dry air: 80 kPa, 310 K, 10 g/kg (see layer_air_test).
inline constexpr double kDryDensity_kg_per_m3 = 0.94321;

class WrfKindTest : public ::testing::Test {
 protected:
  // Describes the file as the store does.
  absl::StatusOr<StormFile> Describe(const testing::SyntheticWrf& file) {
    testing::WriteWrf(file, path_);
    return StormFormats::BuiltIn().Describe(path_);
  }

  absl::StatusOr<volume::HydrometeorFields> Read(const testing::SyntheticWrf& file,
                                                 std::size_t record = 0) {
    absl::StatusOr<StormFile> described = Describe(file);
    if (!described.ok()) return described.status();
    return described->reader->Read(record, std::nullopt, {});
  }

  std::string Message(const testing::SyntheticWrf& file) {
    return std::string(Read(file).status().message());
  }

  static std::string Assumptions(const StormFile& file) {
    return absl::StrJoin(file.assumptions, "\n");
  }

  // Returns the mass above a column (kg/m2) of the field with this index.
  static double ColumnPath(const volume::HydrometeorFields& fields, std::size_t field, int x,
                           int y) {
    if (fields.fields[field].concentration_kg_per_m3.empty()) return 0.0;
    double path = 0.0;
    for (int z = 0; z < fields.grid.cells.z; ++z) {
      path += fields.fields[field].concentration_kg_per_m3[fields.grid.Offset(x, y, z)] *
              fields.grid.spacing_m.z;
    }
    return path;
  }

  // A file with cloud of 1 g/kg from the ground to 4 km.
  static testing::SyntheticWrf Cloud() {
    testing::SyntheticWrf file;
    file.microphysics = 2;  // a scheme whose QCLOUD is liquid
    file.mixing_ratios["QCLOUD"] = [](const testing::WrfCell&) { return 1e-3; };
    return file;
  }

  testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("wrfout_d01");
};

}  // namespace thunderhead::storm_files
