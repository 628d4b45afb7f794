#include "jobs/job_watchers.h"

#include <memory>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::jobs {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class SilentWatcher final : public JobWatcher {
 public:
  void OnJobChanged() override {}
};

TEST(JobWatchers, EachJobHasItsOwn) {
  JobWatchers watchers;
  const std::shared_ptr<JobWatcher> first = std::make_shared<SilentWatcher>();
  const std::shared_ptr<JobWatcher> second = std::make_shared<SilentWatcher>();
  watchers.Add("a", first);
  watchers.Add("a", second);
  watchers.Add("b", second);
  EXPECT_THAT(watchers.Of({"a"}), UnorderedElementsAre(first, second));
  EXPECT_THAT(watchers.Of({"b", "c"}), ElementsAre(second));
  EXPECT_THAT(watchers.Watched(), UnorderedElementsAre("a", "a", "b"));
  watchers.Forget("a");
  EXPECT_THAT(watchers.Of({"a"}), IsEmpty());
  EXPECT_THAT(watchers.Of({"b"}), ElementsAre(second));
}

TEST(JobWatchers, DestroyedOnesAreDropped) {
  JobWatchers watchers;
  const std::shared_ptr<JobWatcher> stays = std::make_shared<SilentWatcher>();
  watchers.Add("a", stays);
  for (int i = 0; i < 100; ++i) watchers.Add("a", std::make_shared<SilentWatcher>());
  EXPECT_EQ(watchers.Size(), 2U);
  EXPECT_THAT(watchers.Of({"a"}), ElementsAre(stays));
  EXPECT_EQ(watchers.Size(), 1U);
}

}  // namespace
}  // namespace thunderhead::jobs
