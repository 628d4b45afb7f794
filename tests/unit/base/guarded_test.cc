#include "base/guarded.h"

#include <limits>
#include <system_error>
#include <vector>

#include "absl/status/statusor.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(GuardedTest, GivesWhatTheWorkGives) {
  EXPECT_EQ(*Guarded([]() -> absl::StatusOr<int> { return 3; }), 3);
  EXPECT_TRUE(absl::IsNotFound(Guarded([] { return absl::NotFoundError("it"); })));
}

TEST(GuardedTest, SoDoesAThreadThatCannotBeBegun) {
  const absl::Status failed = Guarded([]() -> absl::Status {
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
  });
  EXPECT_TRUE(absl::IsResourceExhausted(failed)) << failed;
  EXPECT_TRUE(absl::IsInternal(Guarded([]() -> absl::Status {
    throw std::system_error(std::make_error_code(std::errc::permission_denied));
  })));
}

TEST(GuardedTest, AnyOtherExceptionIsInternalAndTellsNoDetails) {
  const absl::Status failed =
      Guarded([]() -> absl::Status { throw std::runtime_error("of /etc/secret"); });
  EXPECT_TRUE(absl::IsInternal(failed)) << failed;
  EXPECT_EQ(DetailsOf(failed).reason, "UNEXPECTED_FAILURE");
  EXPECT_EQ(failed.message().find("secret"), absl::string_view::npos);
  EXPECT_TRUE(absl::IsInternal(Guarded([]() -> absl::Status { throw 7; })));
}

TEST(GuardedTest, AnAllocationThatFailsFailsTheWorkAlone) {
  const absl::Status failed = Guarded([]() -> absl::Status { throw std::bad_alloc(); });
  EXPECT_TRUE(absl::IsResourceExhausted(failed)) << failed;
  EXPECT_EQ(DetailsOf(failed).reason, "OUT_OF_MEMORY");
  EXPECT_TRUE(DetailsOf(failed).retry_after.has_value());
}

TEST(GuardedTest, SoDoesAContainerLargerThanAnyMemory) {
  const auto failed = Guarded([]() -> absl::StatusOr<std::vector<float>> {
    std::vector<float> values;
    values.resize(std::numeric_limits<std::size_t>::max() / 2);
    return values;
  });
  EXPECT_TRUE(absl::IsResourceExhausted(failed.status()));
}

}  // namespace
}  // namespace thunderhead::base
