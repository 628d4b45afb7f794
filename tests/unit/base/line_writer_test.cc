#include "base/line_writer.h"

#include <chrono>
#include <cstdint>
#include <future>
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

}  // namespace
}  // namespace thunderhead::base
