// Choosing a setting from a table, on plain values.
#include "accuracy/offers.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::accuracy {
namespace {

using scene::MaxError;
using scene::MaxMilliseconds;
using ::testing::HasSubstr;

Setting Slices(int slices, const Path& path = test_support::kLightVolume) {
  Setting setting{path.plain()};
  SetCount(&setting.technique, slices);
  return setting;
}

// Dearer ones are closer, but for the last.
const std::vector<Offer> kOffers = {{Slices(32), 5.0, 0.40},
                                    {Slices(64), 10.0, 0.30},
                                    {Slices(128), 20.0, 0.20},
                                    {Slices(256), 40.0, 0.25}};

Offer Best(const scene::Accuracy& limit, const std::optional<Setting>& current = std::nullopt) {
  return BestOffer(kOffers, limit, current);
}

TEST(BestOfferTest, CheapestThatMeetsAnError) {
  EXPECT_EQ(Best(MaxError{0.5}), kOffers[0]);
  EXPECT_EQ(Best(MaxError{0.40}), kOffers[0]);
  EXPECT_EQ(Best(MaxError{0.39}), kOffers[1]);
  EXPECT_EQ(Best(MaxError{0.26}), kOffers[2]);
}

TEST(BestOfferTest, MostAccurateThatMeetsATime) {
  EXPECT_EQ(Best(MaxMilliseconds{5.0}), kOffers[0]);
  EXPECT_EQ(Best(MaxMilliseconds{19.9}), kOffers[1]);
  // More time than the best needs buys nothing worse.
  EXPECT_EQ(Best(MaxMilliseconds{1000.0}), kOffers[2]);
}

TEST(BestOfferTest, NearestWhereNoneMeets) {
  EXPECT_EQ(Best(MaxError{0.1}), kOffers[2]);
  EXPECT_FALSE(Meets(Best(MaxError{0.1}), MaxError{0.1}));
  EXPECT_EQ(Best(MaxMilliseconds{1.0}), kOffers[0]);
  EXPECT_FALSE(Meets(Best(MaxMilliseconds{1.0}), MaxMilliseconds{1.0}));
  EXPECT_TRUE(Meets(kOffers[0], MaxMilliseconds{5.0}));
}

TEST(BestOfferTest, WhatIsDrawnStaysWhileItIsLittleWorse) {
  // Within a tenth of the limit; but twice as dear as the best.
  EXPECT_EQ(Best(MaxError{0.5}, Slices(64)), kOffers[0]);
  // 10.5 ms would give the second; the third is within a tenth of 18.5.
  EXPECT_EQ(Best(MaxMilliseconds{18.5}), kOffers[1]);
  EXPECT_EQ(Best(MaxMilliseconds{18.5}, Slices(128)), kOffers[2]);
  EXPECT_EQ(Best(MaxMilliseconds{18.0}, Slices(128)), kOffers[1]);
  // The fourth is a quarter worse than the best, no more.
  EXPECT_EQ(Best(MaxMilliseconds{100.0}, Slices(256)), kOffers[3]);
  // What the table does not know cannot stay.
  EXPECT_EQ(Best(MaxError{0.5}, Slices(7)), kOffers[0]);
}

TEST(TableCorrectionTest, WithoutMeasurementsTheTableIsBelieved) {
  EXPECT_EQ(TableCorrection().Factor(Slices(64)), 1.0);
}

TEST(TableCorrectionTest, TheMostSpecialKnowledgeCounts) {
  TableCorrection correction;
  correction.Observe(Slices(64), 10.0, 30.0);
  EXPECT_NEAR(correction.Factor(Slices(64)), 3.0, 1e-9);
  EXPECT_NEAR(correction.Factor(Slices(128)), 3.0, 1e-9);
  const Setting half_angle = Slices(64, test_support::kHalfAngle);
  EXPECT_NEAR(correction.Factor(half_angle), 3.0, 1e-9);
  EXPECT_FALSE(correction.Knows(half_angle));
  correction.Observe(half_angle, 10.0, 5.0);
  EXPECT_TRUE(correction.Knows(half_angle));
  EXPECT_NEAR(correction.Factor(half_angle), 0.5, 1e-9);
  EXPECT_NEAR(correction.Factor(Slices(512, test_support::kHalfAngle)), 0.5, 1e-9);
  EXPECT_NEAR(correction.Factor(Slices(64)), 3.0, 1e-9);
}

TEST(TableCorrectionTest, FollowsAMachineAndForgetsAnOutlier) {
  TableCorrection correction;
  for (int i = 0; i < 20; ++i) correction.Observe(Slices(64), 10.0, 20.0);
  correction.Observe(Slices(64), 10.0, 2000.0);
  for (int i = 0; i < 10; ++i) correction.Observe(Slices(64), 10.0, 20.0);
  // 0.7^10 = 0.028 of 0.3 times the outlier's logarithm is left.
  EXPECT_NEAR(correction.Factor(Slices(64)), 2.0, 2.0 * 0.05);
  for (const double nonsense_ms : {0.0, -1.0}) correction.Observe(Slices(64), 10.0, nonsense_ms);
  EXPECT_NEAR(correction.Factor(Slices(64)), 2.0, 2.0 * 0.05);
}

class OffersTest : public ::testing::Test {
 protected:
  OffersTest() {
    scene_.output = {200, 100, 88};
    scene_.camera = scene::TopDownCamera{};
  }

  static OfferTables Tables() {
    PricedSettings table;
    table.size_px = {200, 100};
    for (const Offer& offer : kOffers) {
      table.rows.push_back({offer.setting, offer.milliseconds, offer.error});
    }
    OfferTables tables;
    tables.fill(absl::FailedPreconditionError("no accuracy can be offered for such views"));
    tables[2] = table;
    return tables;
  }

  int SlicesFor(const scene::Accuracy& limit) {
    scene_.accuracy = limit;
    return CountOf(offers_.Decide(scene_, std::nullopt)->rendering.technique);
  }

  Offers offers_{Tables()};
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(OffersTest, DecidesWhatTheSceneLeavesToThem) {
  scene_.rendering.technique =
      InMode(scene::HalfAngle{}, test_support::kLowAlbedo, scene::Transport::kConsistent);
  scene::MediumSettingsOf(&scene_.rendering.technique)->look.false_colors = true;
  scene_.output.jpeg_quality = 40;
  scene_.accuracy = MaxError{0.35};
  const scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  EXPECT_EQ(PathOf(decided.rendering.technique), test_support::kLightVolume);
  EXPECT_EQ(ModeOf(decided.rendering.technique).name, "per_field_phase_translucent");
  EXPECT_EQ(CountOf(decided.rendering.technique), 64);
  EXPECT_TRUE(scene::FieldLookOf(decided.rendering.technique).false_colors);
  EXPECT_EQ(decided.output.jpeg_quality, 40);
}

TEST_F(OffersTest, LeavesASceneThatAsksForNothingAndTheReference) {
  scene::SetSlices(&scene_.rendering.technique, 7);
  EXPECT_EQ(*offers_.Decide(scene_, std::nullopt), scene_);
  scene_.rendering.technique = scene::Reference{};
  scene_.accuracy = MaxError{0.35};
  EXPECT_EQ(*offers_.Decide(scene_, std::nullopt), scene_);
}

TEST_F(OffersTest, AViewWithoutATableIsTold) {
  scene_.camera = scene::SpotterCamera{};
  EXPECT_TRUE(offers_.Decide(scene_, std::nullopt).ok());
  scene_.accuracy = MaxError{0.35};
  EXPECT_THAT(std::string(offers_.Decide(scene_, std::nullopt).status().message()),
              HasSubstr("no accuracy can be offered"));
  EXPECT_FALSE(offers_.Report(scene_, {}, std::nullopt, 0).has_value());
}

TEST_F(OffersTest, LargerPicturesCostMore) {
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 128);
  scene_.output = {400, 100, 88};
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 64);
}

TEST_F(OffersTest, TimesAreCorrectedByWhatFramesCost) {
  scene_.accuracy = MaxMilliseconds{20.0};
  const scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  EXPECT_EQ(CountOf(decided.rendering.technique), 128);
  offers_.Observe(decided, 45.0);
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 32);
  // A cheaper machine than the table's, once that is known of the setting itself.
  for (int i = 0; i < 30; ++i) offers_.Observe(decided, 10.0);
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 128);
}

TEST_F(OffersTest, ReportsWhatItBelieves) {
  scene_.accuracy = MaxError{0.35};
  const scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  AccuracyReport report = *offers_.Report(decided, {}, std::nullopt, 0);
  EXPECT_EQ(report.slices, 64);
  EXPECT_EQ(report.expected_ms, 10.0);
  EXPECT_EQ(report.model_error, 0.30);
  EXPECT_EQ(report.estimated_error, 0.30);
  EXPECT_FALSE(report.unmet.has_value());
  // A coarse frame tells its own error, and that of what follows meets the limit.
  report = *offers_.Report(decided, {0.5, 0.5}, std::nullopt, 0);
  EXPECT_EQ(report.slices, 32);
  EXPECT_EQ(report.image_scale, 0.5);
  EXPECT_EQ(report.estimated_error, 0.40);
  EXPECT_FALSE(report.unmet.has_value());
  // The view's own slices add so much that the limit is missed after all.
  report = *offers_.Report(decided, {}, 0.4, 0);
  EXPECT_DOUBLE_EQ(report.estimated_error, 0.5);
  EXPECT_EQ(report.discretisation_error, 0.4);
  EXPECT_THAT(report.unmet->message, HasSubstr("the nearest is 0.5"));
}

TEST_F(OffersTest, SaysWhatIsOutOfReachAndWhatIsNearest) {
  scene_.accuracy = MaxError{0.05};
  scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  EXPECT_EQ(offers_.Report(decided, {}, std::nullopt, 0)->unmet->message,
            "an error of 0.05 is out of reach for top-down views; the nearest is 0.2, in 20 ms a "
            "frame. The reference refines to any error");
  scene_.accuracy = MaxMilliseconds{1.0};
  decided = *offers_.Decide(scene_, std::nullopt);
  EXPECT_EQ(offers_.Report(decided, {}, std::nullopt, 0)->unmet->message,
            "1 ms a frame are out of reach for top-down views of 200x100 on this machine; the "
            "nearest is 5 ms, with an error of 0.4");
}

TEST_F(OffersTest, FramesThatAskForNothingAreReportedWhereTheTableKnowsThem) {
  scene::SetSlices(&scene_.rendering.technique, 128);
  AccuracyReport report = *offers_.Report(scene_, {}, std::nullopt, 0);
  EXPECT_EQ(report.model_error, 0.20);
  EXPECT_FALSE(report.expected_ms.has_value());
  offers_.Observe(scene_, 30.0);
  EXPECT_NEAR(*offers_.Report(scene_, {}, std::nullopt, 0)->expected_ms, 30.0, 1e-9);
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  EXPECT_FALSE(offers_.Report(scene_, {}, std::nullopt, 0).has_value());
}

class TracedOffersTest : public ::testing::Test {
 protected:
  // Two settings of diffusion, the second also with traced light.
  static OfferTables Tables() {
    PricedSettings table;
    table.size_px = {200, 100};
    Setting setting = Slices(64);
    test_support::SetTransport(&setting.technique, scene::Transport::kDiffusion);
    table.rows.push_back({setting, 9.0, 0.12});
    SetCount(&setting.technique, 128);
    table.rows.push_back({setting, 10.0, 0.11});
    for (const auto& [paths, error] : {std::pair{0.1, 0.08}, std::pair{1.0, 0.05}}) {
      setting.million_paths = paths;
      table.rows.push_back({setting, 9.5, error});
    }
    OfferTables tables;
    tables.fill(table);
    return tables;
  }

  TracedOffersTest() { scene_.output = {200, 100, 88}; }

  scene::Technique TechniqueFor(const scene::Accuracy& limit) {
    scene_.accuracy = limit;
    return offers_.Decide(scene_, std::nullopt)->rendering.technique;
  }

  Offers offers_{Tables()};
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(TracedOffersTest, LightIsTracedWhereNothingElseIsAsAccurate) {
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.115})), scene::TracedLight::kOff);
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.09})), scene::TracedLight::kAwaited);
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.06})), scene::TracedLight::kAwaited);
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.01})),
            scene::TracedLight::kAwaited);  // the nearest
  EXPECT_EQ(CountOf(TechniqueFor(MaxError{0.01})), 128);
  // A limit of time takes no more of the machine than it says.
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxMilliseconds{50.0})), scene::TracedLight::kOff);
}

TEST_F(TracedOffersTest, TheErrorIsThatOfThePathsSoFar) {
  scene_.accuracy = MaxError{0.06};
  const scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  const auto error_after = [&](std::int64_t paths) {
    return offers_.Report(decided, {}, std::nullopt, paths)->model_error;
  };
  EXPECT_EQ(error_after(0), 0.11);
  EXPECT_EQ(error_after(90'000), 0.11);
  EXPECT_EQ(error_after(100'000), 0.08);
  EXPECT_EQ(error_after(4'000'000), 0.05);
  // Few paths are on their way to what was asked for.
  EXPECT_EQ(offers_.Report(decided, {}, std::nullopt, 0)->unmet, std::nullopt);
  scene_.accuracy = MaxError{0.01};
  const scene::Scene nearest = *offers_.Decide(scene_, std::nullopt);
  EXPECT_THAT(offers_.Report(nearest, {}, std::nullopt, 0)->unmet->message,
              HasSubstr("the nearest is 0.05"));
}

TEST_F(TracedOffersTest, APictureWaitsForTheFewestPathsThatItsErrorNeeds) {
  const auto paths_for = [&](const scene::Accuracy& limit) {
    scene_.accuracy = limit;
    return offers_.PathsFor(*offers_.Decide(scene_, std::nullopt));
  };
  EXPECT_EQ(paths_for(MaxError{0.09}), 100'000);
  EXPECT_EQ(paths_for(MaxError{0.06}), 1'000'000);
  EXPECT_EQ(paths_for(MaxError{0.01}), kTracedPaths) << "out of reach";
  EXPECT_EQ(paths_for(std::monostate()), kImagePaths);
}

TEST_F(TracedOffersTest, FramesOfTracedLightTeachTheirSettingsTime) {
  scene_.accuracy = MaxError{0.06};
  const scene::Scene decided = *offers_.Decide(scene_, std::nullopt);
  offers_.Observe(decided, 19.0);
  EXPECT_NEAR(*offers_.Report(decided, {}, std::nullopt, 0)->expected_ms, 19.0, 1e-9);
}

TEST(BuiltInOfferTablesTest, ServeEveryKindOfView) {
  for (const auto& table : BuiltInOfferTables()) EXPECT_TRUE(table.ok()) << table.status();
}

}  // namespace
}  // namespace thunderhead::accuracy
