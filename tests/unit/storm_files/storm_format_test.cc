// Tests that a format defined only here is recognised, described and read like the built-in
// formats. A file of several formats or of none must give one clear error.
#include "storm_files/storm_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "absl/strings/str_cat.h"
#include "storm_files/cf_format.h"
#include "storm_files/wrf_format.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SyntheticWrf;
using testing::TemporaryFolder;
using testing::WrfCell;

// A reader of toy files. A toy file is the text "toy N C": a cube of N cells a side with C kg/m3 of
// rain in each. A file that begins with "toys" has two such storms.
class ToyReader final : public RecordReader {
 public:
  explicit ToyReader(std::string path) : path_(std::move(path)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(const RecordPart& part,
                                                 const std::optional<VerticalGrid>&,
                                                 const ReadCheckpoint& checkpoint) const override {
    if (part.record != 0) return absl::OutOfRangeError(absl::StrCat(path_, ": has one record"));
    if (part.window.has_value() || part.stride != 1) {
      return absl::UnimplementedError(absl::StrCat(path_, ": is read as a whole"));
    }
    std::string word;
    int cells = 0;
    float concentration = 0.0F;
    std::ifstream(path_) >> word >> cells >> concentration;
    if (!(concentration > 0.0F)) return absl::DataLossError(absl::StrCat(path_, ": holds no rain"));
    if (absl::Status status = checkpoint(0.5); !status.ok()) return status;
    volume::HydrometeorFields fields;
    fields.grid = {glm::ivec3(cells), glm::dvec3(100.0), glm::dvec3(0.0)};
    fields.terrain_height_m.assign(static_cast<std::size_t>(cells) * cells, 0.0F);
    fields.condensate = {glm::ivec3(0), glm::ivec3(cells)};
    fields.fields.resize(1);
    fields.fields[0].hydrometeor = physics::Hydrometeor::kRain;
    fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), concentration);
    return fields;
  }

  absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t) const override {
    return VerticalGrid{0.0, 100.0, 1};
  }

 private:
  std::string path_;
};

class ToyFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "a toy"; }
  std::string_view Example() const override { return "*.toy"; }
  std::string_view Requirement() const override { return "a toy (it does not begin so)"; }

  bool MayBegin(std::string_view start) const override { return start.starts_with("toy"); }

  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    std::string word;
    int cells = 0;
    std::ifstream(unknown.Path()) >> word >> cells;
    if (cells < 1) return absl::DataLossError(absl::StrCat(unknown.Path(), ": has no cells"));
    StormFile file;
    file.path = unknown.Path();
    file.cells = glm::ivec3(cells);
    file.dx_m = file.dy_m = 100.0;
    file.times = {absl::UnixEpoch()};
    file.fields = {physics::Hydrometeor::kRain};
    file.about = "of the test";
    file.reader = std::make_shared<ToyReader>(unknown.Path());
    if (word == "toys") {
      file.member = "a";
      file.others.push_back(file);
      file.others.back().member = "b";
    }
    return file;
  }
};

// A format that claims every netCDF file with the given closeness of match, but cannot describe any
// file.
class Greedy final : public StormFormat {
 public:
  explicit Greedy(FormatFit fit) : fit_(fit) {}

  std::string_view Name() const override { return "any netCDF"; }
  std::string_view Example() const override { return "*.nc"; }
  std::string_view Requirement() const override { return "netCDF"; }
  FormatFit Sniff(const UnknownFile& file) const override {
    return file.Netcdf().ok() ? fit_ : FormatFit::kNone;
  }
  absl::StatusOr<StormFile> Describe(const UnknownFile&) const override {
    return absl::UnimplementedError("described as any netCDF");
  }

 private:
  FormatFit fit_;
};

class StormFormatTest : public ::testing::Test {
 protected:
  void WriteToy(const std::string& name, const std::string& content) {
    std::ofstream(folder_.File(name)) << content;
  }

  std::string WriteWrf() {
    SyntheticWrf file;
    file.mixing_ratios["QCLOUD"] = [](const WrfCell&) { return 1e-3; };
    testing::WriteWrf(file, folder_.File("wrfout"));
    return folder_.File("wrfout");
  }

  std::string WriteCf() {
    testing::WriteCf(testing::ExtinctionFile(2, 2, 2, 100.0, 100.0, 100.0,
                                             [](auto, auto, auto) { return 1e-2; }),
                     folder_.File("cf.nc"));
    return folder_.File("cf.nc");
  }

  static StormFormats With(std::shared_ptr<const StormFormat> format) {
    StormFormats formats = StormFormats::BuiltIn();
    formats.Add(std::move(format));
    return formats;
  }

  TemporaryFolder folder_;
};

TEST_F(StormFormatTest, AFormatOfTheTestIsReadBesideTheBuiltInOnes) {
  WriteToy("rain.toy", "toy 3 0.002");
  WriteWrf();
  WriteCf();
  const auto store = storm_store::StormStore::Open(
      {folder_.Path().string()}, {.read_ahead = 0, .formats = With(std::make_shared<ToyFormat>())});
  ASSERT_TRUE(store.ok()) << store.status();
  std::vector<std::string> ids;
  for (const storm_store::StormInfoPtr& storm : (*store)->Storms()) ids.push_back(storm->id);
  EXPECT_THAT(ids, ElementsAre("cf", "rain.toy", "wrfout"));
  EXPECT_EQ((*store)->Find("rain.toy")->title, "rain.toy (of the test)");
  EXPECT_EQ((*store)->Find("rain.toy")->file_cells, glm::ivec3(3));
  double progress = 0.0;
  const auto fields = (*store)->Get("rain.toy", 0, [&](double share) { progress = share; });
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.CellCount(), 27U);
  EXPECT_THAT((*fields)->fields[0].concentration_kg_per_m3, ::testing::Each(0.002F));
  EXPECT_EQ(progress, 0.5);
  for (const char* id : {"cf", "wrfout"}) EXPECT_TRUE((*store)->Get(id, 0, {}).ok()) << id;
}

TEST_F(StormFormatTest, AStoreTakesAFileOfItLaterToo) {
  const std::string wrf = WriteWrf();
  WriteToy("late.toy", "toy 2 0.001");
  const auto store =
      storm_store::StormStore::Open({wrf}, {.formats = With(std::make_shared<ToyFormat>())})
          .value();
  const auto added = store->Add(folder_.File("late.toy"));
  ASSERT_TRUE(added.ok()) << added.status();
  EXPECT_TRUE(store->Get((*added)->id, 0, {}).ok());
}

TEST_F(StormFormatTest, AStoreTakesNoFileOfSeveralStormsLater) {
  WriteToy("two.toy", "toys 2 0.001");
  const auto store =
      storm_store::StormStore::Open({WriteWrf()}, {.formats = With(std::make_shared<ToyFormat>())})
          .value();
  const auto added = store->Add(folder_.File("two.toy"));
  EXPECT_EQ(added.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(added.status().message()), HasSubstr("it has 2 storms"));
  EXPECT_EQ(store->Storms().size(), 1U);
}

// A process that only reads WRF output needs the database of units, too.
TEST_F(StormFormatTest, EachFormatOfNetcdfIsPreparedForIt) {
  for (const auto& format : {MakeWrfFormat(), MakeCfFormat()}) {
    EXPECT_TRUE(format->MayBegin("CDF\x01")) << format->Name();
    EXPECT_TRUE(format->MayBegin("\x89HDF\r\n\x1a\n")) << format->Name();
    EXPECT_FALSE(format->MayBegin("GRIB")) << format->Name();
  }
}

TEST_F(StormFormatTest, ItsErrorsReachWhoAsks) {
  WriteToy("no_cells.toy", "toy");
  WriteToy("no_rain.toy", "toy 2");
  const storm_store::StormStoreOptions options = {.formats = With(std::make_shared<ToyFormat>())};
  const auto no_cells = storm_store::StormStore::Open({folder_.File("no_cells.toy")}, options);
  EXPECT_THAT(std::string(no_cells.status().message()), HasSubstr("has no cells"));
  const auto no_rain =
      storm_store::StormStore::Open({folder_.File("no_rain.toy")}, options).value();
  EXPECT_THAT(std::string(no_rain->Get("no_rain.toy", 0, {}).status().message()),
              HasSubstr("holds no rain"));
}

TEST_F(StormFormatTest, AnotherListOfFormatsKnowsNothingOfIt) {
  WriteToy("rain.toy", "toy 3 0.002");
  const StormFormats with_toy = With(std::make_shared<ToyFormat>());
  EXPECT_TRUE(with_toy.Describe(folder_.File("rain.toy")).ok());
  const absl::Status status = StormFormats::BuiltIn().Describe(folder_.File("rain.toy")).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("is not a netCDF file"));
}

TEST_F(StormFormatTest, AFileThatTwoFormatsFitEquallyIsAnError) {
  const std::pair<std::string, FormatFit> files[] = {{WriteWrf(), FormatFit::kModelLayout},
                                                     {WriteCf(), FormatFit::kConvention}};
  for (const auto& [path, fit] : files) {
    const auto file = With(std::make_shared<Greedy>(fit)).Describe(path);
    EXPECT_TRUE(absl::IsInvalidArgument(file.status())) << file.status();
    EXPECT_THAT(
        std::string(file.status().message()),
        AllOf(HasSubstr(path), HasSubstr("any netCDF"), HasSubstr("only one of these formats")));
  }
}

TEST_F(StormFormatTest, AModelsLayoutGoesBeforeAConvention) {
  EXPECT_TRUE(With(std::make_shared<Greedy>(FormatFit::kConvention)).Describe(WriteWrf()).ok());
  EXPECT_THAT(std::string(With(std::make_shared<Greedy>(FormatFit::kModelLayout))
                              .Describe(WriteCf())
                              .status()
                              .message()),
              HasSubstr("described as any netCDF"));
}

TEST_F(StormFormatTest, AFileOfNoFormatIsToldWhatEachWouldNeed) {
  testing::SyntheticCf file =
      testing::ExtinctionFile(2, 2, 2, 1.0, 1.0, 1.0, [](auto, auto, auto) { return 1.0; });
  file.variables[0].name = "temperature";
  file.variables[0].attributes = {};
  const std::string path = folder_.File("none.nc");
  testing::WriteCf(file, path);
  const auto message = [&](const StormFormats& formats) {
    return std::string(formats.Describe(path).status().message());
  };
  const std::string built_in =
      path +
      ": is neither WRF output (it has no dimensions west_east, south_north, bottom_top) "
      "nor a CF file with a hydrometeor (by standard name, e.g. "
      "mass_concentration_of_cloud_liquid_water_in_air) or a variable extinction (m-1) "
      "nor GRIB2 (it has no GRIB message) "
      "nor an SHDOM particle or property file (it does not begin with such a header) "
      "nor a MYSTIC cloud file (it does not begin with three numbers of cells and a flag) "
      "nor an AT3D cloud field (it does not begin with its grid and the names of its columns)";
  const std::string toy = " nor a toy (it does not begin so)";
  const std::string advice = "; give a file in one of these formats";
  EXPECT_EQ(message(StormFormats::BuiltIn()), built_in + advice);
  EXPECT_EQ(message(With(std::make_shared<ToyFormat>())), built_in + toy + advice);
}

TEST_F(StormFormatTest, TheNearestFormatSaysWhyAFileIsRefused) {
  testing::SyntheticCf file =
      testing::ExtinctionFile(2, 2, 2, 1.0, 1.0, 1.0, [](auto, auto, auto) { return 1.0; });
  file.variables[0].name = "temperature";
  file.variables[0].attributes = {};
  const std::string path = folder_.File("none.nc");
  testing::WriteCf(file, path);
  const StormFormats formats = With(std::make_shared<Greedy>(FormatFit::kRelated));
  EXPECT_EQ(formats.Describe(path).status().message(), "described as any netCDF");
  EXPECT_TRUE(formats.Describe(WriteCf()).ok());
  EXPECT_TRUE(formats.Describe(WriteWrf()).ok());
  // The first of two formats that are equally near gives the reason.
  StormFormats twice = formats;
  twice.Add(std::make_shared<Greedy>(FormatFit::kRelated));
  EXPECT_EQ(twice.Describe(path).status().message(), "described as any netCDF");
}

TEST_F(StormFormatTest, MessagesSayWhichFilesToGive) {
  const std::string built_in = "wrfout_..., CF netCDF, GRIB2, SHDOM text, MYSTIC text, ";
  EXPECT_EQ(StormFormats::BuiltIn().Examples(), built_in + "or AT3D text");
  EXPECT_EQ(With(std::make_shared<ToyFormat>()).Examples(), built_in + "AT3D text, or *.toy");
  const auto nothing =
      storm_store::FindStorms({folder_.Path().string()}, With(std::make_shared<ToyFormat>()));
  EXPECT_THAT(std::string(nothing.status().message()), HasSubstr("AT3D text, or *.toy"));
}

}  // namespace
}  // namespace thunderhead::storm_files
