#include "base/looks.h"

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "base/stopwatch.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

// What is looked at, and may hang.
struct File {
  std::atomic<int> looks{0};
  std::atomic<bool> hangs{false};
};

std::function<void()> LookAt(const std::shared_ptr<File>& file) {
  return [file] {
    file->hangs.wait(true);
    ++file->looks;
  };
}

TEST(LooksTest, WhoAsksGetsALookOfItsOwnOrALaterOne) {
  const auto file = std::make_shared<File>();
  Looks looks("/file", LookAt(file), std::chrono::seconds(60));
  for (int i = 1; i <= 100; ++i) {
    looks.LookAgain();
    EXPECT_EQ(file->looks, i);
  }
  std::vector<std::jthread> asking;
  for (int i = 0; i < 8; ++i) {
    asking.emplace_back([&] {
      for (int k = 0; k < 100; ++k) {
        const int before = file->looks;
        looks.LookAgain();
        EXPECT_GT(file->looks, before);
      }
    });
  }
}

TEST(LooksTest, OneThatHangsHoldsUpOnce) {
  const auto file = std::make_shared<File>();
  Looks looks("/file", LookAt(file), std::chrono::milliseconds(200));
  looks.LookAgain();
  file->hangs = true;
  const Stopwatch waiting;
  for (int i = 0; i < 100; ++i) looks.LookAgain();
  EXPECT_GE(waiting.ElapsedMs(), 200.0);
  EXPECT_LT(waiting.ElapsedMs(), 2000.0);
  EXPECT_EQ(file->looks, 1);
  file->hangs = false;
  file->hangs.notify_all();
  for (int i = 0; i < 1000 && file->looks < 3; ++i) {
    looks.LookAgain();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GE(file->looks, 3) << "it is looked at again";
}

TEST(LooksTest, OneThatHangsIsLeftBehindAtTheEnd) {
  const auto file = std::make_shared<File>();
  file->hangs = true;
  const Stopwatch ending;
  {
    Looks looks("/file", LookAt(file), std::chrono::milliseconds(100));
    looks.LookAgain();
  }
  EXPECT_LT(ending.ElapsedMs(), 3000.0);
  file->hangs = false;
  file->hangs.notify_all();
}

}  // namespace
}  // namespace thunderhead::base
