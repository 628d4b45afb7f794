#include "app/phase_flag.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "physics/optics.h"

namespace thunderhead::app {
namespace {

using ::testing::HasSubstr;

// Expects that the flag's value is this phase function.
void ExpectPhase(const std::string& flag, const physics::PhaseFunction& phase) {
  const auto parsed = ParsePhase(flag);
  ASSERT_TRUE(parsed.ok()) << parsed.status();
  for (const double mu : {-1.0, -0.2, 0.6, 1.0}) {
    const double expected = physics::PhaseValue(phase, mu);
    EXPECT_NEAR((*parsed)->Value(mu).g, expected, 1e-4 * expected) << flag << " at " << mu;
  }
}

TEST(PhaseFlag, TakesEveryFormulaByItsName) {
  int formulas = 0;
  for (const auto& [kind, name] : physics::kPhaseKindNames) {
    const physics::PhaseFormula* const formula = physics::FormulaOf(kind);
    if (formula == nullptr) continue;
    ++formulas;
    if (formula->has_asymmetry) {
      ExpectPhase(std::string(name) + ":0.5", {kind, 0.5F});
      EXPECT_FALSE(ParsePhase(std::string(name)).ok());
    } else {
      ExpectPhase(std::string(name), {kind});
      EXPECT_FALSE(ParsePhase(std::string(name) + ":0.5").ok());
    }
  }
  EXPECT_GE(formulas, 3);
}

TEST(PhaseFlag, HasShortNames) {
  ExpectPhase("hg:-0.3", {physics::PhaseKind::kHenyeyGreenstein, -0.3F});
  ExpectPhase("cs:0.85", {physics::PhaseKind::kCornetteShanks, 0.85F});
}

TEST(PhaseFlag, ListsItsFormats) {
  constexpr char kFormats[] = "hg:G, cs:G, rayleigh or table:NAME";
  EXPECT_THAT(PhaseFlagHelp(), HasSubstr(kFormats));
  // A table is no formula, and has its own prefix.
  for (const char* const wrong : {"", "hg", "hg:", "hg:x", "rayleigh:", "fog", "ice_rough"}) {
    EXPECT_THAT(std::string(ParsePhase(wrong).status().message()), HasSubstr(kFormats)) << wrong;
  }
  EXPECT_THAT(std::string(ParsePhase("cs:1").status().message()), HasSubstr("from -0.99 to 0.99"));
}

}  // namespace
}  // namespace thunderhead::app
