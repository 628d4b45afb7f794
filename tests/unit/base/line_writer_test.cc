#include "base/line_writer.h"

#include <chrono>
#include <cstdint>
#include <future>
#include <new>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::base {
namespace {

using ::testing::ElementsAre;
using testing::kHangLimit;
using testing::ManualTime;

TEST(LineWriterTest, ADiskThatHangsHoldsUpNobody) {
  std::promise<void> begun;
  std::promise<void> answers;
  std::vector<std::string> written;
  const ManualTime time;
  {
    LineWriter writer(
        3,
        [&, answered = answers.get_future().share()](const std::string& line,
                                                     std::uint64_t left_out) {
          if (line == "0") begun.set_value();
          answered.wait();
          written.push_back(absl::StrCat(line, left_out > 0 ? " after " : "",
                                         left_out > 0 ? absl::StrCat(left_out) : ""));
        },
        time);
    writer.Write("0");
    begun.get_future().wait();
    // The simulated disk responds only after the test has passed all lines to the writer.
    for (int i = 1; i < 100; ++i) writer.Write(absl::StrCat(i));
    answers.set_value();
    // Waits until the queue has space.
    EXPECT_TRUE(writer.Flush(kHangLimit));
    writer.Write("last");
  }
  EXPECT_THAT(written, ElementsAre("0", "1", "2", "3", "last after 96"));
}

TEST(LineWriterTest, ALineThatCannotBeWrittenIsCountedAndTheNextIsWritten) {
  std::vector<std::string> written;
  const ManualTime time;
  {
    LineWriter writer(
        10,
        [&](const std::string& line, std::uint64_t left_out) {
          if (line.starts_with("bad")) throw std::bad_alloc();
          written.push_back(absl::StrCat(line, " after ", left_out));
        },
        time);
    for (const char* line : {"bad", "bad", "good", "fine", "bad at last"}) writer.Write(line);
    EXPECT_TRUE(writer.Flush(kHangLimit));
    EXPECT_EQ(written.size(), 2U);
  }
  EXPECT_THAT(written, ElementsAre("good after 2", "fine after 0", " after 1"));
}

TEST(LineWriterTest, FlushWaitsNoLongerThanItIsTold) {
  std::promise<void> answers;
  ManualTime time;
  LineWriter writer(
      10,
      [answered = answers.get_future().share()](const std::string&, std::uint64_t) {
        answered.wait();
      },
      time);
  writer.Write("hangs");
  auto flushed =
      std::async(std::launch::async, [&] { return writer.Flush(std::chrono::milliseconds(20)); });
  // The flush may begin to wait only now, so the time is advanced repeatedly.
  EXPECT_TRUE(testing::WaitFor([&] {
    time.Advance(std::chrono::milliseconds(20));
    return flushed.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }));
  EXPECT_FALSE(flushed.get());
  answers.set_value();
  EXPECT_TRUE(writer.Flush(kHangLimit));
}

}  // namespace
}  // namespace thunderhead::base
