#include "base/folder_events.h"

#include <chrono>
#include <thread>

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

// Returns a deadline that no test reaches. A wait that reaches it would exceed the test's time
// limit.
std::chrono::steady_clock::time_point Never() {
  return std::chrono::steady_clock::now() + std::chrono::hours(1);
}

TEST(FolderEventsTest, AWakeEndsTheWaitUnderWayAndTheNext) {
  FolderEvents events;
  events.Wake();
  EXPECT_FALSE(events.WaitUntil(Never()));
  const std::jthread waking([&] { events.Wake(); });
  EXPECT_FALSE(events.WaitUntil(Never()));
}

}  // namespace
}  // namespace thunderhead::base
