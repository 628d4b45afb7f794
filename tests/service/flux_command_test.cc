// Tests of `thunderhead flux` as a user runs it, on files written here. Shares of sunlight are
// compared with closed forms and with rays traced through the same cells. Sampled shares must lie
// within 4 standard errors of the expected value. There are 60 or so comparisons. One of them would
// fail by chance in 250 runs if the seed were not fixed.
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/running_program.h"
#include "tests/service/terminal.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Cell = std::size_t;

struct Share {
  double value = 0.0;
  double standard_error = 0.0;
};

class FluxCommand : public ::testing::Test {
 protected:
  int Run(const std::string& arguments) {
    const int status = std::system((std::string(PROGRAM) + " flux " + arguments + " >" +
                                    folder_.File("out") + " 2>" + folder_.File("err"))
                                       .c_str());
    out_ = Contents("out");
    err_ = Contents("err");
    return WEXITSTATUS(status);
  }

  // Runs with --json and parses the shares.
  void Flux(const std::string& arguments) {
    ASSERT_EQ(Run(arguments + " --json"), 0) << err_;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(out_, &json_).ok()) << out_;
    // Every photon ends in exactly one place.
    EXPECT_NEAR(Of("reflectance").value + Of("absorptance").value + Of("sides").value +
                    Of("ground_absorptance").value,
                1.0, 1e-8);
    EXPECT_NEAR(Of("transmittance_direct").value + Of("transmittance_diffuse").value,
                Of("transmittance").value, 1e-8);
  }

  Share Of(const std::string& name) const {
    return {json_.fields().at(name).number_value(),
            json_.fields().at(name + "_stderr").number_value()};
  }

  void ExpectShare(const std::string& name, double expected, double known_to = 0.0) const {
    const Share share = Of(name);
    EXPECT_NEAR(share.value, expected, 4.0 * share.standard_error + known_to) << name;
  }

  std::string Write(const SyntheticCf& file) {
    const std::string path = folder_.File("cloud.nc");
    WriteCf(file, path);
    return path;
  }

 private:
  std::string Contents(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_.File(name)).rdbuf();
    return text.str();
  }

 protected:
  TemporaryFolder folder_;
  std::string out_;
  std::string err_;
  google::protobuf::Struct json_;
};

// Returns the direct beam's transmittance through constant cells. It traces rays from a fine
// lattice on the top, in steps of a fiftieth of a cell's height. The sun's azimuth is clockwise
// from north.
double TracedDirect(const std::function<double(double x_m, double y_m, double z_m)>& extinction,
                    double width_m, double depth_m, double height_m, double elevation_deg,
                    double azimuth_deg, double* through_sides = nullptr) {
  const double elevation = elevation_deg * std::numbers::pi / 180.0;
  const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
  const double drift_x = -std::sin(azimuth) / std::tan(elevation);
  const double drift_y = -std::cos(azimuth) / std::tan(elevation);
  constexpr int kRays = 160;
  constexpr int kSteps = 400;
  double sum = 0.0;
  double sides = 0.0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const int column = i % kRays;
    const int row = i / kRays;
    const double x = width_m * (column + 0.5) / kRays;
    const double y = depth_m * (row + 0.5) / kRays;
    double path = 0.0;
    bool left = false;
    for (int step = 0; step < kSteps && !left; ++step) {
      const double down = height_m * (step + 0.5) / kSteps;
      double at_x = x + drift_x * down;
      double at_y = y + drift_y * down;
      if (through_sides != nullptr) {
        left = at_x < 0.0 || at_x > width_m || at_y < 0.0 || at_y > depth_m;
        if (left) break;
      }
      at_x -= std::floor(at_x / width_m) * width_m;
      at_y -= std::floor(at_y / depth_m) * depth_m;
      path += extinction(at_x, at_y, height_m - down) * height_m / kSteps / std::sin(elevation);
    }
    (left ? sides : sum) += std::exp(-path);
  }
  if (through_sides != nullptr) *through_sides = sides / (kRays * kRays);
  return sum / (kRays * kRays);
}

// The extinction of steep towers of several heights and densities on 10 x 8 x 6 cells.
double Towers(Cell x, Cell y, Cell z) {
  const Cell height = (7 * x + 3 * y) % 7;
  return z < height ? 0.002 * static_cast<double>(1 + (5 * x + 2 * y) % 9) : 0.0;
}

double TowersAt(double x_m, double y_m, double z_m) {
  return Towers(static_cast<Cell>(x_m / 100.0), static_cast<Cell>(y_m / 80.0),
                static_cast<Cell>(z_m / 50.0));
}

SyntheticCf TowersFile() { return ExtinctionFile(10, 8, 6, 100.0, 80.0, 50.0, Towers); }

// The lattice of rays is accurate to 3e-3 across steep walls.
constexpr double kTraced = 3e-3;

TEST_F(FluxCommand, SlabAgreesWithPublishedNumbers) {
  Flux("--slab 1 --phase hg:0.75 --albedo 1 --sun-elevation 90 --photons 1000000");
  ExpectShare("reflectance", 0.07874, 1e-5);
  ExpectShare("transmittance_diffuse", 0.55338, 1e-5);
  ExpectShare("transmittance_direct", std::exp(-1.0));
  Flux("--slab 2 --phase hg:0.75 --albedo 0.9 --photons 1000000");
  ExpectShare("reflectance", 0.09739, 1e-5);
  ExpectShare("transmittance", 0.66096, 1e-5);
}

TEST_F(FluxCommand, DirectBeamThroughPeriodicTowersUnderAnySun) {
  const std::string path = Write(TowersFile());
  for (const auto& [elevation, azimuth] : {std::pair{90, 0}, {30, 270}, {30, 0}, {30, 137}}) {
    SCOPED_TRACE(azimuth);
    Flux(path + " --periodic --photons 200000 --albedo 0.9 --ground-albedo 0.3 --phase hg:0.8" +
         " --sun-elevation " + std::to_string(elevation) + " --sun-azimuth " +
         std::to_string(azimuth));
    ExpectShare("transmittance_direct",
                TracedDirect(TowersAt, 1000.0, 640.0, 300.0, elevation, azimuth), kTraced);
    EXPECT_EQ(Of("sides").value, 0.0);
    ExpectShare("ground_absorptance", 0.7 * Of("transmittance").value,
                4.0 * Of("transmittance").standard_error);
  }
}

TEST_F(FluxCommand, DirectBeamThroughOpenTowersLeavesByTheSides) {
  const std::string path = Write(TowersFile());
  for (const int azimuth : {0, 90, 200}) {
    SCOPED_TRACE(azimuth);
    Flux(path + " --photons 200000 --albedo 0 --sun-elevation 30 --sun-azimuth " +
         std::to_string(azimuth));
    double sides = 0.0;
    const double direct = TracedDirect(TowersAt, 1000.0, 640.0, 300.0, 30.0, azimuth, &sides);
    ExpectShare("transmittance_direct", direct, kTraced);
    ExpectShare("sides", sides, kTraced);
    EXPECT_EQ(Of("reflectance").value, 0.0);
  }
}

// Compares a cloud turned by 90 degrees under a sun turned with it, and a mirrored cloud under a
// mirrored sun.
TEST_F(FluxCommand, TurnedAndMirroredCloudsGiveTheSame) {
  const std::string common = " --periodic --photons 200000 --phase hg:0.85 --sun-elevation 30";
  Flux(Write(TowersFile()) + common + " --sun-azimuth 300");
  const Share reflected = Of("reflectance");
  const Share direct = Of("transmittance_direct");
  const auto expect_same = [&] {
    ExpectShare("reflectance", reflected.value, 4.0 * reflected.standard_error);
    ExpectShare("transmittance_direct", direct.value, 4.0 * direct.standard_error);
  };
  // Turns north to east: what was at (x, y) is at (y, -x).
  Flux(Write(ExtinctionFile(8, 10, 6, 80.0, 100.0, 50.0,
                            [](Cell x, Cell y, Cell z) { return Towers(9 - y, x, z); })) +
       common + " --sun-azimuth 30");
  expect_same();
  Flux(Write(ExtinctionFile(10, 8, 6, 100.0, 80.0, 50.0,
                            [](Cell x, Cell y, Cell z) { return Towers(9 - x, y, z); })) +
       common + " --sun-azimuth 60");
  expect_same();
}

// Writes the same file with its dimensions in another order and its heights downwards.
TEST_F(FluxCommand, LayoutOfTheFileDoesNotMatter) {
  const std::string common = " --photons 20000 --phase hg:0.85 --sun-elevation 30";
  Flux(Write(TowersFile()) + common);
  const double expected = Of("reflectance").value;
  SyntheticCf file = TowersFile();
  std::ranges::reverse(file.coordinates[2].values);
  file.variables[0].dimensions = {"x", "z", "y"};
  file.variables[0].value = [](const auto& at) {
    return Towers(at.at("x"), at.at("y"), 5 - at.at("z"));
  };
  Flux(Write(file) + common);
  EXPECT_NEAR(Of("reflectance").value, expected, 1e-12);
}

// A black, opaque tower absorbs the light on its top and its sunlit wall. The domain must be the
// file's, not the tower's.
TEST_F(FluxCommand, TallBlackBoxStopsItsShadow) {
  const std::string path =
      Write(ExtinctionFile(40, 10, 10, 100.0, 100.0, 100.0, [](Cell x, Cell y, Cell z) {
        return x >= 20 && x < 25 && y >= 4 && y < 6 && z < 8 ? 0.5 : 0.0;
      }));
  const double area = 4000.0 * 1000.0;
  const double shadow = 200.0 * (500.0 + 800.0 * std::sqrt(3.0));
  // Rays that graze an edge pass through less than 2 m of the tower: optical depth 1.
  const double edges = 2.0 * (200.0 + 800.0) / area;
  for (const std::string sides : {"", " --periodic"}) {
    Flux(path + sides + " --photons 200000 --albedo 0 --sun-elevation 30 --sun-azimuth 270");
    ExpectShare("absorptance", shadow / area, edges);
  }
  Flux(path + " --photons 200000 --albedo 0 --sun-elevation 30 --sun-azimuth 270");
  // Light that enters the top at a distance of less than tan 60 degrees times the height from the
  // east side leaves through this side.
  ExpectShare("sides", 1000.0 * std::sqrt(3.0) / 4000.0);
}

// If the cloud is far from the sides, periodic and open domains differ only by the light that
// leaves.
TEST_F(FluxCommand, WideDomainAgreesWithPeriodic) {
  const std::string path =
      Write(ExtinctionFile(41, 41, 4, 250.0, 250.0, 50.0, [](Cell x, Cell y, Cell z) {
        return x >= 19 && x < 22 && y >= 19 && y < 22 && z > 0 ? 0.03 : 0.0;
      }));
  const std::string common =
      path + " --phase hg:0.85 --albedo 0.9 --sun-elevation 60 --photons 400000";
  Flux(common);
  const Share absorbed = Of("absorptance");
  const Share sides = Of("sides");
  Flux(common + " --periodic");
  // In the periodic domain, light that would have left may be absorbed later, at most in proportion
  // to the cloud's fraction of the side area.
  ExpectShare("absorptance", absorbed.value, 4.0 * absorbed.standard_error + 0.05 * sides.value);
}

// Without a medium all light arrives at the ground.
TEST_F(FluxCommand, EmptyFileLetsAllThrough) {
  Flux(Write(ExtinctionFile(3, 3, 3, 10.0, 10.0, 10.0, [](Cell, Cell, Cell) { return 0.0; })) +
       " --photons 1000");
  EXPECT_EQ(Of("transmittance_direct").value, 1.0);
}

// One column of one layer, periodic, has the same fluxes as the slab.
TEST_F(FluxCommand, SingleColumnIsASlab) {
  Flux(Write(ExtinctionFile(1, 1, 1, 500.0, 500.0, 250.0,
                            [](Cell, Cell, Cell) { return 8.0 / 250.0; })) +
       " --periodic --phase hg:0.75 --photons 300000");
  ExpectShare("reflectance", 0.50642, 1e-5);
}

TEST_F(FluxCommand, SaysWhatIsWrong) {
  const std::string path = Write(TowersFile());
  struct Case {
    std::string arguments;
    int code;
    std::string text;
  };
  for (const Case& c :
       {Case{"", 64, "either a STORM or --slab"},
        Case{path + " --slab 2", 64, "either a STORM or --slab"}, Case{"--slab -1", 64, "--slab"},
        Case{"--slab 1 --phase hg", 64, "--phase"}, Case{"--slab 1 --phase hg:1.5", 64, "-0.99"},
        Case{"--slab 1 --phase table:fog", 64, "cloud_re10"},
        Case{path + " --phase nothing", 64, "--phase"},
        Case{path + " --albedo 1.01", 64, "--albedo"},
        Case{path + " --ground-albedo -0.1", 64, "--ground-albedo"},
        Case{path + " --sun-elevation 0", 64, "--sun-elevation"},
        Case{path + " --sun-elevation 91", 64, "--sun-elevation"},
        Case{path + " --photons 0", 64, "--photons"},
        Case{path + " --photons many", 64, "--photons"}, Case{path + " --time 3", 64, "--time"},
        Case{folder_.File("none.nc"), 75, "none.nc"}}) {
    EXPECT_EQ(Run(c.arguments), c.code) << c.arguments;
    EXPECT_THAT(err_, HasSubstr(c.text)) << c.arguments;
    EXPECT_EQ(out_, "") << c.arguments;
  }
}

// Ctrl-C prints the result so far, marked as incomplete.
TEST_F(FluxCommand, InterruptedRunsReportWhatTheyHave) {
  Terminal terminal;
  const std::string out = folder_.File("out");
  RunningProgram program(
      PROGRAM, {"flux", "--slab", "1", "--phase", "hg:0.5", "--photons", "1000000000000", "--json"},
      out, terminal.Name());
  // The bar shows a percentage once photons have been traced.
  WaitFor([&] { return terminal.Shown().find(" %") != std::string::npos || !program.Runs(); });
  // Several signals at once count as one request, because coreutils' timeout sends its signal
  // twice, and terminals signal a whole process group. The program is stopped until all have
  // arrived.
  for (const int signal : {SIGSTOP, SIGINT, SIGTERM, SIGINT, SIGCONT}) program.Signal(signal);
  EXPECT_EQ(program.Wait().code, 0) << terminal.Shown();
  std::ostringstream text;
  text << std::ifstream(out).rdbuf();
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(text.str(), &json_).ok());
  EXPECT_FALSE(json_.fields().at("complete").bool_value());
  EXPECT_GT(json_.fields().at("photons").number_value(), 0.0);
  EXPECT_GT(Of("transmittance").value, 0.5);
}

}  // namespace
}  // namespace thunderhead::testing
