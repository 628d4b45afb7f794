// Tests of how stored values become numbers, and of variables in groups.
#include "netcdf/netcdf_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "netcdf/filters.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::netcdf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;

void Must(int code) { THUNDERHEAD_CHECK(code == NC_NOERR, nc_strerror(code)); }

// A file with one variable `v` of four values, in a group or in the root.
class NetcdfValues : public ::testing::Test {
 protected:
  NetcdfValues() { Must(nc_create(path_.c_str(), NC_NETCDF4, &file_)); }

  int Define(nc_type type, int group) {
    int dimension = 0;
    int variable = 0;
    Must(nc_def_dim(group, "n", 4, &dimension));
    Must(nc_def_var(group, "v", type, 1, &dimension, &variable));
    return variable;
  }
  void Text(int group, int variable, const char* name, const std::string& text) {
    Must(nc_put_att_text(group, variable, name, text.size(), text.c_str()));
  }
  void Close() {
    Must(nc_close(file_));
    file_ = -1;
  }
  std::vector<float> Read(const std::string& group = "") {
    const auto file = NetcdfFile::Open(path_, group);
    THUNDERHEAD_CHECK(file.ok(), std::string(file.status().message()));
    const auto part = file->ReadPart("v", {0}, {4});
    THUNDERHEAD_CHECK(part.ok(), std::string(part.status().message()));
    const auto doubles = file->ReadDoubles("v");
    for (std::size_t i = 0; i < 4; ++i) {
      const auto as_float = static_cast<float>((*doubles)[i]);
      EXPECT_TRUE(as_float == (*part)[i] || (std::isnan(as_float) && std::isnan((*part)[i])));
    }
    return *part;
  }

  absl::Status Problem() { return NetcdfFile::Open(path_)->ReadPart("v", {0}, {4}).status(); }

  thunderhead::testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("values.nc");
  int file_ = -1;
};

TEST_F(NetcdfValues, BytesMayBeMeantWithoutASign) {
  const int v = Define(NC_BYTE, file_);
  Text(file_, v, "_Unsigned", "true");
  const signed char fill = -1;
  const float scale = 0.5F;
  Must(nc_put_att_schar(file_, v, "_FillValue", NC_BYTE, 1, &fill));
  Must(nc_put_att_float(file_, v, "scale_factor", NC_FLOAT, 1, &scale));
  const signed char values[] = {0, 100, -56, -1};
  Must(nc_put_var_schar(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(0.0F, 50.0F, 100.0F, IsNan()));
}

TEST_F(NetcdfValues, ValuesOutsideTheValidRangeAreMissing) {
  const int v = Define(NC_SHORT, file_);
  const float scale = 1e-2F;
  const short range[] = {0, 250};
  Must(nc_put_att_float(file_, v, "scale_factor", NC_FLOAT, 1, &scale));
  Must(nc_put_att_short(file_, v, "valid_range", NC_SHORT, 2, range));
  const short values[] = {-1, 0, 250, 251};
  Must(nc_put_var_short(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(IsNan(), 0.0F, ::testing::FloatNear(2.5F, 1e-6F), IsNan()));
}

// A range of another type than the stored values is one of unpacked values.
TEST_F(NetcdfValues, TheValidRangeMayBeUnpacked) {
  const int v = Define(NC_SHORT, file_);
  const float scale = 0.5F;
  const float most = 1.0F;
  Must(nc_put_att_float(file_, v, "scale_factor", NC_FLOAT, 1, &scale));
  Must(nc_put_att_float(file_, v, "valid_max", NC_FLOAT, 1, &most));
  const short values[] = {1, 2, 3, 4};
  Must(nc_put_var_short(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(0.5F, 1.0F, IsNan(), IsNan()));
}

TEST_F(NetcdfValues, FloatsHaveMissingValuesAndRanges) {
  const int v = Define(NC_FLOAT, file_);
  const float missing[] = {-999.0F, -888.0F};
  const float least = -1.0F;
  Must(nc_put_att_float(file_, v, "missing_value", NC_FLOAT, 2, missing));
  Must(nc_put_att_float(file_, v, "valid_min", NC_FLOAT, 1, &least));
  const float values[] = {-888.0F, 2.0F, -2.0F, -0.5F};
  Must(nc_put_var_float(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(IsNan(), 2.0F, IsNan(), -0.5F));
}

// Each attribute is one that no value can be unpacked with.
TEST_F(NetcdfValues, PackingAttributesMustBeOneFiniteNumber) {
  const float nan = std::nanf("");
  const float infinity = std::numeric_limits<float>::infinity();
  const float two[] = {1.0F, 2.0F};
  const auto numbers = [&](int v, const char* name, const float* values, std::size_t count) {
    Must(nc_put_att_float(file_, v, name, NC_FLOAT, count, values));
  };
  for (const char* name : {"scale_factor", "add_offset"}) {
    for (const auto& write :
         std::vector<std::function<void(int)>>{[&](int v) { numbers(v, name, &nan, 1); },
                                               [&](int v) { numbers(v, name, &infinity, 1); },
                                               [&](int v) { numbers(v, name, two, 2); },
                                               [&](int v) { Text(file_, v, name, "two"); }}) {
      if (file_ < 0) Must(nc_create(path_.c_str(), NC_NETCDF4, &file_));
      const int v = Define(NC_FLOAT, file_);
      write(v);
      Close();
      EXPECT_THAT(std::string(Problem().message()),
                  HasSubstr(std::string("values.nc: v: its attribute ") + name +
                            " is not one finite number"));
      EXPECT_FALSE(NetcdfFile::Open(path_)->ReadDoubles("v").ok());
    }
  }
}

// With a limit that is NaN, the other limit must not be lost.
TEST_F(NetcdfValues, LimitsMustBeNumbers) {
  const float nan = std::nanf("");
  const float most = 1.0F;
  const float range[] = {nan, most};
  for (const nc_type type : {NC_FLOAT, NC_SHORT}) {
    for (const char* name : {"valid_min", "valid_max", "valid_range"}) {
      if (file_ < 0) Must(nc_create(path_.c_str(), NC_NETCDF4, &file_));
      const int v = Define(type, file_);
      const bool is_range = std::string(name) == "valid_range";
      if (std::string(name) == "valid_min") {
        Must(nc_put_att_float(file_, v, "valid_max", NC_FLOAT, 1, &most));
      }
      Must(nc_put_att_float(file_, v, name, NC_FLOAT, is_range ? 2 : 1, is_range ? range : &nan));
      Close();
      EXPECT_THAT(
          std::string(Problem().message()),
          HasSubstr(std::string("values.nc: v: its attribute ") + name + " is not a number (NaN)"));
      EXPECT_FALSE(NetcdfFile::Open(path_)->ReadDoubles("v").ok());
    }
  }
}

// An infinite limit limits nothing, and the other limit holds.
TEST_F(NetcdfValues, LimitsMayBeInfinite) {
  const int v = Define(NC_FLOAT, file_);
  const float least = -std::numeric_limits<float>::infinity();
  const float most = 1.0F;
  Must(nc_put_att_float(file_, v, "valid_min", NC_FLOAT, 1, &least));
  Must(nc_put_att_float(file_, v, "valid_max", NC_FLOAT, 1, &most));
  const float values[] = {-888.0F, 2.0F, 1.0F, -0.5F};
  Must(nc_put_var_float(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(-888.0F, IsNan(), 1.0F, -0.5F));
}

TEST_F(NetcdfValues, OneUndeclaredHugeNumberIsACodeForMissingValues) {
  const int v = Define(NC_FLOAT, file_);
  const float values[] = {1e30F, 2.0F, NC_FILL_FLOAT, 1e30F};
  Must(nc_put_var_float(file_, v, values));
  Close();
  EXPECT_THAT(Read(), ElementsAre(IsNan(), 2.0F, IsNan(), IsNan()));
}

TEST_F(NetcdfValues, OtherHugeValuesMustBeDeclared) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const nc_type type : {NC_FLOAT, NC_DOUBLE}) {
    for (const auto& [first, second] : std::vector<std::pair<float, float>>{
             {infinity, 1.0F}, {-infinity, 1.0F}, {1e38F, 1.0F}, {1e31F, 1e32F}}) {
      for (const bool declared : {false, true}) {
        if (file_ < 0) Must(nc_create(path_.c_str(), NC_NETCDF4, &file_));
        const int v = Define(type, file_);
        const double both[] = {first, second};
        if (declared) Must(nc_put_att_double(file_, v, "missing_value", NC_DOUBLE, 2, both));
        const float values[] = {2.0F, first, second, 3.0F};
        Must(nc_put_var_float(file_, v, values));
        Close();
        if (declared) {
          EXPECT_TRUE(std::isnan(Read()[1])) << first;
        } else {
          EXPECT_THAT(std::string(Problem().message()), HasSubstr("which no quantity has"));
        }
      }
    }
  }
}

// A scale factor that makes values huge is a mistake. The values are not missing.
TEST_F(NetcdfValues, HugeUnpackedValuesAreNotMissing) {
  const int v = Define(NC_SHORT, file_);
  const float scale = 1e33F;
  Must(nc_put_att_float(file_, v, "scale_factor", NC_FLOAT, 1, &scale));
  const short values[] = {0, 1, 1, 0};
  Must(nc_put_var_short(file_, v, values));
  Close();
  EXPECT_THAT(std::string(Problem().message()), HasSubstr("v holds the value 1e+33"));
}

TEST_F(NetcdfValues, VariablesMayBeInAGroup) {
  int outer = 0;
  int inner = 0;
  Must(nc_def_grp(file_, "les", &outer));
  Must(nc_def_grp(outer, "fields", &inner));
  Text(file_, NC_GLOBAL, "title", "a storm");
  const int v = Define(NC_FLOAT, inner);
  const float values[] = {1.0F, 2.0F, 3.0F, 4.0F};
  Must(nc_put_var_float(inner, v, values));
  Close();
  EXPECT_THAT(Read("/les/fields"), ElementsAre(1.0F, 2.0F, 3.0F, 4.0F));
  const auto root = NetcdfFile::Open(path_);
  ASSERT_TRUE(root.ok()) << root.status();
  EXPECT_FALSE(root->HasVariable("v"));
  EXPECT_THAT(root->Groups(), ElementsAre("/les", "/les/fields"));
  const auto group = NetcdfFile::Open(path_, "/les/fields");
  EXPECT_EQ(group->TextOrEmpty("", "title"), "a storm");
  EXPECT_FALSE(NetcdfFile::Open(path_, "/none").ok());
}

TEST(Filters, HaveTheirNamesAndPackages) {
  EXPECT_EQ(NameOfFilter(307), "bzip2 (HDF5 filter 307; Debian package hdf5-filter-plugin)");
  EXPECT_EQ(NameOfFilter(65000), "of number 65000 in HDF5's registry");
}

}  // namespace
}  // namespace thunderhead::netcdf
