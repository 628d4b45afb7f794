// Support for tests of CF files: writes a file, and reads it as the store does.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "storm_store/storm_store.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {

using Index = std::map<std::string, std::size_t>;  // the index along each dimension
using Texts = std::map<std::string, std::string>;  // attributes by their names

// Returns a variable with one value.
inline testing::CfContent OfOneValue(const std::string& name, const std::vector<std::string>& on,
                                     Texts attributes, double value) {
  return {name, on, std::move(attributes), [value](const Index&) { return value; }};
}

class CfFileTest : public ::testing::Test {
 protected:
  virtual void Write(const testing::SyntheticCf& file) { testing::WriteCf(file, path_); }

  // Writes the file and reads one time of its only storm. Sets info_ to the storm's description.
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Read(
      const testing::SyntheticCf& file, int time = 0) {
    Write(file);
    auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
    if (!store.ok()) return store.status();
    info_ = *(*store)->Storms().front();
    return (*store)->Get(info_.id, time, {});
  }

  // Expects an error that names the file and says `what`.
  void ExpectError(const testing::SyntheticCf& file, const std::string& what) {
    const auto fields = Read(file);
    ASSERT_FALSE(fields.ok()) << what;
    EXPECT_THAT(std::string(fields.status().message()), ::testing::HasSubstr(path_));
    EXPECT_THAT(std::string(fields.status().message()), ::testing::HasSubstr(what));
  }

  testing::TemporaryFolder folder_;
  std::string path_ = folder_.File("cloud.nc");
  storm_store::StormInfo info_;
};

}  // namespace thunderhead::storm_files
