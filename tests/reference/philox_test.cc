#include "reference/philox.h"

#include <array>

#include "comparisons.h"
#include "gmock/gmock.h"

namespace thunderhead::reference {
namespace {

// Compares with the known answers that Salmon et al. (reference/philox.h) publish with their
// library.
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(Philox4x32({0, 0, 0, 0}, {0, 0}),
            (PhiloxBlock{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kOnes = 0xffffffff;
  EXPECT_EQ(Philox4x32({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (PhiloxBlock{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxBlock{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(RandomStream, MomentsAreThoseOfTheDistributions) {
  SampleMean uniform;
  SampleMean uniform_square;
  SampleMean exponential;
  SampleMean exponential_square;
  for (std::uint64_t item = 0; item < 20000; ++item) {
    RandomStream random(5, item, 3);
    for (int i = 0; i < 10; ++i) {
      const double u = random.Uniform();
      const double x = random.Exponential();
      uniform.Add(u);
      uniform_square.Add(u * u);
      exponential.Add(x);
      exponential_square.Add(x * x);
    }
  }
  ExpectAgrees(uniform.Share(), 0.5, 0.0, 1e-3);
  ExpectAgrees(uniform_square.Share(), 1.0 / 3.0, 0.0, 1e-3);
  ExpectAgrees(exponential.Share(), 1.0, 0.0, 3e-3);
  ExpectAgrees(exponential_square.Share(), 2.0, 0.0, 2e-2);
}

TEST(RandomStream, DependsOnSeedItemAndSample) {
  const auto first = [](std::uint64_t seed, std::uint64_t item, std::uint32_t sample) {
    return RandomStream(seed, item, sample).Uniform();
  };
  const double value = first(1, 2, 3);
  EXPECT_EQ(value, first(1, 2, 3));
  EXPECT_NE(value, first(2, 2, 3));
  EXPECT_NE(value, first(1, 3, 3));
  EXPECT_NE(value, first(1, 2, 4));
  EXPECT_NE(value, first(1, 2 + (std::uint64_t{1} << 32U), 3));
  EXPECT_NE(value, first(1 + (std::uint64_t{1} << 32U), 2, 3));
}

}  // namespace
}  // namespace thunderhead::reference
