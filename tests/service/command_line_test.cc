// Tests of the program as a user runs it, on the sample storm: its output, files and exit codes.
#include <grpcpp/grpcpp.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include "frame/image_codec.h"
#include "frame/png_text.h"
#include "gmock/gmock.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "tests/service/hanging_storage.h"
#include "tests/service/running_program.h"
#include "tests/service/terminal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kSample = std::string(THUNDERHEAD_SOURCE_DIR) + "/samples/supercell.nc";

std::string Contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

class CommandLineTest : public ::testing::Test {
 protected:
  // Runs the program in the shell, with `arguments` as typed on a command line.
  Outcome Run(const std::string& arguments) const { return Shell(PROGRAM + (" " + arguments)); }

  Outcome Shell(const std::string& command) const {
    const std::string out = folder_.File("out");
    const std::string err = folder_.File("err");
    const int status = std::system(("{ " + command + "; } >" + out + " 2>" + err).c_str());
    return {WEXITSTATUS(status), Contents(out), Contents(err)};
  }

  void ExpectError(const std::string& arguments, int code, const std::string& text) const {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments;
    EXPECT_THAT(outcome.err, StartsWith("thunderhead: ")) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(text)) << arguments;
    // The error is one line on standard error, and standard output is empty.
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    EXPECT_THAT(outcome.out, IsEmpty()) << arguments;
  }

  std::string Scene(const std::string& json) const {
    std::ofstream(folder_.File("scene.json")) << json;
    return folder_.File("scene.json");
  }

  const TemporaryFolder folder_;
  const std::string picture_ = folder_.File("storm.png");
  const std::string render_ =
      "render " + kSample + " --device software --error-seconds 0 -o " + picture_;
};

TEST_F(CommandLineTest, VersionAndHelp) {
  EXPECT_THAT(Run("--version").out, MatchesRegex("thunderhead [0-9.]+\n"));
  const Outcome help = Run("--help");
  EXPECT_EQ(help.code, 0);
  for (const char* command : {"serve", "render", "inspect"})
    EXPECT_THAT(help.out, HasSubstr(command));
  for (const char* command : {"", "render", "export", "sequence", "watch"}) {
    const std::string out = Run(std::string(command) + " --help").out;
    for (const char* code : {"0   all", "64  ", "65  ", "75  ", "78  "})
      EXPECT_THAT(out, HasSubstr(code)) << command;
  }
}

TEST_F(CommandLineTest, ServeReadsItsSettingsFromAFile) {
  const std::string file = folder_.File("serve.conf");
  const auto write = [&file](const std::string& text) { std::ofstream(file) << text; };
  // The printed settings are a complete file that --config accepts.
  const std::string defaults = Run("serve --print-config").out;
  for (const char* const setting :
       {"max-sessions=64", "max-wrong-tokens=5", "insecure=false", "read-deadline=60", "data="}) {
    EXPECT_THAT(defaults, HasSubstr(setting));
  }
  write(defaults);
  EXPECT_EQ(Run("serve --config " + file + " --print-config").out, defaults);
  // The command line takes precedence.
  write("# a comment\nmax-sessions = 200\ninsecure = true\ndata = [\"" + kSample + "\"]\n");
  const std::string merged = Run("serve --config " + file + " --max-viewers 7 --print-config").out;
  for (const std::string& setting : {std::string("max-sessions=200"), std::string("max-viewers=7"),
                                     std::string("insecure=true"), "data=\"" + kSample + "\""}) {
    EXPECT_THAT(merged, HasSubstr(setting));
  }
  EXPECT_THAT(Run("serve --config " + file + " --max-sessions 3 --print-config").out,
              HasSubstr("max-sessions=3\n"));
}

TEST_F(CommandLineTest, ServeAcceptsTheEarlierNamesOfTheLimitsOfImages) {
  const std::string file = folder_.File("serve.conf");
  std::ofstream(file) << "max-stills = 77\n";
  const std::string printed =
      Run("serve --config " + file + " --max-stills-each 55 --print-config").out;
  EXPECT_THAT(printed, HasSubstr("max-images=77\n"));
  EXPECT_THAT(printed, HasSubstr("max-images-each=55\n"));
}

TEST_F(CommandLineTest, TheEarlierNameOfTheFlagTechniqueIsAcceptedAndHidden) {
  for (const std::string command : {"render", "sequence", "measure slices"}) {
    const std::string help = Run(command + " --help").out;
    EXPECT_THAT(help, HasSubstr("  --technique TEXT")) << command;
    EXPECT_THAT(help, Not(HasSubstr("--renderer"))) << command;
  }
  ExpectError(render_ + " --renderer voxels", 64, "--technique is 'voxels'; it must be ");
  ExpectError(render_ + " --renderer metaball --quality fast", 64,
              "--quality excludes --technique");
  ExpectError("measure slices --slab 1 --renderer metaball", 64, "--technique is 'metaball'; ");
}

// Scripts give this flag, which had an effect in earlier versions.
TEST_F(CommandLineTest, ServeAcceptsTheEarlierFlagSandbox) {
  EXPECT_EQ(Run("serve --sandbox all --print-config").out, Run("serve --print-config").out);
  EXPECT_EQ(Run("serve --sandbox untrusted --print-config").code, 0);
  ExpectError("serve --sandbox none --print-config", 64, "--sandbox");
  EXPECT_THAT(Run("serve --help").out, Not(HasSubstr("--sandbox")));
}

TEST_F(CommandLineTest, WrongSettingsAreRefusedWithTheirFile) {
  const std::string file = folder_.File("serve.conf");
  const auto refuse = [&](const std::string& setting, const std::string& text) {
    std::ofstream(file) << setting << "\n";
    ExpectError("serve --data " + kSample + " --config " + file, 64, file + ": " + text);
  };
  refuse("max-session = 3",
         "there is no setting 'max-session'; `thunderhead serve --print-config`");
  refuse("print-config = true", "there is no setting 'print-config'");
  refuse("config = \"other\"", "there is no setting 'config'");
  refuse("[limits]\nmax-sessions = 3", "has a section [limits]");
  refuse("max-sessions = many", "max-sessions: ");
  refuse("max-sessions = 0", "max-sessions: ");
  refuse("max-sessions = 010", "max-sessions: --max-sessions: '010' is not an integer in decimal");
  refuse("insecure = 2", "insecure: --insecure: '2' is neither true nor false");
  refuse("a.max-sessions = 3", "there is no setting 'a.max-sessions'");
  std::string dotted = "max-sessions";
  for (int i = 0; i < 300; ++i) dotted.insert(0, "a.");
  refuse(dotted + " = 3", "there is no setting '" + dotted + "'");
  refuse("[" + dotted + "]\nmax-sessions = 3", "has a section [" + dotted + "]");
  refuse("insecure = perhaps", "insecure: ");
  refuse("max-requests = nan", "max-requests: --max-requests: 'nan' is not a finite number");
  refuse("max-sessions = 3\nmax-viewers = 7\nmax-sessions = 4",
         "max-sessions is set a second time");
  refuse("max-images = 3\nmax-viewers = 7\nmax-stills = 4", "max-stills is set a second time");
  ExpectError("serve --config " + folder_.File("none"), 64, "none cannot be read");
  ExpectError("serve --config /dev/zero", 78, "/dev/zero is not a file");
  ExpectError("serve", 64, "there are no storms to serve");
  // The name of a flag that the help omits is in the message, too.
  ExpectError("serve --data " + kSample + " --max-requests -1", 64, "--max-requests: Value -1");
}

// The help of `serve` lists only the flags that most servers need, on two screens. The other
// settings are described in the settings file.
TEST_F(CommandLineTest, HelpOfServeIsShort) {
  const std::string help = Run("serve --help").out;
  int flags = 0;
  for (std::size_t at = help.find("\n  --"); at != std::string::npos;
       at = help.find("\n  --", at + 1)) {
    ++flags;
  }
  EXPECT_GE(flags, 20);
  EXPECT_LE(flags, 32);
  EXPECT_THAT(help, HasSubstr("--print-config"));
  EXPECT_THAT(help, Not(HasSubstr("--max-streams-per-connection")));
}

TEST_F(CommandLineTest, NumbersAreFinite) {
  for (const char* const number : {"nan", "inf"}) {
    ExpectError("serve --data " + kSample + " --max-requests " + number, 64, number);
    ExpectError(render_ + " --size 16x9 --max-error " + number, 64, number);
    ExpectError("measure frames " + kSample + " --seconds " + number, 64, number);
    ExpectError("generate -o " + folder_.File("cloud.nc") + " --spacing " + number, 64, number);
  }
}

TEST_F(CommandLineTest, IntegersAreDecimalAndNotTooLarge) {
  const std::string cloud = "generate -o " + folder_.File("cloud.nc");
  for (const char* const number : {"0x10", "010", "1.5", "many"}) {
    ExpectError(cloud + " --seed " + number, 64, "' is not an integer in decimal digits");
    ExpectError("flux " + kSample + " --photons " + number, 64,
                "' is not an integer in decimal digits");
  }
  ExpectError(cloud + " --seed 18446744073709551616", 64, "is too large for an integer");
  ExpectError(cloud + " --seed 99999999999999999999", 64, "is too large for an integer");
  ExpectError("flux " + kSample + " --photons 9223372036854775808", 64,
              "is too large for an integer");
  ExpectError(cloud + " --cells 4x4x4.5", 64, "must be an integer from 1 to 4096");
  ExpectError(cloud + " --seed -1", 64, "it must be 0 or more");
  ExpectError(render_ + " --time 4294967296", 64, "--time");
  const std::string small =
      " --spacing 200 --cells 24x24x16 --ellipsoid 0,0,1600,1800,1800,1200 --feature-size 800 "
      "--octaves 2 --threshold 0 --water 1 --base 200";
  EXPECT_EQ(Run(cloud + small + " --seed 18446744073709551615").code, 0);
}

// In these flags, 0 is not a way to ask for the default.
TEST_F(CommandLineTest, TheLimitsOfTheReferenceAreAboveZero) {
  const std::string reference = render_ + " --size 16x9 --technique reference ";
  for (const char* const number : {"0", "-1"}) {
    const std::string is = std::string(" is ") + number + "; it must be ";
    for (const std::string flag : {"--spp", "--max-scatterings"}) {
      ExpectError(reference + flag + " " + number, 64, flag + is + "1 or more");
    }
    for (const std::string flag : {"--seconds", "--target-error"}) {
      ExpectError(reference + flag + " " + number, 64, flag + is + "above 0");
    }
  }
  ExpectError(render_ + " --spp 0", 64, "are for --technique reference");
}

TEST_F(CommandLineTest, FlagsWithoutAValueAreTrueOrFalse) {
  ExpectError("inspect " + kSample + " --json=2", 64, "--json: '2' is neither true nor false");
  EXPECT_THAT(Run("inspect " + kSample + " --json=true").out, StartsWith("{"));
}

TEST_F(CommandLineTest, ASceneIsStrictJson) {
  const auto refuse = [this](const std::string& json, const std::string& why) {
    ExpectError(render_ + " --scene " + Scene(json), 64, " is not a scene: " + why);
  };
  refuse(R"({"sky": {"brightness": 1},)"
         "\n"
         R"("sky": {"brightness": 2}})",
         "line 2, column 5: 'sky' is given a second time");
  refuse(R"({"sky": {},})", "line 1, column 12: this is not JSON: unexpected '}'");
  refuse(R"({"sky": {"brightness": )" + std::string(1000, '1') + "}}",
         "line 1, column 1023: a number is too large; see proto");
  refuse("{'sky': {}}", "line 1, column 2: this is not JSON: ");
  const std::string many(100'000, '[');
  refuse("{\"fields\": " + many + std::string(many.size(), ']') + "}",
         "line 1, column 111: there are more than 100 levels of nesting");
  refuse("{}" + std::string(600'000, ' '), "the JSON has more than 512 KiB");
  // The errors of a scene that is stored in a picture name the line and the column, too.
  const std::string with_scene = folder_.File("other.png");
  std::ofstream(with_scene, std::ios::binary) << frame::WithTexts(
      *frame::EncodePng(1, 1, {{1, 2, 3}}), {{"thunderhead.scene", R"({"sky": {},})"}});
  ExpectError(render_ + " --scene " + with_scene, 64, " is not a scene: line 1, column 12: ");
}

TEST_F(CommandLineTest, OnlyRegularFilesOfALimitedSizeAreRead) {
  const std::string huge = folder_.File("huge");
  std::ofstream(huge) << "x";
  std::filesystem::resize_file(huge, 3ULL << 30);
  const std::string load = "load 127.0.0.1:1 ";
  const std::string commands[] = {
      render_ + " --scene ",  render_ + " --annotate --logo ", "serve --config ",
      load + "--token-file ", load + "--tls-roots ",
  };
  for (const std::string& command : commands) {
    for (const char* const path : {"/", "/dev/zero", "/dev/null"}) {
      if (command.starts_with("serve")) continue;  // serve accepts no pipes, either
      ExpectError(command + path, 64, std::string(path) + " is neither a regular file nor a pipe");
    }
    ExpectError(command + huge, 64, " has more than ");
    ExpectError(command + folder_.File("none"), 64, "none cannot be read");
  }
}

TEST_F(CommandLineTest, WrongUsageIsABadRequest) {
  ExpectError("", 64, "subcommand");
  ExpectError("frobnicate", 64, "'frobnicate'");
  ExpectError("render " + kSample, 64, "--output");
  ExpectError("render " + kSample + " -o storm.gif", 64, "must end in .png");
  ExpectError(render_ + " --size 12", 64, "WIDTHxHEIGHT");
  ExpectError(render_ + " --technique voxels", 64,
              "'voxels'; it must be light_volume, half_angle, metaball, cumulus or reference");
  ExpectError(render_ + " --technique metaball --slices 9", 64, "for light_volume and half_angle;");
  ExpectError(render_ + " --camera kite", 64, "orbit, spotter or top-down");
  ExpectError("serve --data " + kSample + " --http nowhere", 64, "--http");
  ExpectError("serve --data " + kSample + " --http 0.0.0.0:0", 64, "accept this with --insecure");
  ExpectError("serve --data " + kSample + " --grpc 0.0.0.0:0", 64, "no token is needed");
  ExpectError("serve --data " + kSample + " --metrics 0.0.0.0:0", 64,
              "--metrics 0.0.0.0:0 can be reached");
  const std::string fifo = folder_.File("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& not_a_file : {fifo, std::string("/dev/null")}) {
    const std::string says = not_a_file + " is not a file";
    for (const std::string flag : {"--auth tokens ", "--auth jwt ", "--roster-timeouts ",
                                   "--tls-key x --tls-cert ", "--tls-cert x --tls-key "}) {
      ExpectError("serve --data " + kSample + " --state none " + flag + not_a_file, 78, says);
    }
  }
  ExpectError("serve --data " + kSample + " --auth king", 64, "none, tokens FILE or jwt FILE");
  ExpectError("serve --data " + kSample + " --tls-cert x", 64, "belong together");
  ExpectError("serve --data " + kSample + " --state /proc/none", 64, "--state is '/proc/none'");
}

TEST_F(CommandLineTest, ADarkPictureSaysThatItIsNight) {
  const std::string night = Scene(R"({"sun": {"elevationDeg": -20}})");
  const Outcome outcome = Run(render_ + " --size 64x36 --quality fast --scene " + night);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the sun is 20 degrees below the horizon"));
  const std::string dusk = Scene(R"({"sun": {"elevationDeg": -5}})");
  EXPECT_THAT(Run(render_ + " --size 64x36 --quality fast --scene " + dusk).err, IsEmpty());
}

TEST_F(CommandLineTest, InspectDescribesTheSample) {
  const Outcome outcome = Run("inspect " + kSample + " --time 1 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  v1::StormDescription storm;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &storm).ok());
  EXPECT_EQ(storm.times_size(), 4);
  EXPECT_EQ(storm.time_index(), 1U);
  EXPECT_EQ(storm.grid().nx(), 200U);
  EXPECT_EQ(storm.grid().ny(), 160U);
  EXPECT_EQ(storm.fields_size(), 5);
  EXPECT_GT(storm.bytes_per_time(), 1U << 20);
  for (const v1::FieldDescription& field : storm.fields()) {
    EXPECT_EQ(field.size_origin(), v1::FieldDescription::SIZE_ORIGIN_SCHEME);
    EXPECT_EQ(field.size_scheme(), "WSM6");
    EXPECT_EQ(field.size_variable(), "");
    EXPECT_GT(field.mean_radius_m(), 1e-5F);
  }
  const Outcome table = Run("inspect " + kSample);
  EXPECT_EQ(table.code, 0);
  EXPECT_THAT(table.out, HasSubstr("QGRAUP"));
  EXPECT_THAT(table.out, HasSubstr("   3  0001-01-01T01:20:00Z     60.0  described below"));
  EXPECT_THAT(table.out, HasSubstr("snow     scheme WSM6"));
  EXPECT_EQ(storm.turbulence_source(), v1::StormDescription::TURBULENCE_SOURCE_GRADIENT);
  EXPECT_THAT(table.out, HasSubstr("turbulence from contrasts of the fields"));
  EXPECT_THAT(table.out,
              HasSubstr("detail does not move: no wind (U, V, W) was read from the file"));
  const Outcome windy =
      Run("inspect " THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc --time 1");
  EXPECT_THAT(windy.out, HasSubstr("detail drifts with the mean wind of the lowest 6 km, 4.8 m/s "
                                   "east, 2.3 north"));
}

TEST_F(CommandLineTest, MissingAndForeignFilesAreNamed) {
  ExpectError("inspect " + folder_.File("none.nc"), 75, "none.nc");
  std::ofstream(folder_.File("text.nc")) << "no storm at all";
  ExpectError("inspect " + folder_.File("text.nc"), 65, "text.nc");
}

TEST_F(CommandLineTest, RenderWritesThePictureAndItsCosts) {
  const Outcome outcome = Run(render_ + " --time 1 --size 80x45 --slices 16 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());  // no progress bar without a terminal
  const auto image = frame::DecodePng(Contents(picture_));
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width_px, 80);
  EXPECT_EQ(image->height_px, 45);
  v1::RenderImageResponse said;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &said).ok());
  EXPECT_EQ(said.scene().time_index(), 1U);
  EXPECT_TRUE(said.scene().camera().orbit().has_distance_m());
  EXPECT_GT(said.modelled().device_bytes(), 0U);
  EXPECT_GT(said.stages_size(), 2);
  EXPECT_FALSE(said.accuracy().measured());
  EXPECT_FALSE(said.accuracy().has_error_low());
  EXPECT_THAT(Contents(picture_), Not(HasSubstr("thunderhead.error_low")));
}

TEST_F(CommandLineTest, RenderMeasuresThePicturesError) {
  const std::string render = "render " + kSample + " --device software -o " + picture_ +
                             " --time 1 --size 80x45 --slices 64";
  const Outcome outcome = Run(render + " --error-seconds 1 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* key : {"estimatedError", "errorLow", "errorHigh", "bias", "biasLow"}) {
    EXPECT_THAT(outcome.out, ContainsRegex("\"" + std::string(key) + "\": -?[0-9.]+")) << key;
  }
  EXPECT_THAT(outcome.out, HasSubstr("\"measured\": true"));
  v1::RenderImageResponse said;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &said).ok());
  const v1::AccuracyReport& report = said.accuracy();
  EXPECT_LE(report.error_low(), report.estimated_error());
  EXPECT_LT(report.estimated_error(), report.error_high());
  // With the diffusion transport the sample storm has an error of 0.1 to 0.2. A picture that is
  // black or of one colour would have another error.
  EXPECT_GT(report.error_high(), 0.05F);
  EXPECT_LT(report.error_low(), 0.4F);
  EXPECT_THAT(Contents(picture_), HasSubstr("thunderhead.error_low"));
  const Outcome printed = Run(render);
  ASSERT_EQ(printed.code, 0) << printed.err;
  EXPECT_THAT(printed.out, ContainsRegex("error about [0-9.]+ .measured: [0-9.]+ to [0-9.]+.\n"));
}

TEST_F(CommandLineTest, FlagsOverrideTheSceneFile) {
  const std::string scene = Scene(R"({"timeIndex": 3, "rendering": {"lightVolume": {"slices": 9}},
                                      "output": {"widthPx": 64, "heightPx": 36}})");
  const Outcome outcome = Run(render_ + " --scene " + scene + " --slices 12 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  v1::RenderImageResponse said;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &said).ok());
  EXPECT_EQ(said.scene().time_index(), 3U);
  EXPECT_EQ(said.scene().rendering().light_volume().slices(), 12U);
  EXPECT_EQ(said.width_px(), 64U);
}

TEST_F(CommandLineTest, APictureHoldsTheSceneThatDrawsItAgain) {
  ASSERT_EQ(Run(render_ + " --time 1 --size 80x45 --slices 16 --camera spotter").code, 0);
  const std::string again = folder_.File("again.png");
  const Outcome outcome =
      Run("render " + kSample + " --device software --scene " + picture_ + " -o " + again);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto image = frame::DecodePng(Contents(again));
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image->width_px, 80);
  EXPECT_EQ(image->rgb, frame::DecodePng(Contents(picture_))->rgb);
  EXPECT_THAT(Contents(picture_), HasSubstr("thunderhead.valid"));
  EXPECT_THAT(Contents(picture_), HasSubstr("0001-01-01T00:40:00Z"));
  std::ofstream(again, std::ios::binary) << *frame::EncodePng(1, 1, {{1, 2, 3}});
  ExpectError(render_ + " --scene " + again, 64, "a PNG without a scene in it");
}

TEST_F(CommandLineTest, FailedRenderNamesTheCauseAndLeavesNoFile) {
  ExpectError(render_ + " --scene " + Scene(R"({"sun": {"elevation": 3}})"), 64, "elevation");
  ExpectError(render_ + " --scene " + Scene(R"({"sun": {"elevationDeg": 300}})"), 64,
              "scene.sun.elevation_deg is 300; it must be between -90 and 90 deg");
  ExpectError(render_ + " --scene " + folder_.File("none.json"), 64, "none.json");
  ExpectError("render storm --server 127.0.0.1:1 -o " + picture_, 75, "connect");
  EXPECT_FALSE(std::filesystem::exists(picture_));
  ExpectError("render " + kSample + " --device software --size 16x9 --slices 4 -o " +
                  folder_.File("no/folder.png"),
              78, "no/folder.png");
}

TEST_F(CommandLineTest, RenderWaitsForTracedLightAndPrintsTheErrorReached) {
  // This error needs a tenth of the paths that `--quality accurate` alone traces. All of them would
  // take minutes.
  const Outcome outcome =
      Run(render_ + " --time 1 --size 48x27 --quality accurate --max-error 0.09");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out,
              ContainsRegex("diffusion, .* error about 0\\.0[78][0-9]* .from a table., .*, "
                            "0\\.1[0-9]* million traced paths\n"));
  EXPECT_TRUE(frame::DecodePng(Contents(picture_)).ok());
  EXPECT_THAT(Contents(picture_), HasSubstr("TRACED_LIGHT_AWAITED"));
}

TEST_F(CommandLineTest, HelpSaysWhatQualityMeans) {
  const Outcome outcome = Run("render --help");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("fast (half the samples, no detail)"));
  EXPECT_THAT(outcome.out, HasSubstr("{fast,balanced,accurate}"));
  EXPECT_THAT(outcome.out, HasSubstr("waits for the path-traced"));
}

TEST_F(CommandLineTest, QualityFastAndBalancedDoNotWait) {
  const auto rendering = [&](const std::string& quality) {
    const Outcome outcome = Run(render_ + " --time 1 --size 16x9 --json --quality " + quality);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    v1::RenderImageResponse said;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &said).ok());
    EXPECT_EQ(said.modelled().traced_paths(), 0U) << quality;
    return said.scene().rendering().light_volume();
  };
  EXPECT_EQ(rendering("fast").slices(), 64U);
  EXPECT_FALSE(rendering("fast").detail());
  EXPECT_EQ(rendering("balanced").slices(), 128U);
  EXPECT_EQ(rendering("balanced").traced_light(), v1::TRACED_LIGHT_AT_REST);
}

TEST_F(CommandLineTest, TheEarlierNameOfAccurateIsStillAccepted) {
  const auto traced_light = [&](const std::string& flags) {
    // This error needs few paths.
    const Outcome outcome = Run(render_ + " --time 1 --size 16x9 --json --max-error 0.3 " + flags);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    v1::RenderImageResponse said;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &said).ok());
    return said.scene().rendering().light_volume().traced_light();
  };
  EXPECT_EQ(traced_light("--quality balanced"), v1::TRACED_LIGHT_AT_REST);
  EXPECT_EQ(traced_light("--quality accurate"), v1::TRACED_LIGHT_AWAITED);
  EXPECT_EQ(traced_light("--quality true"), v1::TRACED_LIGHT_AWAITED);
  EXPECT_EQ(traced_light("--preset true"), v1::TRACED_LIGHT_AWAITED);
  EXPECT_EQ(traced_light("--scene " + Scene(R"({"rendering": {"preset": "PRESET_TRUE"}})")),
            v1::TRACED_LIGHT_AWAITED);
}

TEST_F(CommandLineTest, AnInterruptedRenderLeavesNoFile) {
  Terminal terminal;
  const std::string out = folder_.File("out");
  RunningProgram program(PROGRAM,
                         {"render", kSample, "--device", "software", "--error-seconds", "0", "-o",
                          picture_, "--time", "1", "--size", "48x27", "--quality", "accurate"},
                         out, terminal.Name());
  // The progress bar reports the paths traced, because the command waits for them.
  WaitFor([&] {
    return terminal.Shown().find(" million paths") != std::string::npos || !program.Runs();
  });
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait().code, 75);
  EXPECT_THAT(terminal.Shown(), HasSubstr("thunderhead: interrupted: no picture was written\r\n"));
  // A million paths take some 300 pictures to draw and trace on any machine, so this bar cannot
  // reach its end. The earlier bar, for reading, may reach its end.
  const std::string shown = terminal.Shown();
  EXPECT_THAT(shown.substr(std::min(shown.find("rendering ["), shown.size())),
              Not(HasSubstr("100 %")))
      << "waited";
  EXPECT_THAT(Contents(out), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(picture_));
}

TEST_F(CommandLineTest, AnOlderServerIsNamed) {
  v1::ThunderheadService::Service knows_no_call;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&knows_no_call);
  const auto server = builder.BuildAndStart();
  ASSERT_NE(server, nullptr);
  ExpectError("render storm --server 127.0.0.1:" + std::to_string(port) + " -o " + picture_, 78,
              "the server is older than this program");
  EXPECT_FALSE(std::filesystem::exists(picture_));
}

TEST_F(CommandLineTest, MeasureFramesHasARowForEachNamedSetting) {
  const Outcome outcome =
      Run("measure frames " + kSample +
          " --time 0 --size 24x16 --slices 8 --runs 1 --seconds 0 --device software --json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  google::protobuf::Struct json;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &json).ok()) << outcome.out;
  ASSERT_EQ(json.fields().size(), 2U) << outcome.out;
  EXPECT_THAT(json.fields().at("machine").struct_value().fields().at("gl_renderer").string_value(),
              HasSubstr("llvmpipe"));
  std::set<std::string> rows;
  for (const google::protobuf::Value& row : json.fields().at("rows").list_value().values()) {
    const auto& fields = row.struct_value().fields();
    // Rows with sparse frames also report the difference between moving frames and frames that are
    // drawn in full.
    const bool sparse = fields.contains("camera_flip");
    EXPECT_EQ(fields.contains("sun_flip"), sparse);
    EXPECT_EQ(fields.size(), sparse ? 7U : 5U);
    EXPECT_TRUE(sparse || fields.at("mode").string_value() != "default");
    EXPECT_GT(fields.at("camera_fps").number_value(), 0.0);
    EXPECT_GT(fields.at("sun_fps").number_value(), 0.0);
    const auto& stages = fields.at("stages_ms").struct_value().fields();
    EXPECT_EQ(stages.contains("light"), fields.at("renderer").string_value() != "half_angle");
    EXPECT_TRUE(stages.contains("tone") && stages.contains("read_back") &&
                stages.contains("encode"));
    EXPECT_FALSE(stages.contains("extinction")) << "neither camera nor sun changes the fields";
    rows.insert(fields.at("renderer").string_value() + " " + fields.at("mode").string_value());
  }
  EXPECT_EQ(rows.size(), 20U) << "four techniques in four modes, three presets and the default";
  EXPECT_TRUE(rows.contains("light_volume default"));
  EXPECT_TRUE(rows.contains("light_volume balanced"));
  EXPECT_TRUE(rows.contains("half_angle uniform_phase_low_albedo"));
  ExpectError("measure frames " + kSample + " --size 5", 64, "WIDTHxHEIGHT");
  ExpectError("measure frames " + kSample + " --time 9", 64, "times 0 to 3");
}

TEST_F(CommandLineTest, MeasureExtremesJudgesEachCase) {
  const Outcome outcome = Run("measure extremes --device software");
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("verdict"));
  EXPECT_THAT(outcome.out, HasSubstr("half_angle: optical depth per slice 1e+08, paper"));
  EXPECT_THAT(outcome.out, HasSubstr("light_volume: empty volume"));
  EXPECT_EQ(outcome.out.find("FAILED"), std::string::npos);
}

TEST_F(CommandLineTest, MeasureSlicesWritesThePlot) {
  const std::string plot = folder_.File("slices.svg");
  const Outcome outcome = Run("measure slices --slab 2 --device software --json -o " + plot);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  google::protobuf::Struct json;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(outcome.out, &json).ok()) << outcome.out;
  EXPECT_EQ(json.fields().at("rows").list_value().values_size(), 2);
  EXPECT_THAT(Contents(plot), StartsWith("<svg"));
  EXPECT_THAT(Contents(plot), HasSubstr("consistent, order"));
  ExpectError("measure slices", 64, "either a STORM or --slab TAU");
  ExpectError("measure slices --slab -1", 64, "above 0");
  ExpectError("measure slices --slab 1 --technique metaball", 64, "half_angle or light_volume");
  ExpectError("measure slices --slab 1 -o x.png", 64, ".svg or .csv");
}

TEST_F(CommandLineTest, ServeSaysOneLineAndStopsOnASignal) {
  const Outcome outcome =
      Shell(std::string(PROGRAM) + " serve --device software --data " + kSample +
            " --http 127.0.0.1:0 --grpc 127.0.0.1:0 --state none & server=$!; "
            "until [ -s " +
            folder_.File("out") +
            " ]; do kill -0 $server || break; sleep 0.1; done; "
            "kill -TERM $server; wait $server");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, MatchesRegex("Thunderhead is ready at http://127.0.0.1:[1-9][0-9]*/ "
                                        "\\(gRPC 127.0.0.1:[1-9][0-9]*\\)\n"));
}

// The server writes its log to a FIFO that no process reads, and SIGHUP ends it.
TEST_F(CommandLineTest, ServeOutlivesTheReaderOfItsLogAndStopsWhenItsTerminalCloses) {
  const std::string log = folder_.File("log");
  const Outcome outcome = Shell("mkfifo " + log + "; true <" + log + " & " + PROGRAM +
                                " serve --device software --data " + kSample +
                                " --http 127.0.0.1:0 --grpc 127.0.0.1:0 --state none 2>" + log +
                                " & server=$!; until [ -s " + folder_.File("out") +
                                " ]; do kill -0 $server || break; sleep 0.1; done; "
                                "kill -HUP $server; wait $server");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, StartsWith("Thunderhead is ready at "));
}

// nohup lets programs ignore SIGHUP. The server must not wait for the signal then.
TEST_F(CommandLineTest, ServeIgnoresAClosedTerminalIfItsCallerDoes) {
  const Outcome outcome =
      Shell("trap '' HUP; " + std::string(PROGRAM) + " serve --device software --data " + kSample +
            " --http 127.0.0.1:0 --grpc 127.0.0.1:0 --state none & server=$!; "
            "until [ -s " +
            folder_.File("out") +
            " ]; do kill -0 $server || break; sleep 0.1; done; "
            "grep SigBlk /proc/$server/status >&2; "
            "kill -TERM $server; wait $server");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  // SIGHUP is the mask's lowest bit, so an even last digit means that it is not blocked.
  EXPECT_THAT(outcome.err, ContainsRegex("SigBlk:\\s*[0-9a-f]*[02468ace]\n"));
}

TEST_F(CommandLineTest, ServeWritesItsAuditToRegularFilesOnly) {
  const std::string fifo = folder_.File("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const std::string serve = "serve --data " + kSample + " --state none --audit-log ";
  for (const std::string& path : {fifo, std::string("/dev/null")}) {
    ExpectError(serve + path, 64,
                "cannot write --audit-log " + path + ": it is not a regular file");
  }
  ExpectError(serve + folder_.Path().string(), 64, "cannot write --audit-log");
}

TEST_F(CommandLineTest, ServeRefusesAStateThatOthersCouldChange) {
  const std::string state = folder_.File("state");
  std::filesystem::create_directory(state);
  std::filesystem::permissions(state, std::filesystem::perms::all);
  const std::string serve = "serve --data " + kSample + " --state " + state;
  ExpectError(serve, 78, "other users may write the folder " + state);
  std::filesystem::permissions(state, std::filesystem::perms::owner_all);
  for (const char* name : {"sessions.db", "storm_ids", "storm_ids.partial"}) {
    const std::string file = state + "/" + name;
    std::filesystem::create_symlink(folder_.File("target"), file);
    ExpectError(serve, 78, file + " is a link");
    std::filesystem::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    ExpectError(serve, 78, file + " is not a regular file");
    std::filesystem::remove(file);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.File("target")));
}

TEST_F(CommandLineTest, ServeRefusesAClockThatIsWrongByDecades) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const HangingStorage hanging;
  setenv("THUNDERHEAD_TEST_WALL_CLOCK", "-100000000", 1);
  ExpectError("serve --data " + kSample + " --state none", 75,
              "the system's clock shows a time before 1970 or after 2262 (1966-10-31 14:13 UTC)");
  unsetenv("THUNDERHEAD_TEST_WALL_CLOCK");
}

TEST_F(CommandLineTest, TheReferenceRendersToExrAndPng) {
  const std::string reference =
      "render " + kSample + " --technique reference --device software --size 24x16 --spp 4 -o ";
  const Outcome exr = Run(reference + folder_.File("reference.exr"));
  ASSERT_EQ(exr.code, 0) << exr.err;
  EXPECT_THAT(exr.out, StartsWith("4 samples a pixel"));
  EXPECT_THAT(Contents(folder_.File("reference.exr")), HasSubstr("stderr.R"));
  ASSERT_EQ(Run(reference + picture_).code, 0);
  const auto png = frame::DecodePng(Contents(picture_));
  ASSERT_TRUE(png.ok());
  EXPECT_EQ(png->width_px, 24);
  ExpectError(render_ + " --spp 4", 64, "for --technique reference");
  ExpectError(render_ + " --no-air", 64, "for --technique reference");
  ExpectError(reference + picture_ + " --max-scatterings -2", 64, "--max-scatterings is -2");
  ExpectError(reference + "reference.txt", 64, "must end in");
  ExpectError(reference + picture_ + " --seconds -1", 64, "--seconds is -1");
}

TEST_F(CommandLineTest, ExportWritesGridsAndTheView) {
  const std::string vdb = folder_.File("storm.vdb");
  const std::string view = folder_.File("storm.json");
  const Outcome outcome = Run("export " + kSample + " --time 1 --camera top-down --size 80x40 -o " +
                              vdb + " --view " + view);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cloud    extinction (1/m), 200 x 160 x"));
  EXPECT_THAT(Contents(vdb), HasSubstr("graupel"));
  EXPECT_FALSE(std::filesystem::exists(vdb + ".partial"));
  google::protobuf::Struct json;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(Contents(view), &json).ok());
  const auto& camera = json.fields().at("camera").struct_value().fields();
  EXPECT_DOUBLE_EQ(camera.at("halfWidthM").number_value(),
                   2.0 * camera.at("halfHeightM").number_value());
  EXPECT_DOUBLE_EQ(camera.at("forward").list_value().values(2).number_value(), -1.0);
  const auto& sun = json.fields().at("sun").struct_value().fields();
  EXPECT_NEAR(sun.at("towards").list_value().values(2).number_value(),
              std::sin(18.0 * std::numbers::pi / 180.0), 1e-9);
  EXPECT_EQ(json.fields().at("image").struct_value().fields().at("widthPx").number_value(), 80.0);
  EXPECT_EQ(json.fields().at("grids").list_value().values_size(), 5);
}

TEST_F(CommandLineTest, ExportNamesWhatIsWrong) {
  const std::string vdb = folder_.File("storm.vdb");
  ExpectError("export " + kSample + " -o storm.nc", 64,
              "-o is 'storm.nc'; its name must end in .vdb");
  ExpectError("export " + kSample + " -o " + vdb + " --view " + vdb, 64,
              "--view is '" + vdb + "'; its name must end in .json");
  ExpectError("export " + kSample + " --time 9 -o " + vdb, 64, "9");
  ExpectError("export " + folder_.File("none.nc") + " -o " + vdb, 75, "none.nc");
  ExpectError("export " + kSample + " -o " + folder_.File("no/storm.vdb"), 78,
              "no/storm.vdb cannot be written");
  ExpectError("export " + kSample + " -o " + vdb + " --view " + folder_.File("no/storm.json"), 78,
              "no/storm.json");
}

TEST_F(CommandLineTest, FitNamesWhatIsWrongWithItsOutputs) {
  const std::string fit = "fit " + kSample + " --balls 1 -o ";
  const std::string balls = folder_.File("storm.balls");
  ExpectError(fit + "storm.nc", 64, "-o is 'storm.nc'; its name must end in .balls");
  ExpectError(fit + balls + " --volume " + balls, 64,
              "--volume is '" + balls + "'; its name must end in .nc");
  ExpectError(fit + balls + " --volume /dev/full", 64, "must end in .nc");
  EXPECT_FALSE(std::filesystem::exists(balls));
}

TEST_F(CommandLineTest, AnOutputDoesNotReplaceItsStorm) {
  const std::string storm = folder_.File("storm.nc");
  std::filesystem::copy_file(kSample, storm);
  ExpectError("render " + storm + " -o " + storm, 64, "-o would replace the storm file");
  ExpectError(
      "fit " + storm + " --balls 1 -o " + folder_.File("storm.balls") + " --volume " + storm, 64,
      "--volume would replace the storm file");
  EXPECT_EQ(Contents(storm), Contents(kSample));
}

// A file in place of a device would stop other programs that use it.
TEST_F(CommandLineTest, AnOutputReplacesNoDevice) {
  std::filesystem::create_symlink("/dev/null", picture_);
  ExpectError(render_, 78, picture_ + " is not a regular file and is not replaced by one");
  EXPECT_TRUE(std::filesystem::is_symlink(picture_));
}

TEST_F(CommandLineTest, AnInterruptedExportLeavesNoFile) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const std::string vdb = folder_.File("storm.vdb");
  const std::string partial = vdb + ".partial";
  const std::string out = folder_.File("out");
  const std::string err = folder_.File("err");
  // The command hangs when it begins to write, until it has received the signal.
  HangAt(partial);
  const HangingStorage hanging;
  RunningProgram program(PROGRAM, {"export", kSample, "--detail", "-o", vdb}, out, err);
  WaitFor([&] { return Hangs(partial) || !program.Runs(); });
  program.Signal(SIGTERM);
  EXPECT_TRUE(WaitFor([&] { return program.IsInterrupted() || !program.Runs(); }));
  HangNoLonger(partial);
  EXPECT_EQ(program.Wait().code, 75);
  EXPECT_EQ(Contents(err), "thunderhead: interrupted: no file was written\n");
  EXPECT_FALSE(std::filesystem::exists(vdb));
  EXPECT_FALSE(std::filesystem::exists(vdb + ".partial"));
}

TEST_F(CommandLineTest, AnExportedGridIsImportedAsAStorm) {
  const std::string vdb = folder_.File("storm.vdb");
  const std::string cloud = folder_.File("cloud.nc");
  ASSERT_EQ(Run("export " + kSample + " --time 1 -o " + vdb).code, 0);
  const std::string import = "import-vdb " + vdb + " -o " + cloud;
  const std::string grid = " --grid cloud";
  const std::string up = " --up z";
  const std::string metres = " --metres-per-unit 1";
  const std::string extinction = " --extinction-per-unit 2";
  ExpectError(import + up + metres + extinction, 64, "the file's grids are: cloud (float), ");
  ExpectError(import + " --grid fog" + up + metres + extinction, 64, "has no grid 'fog'");
  ExpectError(import + grid + metres + extinction, 64, "give --up (");
  ExpectError(import + grid + up + extinction, 64, "give --metres-per-unit (");
  ExpectError(import + grid + up + metres, 64, "give --extinction-per-unit (");
  ExpectError(import + grid, 64, "), and --metres-per-unit (");
  ExpectError(import + grid + " --up w" + metres + extinction, 64, "--up is 'w'");
  ExpectError(import + grid + up + " --metres-per-unit 0" + extinction, 64,
              "--metres-per-unit is 0");
  // A file that has just changed is usually refused only for now (exit code 75). An OpenVDB file is
  // refused for good nevertheless.
  ExpectError("inspect " + vdb, 65, "thunderhead import-vdb");
  EXPECT_FALSE(std::filesystem::exists(cloud));
  const Outcome outcome = Run(import + grid + up + metres + extinction);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cells of 1000 x 1000 x "));
  EXPECT_FALSE(std::filesystem::exists(cloud + ".partial"));
  const Outcome inspected = Run("inspect " + cloud);
  ASSERT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_THAT(inspected.out, HasSubstr("extinction"));
}

// Uses a small cloud, because the command draws some ninety settings.
TEST_F(CommandLineTest, MeasureTradeContinuesWhereItStopped) {
  const std::string cloud = folder_.File("cloud.nc");
  ASSERT_EQ(Run("generate --spacing 200 --cells 24x24x16 --ellipsoid 0,0,1600,1800,1800,1200 "
                "--feature-size 800 --octaves 2 --threshold 0 --water 1 --base 200 -o " +
                cloud)
                .code,
            0);
  const std::string trade = folder_.File("trade");
  const std::string command = "measure trade " + cloud +
                              " --device software --size 24x16 --spp 16 --million-paths 0.01 -o " +
                              trade;
  const Outcome first = Run(command);
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("half_angle    uniform_phase_low_albedo"));
  EXPECT_THAT(Contents(trade + ".svg"), HasSubstr("<polyline"));
  EXPECT_THAT(Contents(trade + ".json"), HasSubstr("\"pareto\": true"));
  // Removes one and a half rows. The other rows are not measured again, so their times stay the
  // same.
  const std::string whole = Contents(trade + ".csv");
  const std::string kept = whole.substr(0, whole.size() - 150);
  std::ofstream(trade + ".csv") << kept;
  ASSERT_EQ(Run(command).code, 0);
  const std::string again = Contents(trade + ".csv");
  EXPECT_THAT(again, StartsWith(kept.substr(0, kept.rfind('\n') + 1)));
  EXPECT_EQ(std::count(again.begin(), again.end(), '\n'),
            std::count(whole.begin(), whole.end(), '\n'));
  // A file made for another picture is not changed.
  const Outcome other =
      Run("measure trade " + cloud + " --device software --size 30x16 --spp 16 -o " + trade);
  EXPECT_EQ(other.code, 64);
  EXPECT_THAT(other.err, HasSubstr("cannot be continued"));
  EXPECT_EQ(Contents(trade + ".csv"), again);
}

}  // namespace
}  // namespace thunderhead::testing
