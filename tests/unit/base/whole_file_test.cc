#include "base/whole_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/file_descriptor.h"
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

// Writes the file by WriteWholeFile, and starts another by StartPartial. `plant` puts something in
// place of each partial file, which must be replaced at once.
void ExpectReplaced(const std::function<void(const std::string& partial)>& plant) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  plant(PartialPath(path));
  const absl::Status written = WriteWholeFile(path, "new");
  ASSERT_TRUE(written.ok()) << written;
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
  EXPECT_EQ(ReadWholeFile(path).value(), "new");
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(PartialPath(path))));
  plant(PartialPath(path));
  const absl::StatusOr<std::string> started = StartPartial(path);
  ASSERT_TRUE(started.ok()) << started.status();
  EXPECT_EQ(*started, PartialPath(path));
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(*started)));
  EXPECT_EQ(std::filesystem::file_size(*started), 0U);
}

void MakeFifo(const std::string& path) { ASSERT_EQ(mkfifo(path.c_str(), 0600), 0); }

// Opening such a FIFO for writing waits for a reader.
TEST(WholeFile, AFifoWithoutReaderIsReplaced) { ExpectReplaced(&MakeFifo); }

TEST(WholeFile, AFifoWithAReaderIsReplacedAndGetsNothing) {
  std::vector<FileDescriptor> readers;
  ExpectReplaced([&](const std::string& partial) {
    MakeFifo(partial);
    readers.emplace_back(open(partial.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    ASSERT_TRUE(readers.back().IsOpen());
  });
  ASSERT_EQ(readers.size(), 2U);
  for (const FileDescriptor& reader : readers) {
    char byte = 0;
    EXPECT_EQ(read(reader.Get(), &byte, 1), 0) << "neither a byte nor a writer";
  }
}

TEST(WholeFile, ASocketIsReplaced) {
  ExpectReplaced([](const std::string& partial) {
    const FileDescriptor socket_file(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un address = {.sun_family = AF_UNIX, .sun_path = {}};
    ASSERT_LT(partial.size(), sizeof(address.sun_path));
    partial.copy(address.sun_path, partial.size());
    ASSERT_EQ(bind(socket_file.Get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
              0);
  });
}

TEST(WholeFile, AFolderInPlaceOfThePartialFileIsAnErrorAndStays) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  std::filesystem::create_directory(PartialPath(path));
  EXPECT_EQ(WriteWholeFile(path, "new").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(StartPartial(path).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(std::filesystem::is_directory(PartialPath(path)));
}

// The FIFO arrives between StartPartial and PublishFile.
TEST(WholeFile, AFifoIsNotPublished) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  MakeFifo(PartialPath(path));
  EXPECT_FALSE(PublishFile(path).ok());
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

// Expects that no file replaces what is at `path`.
void ExpectStays(const std::string& path, std::filesystem::file_type type) {
  const std::string partial = PartialPath(path);
  std::ofstream(partial) << "a whole file";
  const absl::Status published = PublishFile(path);
  for (const absl::Status& refusal :
       {published, WriteWholeFile(path, "new"), StartPartial(path).status()}) {
    EXPECT_EQ(refusal.code(), absl::StatusCode::kFailedPrecondition) << refusal;
    EXPECT_EQ(refusal.message(),
              path + " is not a regular file and is not replaced by one; choose another name");
  }
  EXPECT_EQ(std::filesystem::symlink_status(path).type(), type);
  EXPECT_FALSE(std::filesystem::exists(partial));
}

TEST(WholeFile, OnlyARegularFileIsReplaced) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("picture.png");
  MakeFifo(path);
  ExpectStays(path, std::filesystem::file_type::fifo);
  const std::string link = folder.File("link");
  std::filesystem::create_symlink(path, link);
  ExpectStays(link, std::filesystem::file_type::symlink);
  std::filesystem::create_symlink("/dev/null", folder.File("null"));
  ExpectStays(folder.File("null"), std::filesystem::file_type::symlink);
  if (const std::string device = folder.File("device");
      mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0) {  // only root can make one
    ExpectStays(device, std::filesystem::file_type::character);
  }
}

TEST(WholeFile, ALinkToAFileOrToNothingIsReplacedAndNotFollowed) {
  const testing::TemporaryFolder folder;
  const std::string target = folder.File("target");
  const std::string path = folder.File("picture.png");
  std::ofstream(target) << "kept";
  for (const std::string& leads_to : {target, folder.File("nothing")}) {
    std::filesystem::remove(path);
    std::filesystem::create_symlink(leads_to, path);
    ASSERT_TRUE(WriteWholeFile(path, "new").ok());
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
  }
  EXPECT_EQ(ReadWholeFile(target).value(), "kept");
  EXPECT_FALSE(std::filesystem::exists(folder.File("nothing")));
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
