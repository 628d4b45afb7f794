#include "pipeline/plan.h"

#include <cstdlib>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Plan, TimesAreIndicesAndRanges) {
  EXPECT_THAT(*ParseTimes("all", 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(*ParseTimes("last", 3), ElementsAre(2));
  EXPECT_THAT(*ParseTimes("4,0-2,1", 5), ElementsAre(0, 1, 2, 4));
  for (const char* wrong : {"", "5", "-1", "2-1", "0-5", "1-", "x", "0,,1"}) {
    EXPECT_THAT(std::string(ParseTimes(wrong, 5).status().message()), HasSubstr("--times is"))
        << wrong;
  }
}

TEST(Plan, ShardsComeFromTheFlagOrTheBatchSystem) {
  EXPECT_EQ(ParseShard("2/4")->index, 2);
  EXPECT_EQ(ParseShard("2/4")->count, 4);
  for (const char* wrong : {"", "4/4", "-1/4", "1/0", "1", "a/b"}) {
    EXPECT_THAT(std::string(ParseShard(wrong).status().message()), HasSubstr("--shard is"))
        << wrong;
  }
  const auto clear = [] {
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT",
                             "SLURM_ARRAY_TASK_MIN", "JOB_COMPLETION_INDEX", "JOB_COMPLETIONS"}) {
      unsetenv(name);
    }
  };
  clear();
  EXPECT_EQ(ShardOfEnvironment()->count, 1);
  setenv("SLURM_ARRAY_TASK_ID", "3", 1);
  EXPECT_FALSE(ShardOfEnvironment().ok());
  setenv("SLURM_ARRAY_TASK_COUNT", "4", 1);
  setenv("SLURM_ARRAY_TASK_MIN", "1", 1);
  EXPECT_EQ(ShardOfEnvironment()->index, 2);
  EXPECT_EQ(ShardOfEnvironment()->count, 4);
  clear();
  setenv("JOB_COMPLETION_INDEX", "1", 1);
  EXPECT_FALSE(ShardOfEnvironment().ok());
  setenv("JOB_COMPLETIONS", "2", 1);
  EXPECT_EQ(ShardOfEnvironment()->index, 1);
  clear();
  EXPECT_EQ(ManifestName({0, 1}), "manifest.jsonl");
  EXPECT_EQ(ManifestName({2, 4}), "manifest.2-of-4.jsonl");
  EXPECT_TRUE(IsManifestOfShare("manifest.2-of-4.jsonl"));
  for (const char* other : {"manifest.jsonl", "manifest.west.jsonl", "manifest.4-of-4.jsonl",
                            "manifest.02-of-4.jsonl", "manifest.-of-.jsonl", "manifest.2-of-4.txt",
                            "manifest..jsonl", "x.manifest.2-of-4.jsonl"}) {
    EXPECT_FALSE(IsManifestOfShare(other)) << other;
  }
}

}  // namespace
}  // namespace thunderhead::pipeline
