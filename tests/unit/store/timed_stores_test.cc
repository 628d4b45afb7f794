// Tests of a state file whose storage hangs: calls and the shutdown must return in time.
#include "store/timed_stores.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <future>

#include "base/error_details.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using jobs::JobRecord;
using session::SessionRecord;
using ::testing::HasSubstr;

constexpr std::chrono::milliseconds kPatience{200};

// A simulated storage that can hang.
class Storage {
 public:
  void Hang() { hangs_ = true; }
  void Answer() {
    hangs_ = false;
    hangs_.notify_all();
  }
  absl::Status Use() {
    ++begun;
    hangs_.wait(true);
    ++uses;
    return absl::OkStatus();
  }

  std::atomic<int> begun{0};
  std::atomic<int> uses{0};

 private:
  std::atomic<bool> hangs_{false};
};

class Sessions final : public session::SessionStore {
 public:
  explicit Sessions(std::shared_ptr<Storage> storage) : storage_(std::move(storage)) {}
  // The destructor uses the storage, because a database also writes when it is closed.
  ~Sessions() override { (void)storage_->Use(); }
  absl::Status Save(const std::vector<SessionRecord>&) override { return storage_->Use(); }
  absl::Status Remove(const std::vector<std::string>&) override { return storage_->Use(); }
  absl::Status Check() override { return storage_->Use(); }
  absl::StatusOr<std::vector<SessionRecord>> Load() override {
    return std::vector<SessionRecord>();
  }

 private:
  const std::shared_ptr<Storage> storage_;
};

class Jobs final : public jobs::JobStore {
 public:
  absl::Status Add(const JobRecord& job) override {
    return job.id == "wrong" ? absl::InvalidArgumentError(job.id) : absl::OkStatus();
  }
  absl::Status Save(const std::vector<jobs::JobChange>&) override { return absl::OkStatus(); }
  absl::Status Remove(const std::vector<std::string>&) override { return absl::OkStatus(); }
  absl::StatusOr<std::vector<JobRecord>> Load() override { return std::vector<JobRecord>(); }
};

class TimedStoresTest : public ::testing::Test {
 protected:
  static void ExpectHangs(const absl::Status& status) {
    EXPECT_TRUE(absl::IsUnavailable(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("the state folder /var/lib/storms"));
    EXPECT_EQ(base::DetailsOf(status).reason, "STORAGE_HANGS");
    EXPECT_TRUE(base::DetailsOf(status).retry_after.has_value());
  }

  // Uses the storage while it hangs, until the timeout.
  template <typename Use>
  auto UseInVain(Use use) {
    const int begun = storage_->begun;
    auto hangs = std::async(std::launch::async, use);
    EXPECT_TRUE(WaitFor([&] { return storage_->begun > begun; }));
    Time().Advance(kPatience);
    return hangs.get();
  }

  // The time advances only where a test advances it. It is static because an abandoned call
  // outlives the test.
  static ManualTime& Time() {
    static ManualTime time;
    return time;
  }

  const std::shared_ptr<Storage> storage_ = std::make_shared<Storage>();
  const std::shared_ptr<base::TimedCalls> calls_ =
      std::make_shared<base::TimedCalls>(kPatience, Time());
  std::shared_ptr<session::SessionStore> sessions_ =
      store::WithPatience(std::make_shared<Sessions>(storage_), calls_, "/var/lib/storms");
  std::shared_ptr<jobs::JobStore> jobs_ =
      store::WithPatience(std::make_shared<Jobs>(), calls_, "/var/lib/storms");
};

TEST_F(TimedStoresTest, GiveWhatTheStoresGive) {
  EXPECT_TRUE(sessions_->Save({}).ok());
  EXPECT_TRUE(jobs_->Add({}).ok());
  JobRecord wrong;
  wrong.id = "wrong";
  EXPECT_TRUE(absl::IsInvalidArgument(jobs_->Add(wrong)));
  EXPECT_TRUE(sessions_->Load().ok());
  sessions_.reset();
  EXPECT_EQ(storage_->uses, 2) << "it is closed";
}

TEST_F(TimedStoresTest, AreUnavailableWhileTheStorageHangs) {
  storage_->Hang();
  ExpectHangs(UseInVain([&] { return sessions_->Save({}); }));
  // The storage is known to hang, so these calls end at once, although no time passes.
  for (int i = 0; i < 20; ++i) ExpectHangs(sessions_->Remove({}));
  // The job store has the same file, so its calls are refused, although the storage would answer.
  ExpectHangs(jobs_->Add({}));
  EXPECT_EQ(storage_->uses, 0);
  storage_->Answer();
  EXPECT_TRUE(WaitFor([&] { return sessions_->Save({}).ok(); }));
  EXPECT_TRUE(sessions_->Remove({}).ok());
  EXPECT_TRUE(jobs_->Add({}).ok());
}

TEST_F(TimedStoresTest, EndWhileTheStorageHangs) {
  storage_->Hang();
  ExpectHangs(UseInVain([&] { return sessions_->Save({}); }));
  // Time stands still meanwhile.
  sessions_.reset();
  jobs_.reset();
  EXPECT_EQ(storage_->uses, 0) << "it stays open";
  storage_->Answer();
}

TEST_F(TimedStoresTest, EndWhereTheStorageHangsAsItIsClosed) {
  storage_->Hang();
  UseInVain([&] { sessions_.reset(); });
  EXPECT_GT(calls_->HangingSeconds(), 0.0);
  storage_->Answer();
}

}  // namespace
}  // namespace thunderhead::testing
