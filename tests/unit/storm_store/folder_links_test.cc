// Tests of symbolic links in data folders: cycles, links to the outside, and links that cannot be
// followed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "storm_store/storm_catalogue.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class FolderLinks : public ::testing::Test {
 protected:
  FolderLinks() {
    fs::create_directories(data_ / "sub");
    fs::create_directories(outside_);
    Write(data_ / "own.nc", "QCLOUD");
    Write(outside_ / "secret.nc", "QRAIN");
  }

  // Writes a file with `field`. Files with different fields are different storms, not further times
  // of one.
  static void Write(const fs::path& path, const std::string& field) {
    testing::SyntheticWrf storm;
    storm.mixing_ratios[field] = [](const testing::WrfCell&) { return 1e-3; };
    testing::WriteWrf(storm, path.string());
  }

  // Searches the data folder and returns the storms' ids. Also records what was left out and which
  // folders were listed.
  std::vector<std::string> Find(const LinkPolicy& links = {}) {
    left_out_.clear();
    folders_ = 0;
    const storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
    const auto storms = FindStorms(
        {data_.string()},
        {.describe =
             [&](const std::vector<std::string>& paths) {
               return DescribeInBatches(paths, formats, [] { return true; });
             },
         .describe_together = {},
         .may_find_nothing = true,
         .on_unlisted = [&](const std::string&,
                            const absl::Status& why) { left_out_.emplace_back(why.message()); },
         .on_folder = [&](const std::string&) { ++folders_; },
         .examples = formats.Examples(),
         .links = links});
    std::vector<std::string> ids;
    EXPECT_TRUE(storms.ok()) << storms.status();
    for (const CataloguedStorm& storm : *storms) ids.push_back(storm.info.id);
    return ids;
  }

  testing::TemporaryFolder folder_;
  const fs::path data_ = folder_.Path() / "data";
  const fs::path outside_ = folder_.Path() / "outside";
  std::vector<std::string> left_out_;
  int folders_ = 0;
};

TEST_F(FolderLinks, AFolderIsVisitedOnce) {
  for (const char* name : {"a", "b", "c"}) fs::create_directory_symlink(".", data_ / name);
  fs::create_directory_symlink("..", data_ / "sub" / "up");
  EXPECT_THAT(Find(), ElementsAre("own"));
  EXPECT_EQ(folders_, 2);
  EXPECT_THAT(left_out_, IsEmpty());
}

TEST_F(FolderLinks, LinksOutOfTheDataFoldersAreRefusedWithTheRemedy) {
  fs::create_directory_symlink(outside_, data_ / "sub" / "link");
  fs::create_symlink(outside_ / "secret.nc", data_ / "secretfile.nc");
  EXPECT_THAT(Find(), ElementsAre("own"));
  const std::string remedy = "allow it with --allow-links-to " + outside_.string();
  EXPECT_THAT(left_out_, UnorderedElementsAre(HasSubstr(remedy), HasSubstr(remedy)));
}

TEST_F(FolderLinks, AllowedFoldersMayBeLinkedTo) {
  fs::create_symlink(outside_ / "secret.nc", data_ / "linked.nc");
  EXPECT_THAT(Find({.allowed = {outside_.string()}, .untrusted = {}}),
              UnorderedElementsAre("own", "linked"));
  EXPECT_THAT(left_out_, IsEmpty());
  // A folder whose name merely begins like an allowed one is not allowed.
  EXPECT_THAT(Find({.allowed = {(folder_.Path() / "out").string()}, .untrusted = {}}),
              ElementsAre("own"));
}

TEST_F(FolderLinks, WhereAFileReallyLiesDecides) {
  const std::string data = data_.string();
  const std::string own = (data_ / "own.nc").string();
  const std::string secret = (outside_ / "secret.nc").string();
  const LinkPolicy trusted;
  EXPECT_TRUE(CheckPlace({data}, trusted, own, own).ok());
  EXPECT_FALSE(CheckPlace({data}, trusted, own, secret).ok());
  EXPECT_TRUE(
      CheckPlace({data}, {.allowed = {outside_.string()}, .untrusted = {}}, own, secret).ok());
  // A file found in an untrusted folder must lie there, whatever other links are allowed.
  const LinkPolicy untrusted{.allowed = {outside_.string()}, .untrusted = {data + "/sub/"}};
  EXPECT_TRUE(CheckPlace({data}, untrusted, data + "/sub/a.nc", data + "/sub/a.nc").ok());
  EXPECT_FALSE(CheckPlace({data}, untrusted, data + "/sub/a.nc", secret).ok());
  EXPECT_FALSE(CheckPlace({data}, untrusted, data + "/sub/a.nc", own).ok());
  EXPECT_TRUE(CheckPlace({data}, untrusted, own, secret).ok());
}

TEST_F(FolderLinks, AFileOfTooManyTimesIsRefused) {
  EXPECT_TRUE(storm_files::CheckRecords("a.nc", storm_files::kMaxTimes).ok());
  EXPECT_FALSE(storm_files::CheckRecords("a.nc", storm_files::kMaxTimes + 1).ok());
}

TEST_F(FolderLinks, LinksWithinTheDataFoldersAreFollowed) {
  fs::create_symlink(data_ / "own.nc", data_ / "sub" / "same.nc");
  EXPECT_THAT(Find(), ElementsAre("own"));
  EXPECT_THAT(left_out_, IsEmpty());
}

// If the link stayed and the file were dropped, the link's owner could exchange the storm.
TEST_F(FolderLinks, AFileIsFoundWhereItIsAndNotThroughALinkThatComesBefore) {
  fs::create_directories(data_ / "a");
  fs::create_directories(data_ / "z");
  Write(data_ / "z" / "run.nc", "QSNOW");
  fs::create_symlink(data_ / "z" / "run.nc", data_ / "a" / "run.nc");
  fs::create_directory_symlink(data_ / "z", data_ / "b");
  for (const std::string& data : {data_.string(), data_.string() + "/"}) {
    const auto storms = FindStorms({data}, storm_files::StormFormats::BuiltIn());
    ASSERT_TRUE(storms.ok()) << storms.status();
    ASSERT_EQ(storms->size(), 2U);
    EXPECT_EQ(storms->back().info.id, "run");
    EXPECT_EQ(fs::path(storms->back().info.files.front()), data_ / "z" / "run.nc");
  }
  // The searched path itself may be a link, and a file may be found through a link only.
  fs::create_directory_symlink(data_, folder_.Path() / "link");
  const auto linked =
      FindStorms({(folder_.Path() / "link").string()}, storm_files::StormFormats::BuiltIn());
  ASSERT_TRUE(linked.ok()) << linked.status();
  ASSERT_EQ(linked->size(), 2U);
  EXPECT_EQ(fs::path(linked->back().info.files.front()), folder_.Path() / "link" / "z" / "run.nc");
  fs::rename(data_ / "z", data_ / ".z");
  fs::remove(data_ / "a" / "run.nc");
  fs::create_symlink(data_ / ".z" / "run.nc", data_ / "a" / "run.nc");
  EXPECT_THAT(Find(), UnorderedElementsAre("own", "run"));
}

TEST_F(FolderLinks, UntrustedFoldersHaveNone) {
  fs::create_symlink(outside_ / "secret.nc", data_ / "sub" / "linked.nc");
  fs::create_symlink(data_ / "own.nc", data_ / "sub" / "same.nc");
  EXPECT_THAT(Find({.allowed = {outside_.string()}, .untrusted = {(data_ / "sub").string()}}),
              ElementsAre("own"));
  EXPECT_THAT(left_out_,
              UnorderedElementsAre(HasSubstr("not followed"), HasSubstr("not followed")));
}

TEST_F(FolderLinks, WhatIsNoFileIsNoStorm) {
  fs::create_symlink("/dev/zero", data_ / "zero.nc");
  fs::create_symlink("loop", data_ / "loop");
  fs::create_symlink("/proc/self/environ", data_ / "environ.nc");
  EXPECT_THAT(Find({.allowed = {outside_.string()}, .untrusted = {}}), ElementsAre("own"));
}

}  // namespace
}  // namespace thunderhead::storm_store
