#include "pipeline/manifest.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "base/whole_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pipeline/plan.h"
#include "pipeline/sha256.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ManifestEntry Entry(const std::string& sha256) {
  ManifestEntry entry;
  entry.bytes = 12;
  entry.sha256 = sha256;
  entry.storm = "supercell";
  entry.valid = "2013-05-20T19:40:00Z";
  entry.run = "2013-05-20T12:00:00Z";
  entry.lead_s = 27600.0;
  entry.view = "west";
  entry.scene_sha256 = "5ce7e";
  entry.version = "1.2.3";
  entry.device = "software";
  entry.milliseconds = 250.5;
  entry.input = {"/data/wrfout", 99, 1'700'000'000'123'456'789, "1f"};
  return entry;
}

class ManifestTest : public ::testing::Test {
 protected:
  std::string Text() const { return *base::ReadWholeFile(path_); }

  const testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("manifest.jsonl");
};

TEST(Sha256Test, IsThatOfTheStandard) {
  // The example is from FIPS 180-2, appendix B.1.
  EXPECT_EQ(Sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256OfFile("/no/such/file").status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(ManifestTest, AnEntryComesBackWhole) {
  const auto back = FromLine(ToLine(Entry("abc")));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(ToLine(*back), ToLine(Entry("abc")));
  EXPECT_EQ(back->input.modified_ns, 1'700'000'000'123'456'789);
  EXPECT_EQ(back->lead_s, 27600.0);
  EXPECT_FALSE(back->estimated_error.has_value());
  EXPECT_FALSE(back->error_low.has_value());
  EXPECT_EQ(FromLine("{}").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(ManifestTest, AMeasuredErrorHasItsInterval) {
  ManifestEntry entry = Entry("abc");
  entry.estimated_error = 0.2;
  entry.error_low = 0.15;
  entry.error_high = 0.25;
  const std::string line = ToLine(entry);
  EXPECT_EQ(FromLine(line)->error_low, 0.15);
  EXPECT_EQ(FromLine(line)->error_high, 0.25);
  // Earlier versions wrote a manifest line in this form.
  const std::string interval = R"("error_low":0.15,"error_high":0.25,)";
  std::string earlier = line;
  ASSERT_NE(earlier.find(interval), std::string::npos) << line;
  earlier.erase(earlier.find(interval), interval.size());
  ASSERT_TRUE(FromLine(earlier).ok());
  EXPECT_EQ(FromLine(earlier)->estimated_error, 0.2);
  EXPECT_FALSE(FromLine(earlier)->error_low.has_value());
}

TEST_F(ManifestTest, EntriesOutliveTheProcessAndTheLastOfAProductCounts) {
  {
    auto manifest = *Manifest::Open(path_, {});
    ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry("1")).ok());
    ASSERT_TRUE(manifest.Record(folder_.File("sub/b.png"), Entry("2")).ok());
    ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry("3")).ok());
    // This process still owns the manifest after its file was replaced.
    EXPECT_EQ(Manifest::Open(path_, {}).status().code(), absl::StatusCode::kUnavailable);
    ASSERT_TRUE(manifest.Record(folder_.File("c.png"), Entry("4")).ok());
  }
  const auto manifest = *Manifest::Open(path_, {});
  EXPECT_EQ(manifest.Find(folder_.File("a.png"))->sha256, "3");
  EXPECT_EQ(manifest.Find(folder_.File("sub/b.png"))->file, "sub/b.png");
  EXPECT_EQ(manifest.Find(folder_.File("c.png"))->sha256, "4");
  EXPECT_EQ(manifest.Find(folder_.File("d.png")), nullptr);
  const std::string text = Text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_FALSE(std::filesystem::exists(base::PartialPath(path_)));
}

TEST_F(ManifestTest, ATornLastLineIsDroppedAndAnotherIsAnError) {
  const std::string first = ToLine(Entry("1")) + "\n";
  const std::string second = ToLine(Entry("2"));
  for (const std::size_t length : {std::size_t{1}, second.size() / 2, second.size()}) {
    std::ofstream(path_) << first << second.substr(0, length);
    auto manifest = Manifest::Open(path_, {});
    ASSERT_TRUE(manifest.ok()) << manifest.status();
    EXPECT_EQ(Text(), first);
    ASSERT_TRUE(manifest->Record(folder_.File("c.png"), Entry("3")).ok());
    EXPECT_EQ(Text().size(),
              first.size() + ToLine(*manifest->Find(folder_.File("c.png"))).size() + 1);
  }
  std::ofstream(path_) << second.substr(0, 20) << "\n" << first;
  const auto broken = Manifest::Open(path_, {});
  EXPECT_EQ(broken.status().code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(broken.status().message()), HasSubstr("manifest.jsonl: line 1 is not"));
}

TEST_F(ManifestTest, ProductsOfOtherShardsCount) {
  const std::string other = folder_.File("manifest.1-of-2.jsonl");
  {
    auto manifest = *Manifest::Open(other, {});
    ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry("1")).ok());
    ASSERT_TRUE(manifest.Record(folder_.File("b.png"), Entry("2")).ok());
  }
  {
    auto manifest = *Manifest::Open(path_, {.count = {other}, .take_over = {}});
    EXPECT_EQ(manifest.Find(folder_.File("b.png"))->sha256, "2");
    ASSERT_TRUE(manifest.Record(folder_.File("b.png"), Entry("3")).ok());
    EXPECT_EQ(manifest.Find(folder_.File("a.png"))->sha256, "1");
    EXPECT_EQ(manifest.Find(folder_.File("b.png"))->sha256, "3");
  }
  // If several manifests in the folder had lines for one product, only the valid line remains.
  EXPECT_THAT(*base::ReadWholeFile(other), Not(HasSubstr("b.png")));
  EXPECT_THAT(*base::ReadWholeFile(other), HasSubstr("a.png"));
  EXPECT_THAT(Text(), HasSubstr("b.png"));
  // A manifest that another process has open stays unchanged.
  const auto kept = *Manifest::Open(other, {});
  auto manifest = *Manifest::Open(path_, {.count = {other}, .take_over = {}});
  ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry("4")).ok());
  EXPECT_THAT(*base::ReadWholeFile(other), HasSubstr("a.png"));
}

TEST_F(ManifestTest, OfTwoOthersTheOneWrittenToLastCounts) {
  const std::string first = folder_.File("manifest.0-of-2.jsonl");
  const std::string second = folder_.File("manifest.1-of-2.jsonl");
  for (const std::string& path : {first, second}) {
    auto manifest = *Manifest::Open(path, {});
    ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry(path)).ok());
  }
  const auto now = std::filesystem::last_write_time(second);
  for (const std::string& newest : {first, second}) {
    std::filesystem::last_write_time(first, now - std::chrono::seconds(newest == first ? 1 : 9));
    std::filesystem::last_write_time(second, now - std::chrono::seconds(5));
    const auto manifest = *Manifest::Open(path_, {.count = {first, second}, .take_over = {}});
    EXPECT_EQ(manifest.Find(folder_.File("a.png"))->sha256, newest);
    EXPECT_EQ(manifest.Entries().size(), 1U);
  }
}

TEST_F(ManifestTest, ManifestsOfSharesThatHaveEndedAreTakenOver) {
  const std::string ended = folder_.File("manifest.0-of-2.jsonl");
  const std::string running = folder_.File("manifest.1-of-2.jsonl");
  {
    auto manifest = *Manifest::Open(ended, {});
    ASSERT_TRUE(manifest.Record(folder_.File("a.png"), Entry("1")).ok());
    ASSERT_TRUE(manifest.Record(folder_.File("b.png"), Entry("2")).ok());
  }
  // One of several programs that share the work was killed while it wrote a line.
  std::ofstream(ended, std::ios::app) << ToLine(Entry("9")).substr(0, 30);
  auto other = *Manifest::Open(running, {});
  ASSERT_TRUE(other.Record(folder_.File("c.png"), Entry("3")).ok());
  {
    const auto manifest = *Manifest::Open(path_, {.count = {}, .take_over = {ended, running}});
    EXPECT_FALSE(std::filesystem::exists(ended));
    EXPECT_TRUE(std::filesystem::exists(running));
    EXPECT_EQ(manifest.Entries().size(), 3U);
    EXPECT_EQ(manifest.Find(folder_.File("c.png"))->sha256, "3");
  }
  const std::string text = Text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  // If the program is killed before it deletes the other manifest, this file remains. Its entries
  // must not be added twice.
  std::ofstream(ended) << text;
  const auto again = *Manifest::Open(path_, {.count = {}, .take_over = {ended}});
  EXPECT_EQ(Text(), text);
  EXPECT_FALSE(std::filesystem::exists(ended));
}

TEST_F(ManifestTest, AFolderThatMayNotBeWrittenToIsConfiguration) {
  EXPECT_EQ(Manifest::Open(folder_.File("none/manifest.jsonl"), {}).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

// Another user of the folder could otherwise make the program change or read its owner's files.
TEST_F(ManifestTest, WhatIsPlantedInItsPlaceIsNeitherFollowedNorChanged) {
  const std::string victim = folder_.File("victim");
  std::ofstream(victim) << "kept without a line break";
  const auto refusal = [&](const OtherManifests& others) {
    const absl::Status status = Manifest::Open(path_, others).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
    EXPECT_EQ(*base::ReadWholeFile(victim), "kept without a line break");
    return std::string(status.message());
  };
  std::filesystem::create_symlink(victim, path_);
  EXPECT_THAT(refusal({}), HasSubstr("this is a symbolic link"));
  std::filesystem::remove(path_);
  std::filesystem::create_symlink(folder_.File("new"), path_);
  EXPECT_THAT(refusal({}), HasSubstr("remove it, or name another manifest with --manifest"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("new")));
  std::filesystem::remove(path_);
  std::filesystem::create_hard_link(victim, path_);
  EXPECT_THAT(refusal({}), HasSubstr("a hard link"));
  std::filesystem::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THAT(refusal({}), HasSubstr("this is a FIFO"));
  std::filesystem::remove(path_);
  const std::string other = folder_.File("manifest-2.jsonl");
  std::filesystem::create_symlink(victim, other);
  EXPECT_THAT(refusal({.count = {other}, .take_over = {}}), HasSubstr("this is a symbolic link"));
  EXPECT_THAT(refusal({.count = {}, .take_over = {other}}), HasSubstr("this is a symbolic link"));
}

TEST_F(ManifestTest, AFifoInPlaceOfThePartialFileIsReplaced) {
  const std::string product = folder_.File("a.png");
  const std::string other = folder_.File("manifest-2.jsonl");
  ASSERT_TRUE(Manifest::Open(other, {})->Record(product, Entry("1")).ok());
  auto manifest = *Manifest::Open(path_, {.count = {other}, .take_over = {}});
  ASSERT_EQ(mkfifo(base::PartialPath(other).c_str(), 0600), 0);
  ASSERT_TRUE(manifest.Record(product, Entry("2")).ok());
  EXPECT_EQ(*base::ReadWholeFile(other), "");
  ASSERT_EQ(mkfifo(base::PartialPath(path_).c_str(), 0600), 0);
  ASSERT_TRUE(manifest.Record(product, Entry("3")).ok());
  EXPECT_THAT(Text(), HasSubstr(R"("sha256":"3")"));
  EXPECT_THAT(Text(), Not(HasSubstr(R"("sha256":"2")")));
}

TEST_F(ManifestTest, AFileThatIsTooLargeIsNotRead) {
  std::ofstream(path_).flush();
  std::filesystem::resize_file(path_, (std::uintmax_t{1} << 30) + 1);  // without blocks
  const absl::Status status = Manifest::Open(path_, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("1073741825 bytes"));
}

TEST(MadeAlikeTest, ByScenePathSizeTimeVersionOrTheInputsHash) {
  ManifestEntry entry = Entry("1");
  InputFile input = entry.input;
  input.sha256 = "";
  const auto never = []() -> std::string {
    ADD_FAILURE() << "hashed";
    return "";
  };
  const auto same = [] { return "1f"; };
  const auto other = [] { return "2f"; };
  EXPECT_TRUE(MadeAlike(entry, "5ce7e", "1.2.3", input, never));
  EXPECT_FALSE(MadeAlike(entry, "other", "1.2.3", input, never));
  EXPECT_FALSE(MadeAlike(entry, "5ce7e", "1.2.4", input, never));
  input.modified_ns += 1;
  EXPECT_TRUE(MadeAlike(entry, "5ce7e", "1.2.3", input, same));
  EXPECT_FALSE(MadeAlike(entry, "5ce7e", "1.2.3", input, other));
  input.bytes += 1;
  EXPECT_FALSE(MadeAlike(entry, "5ce7e", "1.2.3", input, never));
  input = entry.input;
  input.sha256 = "2f";
  EXPECT_FALSE(MadeAlike(entry, "5ce7e", "1.2.3", input, never));
}

}  // namespace
}  // namespace thunderhead::pipeline
