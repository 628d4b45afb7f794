// Tests of choosing a setting from a table, on plain values.
#include "accuracy/offers.h"

#include <cmath>
#include <utility>

#include "accuracy/estimator.h"
#include "accuracy/named_settings.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::accuracy {
namespace {

using scene::MaxError;
using scene::MaxMilliseconds;
using ::testing::HasSubstr;

Setting Slices(int slices, const PlainTechnique& plain = test_support::kLightVolume) {
  Setting setting{plain.settings()};
  scene::SetCount(&setting.technique, slices);
  return setting;
}

// More expensive settings are more accurate, except for the last.
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
  // A limit above the time of the best setting does not select a worse one.
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
  // The present setting's error is within a tenth of the limit, but the setting costs twice as much
  // as the best one.
  EXPECT_EQ(Best(MaxError{0.5}, Slices(64)), kOffers[0]);
  // The second setting is the best within the limit; the third is within a tenth of 18.5 ms.
  EXPECT_EQ(Best(MaxMilliseconds{18.5}), kOffers[1]);
  EXPECT_EQ(Best(MaxMilliseconds{18.5}, Slices(128)), kOffers[2]);
  EXPECT_EQ(Best(MaxMilliseconds{18.0}, Slices(128)), kOffers[1]);
  // The fourth setting is a quarter worse than the best, which is exactly the tolerance.
  EXPECT_EQ(Best(MaxMilliseconds{100.0}, Slices(256)), kOffers[3]);
  // A present setting that is not in the table is not kept.
  EXPECT_EQ(Best(MaxError{0.5}, Slices(7)), kOffers[0]);
}

// The choice of settings and the estimates that one machine makes from `tables`.
struct Desk {
  explicit Desk(OfferTables offer_tables) : tables(std::move(offer_tables)) {}

  // Records the time of a full frame of `scene`. The frame counts as not the first of its setting,
  // so that the time includes no compilation.
  void Observe(const scene::Scene& scene, double milliseconds) {
    const int frames = std::exchange(compiled, true) ? 1 : 2;
    for (int i = 0; i < frames; ++i) {
      costs.Observe("", {scene, {}, milliseconds, {{scene::FrameStage::kView, milliseconds}}});
    }
  }

  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene) const {
    return offers.Decide(scene, std::nullopt);
  }

  const OfferTables tables;
  MachineCosts costs{tables};
  const Offers offers{tables, costs};
  const Estimator estimator{tables, costs};
  bool compiled = false;
};

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
    return scene::CountOf(desk_.Decide(scene_)->rendering.technique);
  }

  Desk desk_{Tables()};
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(OffersTest, DecidesWhatTheSceneLeavesToThem) {
  scene_.rendering.technique =
      InMode(scene::HalfAngle{}, test_support::kLowAlbedo, scene::Transport::kConsistent);
  scene::MediumSettingsOf(&scene_.rendering.technique)->look.false_colors = true;
  scene_.output.jpeg_quality = 40;
  scene_.accuracy = MaxError{0.35};
  const scene::Scene decided = *desk_.Decide(scene_);
  EXPECT_EQ(test_support::PlainTechniqueOf(decided.rendering.technique),
            test_support::kLightVolume);
  EXPECT_EQ(ModeOf(decided.rendering.technique).name, "per_field_phase_translucent");
  EXPECT_EQ(scene::CountOf(decided.rendering.technique), 64);
  EXPECT_TRUE(scene::FieldLookOf(decided.rendering.technique).false_colors);
  EXPECT_EQ(decided.output.jpeg_quality, 40);
}

TEST_F(OffersTest, LeavesASceneThatAsksForNothingAndTheReference) {
  scene::SetSlices(&scene_.rendering.technique, 7);
  EXPECT_EQ(*desk_.Decide(scene_), scene_);
  scene_.rendering.technique = scene::Reference{};
  scene_.accuracy = MaxError{0.35};
  EXPECT_EQ(*desk_.Decide(scene_), scene_);
}

TEST_F(OffersTest, AViewWithoutATableIsTold) {
  scene_.camera = scene::SpotterCamera{};
  EXPECT_TRUE(desk_.Decide(scene_).ok());
  scene_.accuracy = MaxError{0.35};
  EXPECT_THAT(std::string(desk_.Decide(scene_).status().message()),
              HasSubstr("no accuracy can be offered"));
  EXPECT_FALSE(desk_.estimator.Report(scene_, {}, {}).has_value());
}

TEST_F(OffersTest, LargerPicturesCostMore) {
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 128);
  scene_.output = {400, 100, 88};
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 64);
}

TEST_F(OffersTest, TimesAreCorrectedByWhatFramesCost) {
  scene_.accuracy = MaxMilliseconds{20.0};
  const scene::Scene decided = *desk_.Decide(scene_);
  EXPECT_EQ(scene::CountOf(decided.rendering.technique), 128);
  desk_.Observe(decided, 45.0);
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 32);
  // This machine is faster than the table says. The estimate uses this once frames of this setting
  // have been measured.
  for (int i = 0; i < 30; ++i) desk_.Observe(decided, 10.0);
  EXPECT_EQ(SlicesFor(MaxMilliseconds{20.0}), 128);
}

TEST_F(OffersTest, ReportsWhatItBelieves) {
  scene_.accuracy = MaxError{0.35};
  const scene::Scene decided = *desk_.Decide(scene_);
  AccuracyReport report = *desk_.estimator.Report(decided, {}, {});
  EXPECT_EQ(report.slices, 64);
  EXPECT_EQ(report.expected_ms, 10.0);
  EXPECT_EQ(report.model_error, 0.30);
  EXPECT_EQ(report.estimated_error, 0.30);
  EXPECT_FALSE(report.unmet.has_value());
  // A coarse frame reports its own error; the error of the full frame meets the limit.
  report = *desk_.estimator.Report(decided, {0.5, 0.5}, {});
  EXPECT_EQ(report.slices, 32);
  EXPECT_EQ(report.image_scale, 0.5);
  EXPECT_EQ(report.estimated_error, 0.40);
  EXPECT_FALSE(report.unmet.has_value());
  // The discretisation error of this view is so large that the limit is missed.
  report = *desk_.estimator.Report(decided, {}, {0, 0.4});
  EXPECT_DOUBLE_EQ(report.estimated_error, 0.5);
  EXPECT_EQ(report.discretisation_error, 0.4);
  EXPECT_THAT(report.unmet->message, HasSubstr("the best has 0.5"));
}

TEST_F(OffersTest, MeasuredErrorsCountForTheSameLightAndGuessOthers) {
  MeasuredErrors measured;
  EXPECT_EQ(measured.FactorOf(Slices(64)), 1.0);
  measured.Observe(Slices(64), 0.30, 0.45);
  EXPECT_DOUBLE_EQ(measured.FactorOf(Slices(32)), 1.5);
  Setting traced = Slices(32);
  traced.million_paths = 1.0;
  EXPECT_EQ(measured.FactorOf(traced), 1.0) << "which mends what is wrong about the light";
  measured.Observe(traced, 0.02, 0.16);
  EXPECT_DOUBLE_EQ(measured.FactorOf(traced), 8.0);
  measured.Observe(Slices(128), 0.10, 0.40);
  EXPECT_DOUBLE_EQ(measured.FactorOf(Slices(64)), 4.0);
  const Setting half_angle = Slices(32, test_support::kHalfAngle);
  EXPECT_DOUBLE_EQ(measured.FactorOf(half_angle), 4.0) << "as the other, until it is measured";
  measured.Observe(half_angle, 0.30, 0.30);
  EXPECT_DOUBLE_EQ(measured.FactorOf(half_angle), 1.0);
  const Setting third{
      InMode(scene::HalfAngle{}, test_support::kLowAlbedo, scene::Transport::kConsistent)};
  EXPECT_DOUBLE_EQ(measured.FactorOf(third), 2.0) << "their mean";
}

TEST_F(OffersTest, AMeasuredErrorAboveTheLimitRefutesTheTable) {
  const auto refuted = [](double low, double value) {
    return MeasuredError{.relative_rmse = {value, low, 2.0 * value - low}};
  };
  scene_.accuracy = MaxError{0.35};
  const scene::Scene decided = *desk_.Decide(scene_);
  ASSERT_EQ(scene::CountOf(decided.rendering.technique), 64);
  MeasuredErrors measured;
  const Setting drawn = SettingOf(decided);
  EXPECT_FALSE(desk_.offers.Refutes(decided, drawn, refuted(0.34, 0.40), &measured))
      << "not surely";
  EXPECT_TRUE(desk_.offers.Refutes(decided, drawn, refuted(0.36, 0.45), &measured));
  const scene::Scene again = *desk_.offers.Decide(scene_, drawn, measured);
  EXPECT_EQ(scene::CountOf(again.rendering.technique), 128) << "0.2 times 1.5 is within it";
  scene_.accuracy = MaxMilliseconds{10.0};
  EXPECT_FALSE(desk_.offers.Refutes(*desk_.Decide(scene_), drawn, refuted(0.9, 1.0), &measured))
      << "no error was asked for";
}

TEST_F(OffersTest, SaysWhatIsOutOfReachAndWhatIsNearest) {
  scene_.accuracy = MaxError{0.05};
  scene::Scene decided = *desk_.Decide(scene_);
  EXPECT_EQ(desk_.estimator.Report(decided, {}, {})->unmet->message,
            "no setting reaches an error of 0.05 for top-down views; the best has 0.2 in 20 ms a "
            "frame; for a smaller error, choose the technique reference");
  scene_.accuracy = MaxMilliseconds{1.0};
  decided = *desk_.Decide(scene_);
  EXPECT_EQ(
      desk_.estimator.Report(decided, {}, {})->unmet->message,
      "no setting reaches 1 ms a frame for top-down views of 200x100 on this machine; the best "
      "takes 5 ms, with an error of 0.4; for less time, choose a smaller picture");
}

TEST_F(OffersTest, FramesThatAskForNothingAreReportedWhereTheTableKnowsThem) {
  scene::SetSlices(&scene_.rendering.technique, 128);
  AccuracyReport report = *desk_.estimator.Report(scene_, {}, {});
  EXPECT_EQ(report.model_error, 0.20);
  EXPECT_FALSE(report.expected_ms.has_value());
  desk_.Observe(scene_, 30.0);
  EXPECT_NEAR(*desk_.estimator.Report(scene_, {}, {})->expected_ms, 30.0, 1e-9);
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  EXPECT_FALSE(desk_.estimator.Report(scene_, {}, {}).has_value());
}

class TracedOffersTest : public ::testing::Test {
 protected:
  // Returns tables with two settings of the diffusion transport. The second setting also has
  // path-traced correction.
  static OfferTables Tables() {
    PricedSettings table;
    table.size_px = {200, 100};
    Setting setting = Slices(64);
    test_support::SetTransport(&setting.technique, scene::Transport::kDiffusion);
    table.rows.push_back({setting, 9.0, 0.12});
    scene::SetCount(&setting.technique, 128);
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
    return desk_.Decide(scene_)->rendering.technique;
  }

  Desk desk_{Tables()};
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(TracedOffersTest, LightIsTracedWhereNothingElseIsAsAccurate) {
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.115})), scene::TracedLight::kOff);
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.09})), scene::TracedLight::kAwaited);
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.06})), scene::TracedLight::kAwaited);
  // No setting is this accurate, so the nearest setting is used.
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxError{0.01})), scene::TracedLight::kAwaited);
  EXPECT_EQ(scene::CountOf(TechniqueFor(MaxError{0.01})), 128);
  // With a time limit no light is traced.
  EXPECT_EQ(scene::TracedLightOf(TechniqueFor(MaxMilliseconds{50.0})), scene::TracedLight::kOff);
}

TEST_F(TracedOffersTest, TheErrorIsThatOfThePathsSoFar) {
  scene_.accuracy = MaxError{0.06};
  const scene::Scene decided = *desk_.Decide(scene_);
  const auto error_after = [&](std::int64_t paths) {
    return desk_.estimator.Report(decided, {}, {paths, std::nullopt})->model_error;
  };
  EXPECT_EQ(error_after(0), 0.11);
  EXPECT_EQ(error_after(90'000), 0.11);
  EXPECT_EQ(error_after(100'000), 0.08);
  EXPECT_EQ(error_after(4'000'000), 0.05);
  // A picture with few paths does not yet meet the request.
  EXPECT_EQ(desk_.estimator.Report(decided, {}, {})->unmet, std::nullopt);
  scene_.accuracy = MaxError{0.01};
  const scene::Scene nearest = *desk_.Decide(scene_);
  EXPECT_THAT(desk_.estimator.Report(nearest, {}, {})->unmet->message,
              HasSubstr("the best has 0.05"));
}

TEST_F(TracedOffersTest, APictureWaitsForTheFewestPathsThatItsErrorNeeds) {
  const auto paths_for = [&](const scene::Accuracy& limit) {
    scene_.accuracy = limit;
    return desk_.estimator.PathsFor(*desk_.Decide(scene_));
  };
  EXPECT_EQ(paths_for(MaxError{0.09}), 100'000);
  EXPECT_EQ(paths_for(MaxError{0.06}), 1'000'000);
  EXPECT_EQ(paths_for(MaxError{0.01}), kTracedPaths) << "out of reach";
  EXPECT_EQ(paths_for(std::monostate()), kImagePaths);
  // Measured with 100 000 paths, the picture has one and a half times the error of the table.
  scene_.accuracy = MaxError{0.09};
  Setting drawn = SettingOf(*desk_.Decide(scene_));
  drawn.million_paths = 0.1;
  MeasuredErrors measured;
  const MeasuredError error{.relative_rmse = {0.12, 0.11, 0.13}};
  ASSERT_TRUE(desk_.offers.Refutes(scene_, drawn, error, &measured));
  EXPECT_EQ(desk_.estimator.PathsFor(*desk_.Decide(scene_), measured), 1'000'000);
}

TEST_F(TracedOffersTest, FramesOfTracedLightTeachTheirSettingsTime) {
  scene_.accuracy = MaxError{0.06};
  const scene::Scene decided = *desk_.Decide(scene_);
  desk_.Observe(decided, 19.0);
  EXPECT_NEAR(*desk_.estimator.Report(decided, {}, {})->expected_ms, 19.0, 1e-9);
}

TEST(DiscretisationErrorTest, IsTheRelativeDifferenceOfColours) {
  // The three colour values differ by 1, 0 and 0, at a mean of 2. The fourth value is not a colour
  // and is ignored.
  EXPECT_NEAR(DiscretisationError({3.0F, 2.0F, 2.0F, 9.0F}, {2.0F, 2.0F, 2.0F, 1.0F}),
              std::sqrt(1.0 / 3.0) / 2.0, 1e-7);
  EXPECT_EQ(DiscretisationError({0.0F, 0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F, 0.0F}), 0.0);
}

TEST(BuiltInOfferTablesTest, ServeEveryKindOfView) {
  for (const auto& table : BuiltInOfferTables()) EXPECT_TRUE(table.ok()) << table.status();
}

}  // namespace
}  // namespace thunderhead::accuracy
