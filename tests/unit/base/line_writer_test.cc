#include "base/line_writer.h"

#include <chrono>
#include <cstdint>
#include <future>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using ::testing::ElementsAre;

TEST(LineWriterTest, ADiskThatHangsHoldsUpNobody) {
  std::promise<void> begun;
  std::promise<void> answers;
  std::vector<std::string> written;
  {
    LineWriter writer(3, [&, answered = answers.get_future().share()](const std::string& line,
                                                                      std::uint64_t left_out) {
      if (line == "0") begun.set_value();
      answered.wait();
      written.push_back(absl::StrCat(line, left_out > 0 ? " after " : "",
                                     left_out > 0 ? absl::StrCat(left_out) : ""));
    });
    writer.Write("0");
    begun.get_future().wait();
    const auto start = std::chrono::steady_clock::now();
    for (int i = 1; i < 100; ++i) writer.Write(absl::StrCat(i));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
    answers.set_value();
    // Until there is room.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    writer.Write("last");
  }
  EXPECT_THAT(written, ElementsAre("0", "1", "2", "3", "last after 96"));
}

TEST(LineWriterTest, ALineThatCannotBeWrittenIsCountedAndTheNextIsWritten) {
  std::vector<std::string> written;
  {
    LineWriter writer(10, [&](const std::string& line, std::uint64_t left_out) {
      if (line.starts_with("bad")) throw std::bad_alloc();
      written.push_back(absl::StrCat(line, " after ", left_out));
    });
    for (const char* line : {"bad", "bad", "good", "fine", "bad at last"}) writer.Write(line);
    EXPECT_TRUE(writer.Flush(std::chrono::seconds(10)));
    EXPECT_EQ(written.size(), 2U);
  }
  EXPECT_THAT(written, ElementsAre("good after 2", "fine after 0", " after 1"));
}

TEST(LineWriterTest, FlushWaitsNoLongerThanItIsTold) {
  std::promise<void> answers;
  LineWriter writer(10, [answered = answers.get_future().share()](
                            const std::string&, std::uint64_t) { answered.wait(); });
  writer.Write("hangs");
  EXPECT_FALSE(writer.Flush(std::chrono::milliseconds(20)));
  answers.set_value();
  EXPECT_TRUE(writer.Flush(std::chrono::seconds(10)));
}

}  // namespace
}  // namespace thunderhead::base
