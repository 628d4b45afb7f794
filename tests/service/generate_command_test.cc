// Tests of `thunderhead generate` as a user runs it: every other command accepts its output.
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;

class GenerateCommand : public ::testing::Test {
 protected:
  int Run(const std::string& arguments) {
    const int status = std::system((std::string(PROGRAM) + " " + arguments + " >" +
                                    folder_.File("out") + " 2>" + folder_.File("err"))
                                       .c_str());
    out_ = Contents("out");
    err_ = Contents("err");
    return WEXITSTATUS(status);
  }

  std::string Contents(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_.File(name), std::ios::binary).rdbuf();
    return text.str();
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_.File("cloud.nc");
  std::string out_;
  std::string err_;
};

TEST_F(GenerateCommand, PresetsAreStormFiles) {
  for (const std::string preset : {"fair-weather-cumulus", "congestus", "cumulus-field"}) {
    ASSERT_EQ(Run("generate --preset " + preset + " -o " + cloud_), 0) << err_;
    EXPECT_EQ(err_, "");
    ASSERT_EQ(Run("inspect " + cloud_), 0) << err_;
    EXPECT_THAT(out_, HasSubstr("lwc"));
    EXPECT_THAT(out_, HasSubstr("kg m-3"));
    EXPECT_THAT(out_, HasSubstr(preset));
  }
}

TEST_F(GenerateCommand, ASeedIsACloud) {
  const std::string small = "generate --cells 40x40x50 --spacing 40 --octaves 3 -o ";
  const auto description = [&](const std::string& seed) {
    EXPECT_EQ(Run(small + cloud_ + " --seed " + seed), 0) << err_;
    EXPECT_EQ(Run("inspect --json " + cloud_), 0) << err_;
    nlohmann::json storm = nlohmann::json::parse(out_);
    for (nlohmann::json& time : storm["times"]) time["file"].erase("modifiedNs");
    return storm.dump();
  };
  const std::string first = description("5");
  EXPECT_EQ(description("5"), first);
  EXPECT_NE(description("6"), first);
}

TEST_F(GenerateCommand, CloudsOfOwnEllipsoidsAreDrawn) {
  ASSERT_EQ(Run("generate --cells 48x48x32 --spacing 50 --octaves 4 --persistence 0.7 "
                "--interpolation cubic --feature-size 300 --threshold 0.02 --dynamics 0.9 "
                "--water 3 --base 500 --ellipsoid 0,0,800,700,500,500,0,0,30 "
                "--ellipsoid=-300,0,1100,300,300,250 -o " +
                cloud_),
            0)
      << err_;
  const std::string picture = folder_.File("cloud.png");
  ASSERT_EQ(Run("render " + cloud_ + " --device software --size 96x64 --slices 32 -o " + picture),
            0)
      << err_;
  const auto image = frame::DecodePng(Contents("cloud.png"));
  ASSERT_TRUE(image.ok()) << image.status();
  // The cloud in the middle is brighter than the ground in the corner.
  const auto brightness = [&](int x, int y) {
    const auto* pixel = &image->rgb[static_cast<std::size_t>(y * 96 + x) * 3];
    return pixel[0] + pixel[1] + pixel[2];
  };
  EXPECT_GT(brightness(48, 32), brightness(2, 60) + 60);
  ASSERT_EQ(Run("flux " + cloud_ + " --photons 5000"), 0) << err_;
}

TEST_F(GenerateCommand, BadParametersAreNamed) {
  struct Case {
    std::string arguments;
    std::string text;
  };
  for (const Case& c : {Case{"--octaves 0", "octaves"},
                        Case{"--octaves 14", "too fine"},
                        Case{"--persistence 0", "persistence"},
                        Case{"--threshold 1", "threshold"},
                        Case{"--dynamics 1.5", "dynamics"},
                        Case{"--water -1", "water"},
                        Case{"--interpolation spline", "--interpolation"},
                        Case{"--ellipsoid 0,0,800,100,-5,100", "radius"},
                        Case{"--ellipsoid 0,0,800,100", "--ellipsoid"},
                        Case{"--ellipsoid 0,0,80000,100,100,100", "no cell"},
                        Case{"--cells 12x12", "--cells"},
                        Case{"--cells 0x4x4", "--cells"},
                        Case{"--spacing 0", "size of a cell"},
                        Case{"--preset nimbus", "nimbus"},
                        Case{"--feature-size -3", "feature"},
                        Case{"--persistence nan", "persistence"},
                        Case{"--threshold nan", "threshold"},
                        Case{"--dynamics nan", "dynamics"},
                        Case{"--water inf", "water"},
                        Case{"--feature-size nan", "feature"},
                        Case{"--base nan", "base"},
                        Case{"--spacing nan", "not a finite number"},
                        Case{"--cells 4096x4096x4096", "cells"},
                        Case{"--ellipsoid nan,0,800,100,100,100", "not finite"},
                        Case{"--ellipsoid 0,0,800,100,inf,100", "radius"},
                        Case{"--seed -1", "--seed"}}) {
    EXPECT_EQ(Run("generate -o " + cloud_ + " " + c.arguments), 64) << c.arguments;
    EXPECT_THAT(err_, HasSubstr(c.text)) << c.arguments;
    EXPECT_FALSE(std::ifstream(cloud_).good()) << c.arguments;
  }
  EXPECT_EQ(Run("generate -o cloud.png"), 64);
  EXPECT_EQ(Run("generate -o " + folder_.File("none/cloud.nc")), 78);
}

TEST_F(GenerateCommand, CloudsAreFittedByMetaballs) {
  ASSERT_EQ(Run("generate --cells 40x40x50 --spacing 40 --octaves 3 -o " + cloud_), 0) << err_;
  const std::string balls = folder_.File("cloud.balls");
  const std::string volume = folder_.File("balls.nc");
  double before = 1e30;
  for (const std::string solver : {"gradient", "direct"}) {
    for (const std::string count : {"10", "200"}) {
      ASSERT_EQ(Run("fit " + cloud_ + " --json --balls " + count + " --solver " + solver + " -o " +
                    balls + " --volume " + volume),
                0)
          << err_;
      const std::size_t at = out_.find("\"error\": ");
      ASSERT_NE(at, std::string::npos) << out_;
      const double error = std::stod(out_.substr(at + 9));
      EXPECT_TRUE(count == "10" || error < 0.8 * before) << error << " after " << before;
      before = error;
    }
  }
  EXPECT_THAT(Contents("cloud.balls"), HasSubstr("balls 200"));
  ASSERT_EQ(Run("inspect " + volume), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("extinction"));
  EXPECT_EQ(
      Run("fit " + cloud_ + " --field cloud --basis wyvill --non-negative --balls 20 -o " + balls),
      0)
      << err_;
  EXPECT_THAT(Contents("cloud.balls"), HasSubstr("quantity cloud kg/m3"));
}

// With only zeros and negative values there is no cloud to fit, and every renderer draws the sky.
TEST_F(GenerateCommand, EmptyVolumesAreNamedByFitAndDrawnAsSky) {
  for (const double value : {0.0, -1e-3}) {
    WriteCf(
        ExtinctionFile(6, 6, 4, 100.0, 100.0, 100.0, [value](auto, auto, auto) { return value; }),
        cloud_);
    EXPECT_EQ(Run("fit " + cloud_ + " --balls 3 -o " + folder_.File("x.balls")), 64) << value;
    EXPECT_THAT(err_, HasSubstr("empty")) << value;
    for (const std::string renderer : {"metaball", "cumulus", "light_volume", "half_angle"}) {
      EXPECT_EQ(Run("render " + cloud_ + " --device software --size 16x12 --technique " + renderer +
                    " -o " + folder_.File("sky.png")),
                0)
          << renderer << ' ' << value << ' ' << err_;
    }
  }
}

TEST_F(GenerateCommand, VolumesWithoutAnyValueAreRefused) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), 1e31}) {
    WriteCf(
        ExtinctionFile(6, 6, 4, 100.0, 100.0, 100.0, [value](auto, auto, auto) { return value; }),
        cloud_);
    // A file that has just changed could still be being written, which is another error.
    std::filesystem::last_write_time(
        cloud_, std::filesystem::last_write_time(cloud_) - std::chrono::hours(1));
    EXPECT_EQ(Run("fit " + cloud_ + " --balls 3 -o " + folder_.File("x.balls")), 65) << value;
    EXPECT_THAT(err_, HasSubstr("holds nothing but missing values")) << value;
    EXPECT_EQ(
        Run("render " + cloud_ + " --device software --size 16x12 -o " + folder_.File("sky.png")),
        65)
        << value << ' ' << err_;
  }
}

TEST_F(GenerateCommand, BadFitsAreNamed) {
  ASSERT_EQ(Run("generate --cells 40x40x50 --spacing 40 --octaves 3 -o " + cloud_), 0) << err_;
  const std::string fit = "fit " + cloud_ + " -o " + folder_.File("cloud.balls");
  struct Case {
    std::string arguments;
    std::string text;
  };
  for (const Case& c :
       {Case{"", "--balls"}, Case{" --balls 0", "--balls"}, Case{" --balls -4", "--balls"},
        Case{" --balls 100000000", "fewer"}, Case{" --balls 5 --field rain", "cloud"},
        Case{" --balls 5 --basis box", "--basis"}, Case{" --balls 5 --solver magic", "--solver"},
        Case{" --balls 5 --overlap 0", "overlap"}, Case{" --balls 5 --time 2", "--time"},
        Case{" --balls 5 --iterations 0", "iterations"}, Case{" --balls nan", "--balls"},
        Case{" --balls 5 --overlap nan", "overlap"}, Case{" --balls 5 --threads -1", "--threads"},
        Case{" --balls 5 --seed -1", "--seed"}}) {
    EXPECT_EQ(Run(fit + c.arguments), 64) << c.arguments;
    EXPECT_THAT(err_, HasSubstr(c.text)) << c.arguments;
  }
  EXPECT_FALSE(std::ifstream(folder_.File("cloud.balls")).good());
}

}  // namespace
}  // namespace thunderhead::testing
