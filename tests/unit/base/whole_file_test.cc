#include "base/whole_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace thunderhead::base {
namespace {

// Another user of the folder could otherwise make the program overwrite its owner's files.
TEST(WholeFile, APlantedLinkIsNotFollowed) {
  const testing::TemporaryFolder folder;
  const std::string victim = folder.File("victim");
  const std::string path = folder.File("picture.png");
  std::ofstream(victim) << "kept";
  std::filesystem::create_symlink(victim, PartialPath(path));
  ASSERT_TRUE(WriteWholeFile(path, "new").ok());
  EXPECT_EQ(ReadWholeFile(victim).value(), "kept");
  EXPECT_EQ(ReadWholeFile(path).value(), "new");
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
  EXPECT_FALSE(std::filesystem::exists(PartialPath(path)));
  std::filesystem::create_hard_link(victim, PartialPath(path));
  ASSERT_TRUE(WriteWholeFile(path, "newer").ok());
  EXPECT_EQ(ReadWholeFile(victim).value(), "kept");
  EXPECT_EQ(ReadWholeFile(path).value(), "newer");
}

TEST(WholeFile, WhatAnInterruptedWriteLeftIsReplaced) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  std::ofstream(PartialPath(path)) << "a longer text that was cut";
  ASSERT_TRUE(WriteWholeFile(path, "new").ok());
  EXPECT_EQ(ReadWholeFile(path).value(), "new");
  EXPECT_FALSE(WriteWholeFile(folder.File("missing/picture.png"), "new").ok());
}

}  // namespace
}  // namespace thunderhead::base
