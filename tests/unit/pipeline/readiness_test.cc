#include "pipeline/readiness.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::pipeline {
namespace {

using ::testing::HasSubstr;

SeenFile File(const std::string& name, double unchanged_s, std::uint64_t bytes = 1000) {
  SeenFile file;
  file.name = name;
  file.bytes = bytes;
  file.unchanged = absl::Seconds(unchanged_s);
  return file;
}

// Returns the reason why the first file is not ready; "" if it is ready.
std::string Waits(const std::string& policy, const std::vector<SeenFile>& files,
                  std::vector<std::string> names = {}) {
  for (const SeenFile& file : files) names.push_back(file.name);
  return ReadinessPolicy::Parse(policy)->WaitsFor(files.front(), files, names).value_or("");
}

TEST(Readiness, OpenAndAgeWaitForQuiet) {
  EXPECT_THAT(Waits("open", {File("a", 1.5)}), HasSubstr("less than 2s"));
  EXPECT_EQ(Waits("open", {File("a", 2.5)}), "");
  EXPECT_THAT(Waits("age:60", {File("a", 59)}), HasSubstr("less than 1m"));
  EXPECT_EQ(Waits("age:60", {File("a", 61)}), "");
  EXPECT_THAT(Waits("age:60,minsize:2000", {File("a", 61)}), HasSubstr("1000 of at least 2000"));
  EXPECT_EQ(Waits("age:60,minsize:1000", {File("a", 61)}), "");
}

TEST(Readiness, NextWaitsForALaterName) {
  EXPECT_THAT(Waits("next", {File("b", 1e6), File("a", 0)}), HasSubstr("next file"));
  EXPECT_EQ(Waits("next", {File("b", 0), File("c", 0)}), "");
  EXPECT_THAT(Waits("next,age:600", {File("b", 599)}), HasSubstr("less than 10m"));
  EXPECT_EQ(Waits("next,age:600", {File("b", 601)}), "");
}

TEST(Readiness, MarkersBelongToTheFileWhoseNameEndsAlike) {
  const SeenFile file = File("wrfout_d01_2013-05-20_20:00:00", 0);
  const std::string policy = "marker:wrfoutReady_*";
  EXPECT_THAT(Waits(policy, {file}), HasSubstr("no marker file wrfoutReady_* exists for it"));
  EXPECT_THAT(Waits(policy, {file}, {"wrfoutReady_d01_2013-05-20_20:10:00"}),
              HasSubstr("no marker file"));
  EXPECT_THAT(Waits(policy, {file}, {"wrfoutReady_"}), HasSubstr("no marker file"));
  EXPECT_EQ(Waits(policy, {file}, {"wrfoutReady_d01_2013-05-20_20:00:00"}), "");
  EXPECT_EQ(Waits("marker:*.done", {File("a.nc", 0)}, {"a.nc.done"}), "");
  EXPECT_EQ(Waits("marker:*.ok", {File("a.nc", 0)}, {"a.ok"}), "");
  EXPECT_TRUE(ReadinessPolicy::Parse(policy)->IsMarker("wrfoutReady_d01"));
  EXPECT_FALSE(ReadinessPolicy::Parse(policy)->IsMarker(file.name));
  EXPECT_FALSE(ReadinessPolicy::Parse("open")->IsMarker("wrfoutReady_d01"));
}

TEST(Readiness, OtherPoliciesAreRefused) {
  for (const char* wrong : {"", "later", "age", "age:", "age:x", "age:-1", "minsize:5",
                            "open,age:5", "age:5,open", "next,minsize:5", "marker:", "marker:*",
                            "marker:ready", "marker:a*b*", "marker:up/*", "age:5,age:6"}) {
    EXPECT_EQ(ReadinessPolicy::Parse(wrong).status().code(), absl::StatusCode::kInvalidArgument)
        << wrong;
  }
}

}  // namespace
}  // namespace thunderhead::pipeline
