#include "base/own_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace thunderhead::base {
namespace {

namespace fs = std::filesystem;

TEST(OwnFile, ReadsTheWholeFileAlsoInALinkedFolder) {
  const testing::TemporaryFolder folder;
  const std::string bytes = std::string(100'000, 'a') + std::string(1, '\0') + "end";
  std::ofstream(folder.File("picture.png"), std::ios::binary) << bytes;
  EXPECT_EQ(ReadOwnFile(folder.File("picture.png")).value_or(""), bytes);
  fs::create_directory(folder.File("other"));
  fs::create_directory_symlink(folder.Path(), folder.File("other/products"));
  EXPECT_EQ(ReadOwnFile(folder.File("other/products/picture.png")).value_or(""), bytes);
  std::ofstream(folder.File("empty")).flush();
  EXPECT_EQ(ReadOwnFile(folder.File("empty")).value_or("none"), "");
}

TEST(OwnFile, RefusesWhatIsPlantedAndWaitsForNoWriter) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  const std::string secret = folder.File("secret");
  const auto code = [&] { return ReadOwnFile(path).status().code(); };
  EXPECT_EQ(code(), absl::StatusCode::kNotFound);
  std::ofstream(secret) << "secret";
  fs::create_symlink(secret, path);
  EXPECT_EQ(code(), absl::StatusCode::kDataLoss);
  fs::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(code(), absl::StatusCode::kDataLoss);
  fs::remove(path);
  fs::create_directory(path);
  EXPECT_EQ(code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(ReadOwnFile(folder.File("missing/picture.png")).status().code(),
            absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace thunderhead::base
