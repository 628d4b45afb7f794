// Runs every extreme of `thunderhead measure extremes` (server/measure/extremes*.cc) as a test.
#include "measure/extremes.h"

#include <memory>

#include "gl/context.h"
#include "gtest/gtest.h"
#include "tests/support/gl_context.h"

namespace thunderhead::measure {
namespace {

class ExtremeCase : public testing::TestWithParam<Extreme> {
 protected:
  static void SetUpTestSuite() {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    probe_ = std::make_unique<Probe>();
  }
  static void TearDownTestSuite() {
    probe_.reset();
    context_.reset();
  }

  static inline std::unique_ptr<gl::Context> context_;
  static inline std::unique_ptr<Probe> probe_;
};

TEST_P(ExtremeCase, HasItsAnswer) {
  const auto verdict = GetParam().check(*probe_);
  ASSERT_TRUE(verdict.ok()) << verdict.status();
  EXPECT_TRUE(verdict->passed) << GetParam().name << ": expected " << verdict->expected << ", got "
                               << verdict->got;
}

std::string TestName(const testing::TestParamInfo<Extreme>& extreme) {
  std::string name;
  for (const char c : extreme.param.name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += c;
    } else if (c == '-') {
      name += "minus";
    } else if (c == '.') {
      name += "point";
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Extremes, ExtremeCase, testing::ValuesIn(Extremes()), TestName);

}  // namespace

void PrintTo(const Extreme& extreme, std::ostream* out) { *out << extreme.name; }

}  // namespace thunderhead::measure
