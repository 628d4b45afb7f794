#include "base/out_of_memory.h"

#include <limits>
#include <system_error>
#include <vector>

#include "absl/status/statusor.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(OrOutOfMemoryTest, GivesWhatTheWorkGives) {
  EXPECT_EQ(*OrOutOfMemory([]() -> absl::StatusOr<int> { return 3; }), 3);
  EXPECT_TRUE(absl::IsNotFound(OrOutOfMemory([] { return absl::NotFoundError("it"); })));
}

TEST(OrOutOfMemoryTest, SoDoesAThreadThatCannotBeBegun) {
  const absl::Status failed = OrOutOfMemory([]() -> absl::Status {
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
  });
  EXPECT_TRUE(absl::IsResourceExhausted(failed)) << failed;
  EXPECT_THROW(OrOutOfMemory([]() -> absl::Status {
                 throw std::system_error(std::make_error_code(std::errc::permission_denied));
               }),
               std::system_error);
}

TEST(OrOutOfMemoryTest, AnAllocationThatFailsFailsTheWorkAlone) {
  const absl::Status failed = OrOutOfMemory([]() -> absl::Status { throw std::bad_alloc(); });
  EXPECT_TRUE(absl::IsResourceExhausted(failed)) << failed;
  EXPECT_EQ(DetailsOf(failed).reason, "OUT_OF_MEMORY");
  EXPECT_TRUE(DetailsOf(failed).retry_after.has_value());
}

TEST(OrOutOfMemoryTest, SoDoesAContainerLargerThanAnyMemory) {
  const auto failed = OrOutOfMemory([]() -> absl::StatusOr<std::vector<float>> {
    std::vector<float> values;
    values.resize(std::numeric_limits<std::size_t>::max() / 2);
    return values;
  });
  EXPECT_TRUE(absl::IsResourceExhausted(failed.status()));
}

}  // namespace
}  // namespace thunderhead::base
