// Tests of HDF5 files that store values outside themselves, and of variables with types that
// netCDF-C does not know. Both come from attackers. The first would show other files of the
// server's user, and the second makes netCDF-C write past its memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "netcdf/hdf5_layout.h"
#include "netcdf/netcdf_lock.h"
#include "storm_store/storm_store.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;

class ForeignLayoutsTest : public ::testing::Test {
 protected:
  ForeignLayoutsTest() {
    testing::SyntheticWrf storm;
    storm.format = testing::WrfFormat::kNetcdf4;
    storm.mixing_ratios["QCLOUD"] = [](const testing::WrfCell&) { return 1e-3; };
    testing::WriteWrf(storm, path_);
    std::ofstream(secret_) << std::string(1 << 20, 's');
    file_ = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t cloud = H5Dopen2(file_, "QCLOUD", H5P_DEFAULT);
    space_ = H5Dget_space(cloud);
    H5Dclose(cloud);
  }
  ~ForeignLayoutsTest() override {
    if (file_ >= 0) H5Fclose(file_);
  }

  // Replaces QCLOUD by another dataset.
  void ReplaceCloud(hid_t type, hid_t creation) {
    ASSERT_GE(H5Ldelete(file_, "QCLOUD", H5P_DEFAULT), 0);
    const hid_t made =
        H5Dcreate2(file_, "QCLOUD", type, space_, H5P_DEFAULT, creation, H5P_DEFAULT);
    ASSERT_GE(made, 0);
    H5Dclose(made);
  }

  // Returns the first error between opening the storm and reading its fields, as a storm on disk.
  absl::Status Read() {
    H5Fclose(file_);
    file_ = -1;
    auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
    if (!store.ok()) return store.status();
    return (*store)->Get((*store)->Storms()[0]->id, 0, {}).status();
  }

  // Returns the result of checking the same bytes in memory, as the confined reader does.
  absl::Status LookAtBytes() {
    std::ifstream file(path_, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const netcdf::NetcdfLock lock;
    return netcdf::CheckHdf5Bytes(path_, std::as_bytes(std::span(bytes)));
  }

  void ExpectRefused(const std::string& what) {
    const absl::Status status = Read();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(what));
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_));
    EXPECT_THAT(std::string(LookAtBytes().message()), HasSubstr(what));
  }

  testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("wrfout_d01");
  const std::string secret_ = folder_.File("secret");
  hid_t file_ = -1;
  hid_t space_ = -1;
};

TEST_F(ForeignLayoutsTest, ASoundFileIsRead) {
  EXPECT_TRUE(Read().ok());
  EXPECT_TRUE(LookAtBytes().ok());
}

TEST_F(ForeignLayoutsTest, ExternalStorageIsRefused) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(creation, secret_.c_str(), 0, H5F_UNLIMITED);
  // A dataset with external storage must not have an unlimited time dimension.
  hsize_t lengths[H5S_MAX_RANK];
  const int rank = H5Sget_simple_extent_dims(space_, lengths, nullptr);
  space_ = H5Screate_simple(rank, lengths, nullptr);
  ReplaceCloud(H5T_NATIVE_FLOAT, creation);
  ExpectRefused("external storage");
}

TEST_F(ForeignLayoutsTest, VirtualDatasetsAreRefused) {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  hsize_t lengths[H5S_MAX_RANK];
  const int rank = H5Sget_simple_extent_dims(space_, lengths, nullptr);
  space_ = H5Screate_simple(rank, lengths, nullptr);
  ASSERT_GE(H5Pset_virtual(creation, space_, secret_.c_str(), "QCLOUD", space_), 0);
  ReplaceCloud(H5T_NATIVE_FLOAT, creation);
  ExpectRefused("virtual dataset");
}

TEST_F(ForeignLayoutsTest, LinksToOtherFilesAreRefused) {
  ASSERT_GE(H5Lcreate_external(secret_.c_str(), "/", file_, "elsewhere", H5P_DEFAULT, H5P_DEFAULT),
            0);
  ExpectRefused("link to another file");
}

TEST_F(ForeignLayoutsTest, ALinkToAnotherFileIsFoundInAGroup) {
  const hid_t group = H5Gcreate2(file_, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/g/self", group, "self", H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Lcreate_external(secret_.c_str(), "/", group, "out", H5P_DEFAULT, H5P_DEFAULT), 0);
  H5Gclose(group);
  ExpectRefused("link to another file");
}

// NetCDF-C would follow such links forever.
TEST_F(ForeignLayoutsTest, CirclesOfGroupsAreRefused) {
  ASSERT_GE(H5Lcreate_hard(file_, "/", file_, "root", H5P_DEFAULT, H5P_DEFAULT), 0);
  ExpectRefused("second link to a group");
}

TEST_F(ForeignLayoutsTest, CirclesBySoftLinksAreRefused) {
  const hid_t group = H5Gcreate2(file_, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Lcreate_soft("/g", group, "g", H5P_DEFAULT, H5P_DEFAULT), 0);
  H5Gclose(group);
  ExpectRefused("second link to a group");
}

// NetCDF-C would take a minute for such files, because it searches each group from the root.
TEST_F(ForeignLayoutsTest, GroupsInManyGroupsAreRefused) {
  hid_t parent = H5Gopen2(file_, "/", H5P_DEFAULT);
  const auto nest = [&] {
    const hid_t child = H5Gcreate2(parent, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(parent);
    parent = child;
  };
  for (int depth = 1; depth <= 16; ++depth) nest();
  H5Fflush(file_, H5F_SCOPE_LOCAL);
  EXPECT_TRUE(LookAtBytes().ok());
  nest();
  H5Gclose(parent);
  ExpectRefused("is in more than 16 groups");
}

TEST_F(ForeignLayoutsTest, TooManyVariablesAreRefused) {
  const hid_t scalar = H5Screate(H5S_SCALAR);
  for (int variable = 0; variable < 10'000; ++variable) {
    H5Dclose(H5Dcreate2(file_, absl::StrCat("v", variable).c_str(), H5T_NATIVE_FLOAT, scalar,
                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }
  H5Sclose(scalar);
  ExpectRefused("is one object more than 10000");
}

TEST_F(ForeignLayoutsTest, NumbersOfAnotherTypeAreRefused) {
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 8);
  const hid_t texts = H5Tcopy(H5T_C_S1);
  H5Tset_size(texts, H5T_VARIABLE);
  for (const hid_t type : {text, texts, hid_t{H5T_NATIVE_LDOUBLE}}) {
    if (file_ < 0) file_ = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t chunk[] = {1, 1, 1, 1};
    H5Pset_chunk(creation, 4, chunk);
    ReplaceCloud(type, creation);
    const absl::Status status = Read();
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(std::string(status.message()), HasSubstr("QCLOUD")) << H5Tget_size(type);
  }
}

}  // namespace
}  // namespace thunderhead::storm_files
