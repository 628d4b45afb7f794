#include "base/byte_source.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/file_descriptor.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::base {
namespace {

using ::testing::HasSubstr;

std::string MessageOf(const absl::Status& status) { return std::string(status.message()); }

TEST(OpenRegularFile, APathThatLeadsToNoFileIsNotFound) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.File("file");
  std::ofstream(file) << "a file";
  const std::string circle = folder.File("circle");
  std::filesystem::create_symlink("circle", circle);
  for (const std::string& path :
       {folder.File("none"), file + "/below", circle, folder.File(std::string(300, 'a'))}) {
    const absl::Status status = OpenRegularFile(path).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kNotFound) << status;
    EXPECT_THAT(MessageOf(status), HasSubstr("check the path"));
  }
  EXPECT_EQ(OpenRegularFile(folder.Path()).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(OpenRegularFile, TooManyOpenFilesAreNoMatterOfPermission) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("file");
  std::ofstream(path) << "a file";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 64;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<FileDescriptor> open_files;
  do {
    open_files.emplace_back(open("/dev/null", O_RDONLY | O_CLOEXEC));
  } while (open_files.back().IsOpen());
  const absl::Status status = OpenRegularFile(path).status();
  open_files.clear();
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(MessageOf(status),
            path +
                ": cannot be opened (Too many open files); try again, or raise the limit of open "
                "files");
}

}  // namespace
}  // namespace thunderhead::base
