// Tests that a time of a storm may be spread over several files. The format of these files is known
// only here. A text "part RUN MINUTE LAYER C" has one layer of rain of one time. A text "heights
// RUN METRES" has the depth of the layers at all times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/storm_format.h"
#include "storm_store/catalogue_scan.h"
#include "storm_store/storm_store.h"
#include "tests/support/captured_log.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kLayers = 2;

std::istringstream Words(const UnknownFile& file) {
  return std::istringstream(std::string(file.Start()));
}

struct Layered {
  double depth_m = 0.0;
  absl::Time time;
  std::map<int, float> rain_kg_per_m3;  // by layer
};

class LayeredToy final : public LayerSource {
 public:
  explicit LayeredToy(Layered toy) : toy_(std::move(toy)) {
    domain_.path = "toy";
    domain_.time = toy_.time;
    domain_.cells = {1, 1, kLayers};
    domain_.dx_m = domain_.dy_m = 1000.0;
    domain_.fixed_heights = true;
    domain_.fields = {{.hydrometeor = physics::Hydrometeor::kRain,
                       .variable = "rain",
                       .quantity = volume::Quantity::kMassConcentration}};
  }

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override {
    const auto depth_m = static_cast<float>(toy_.depth_m);
    return std::vector<float>{0.0F, depth_m, 2.0F * depth_m};
  }
  absl::StatusOr<LayerState> Air() override { return absl::InternalError("not asked for"); }
  absl::StatusOr<LayerAmounts> Amounts(std::size_t) override {
    LayerAmounts amounts;
    for (const auto& [layer, rain] : toy_.rain_kg_per_m3) amounts.amounts.push_back(rain);
    return amounts;
  }

 private:
  const Layered toy_;
  LayerDomain domain_;
};

class PartFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "a part"; }
  std::string_view Example() const override { return "*.part"; }
  std::string_view Requirement() const override { return "a part (it does not begin so)"; }
  bool MayBegin(std::string_view start) const override {
    return start.starts_with("part ") || start.starts_with("heights ");
  }
  FormatFit Sniff(const UnknownFile& file) const override {
    return MayBegin(file.Start()) ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    std::string kind;
    std::string run;
    int minute = 0;
    Words(unknown) >> kind >> run >> minute;
    StormFile file;
    file.path = unknown.Path();
    file.part = {.of = run, .at_all_times = kind == "heights"};
    if (kind == "part") file.times = {absl::UnixEpoch() + absl::Minutes(minute)};
    return file;
  }

  absl::StatusOr<StormFile> DescribeTogether(const std::vector<UnknownFile>& files) const override {
    Layered toy;
    std::string run;
    for (const UnknownFile& each : files) {
      std::istringstream words = Words(each);
      std::string kind;
      int minute = 0;
      int layer = 0;
      words >> kind >> run;
      if (kind == "heights") {
        words >> toy.depth_m;
      } else {
        words >> minute >> layer >> toy.rain_kg_per_m3[layer];
        toy.time = absl::UnixEpoch() + absl::Minutes(minute);
      }
    }
    if (toy.depth_m == 0.0) return absl::InvalidArgumentError("the heights are missing");
    if (toy.rain_kg_per_m3.size() != kLayers) {
      return absl::InvalidArgumentError(
          absl::StrCat(run, " lacks a layer of ", toy.rain_kg_per_m3.size()));
    }
    StormFile file;
    file.cells = {1, 1, kLayers};
    file.dx_m = file.dy_m = 1000.0;
    file.times = {toy.time};
    file.fields = {physics::Hydrometeor::kRain};
    file.run = run;
    file.reader =
        MakeRecordReader([toy](std::size_t) { return std::make_unique<LayeredToy>(toy); });
    return file;
  }
};

class PartsOfTime : public ::testing::Test {
 protected:
  PartsOfTime() {
    formats_ = StormFormats::BuiltIn();
    formats_.Add(std::make_shared<PartFormat>());
  }

  void Write(const std::string& name, const std::string& content) {
    std::ofstream(folder_.File(name)) << content;
  }

  // Returns the valid times of each storm.
  std::vector<std::vector<std::string>> TimesAt(storm_store::CatalogueScan& scan, seconds after) {
    const auto result = scan.Scan(storm_store::CatalogueScan::Time(std::chrono::hours(1)) + after);
    std::vector<std::vector<std::string>> storms;
    if (!result.ok()) return storms;
    for (const storm_store::CataloguedStorm& storm : result->storms) {
      std::vector<std::string>& times = storms.emplace_back();
      for (const storm_store::StormTime& time : storm.info.times) {
        times.push_back(time.valid_time.substr(11, 5));
      }
    }
    return storms;
  }

  testing::TemporaryFolder folder_;
  StormFormats formats_;
};

TEST_F(PartsOfTime, FilesOfOneRunAndTimeAreReadTogether) {
  Write("a.heights", "heights A 500");
  for (const int minute : {0, 10}) {
    for (const int layer : {0, 1}) {
      Write(absl::StrCat("a", minute, layer),
            absl::StrCat("part A ", minute, " ", layer, " 0.00", 1 + layer + minute / 10));
    }
  }
  Write("b.heights", "heights B 250");
  Write("b0", "part B 0 0 0.005");
  Write("b1", "part B 0 1 0.006");
  const auto store = storm_store::StormStore::Open({folder_.Path().string()},
                                                   {.read_ahead = 0, .formats = formats_});
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 2U);
  for (const storm_store::StormInfoPtr& storm : (*store)->Storms()) {
    const bool is_a = storm->times.size() == 2;
    for (std::size_t time = 0; time < storm->times.size(); ++time) {
      const auto fields = (*store)->Get(storm->id, static_cast<int>(time), {});
      ASSERT_TRUE(fields.ok()) << fields.status();
      EXPECT_EQ((*fields)->grid.spacing_m.z, is_a ? 500.0 : 250.0);
      const float first = is_a ? 0.001F + 0.001F * static_cast<float>(time) : 0.005F;
      EXPECT_THAT((*fields)->fields[0].concentration_kg_per_m3,
                  ElementsAre(::testing::FloatEq(first), ::testing::FloatEq(first + 0.001F)));
    }
  }
}

TEST_F(PartsOfTime, ATimeIsListedWhenAllItsFilesAreThere) {
  const testing::CapturedLog log;
  storm_store::CatalogueScan scan({.paths = {folder_.Path().string()},
                                   .formats = formats_,
                                   .settle = seconds(3),
                                   .retry = seconds(30)});
  Write("a00", "part A 0 0 0.001");
  Write("a01", "part A 0 1 0.002");
  TimesAt(scan, seconds(0));
  EXPECT_THAT(TimesAt(scan, seconds(5)), ElementsAre());
  EXPECT_THAT(log.Text(), HasSubstr("the heights are missing"));
  Write("heights", "heights A 500");
  Write("a10", "part A 10 0 0.001");
  TimesAt(scan, seconds(10));
  EXPECT_THAT(TimesAt(scan, seconds(15)), ElementsAre(ElementsAre("00:00")));
  EXPECT_THAT(log.Text(), HasSubstr("A lacks a layer of 1"));
  Write("a11", "part A 10 1 0.001");
  TimesAt(scan, seconds(20));
  EXPECT_THAT(TimesAt(scan, seconds(25)), ElementsAre(ElementsAre("00:00", "00:10")));
}

TEST_F(PartsOfTime, OneFileOfATimeIsNoStorm) {
  Write("a00", "part A 0 0 0.001");
  const auto store =
      storm_store::StormStore::Open({folder_.File("a00")}, {.read_ahead = 0, .formats = formats_});
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("give the folder with all of them"));
}

TEST_F(PartsOfTime, HeightsWithoutATimeAreReported) {
  Write("heights", "heights A 500");
  const auto store = storm_store::StormStore::Open({folder_.Path().string()},
                                                   {.read_ahead = 0, .formats = formats_});
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("put them together"));
}

}  // namespace
}  // namespace thunderhead::storm_files
