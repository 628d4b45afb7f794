#include "base/named_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::base {
namespace {

using ::testing::HasSubstr;

std::string ErrorOf(const std::string& path) {
  const absl::Status status = ReadBoundedFile(path, 2048).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << path;
  return std::string(status.message());
}

TEST(NamedFile, OnlyRegularFilesUpToTheLimitAreRead) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("file");
  const auto write = [&path](std::size_t bytes) { std::ofstream(path) << std::string(bytes, 'x'); };
  for (const std::size_t bytes : {0, 1, 2048}) {
    write(bytes);
    EXPECT_EQ(ReadBoundedFile(path, 2048).value(), std::string(bytes, 'x'));
  }
  write(2049);
  EXPECT_EQ(ErrorOf(path),
            path + " has more than 2 KiB, the limit; check that it is the right file");
  EXPECT_EQ(ReadFileStart(path, 2048).value(), std::string(2048, 'x'));
  // The file is read in several blocks.
  write(200'000);
  EXPECT_EQ(ReadBoundedFile(path, 200'000).value(), std::string(200'000, 'x'));

  EXPECT_THAT(ErrorOf(folder.File("none")), HasSubstr("none cannot be read (No such file"));
  EXPECT_THAT(ErrorOf(folder.File("")), HasSubstr("is neither a regular file nor a pipe"));
  EXPECT_THAT(ErrorOf("/dev/zero"), HasSubstr("/dev/zero is neither a regular file"));
}

TEST(NamedFile, ReadRegularFileWaitsForNoPipe) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("fifo");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(ReadRegularFile(path, 2048).status().message(),
            path + " is not a regular file; check the path");
  std::ofstream(folder.File("file")) << "sun";
  std::filesystem::create_symlink(folder.File("file"), folder.File("link"));
  EXPECT_EQ(ReadRegularFile(folder.File("link"), 3).value(), "sun");
  EXPECT_FALSE(ReadRegularFile(folder.File("link"), 2).ok());
}

TEST(NamedFile, PipesAreReadToTheirEnd) {
  const testing::TemporaryFolder folder;
  const std::string fifo = folder.File("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(ReadBoundedFile(fifo, 2048).value(), "") << "it has no writer";
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const FileDescriptor out(ends[0]);
  FileDescriptor in(ends[1]);
  const std::string path = absl::StrCat("/dev/fd/", out.Get());
  auto read = std::async(std::launch::async, [&] { return ReadBoundedFile(path, 2048); });
  for (const char* const part : {"sun", "shine"}) {
    ASSERT_GT(write(in.Get(), part, std::strlen(part)), 0);
  }
  in = {};
  EXPECT_EQ(read.get().value(), "sunshine");
}

}  // namespace
}  // namespace thunderhead::base
