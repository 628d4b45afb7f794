#include "gateway/open_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <memory>

#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

class OpenFileTest : public ::testing::Test {
 protected:
  OpenFileTest() { std::ofstream(path_) << "picture"; }

  std::shared_ptr<const OpenFile> Open(const std::shared_ptr<FileCloser>& closer) {
    auto file = OpenFile::Open(path_, closer);
    EXPECT_TRUE(file.ok()) << file.status();
    return *std::move(file);
  }

  testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("picture.png");
};

TEST_F(OpenFileTest, IsClosedWhenItIsLetGo) {
  std::promise<int> closed;
  const auto closer = std::make_shared<FileCloser>([&](int number) {
    close(number);
    closed.set_value(number);
  });
  auto file = Open(closer);
  EXPECT_EQ(file->Bytes(), 7U);
  char text[8] = {};
  EXPECT_EQ(file->Read(3, text, 8), 4);
  EXPECT_STREQ(text, "ture");
  file.reset();
  EXPECT_EQ(fcntl(closed.get_future().get(), F_GETFD), -1);
}

TEST_F(OpenFileTest, WhoLetsItGoDoesNotWaitForAStorageThatHangs) {
  std::promise<void> answers;
  const auto closer =
      std::make_shared<FileCloser>([until = answers.get_future().share()](int number) {
        until.wait();
        close(number);
      });
  // There are more files than threads that close them. If this thread closed the files itself, it
  // would hang at the first one.
  for (int i = 0; i < 40; ++i) Open(closer);
  answers.set_value();
}

TEST_F(OpenFileTest, IsLeftOpenAfterTheClosersEnd) {
  auto closer = std::make_shared<FileCloser>([](int) { ADD_FAILURE() << "nobody closes it"; });
  auto file = Open(closer);
  closer.reset();
  file.reset();
}

}  // namespace
}  // namespace thunderhead::gateway::test
