// Tests of `thunderhead sequence` and `watch` when their products cannot be written: a disk that is
// full or becomes full, and a folder without write permission. The test mounts small file systems
// in its own namespaces. It is skipped if the machine refuses those.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/product_folder.h"
#include "tests/service/synthetic_run.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kDiskTimes = 3;

class FullDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("unshare -rm true 2>/dev/null") != 0) {
      GTEST_SKIP() << "no namespaces here: unshare -rm is refused";
    }
    fs::create_directories(storms_);
    for (int time = 0; time < kDiskTimes; ++time) WriteRunFile(storms_, time);
  }

  // Runs a script in its own mount namespace and returns its output line by line. The script has
  // the functions `draw` and `watch` for the program with products in $OUT, `fill` to take the rest
  // of $OUT's space, and `say`.
  std::vector<std::string> Run(const std::string& script) const {
    const std::string file = folder_.File("script");
    std::ofstream(file)
        << "set -u\nOUT='" << out_ << "'; IN='" << storms_ << "'; KEPT='" << kept_
        << "'\nmkdir -p \"$OUT\" \"$KEPT\"\n"
        << "program() { command=$1; shift; ${AS:-} '" << PROGRAM << "' $command \"$IN\" "
        << "--product \"$OUT/${IN_FOLDER:-}{valid:%H%M}.png\" --size 32x18 --quality fast "
        << "--device software --jobs 1 \"$@\" > '" << log_ << "' 2>&1; code=$?; "
        << "cat '" << log_ << "' >> '" << all_ << "'; echo \"code $code\"; }\n"
        << "draw() { program sequence \"$@\"; }\n"
        << "watch() { program watch --ready age:0 \"$@\"; }\n"
        << "fill() { cat /dev/zero > \"$OUT/fill\" 2>/dev/null; }\n"
        << "drawn() { ls \"$OUT\" | grep -c 'png$'; }\n"
        << script;
    const std::string out = folder_.File("script.out");
    const int ended =
        std::system(("unshare -rm bash " + file + " > " + out + " 2>> " + all_).c_str());
    EXPECT_EQ(ended, 0) << Contents(all_);
    std::vector<std::string> lines;
    std::ifstream said(out);
    for (std::string line; std::getline(said, line);) lines.push_back(line);
    return lines;
  }

  std::string Said() const { return Contents(all_); }

  static std::vector<std::string> Products() {
    std::vector<std::string> names;
    for (int time = 0; time < kDiskTimes; ++time) names.push_back(RunTime(time).substr(9) + ".png");
    return names;
  }

  const TemporaryFolder folder_;
  const std::string storms_ = folder_.File("run");
  const std::string out_ = folder_.File("out");
  const std::string kept_ = folder_.File("kept");  // copy of the last contents of `out_`
  const std::string log_ = folder_.File("log");
  const std::string all_ = folder_.File("all");
};

TEST_F(FullDisk, WhatItCannotHoldComesWhenThereIsRoom) {
  // The disk has space for the manifest and one or two pictures.
  const std::vector<std::string> lines = Run(R"(
    mount -t tmpfs -o size=256k none "$OUT"
    head -c $((256 * 1024 - 3 * 4096)) /dev/zero > "$OUT/fill"
    draw
    drawn
    ls "$OUT" | grep -c partial
    rm "$OUT/fill"
    draw
    drawn
    cp -a "$OUT/." "$KEPT"
  )");
  ASSERT_EQ(lines.size(), 5U) << Said();
  EXPECT_EQ(lines[0], "code 75") << Said();
  EXPECT_GE(std::stoi(lines[1]), 1) << "full from the beginning";
  EXPECT_LT(std::stoi(lines[1]), kDiskTimes) << "not full";
  EXPECT_EQ(lines[2], "0");
  EXPECT_EQ(lines[3], "code 0") << Said();
  EXPECT_THAT(Said(), HasSubstr("cannot be written (No space left on device)"));
  EXPECT_THAT(Said(), HasSubstr(" (as before)")) << "what was whole was drawn again";
  ExpectFinished(kept_, Products());
}

TEST_F(FullDisk, NeitherAManifestNorAMovieIsHalfWritten) {
  const std::vector<std::string> lines = Run(R"(
    mount -t tmpfs -o size=1m none "$OUT"
    draw
    cp "$OUT/manifest.jsonl" "$KEPT/before"
    fill
    touch "$IN"/*        # the same bytes with another date: their lines are written anew
    draw
    cmp "$OUT/manifest.jsonl" "$KEPT/before" && echo same
    rm "$KEPT/before" "$OUT/fill"
    draw
    fill
    draw --movie "$OUT/film.webm"
    draw --movie "$OUT/new/film.webm" --times 0
    ls "$OUT" | tr '\n' ' '; echo
    rm -r "$OUT/fill" "$OUT/new"
    draw --movie "$OUT/film.webm"
    cp -a "$OUT/." "$KEPT"
  )");
  EXPECT_THAT(lines, ElementsAre("code 0", "code 75", "same", "code 0", "code 75", "code 75",
                                 "2000.png 2010.png 2020.png fill manifest.jsonl new ", "code 0"))
      << Said();
  EXPECT_THAT(Said(), HasSubstr("film.webm cannot be written"));
  std::vector<std::string> products = Products();
  products.push_back("film.webm");
  ExpectFinished(kept_, products);
}

TEST_F(FullDisk, AFolderThatHasNoRoomForAnotherComesLater) {
  // There are inodes for the root and one more folder.
  const std::vector<std::string> lines = Run(R"(
    mount -t tmpfs -o size=1m,nr_inodes=2 none "$OUT"
    IN_FOLDER=a/deep/
    draw
    mount -o remount,nr_inodes=100 "$OUT"
    draw
  )");
  EXPECT_THAT(lines, ElementsAre("code 75", "code 0")) << Said();
  EXPECT_THAT(Said(), HasSubstr("the folder cannot be created (No space left on device)"));
}

TEST_F(FullDisk, WatchEndsWithTryAgainAndGoesOn) {
  const std::vector<std::string> lines = Run(R"(
    mount -t tmpfs -o size=1m none "$OUT"
    mkdir "$IN/../later"
    mv "$IN"/*20:00 "$IN/../later"
    watch --until 2
    fill
    mv "$IN"/../later/* "$IN"
    watch --until 3
    drawn
    rm "$OUT/fill"
    watch --until 3
    cp -a "$OUT/." "$KEPT"
  )");
  EXPECT_THAT(lines, ElementsAre("code 0", "code 75", "2", "code 0")) << Said();
  ExpectFinished(kept_, Products());
}

TEST_F(FullDisk, AFolderThatMayNotBeWrittenToIsConfiguration) {
  const std::vector<std::string> lines = Run(R"(
    mount --bind "$OUT" "$OUT"
    mount -o remount,bind,ro "$OUT"
    draw
    draw --manifest "$KEPT/manifest.jsonl"
    watch --until 1
    mount -o remount,bind,rw "$OUT"
    # Of a user that may not write there; root may, unless it gives up its capabilities.
    chmod 555 "$OUT"
    AS="setpriv --bounding-set=-all"
    draw
    chmod 755 "$OUT"
    ls "$OUT" | wc -l
  )");
  EXPECT_THAT(lines, ElementsAre("code 78", "code 78", "code 78", "code 78", "0")) << Said();
  EXPECT_THAT(Said(), HasSubstr("the manifest cannot be written (Read-only file system)"));
  EXPECT_THAT(Said(), HasSubstr(".png cannot be written (Read-only file system)"));
  EXPECT_THAT(Said(), HasSubstr("the manifest cannot be written (Permission denied)"));
  EXPECT_THAT(Said(), Not(HasSubstr(" ms)"))) << "a product was told that is not there";
}

}  // namespace
}  // namespace thunderhead::testing
