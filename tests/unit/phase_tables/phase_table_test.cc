#include "physics/phase_table.h"

#include <cmath>
#include <numbers>

#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "physics/phase_accumulator.h"
#include "physics/refractive_index.h"

namespace thunderhead::physics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kHalfTurn_rad = std::numbers::pi;
constexpr double kDegree_rad = kHalfTurn_rad / 180.0;

PhaseTable HenyeyGreensteinTable(double g) {
  PhaseTableContent content{"hg", kWavelengthsUm, AngleGrid({{20, 0.05}, {180, 0.25}}), {}};
  for (const double angle_deg : content.angles_deg) {
    const double value =
        (1 - g * g) / std::pow(1 + g * g - 2 * g * std::cos(angle_deg * kDegree_rad), 1.5);
    content.values.push_back({value, value, value});
  }
  auto table = PhaseTable::Create(std::move(content), 1e-3);
  EXPECT_TRUE(table.ok()) << table.status();
  return *table;
}

std::string GoodText() {
  return "# comment\nname test\nwavelengths_um 0.65 0.55 0.45\nasymmetry 0 0 0\n"
         "forward_share 5 0.0019026 0.0019026 0.0019026\nangles 3\n"
         "0 1 1 1\n90 1 1 1\n180 1 1 1\n";
}

TEST(PhaseTable, IsotropicClosedForms) {
  const auto table = PhaseTable::Load(GoodText());
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->name(), "test");
  EXPECT_NEAR(table->Asymmetry(0), 0.0, 1e-12);
  for (const double angle : {0.0, 1e-5, 0.01, 0.7, 1.5707, 2.0, kHalfTurn_rad}) {
    const double share = std::pow(std::sin(0.5 * angle), 2);
    EXPECT_NEAR(table->Value(angle, 1), 1.0, 1e-12);
    EXPECT_NEAR(table->CumulativeShare(angle, 1), share, 1e-14 + 1e-9 * share) << angle;
    EXPECT_NEAR(table->SampleAngle(share, 1), angle, 1e-7) << angle;
    EXPECT_NEAR(table->CutShare(angle, 1), 0.0, 1e-12);
  }
  EXPECT_EQ(table->ValueAtCosine(1.5, 0), table->Value(0.0, 0));
}

// The table is piecewise linear, so it differs from the formula by up to 1e-5 at these steps.
TEST(PhaseTable, HenyeyGreensteinFigures) {
  const double g = 0.85;
  const PhaseTable table = HenyeyGreensteinTable(g);
  EXPECT_NEAR(table.Asymmetry(2), g, 2e-5);
  // The lambda evaluates the integral of Henyey-Greenstein in closed form.
  const auto share = [g](double mu) {
    return 1.0 - (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g - 2 * g * mu) - 1 / (1 + g));
  };
  for (const double angle_deg : {1.0, 5.0, 10.0, 60.0, 120.0}) {
    EXPECT_NEAR(table.CumulativeShare(angle_deg * kDegree_rad, 0),
                share(std::cos(angle_deg * kDegree_rad)), 2e-5)
        << angle_deg;
  }
  const double mu = std::cos(10.0 * kDegree_rad);
  const double cut = share(mu) - table.Value(10.0 * kDegree_rad, 0) * 0.5 * (1.0 - mu);
  EXPECT_NEAR(table.CutShare(10.0 * kDegree_rad, 0), cut, 2e-5);
}

TEST(PhaseTable, TextGoesRound) {
  const PhaseTable table = HenyeyGreensteinTable(0.85);
  const auto again = PhaseTable::Load(table.ToText("where from\nand how"));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->name(), table.name());
  EXPECT_EQ(again->wavelengths_um(), table.wavelengths_um());
  ASSERT_EQ(again->values().size(), table.values().size());
  for (std::size_t i = 0; i < table.values().size(); ++i) {
    EXPECT_NEAR(again->values()[i][1] / table.values()[i][1], 1.0,
                1e-5);  // the file has six digits
  }
}

TEST(PhaseTable, MalformedTextsAreRefusedWithTheReason) {
  const struct {
    const char* from;
    const char* to;
    const char* message;
  } cases[] = {
      {"name test\n", "", "line 2: name and one word expected"},
      {"wavelengths_um", "wavelength", "line 3: wavelengths_um and 3 numbers"},
      {"asymmetry 0 0 0", "asymmetry 0 0", "line 4"},
      {"asymmetry 0 0 0", "asymmetry 0.5 0 0", "asymmetry 0.5"},
      {"forward_share 5", "forward_share 4", "it must be within 5 degrees"},
      {"forward_share 5 0.0019026", "forward_share 5 0.9", "forward share 0.9"},
      {"angles 3", "angles 4", "4 numbers expected, got 0 words"},
      {"angles 3", "angles 2", "more than the 2 angles"},
      {"angles 3", "angles 1e300", "line 6"},
      {"90 1 1 1", "90 1 1", "line 8: 4 numbers expected, got 3 words"},
      {"90 1 1 1", "90 1 x 1", "line 8: 'x' is not a finite number"},
      {"90 1 1 1", "90 1 nan 1", "line 8: 'nan' is not a finite number"},
      {"90 1 1 1", "90 1 -1 1", "the value -1 at 90 degrees"},
      {"90 1 1 1", "180 1 1 1", "angles must ascend"},
      {"180 1 1 1", "170 1 1 1", "they must go from 0 to 180"},
      {"90 1 1 1", "90 1 1.5 1", "the mean over the sphere is"},
  };
  for (const auto& bad : cases) {
    const std::string text = absl::StrReplaceAll(GoodText(), {{bad.from, bad.to}});
    ASSERT_NE(text, GoodText()) << bad.from;
    const auto table = PhaseTable::Load(text);
    EXPECT_FALSE(table.ok()) << bad.from << " -> " << bad.to;
    EXPECT_THAT(std::string(table.status().message()), HasSubstr(bad.message));
  }
  EXPECT_FALSE(PhaseTable::Load("").ok());
}

TEST(PhaseTable, UnknownNameListsTheKnownOnes) {
  const auto table = EmbeddedPhaseTable("hail");
  ASSERT_FALSE(table.ok());
  EXPECT_THAT(std::string(table.status().message()), HasSubstr("cloud_re10"));
}

TEST(EmbeddedTables, AreAllThereAndSound) {
  EXPECT_THAT(PhaseTableNames(),
              ElementsAre("cloud_re05", "cloud_re05_narrow", "cloud_re10", "cloud_re20",
                          "ice_columns", "ice_plates", "ice_rough", "rain"));
  for (const std::string& name : PhaseTableNames()) {
    const auto table = EmbeddedPhaseTable(name);
    ASSERT_TRUE(table.ok()) << table.status();
    EXPECT_EQ(table->name(), name);
    EXPECT_EQ(table->wavelengths_um(), kWavelengthsUm);
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      EXPECT_NEAR(table->CumulativeShare(kHalfTurn_rad, c), 1.0, 1e-12) << name;
      EXPECT_EQ(table->CumulativeShare(0.0, c), 0.0) << name;
      // Diffraction carries about half of the light of large particles.
      EXPECT_GT(table->ForwardShare(c), 0.4) << name;
      EXPECT_LT(table->ForwardShare(c), 0.75) << name;
    }
  }
}

TEST(EmbeddedTables, SamplingInvertsTheCumulativeShare) {
  for (const std::string& name : PhaseTableNames()) {
    const auto table = EmbeddedPhaseTable(name);
    ASSERT_TRUE(table.ok()) << table.status();
    constexpr int kSamples = 20'000;
    for (std::size_t c = 0; c < kPhaseChannels; ++c) {
      double cosine = 0.0;
      double previous = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        const double u = (i + 0.5) / kSamples;
        const double angle = table->SampleAngle(u, c);
        ASSERT_GE(angle, previous) << name;
        ASSERT_NEAR(table->CumulativeShare(angle, c), u, 1e-9) << name << " " << u;
        cosine += std::cos(angle) / kSamples;
        previous = angle;
      }
      // The sum is the midpoint rule over the shares.
      EXPECT_NEAR(cosine, table->Asymmetry(c), 1e-5) << name;
      EXPECT_NEAR(table->SampleAngle(0.0, c), 0.0, 1e-6) << name;
      EXPECT_NEAR(table->SampleAngle(1.0, c), kHalfTurn_rad, 1e-6) << name;
    }
  }
}

TEST(EmbeddedTables, CloudsHaveThePublishedAsymmetry) {
  const struct {
    const char* name;
    double asymmetry;
  } cases[] = {{"cloud_re05", 0.846}, {"cloud_re10", 0.862}, {"cloud_re20", 0.872}};
  for (const auto& expected : cases) {
    const auto table = EmbeddedPhaseTable(expected.name);
    ASSERT_TRUE(table.ok()) << table.status();
    EXPECT_NEAR(table->Asymmetry(1), expected.asymmetry, 0.003) << expected.name;
    // The cloudbow and a glory must be there. A glory is a ring or spot about the backward
    // direction that is brighter than its surroundings.
    EXPECT_GT(table->Value(142.0 * kDegree_rad, 1), 2.0 * table->Value(130.0 * kDegree_rad, 1));
    EXPECT_GT(table->Value(180.0 * kDegree_rad, 1), 2.0 * table->Value(172.0 * kDegree_rad, 1));
  }
}

// Returns the angle of the rainbow after a number of inner reflections, from Descartes' ray.
double RainbowDeg(int reflections, double index) {
  const double k = reflections + 1.0;
  const double cosine = std::sqrt((index * index - 1.0) / (k * k - 1.0));
  const double incidence = std::acos(cosine);
  const double refraction = std::asin(std::sin(incidence) / index);
  const double turned = reflections * kHalfTurn_rad + 2.0 * incidence - 2.0 * k * refraction;
  return (turned > kHalfTurn_rad ? 2.0 * kHalfTurn_rad - turned : turned) / kDegree_rad;
}

TEST(EmbeddedTables, RainHasBothRainbows) {
  const auto table = EmbeddedPhaseTable("rain");
  ASSERT_TRUE(table.ok()) << table.status();
  const auto peak_deg = [&](std::size_t channel, double from_deg, double to_deg) {
    double best_deg = from_deg;
    for (double angle_deg = from_deg; angle_deg <= to_deg; angle_deg += 0.05) {
      if (table->Value(angle_deg * kDegree_rad, channel) >
          table->Value(best_deg * kDegree_rad, channel)) {
        best_deg = angle_deg;
      }
    }
    return best_deg;
  };
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    const double index = WaterRefractiveIndex(kWavelengthsUm[c]);
    // By Airy's theory the rainbow of a finite drop is shifted from Descartes' ray towards the
    // bright side. For drops of this size the primary bow is shifted by 0.3 degrees, the secondary
    // by 0.6 degrees.
    const double primary = peak_deg(c, 134, 145);
    EXPECT_GT(primary, RainbowDeg(1, index)) << c;
    EXPECT_LT(primary, RainbowDeg(1, index) + 0.7) << c;
    const double secondary = peak_deg(c, 122, 132);
    EXPECT_LT(secondary, RainbowDeg(2, index)) << c;
    EXPECT_GT(secondary, RainbowDeg(2, index) - 1.2) << c;
    // Alexander's dark band lies between the two rainbows.
    const double dark = table->Value(134.0 * kDegree_rad, c);
    EXPECT_GT(table->Value(primary * kDegree_rad, c), 20.0 * dark) << c;
    EXPECT_GT(table->Value(secondary * kDegree_rad, c), 4.0 * dark) << c;
  }
  // Red is the outer colour of the primary rainbow and the inner colour of the secondary rainbow.
  EXPECT_LT(peak_deg(0, 134, 145), peak_deg(2, 134, 145));
  EXPECT_GT(peak_deg(0, 122, 132), peak_deg(2, 122, 132));
}

}  // namespace
}  // namespace thunderhead::physics
