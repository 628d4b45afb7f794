#include "jobs/jobs.h"

#include <atomic>
#include <future>
#include <new>
#include <thread>

#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::jobs {
namespace {

// A picture that has no memory so many times: to be begun, then to be taken.
class Picture final : public PictureInHand {
 public:
  explicit Picture(std::atomic<int>& cannot_take) : cannot_take_(cannot_take) {}
  void Cancel() override {}
  absl::StatusOr<DrawnPicture> Take() override {
    if (cannot_take_-- > 0) throw std::bad_alloc();
    return DrawnPicture{"bytes", "png", "about", 1.0};
  }

 private:
  std::atomic<int>& cannot_take_;
};

TEST(JobsTest, APictureWithoutMemoryIsTriedAgainAndTakesNothingWithIt) {
  const testing::TemporaryFolder folder;
  std::atomic<int> cannot_begin{1};
  std::atomic<int> cannot_take{1};
  std::atomic<int> begun{0};
  JobsOptions options;
  options.folder = folder.File("jobs");
  auto jobs = Jobs::Open(options);
  ASSERT_TRUE(jobs.ok()) << jobs.status();
  (*jobs)->Start([&](const PictureOrder&, const std::function<void()>& done) {
    ++begun;
    if (cannot_begin-- > 0) throw std::bad_alloc();
    auto picture = std::make_unique<Picture>(cannot_take);
    done();
    return picture;
  });
  NewJob job;
  job.owner = "night";
  job.pictures.resize(3);
  std::promise<absl::StatusOr<JobView>> created;
  (*jobs)->Create(job, [&](absl::StatusOr<JobView> view) { created.set_value(std::move(view)); });
  ASSERT_TRUE(created.get_future().get().ok());
  // One is drawn; the other two are tried again after a pause.
  for (int i = 0; i < 1000 && (*jobs)->Load().result_bytes == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ((*jobs)->Load().result_bytes, 5U);
  EXPECT_EQ((*jobs)->Load().waiting, 2U);
  EXPECT_EQ(begun, 3);
}

}  // namespace
}  // namespace thunderhead::jobs
