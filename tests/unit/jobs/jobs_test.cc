#include "jobs/jobs.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/whole_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "jobs/result_folder.h"
#include "tests/support/manual_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::jobs {
namespace {

using ::testing::HasSubstr;
using testing::ManualTime;
using testing::WaitFor;

// A picture that fails a given number of times for lack of memory, first when it begins and then
// when its result is taken.
class Picture final : public PictureInHand {
 public:
  explicit Picture(
      std::atomic<int>& cannot_take, std::function<void()> before_take = [] {},
      std::function<void()> at_end = [] {})
      : cannot_take_(cannot_take),
        before_take_(std::move(before_take)),
        at_end_(std::move(at_end)) {}
  ~Picture() override { at_end_(); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  void Cancel() override {}
  absl::StatusOr<DrawnPicture> Take() override {
    before_take_();
    if (cannot_take_-- > 0) throw std::bad_alloc();
    return DrawnPicture{"bytes", "png", "about", 1.0};
  }

 private:
  std::atomic<int>& cannot_take_;
  const std::function<void()> before_take_;
  const std::function<void()> at_end_;
};

TEST(JobsTest, APictureWithoutMemoryIsTriedAgainAndTakesNothingWithIt) {
  const testing::TemporaryFolder folder;
  std::atomic<int> cannot_begin{1};
  std::atomic<int> cannot_take{1};
  std::atomic<int> begun{0};
  const ManualTime time;
  JobsOptions options;
  options.folder = folder.File("jobs");
  options.time = &time;
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
  // One picture is drawn. The other two are tried again after a pause, which does not pass here.
  ASSERT_TRUE(WaitFor([&] { return (*jobs)->Load().result_bytes > 0; }));
  EXPECT_EQ((*jobs)->Load().result_bytes, 5U);
  EXPECT_EQ((*jobs)->Load().waiting, 2U);
  EXPECT_EQ(begun, 3);
}

class Watcher final : public JobWatcher {
 public:
  void OnJobChanged() override {}
};

TEST(JobsTest, WatchersThatAreGoneAreForgotten) {
  const testing::TemporaryFolder folder;
  JobsOptions options;
  options.folder = folder.File("jobs");
  auto jobs = Jobs::Open(options);
  ASSERT_TRUE(jobs.ok()) << jobs.status();
  NewJob job;
  job.pictures.resize(1);
  std::promise<absl::StatusOr<JobView>> created;
  (*jobs)->Create(job, [&](absl::StatusOr<JobView> view) { created.set_value(std::move(view)); });
  const absl::StatusOr<JobView> view = created.get_future().get();
  ASSERT_TRUE(view.ok()) << view.status();
  const auto stays = std::make_shared<Watcher>();
  ASSERT_TRUE((*jobs)->Watch(view->id, {}, stays).ok());
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE((*jobs)->Watch(view->id, {}, std::make_shared<Watcher>()).ok());
  }
  EXPECT_LE((*jobs)->Load().watchers, 2U);
}

// A store in memory that can be full.
class FullStore final : public JobStore {
 public:
  absl::Status Add(const JobRecord& job) override {
    const std::lock_guard lock(mutex_);
    jobs_[job.id] = job;
    return absl::OkStatus();
  }
  absl::Status Save(const std::vector<JobChange>&) override {
    ++saves;
    blocked.wait(true);
    return Outcome();
  }
  absl::Status Remove(const std::vector<std::string>& ids) override {
    if (full) return Outcome();
    const std::lock_guard lock(mutex_);
    for (const std::string& id : ids) jobs_.erase(id);
    return absl::OkStatus();
  }
  absl::StatusOr<std::vector<JobRecord>> Load() override {
    const std::lock_guard lock(mutex_);
    std::vector<JobRecord> records;
    for (const auto& [id, record] : jobs_) records.push_back(record);
    return records;
  }

  std::atomic<bool> full{false};
  std::atomic<bool> blocked{false};  // saving waits while it is true
  std::atomic<int> saves{0};         // saves that have begun

 private:
  absl::Status Outcome() const {
    return full ? absl::UnavailableError("database or disk is full") : absl::OkStatus();
  }

  std::mutex mutex_;
  std::map<std::string, JobRecord> jobs_;
};

TEST(JobsTest, AForgottenJobStaysForgottenThoughTheStoreWasFull) {
  const testing::TemporaryFolder folder;
  const auto store = std::make_shared<FullStore>();
  JobsOptions options;
  options.store = store;
  options.folder = folder.File("jobs");
  {
    auto jobs = Jobs::Open(options);
    ASSERT_TRUE(jobs.ok()) << jobs.status();
    NewJob job{"night", "", std::vector<PictureOrder>(3)};
    std::promise<absl::StatusOr<JobView>> created;
    (*jobs)->Create(job, [&](const absl::StatusOr<JobView>& view) { created.set_value(view); });
    const auto view = created.get_future().get();
    ASSERT_TRUE(view.ok()) << view.status();
    store->full = true;
    std::promise<absl::Status> cancelled;
    (*jobs)->Cancel(view->id, {.name = "night"}, true,
                    [&](const absl::StatusOr<JobView>& end) { cancelled.set_value(end.status()); });
    EXPECT_FALSE(cancelled.get_future().get().ok()) << "it does not outlive the server yet";
    store->full = false;
  }
  auto jobs = Jobs::Open(options);
  ASSERT_TRUE(jobs.ok()) << jobs.status();
  EXPECT_EQ((*jobs)->Load().running, 0U) << "it would be drawn again";
}

TEST(JobsTest, WhatIsFetchedWhileAnotherFetchIsSavedLetsDrawingGoOn) {
  const testing::TemporaryFolder folder;
  const auto store = std::make_shared<FullStore>();
  std::atomic<int> cannot_take{0};
  JobsOptions options;
  options.store = store;
  options.folder = folder.File("jobs");
  options.patience = testing::kHangLimit;
  options.limits.max_result_bytes = 1;
  options.limits.max_in_hand = 1;
  auto jobs = Jobs::Open(options);
  ASSERT_TRUE(jobs.ok()) << jobs.status();
  (*jobs)->Start([&](const PictureOrder&, const std::function<void()>& done) {
    auto picture = std::make_unique<Picture>(cannot_take);
    done();
    return picture;
  });
  std::promise<absl::StatusOr<JobView>> created;
  (*jobs)->Create({"night", "", std::vector<PictureOrder>(4)},
                  [&](const absl::StatusOr<JobView>& view) { created.set_value(view); });
  const std::string id = created.get_future().get()->id;
  // The second picture was in progress when the first was stored.
  ASSERT_TRUE(WaitFor([&] {
    const JobsLoad load = (*jobs)->Load();
    return load.result_bytes == 10 && load.stalled_s == 0.0;
  }));
  EXPECT_EQ((*jobs)->Load().paused, 2U);
  const int saves = store->saves;
  store->blocked = true;
  (*jobs)->Fetched({id, 0});
  ASSERT_TRUE(WaitFor([&] { return store->saves > saves; }));
  (*jobs)->Fetched({id, 1});
  store->blocked = false;
  store->blocked.notify_all();
  EXPECT_TRUE(WaitFor([&] { return (*jobs)->Load().waiting < 2; }));
}

// A storage on which writing files can hang. An abandoned thread may outlive its test, so the
// thread shares it.
class HangingFiles {
 public:
  // Returns a function that waits while `hangs` is true and then writes the file.
  WriteFile Writer() const {
    return [hangs = hangs_](const std::string& path, std::string_view bytes) {
      hangs->wait(true);
      return base::WriteWholeFile(path, bytes);
    };
  }
  void Hang() { *hangs_ = true; }
  void Respond() {
    *hangs_ = false;
    hangs_->notify_all();
  }

 private:
  const std::shared_ptr<std::atomic<bool>> hangs_ = std::make_shared<std::atomic<bool>>(false);
};

class UnwrittenPictures : public ::testing::Test {
 protected:
  void Open() {
    JobsOptions options;
    options.folder = results_;
    options.patience = patience_;
    options.time = &Time();
    options.write_file = files_.Writer();
    auto jobs = Jobs::Open(options);
    ASSERT_TRUE(jobs.ok()) << jobs.status();
    jobs_ = *std::move(jobs);
    jobs_->Start([this](const PictureOrder&, const std::function<void()>& done) {
      ++begun_;
      auto picture = std::make_unique<Picture>(
          cannot_take_, [this] { may_take_.wait(false); }, [this] { ++ended_; });
      done();
      return picture;
    });
  }

  // Makes writing files fail, as on a full disk. `refused_` counts the writes that the kernel
  // refuses.
  static void Block() {
    refused_ = 0;
    std::signal(SIGXFSZ, [](int) { ++refused_; });
    Limit(1);
  }
  static void Unblock() { Limit(RLIM_INFINITY); }
  static void Limit(rlim_t bytes) {
    rlimit limit{};
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = std::min(bytes, limit.rlim_max);
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  void TearDown() override {
    Unblock();
    files_.Respond();
  }

  std::string Create(int pictures) {
    NewJob job;
    job.owner = "night";
    job.pictures.resize(static_cast<std::size_t>(pictures));
    std::promise<std::string> created;
    jobs_->Create(job, [&](const absl::StatusOr<JobView>& view) { created.set_value(view->id); });
    return created.get_future().get();
  }

  std::optional<Problem> PauseOf(const std::string& id) const {
    const auto news = jobs_->Get(id, {.name = "night"});
    return news.ok() ? news->job.paused : std::nullopt;
  }

  // Makes the first result of a job hang while it is written. Sets the job's id.
  void HangFirstResult(std::string& id) {
    patience_ = std::chrono::seconds(10);
    Open();
    files_.Hang();
    id = Create(1);
    // The picture's memory is released after the server has given up writing the picture.
    ASSERT_TRUE(Await([this] { return ended_ > 0; }));
    EXPECT_GE(jobs_->Load().stalled_s, 10.0);
  }

  // Waits for the condition while time passes.
  template <typename Condition>
  static bool Await(const Condition& condition) {
    return WaitFor([&] {
      if (condition()) return true;
      Time().Advance(std::chrono::milliseconds(200));
      return false;
    });
  }

  // The time of all tests, because an abandoned thread outlives its test.
  static ManualTime& Time() {
    static ManualTime time;
    return time;
  }

  const testing::TemporaryFolder folder_;
  const std::string results_ = folder_.File("jobs");
  std::atomic<int> cannot_take_{0};
  std::atomic<bool> may_take_{true};
  static inline std::atomic<int> refused_{0};
  std::atomic<int> begun_{0};
  std::atomic<int> ended_{0};
  std::chrono::milliseconds patience_ = std::chrono::hours(1);
  HangingFiles files_;
  std::unique_ptr<Jobs> jobs_;
};

TEST_F(UnwrittenPictures, AreKeptUntilTheyCanBeWrittenAndNotDrawnAgain) {
  Open();
  Block();
  const std::string id = Create(10);
  ASSERT_FALSE(id.empty());
  ASSERT_TRUE(WaitFor([] { return refused_ > 0; }));
  // The server tries several times to write up to four pictures.
  for (int i = 0; i < 12; ++i) {
    const int refused = refused_;
    ASSERT_TRUE(Await([&] { return refused_ > refused; }));
  }
  EXPECT_LE(begun_, 4) << "none is begun while none can be written";
  EXPECT_EQ(jobs_->Load().result_bytes, 0U);
  // Every job says why it waits, even one without a drawn picture.
  for (const std::string& waiting : {id, Create(1)}) {
    const std::optional<Problem> paused = PauseOf(waiting);
    ASSERT_TRUE(paused.has_value());
    EXPECT_EQ(paused->reason, "RESULTS_NOT_WRITTEN");
    EXPECT_THAT(paused->message, HasSubstr(".about cannot be written (File too large)"));
  }
  Unblock();
  EXPECT_TRUE(Await([this] { return jobs_->Load().result_bytes == 55; }));
  EXPECT_EQ(begun_, 11);
  EXPECT_FALSE(PauseOf(id).has_value());
}

TEST_F(UnwrittenPictures, GoWithTheirJobAndHoldUpNoEnd) {
  Open();
  Block();
  const std::string id = Create(2);
  ASSERT_TRUE(WaitFor([this] { return begun_ > 0; }));
  std::promise<bool> cancelled;
  jobs_->Cancel(id, {.name = "night"}, false,
                [&](const absl::StatusOr<JobView>& view) { cancelled.set_value(view.ok()); });
  EXPECT_TRUE(cancelled.get_future().get());
  Create(2);
  jobs_->Stop();
  EXPECT_EQ(jobs_->Load().drawing, 0U);
  EXPECT_EQ(jobs_->Load().waiting, 2U) << "drawn again after the next start";
}

TEST_F(UnwrittenPictures, OfOneJobWhoseFolderIsSomebodyElsesHoldUpNoOtherJob) {
  Open();
  may_take_ = false;
  const std::string first = Create(1);
  ASSERT_TRUE(WaitFor([this] { return begun_ > 0; }));
  std::ofstream(results_ + "/" + first) << "in the way";
  may_take_ = true;
  may_take_.notify_all();
  const std::string second = Create(3);
  EXPECT_TRUE(WaitFor([this] { return jobs_->Load().result_bytes == 15; }));
  EXPECT_EQ(jobs_->Load().waiting, 1U);
  EXPECT_FALSE(PauseOf(second).has_value());
  const std::optional<Problem> paused = PauseOf(first);
  ASSERT_TRUE(paused.has_value());
  EXPECT_EQ(paused->reason, "RESULTS_NOT_WRITTEN");
  EXPECT_THAT(paused->message, HasSubstr(first + " cannot be created (File exists)"));
  std::filesystem::remove(results_ + "/" + first);
  EXPECT_TRUE(Await([this] { return jobs_->Load().result_bytes == 20; }));
  EXPECT_FALSE(PauseOf(first).has_value());
}

TEST_F(UnwrittenPictures, ALinkInPlaceOfAJobsFolderIsNotFollowed) {
  Open();
  may_take_ = false;
  const std::string id = Create(1);
  ASSERT_TRUE(WaitFor([this] { return begun_ > 0; }));
  const std::string other = folder_.File("other");
  std::filesystem::create_directory(other);
  std::ofstream(other + "/000000.png") << "of another user";
  std::ofstream(other + "/x.partial") << "of another user";
  std::filesystem::create_directory_symlink(other, results_ + "/" + id);
  may_take_ = true;
  may_take_.notify_all();
  Create(3);
  EXPECT_TRUE(WaitFor([this] { return jobs_->Load().result_bytes == 15; }));
  EXPECT_EQ(jobs_->Load().waiting, 1U);
  EXPECT_EQ(base::ReadWholeFile(other + "/000000.png").value_or(""), "of another user");
  EXPECT_FALSE(std::filesystem::exists(other + "/000000.about"));
  auto folder = ResultFolder::Open(results_, patience_, Time());
  ASSERT_TRUE(folder.ok());
  folder->Clean({id});
  folder->Remove(id, 0, "png");
  EXPECT_TRUE(std::filesystem::exists(other + "/x.partial"));
  EXPECT_TRUE(std::filesystem::exists(other + "/000000.png"));
  folder->Remove(id);
  EXPECT_FALSE(std::filesystem::is_symlink(results_ + "/" + id));
  EXPECT_TRUE(std::filesystem::exists(other + "/000000.png"));
}

TEST_F(UnwrittenPictures, OfAFolderThatHangsHoldUpNeitherCallersNorTheEnd) {
  std::string id;
  ASSERT_NO_FATAL_FAILURE(HangFirstResult(id));
  EXPECT_FALSE(Create(1).empty()) << "the job's record is another matter";
  std::promise<bool> forgotten;
  jobs_->Cancel(id, {.name = "night"}, true,
                [&](const absl::StatusOr<JobView>& view) { forgotten.set_value(view.ok()); });
  EXPECT_TRUE(forgotten.get_future().get());
  EXPECT_TRUE(std::filesystem::exists(results_ + "/" + id));
  // The folder responds again. Files that could not be removed before are removed together with the
  // next file.
  files_.Respond();
  EXPECT_TRUE(Await([this] { return jobs_->Load().result_bytes == 5; }));
  const std::string last = Create(1);
  jobs_->Cancel(last, {.name = "night"}, true, [](const absl::StatusOr<JobView>&) {});
  EXPECT_TRUE(Await([&] { return !std::filesystem::exists(results_ + "/" + id); }));
}

TEST_F(UnwrittenPictures, OfAFolderThatHangsAreLeftBehindAtTheEnd) {
  std::string id;
  ASSERT_NO_FATAL_FAILURE(HangFirstResult(id));
  jobs_.reset();  // time stands still meanwhile
  const std::string picture = results_ + "/" + id + "/000000.png";
  EXPECT_FALSE(std::filesystem::exists(picture));
  // The abandoned thread still has what it needs to write both files.
  files_.Respond();
  EXPECT_TRUE(WaitFor([&] { return std::filesystem::exists(picture); }));
  EXPECT_EQ(base::ReadWholeFile(picture).value_or(""), "bytes");
}

}  // namespace
}  // namespace thunderhead::jobs
