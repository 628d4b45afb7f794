// Tests of how sessions are saved and restored. The store is in memory.
#include "session/session_keeper.h"

#include <future>
#include <map>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"

namespace thunderhead::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class StoreInMemory final : public SessionStore {
 public:
  absl::Status Save(const std::vector<SessionRecord>& saved) override {
    if (!outcome.ok()) return outcome;
    for (const SessionRecord& record : saved) records[record.id] = record;
    ++saves;
    return absl::OkStatus();
  }
  absl::Status Remove(const std::vector<std::string>& ids) override {
    if (!outcome.ok()) return outcome;
    for (const std::string& id : ids) records.erase(id);
    return absl::OkStatus();
  }
  absl::Status Check() override { return outcome; }
  absl::StatusOr<std::vector<SessionRecord>> Load() override {
    std::vector<SessionRecord> all;
    for (const auto& [id, record] : records) all.push_back(record);
    return all;
  }

  absl::Status outcome;
  std::map<std::string, SessionRecord> records;
  int saves = 0;
};

absl::StatusOr<DecodedScene> Decode(const std::string& serialized) {
  if (serialized == "damaged") return absl::DataLossError("not a scene");
  return DecodedScene{.serialized = serialized};
}

// A server run: its sessions and their keeper.
struct ServerRun {
  explicit ServerRun(StoreInMemory& store, const testing::ManualTime& time)
      : sessions({.max_absence = std::chrono::hours(24), .time = &time},
                 {.on_work = [] {}, .on_due = [] {}}),
        keeper(*SessionKeeper::Start(store, sessions, Decode)) {}

  std::shared_ptr<Session> Create(const std::string& scene) {
    auto session = *sessions.Create();
    session->Show(session->TakeRevision(), {}, scene);
    return session;
  }

  // Waits for the next attempt to save, and returns its outcome.
  SessionKeeper::Outcome Save() {
    std::promise<SessionKeeper::Outcome> saved;
    keeper->SaveThen([&saved](const SessionKeeper::Outcome& outcome) { saved.set_value(outcome); });
    return saved.get_future().get();
  }

  Sessions sessions;
  std::unique_ptr<SessionKeeper> keeper;
};

// The keeper's thread uses the store between Save() and the end of the keeper only when the clock
// moves. The tests therefore read the store while the clock stands.
class SessionKeeperTest : public ::testing::Test {
 protected:
  testing::ManualTime time_;
  StoreInMemory store_;
};

TEST_F(SessionKeeperTest, ANewRunHasTheSessionsOfTheLastOne) {
  SessionKeys keys;
  std::uint64_t revision = 0;
  {
    ServerRun run(store_, time_);
    const auto session = run.Create("scene");
    keys = session->keys();
    revision = session->Newest()->revision;
  }
  ServerRun run(store_, time_);
  const auto found = run.sessions.Find(keys.presenter);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(*found->session->Newest()->serialized, "scene");
  EXPECT_GT(found->session->Newest()->revision, revision);
}

TEST_F(SessionKeeperTest, OnlyChangesAreSaved) {
  ServerRun run(store_, time_);
  const auto session = run.Create("scene");
  EXPECT_TRUE(run.Save().saved.ok());
  const int saves = store_.saves;
  EXPECT_TRUE(run.Save().saved.ok());
  EXPECT_EQ(store_.saves, saves);
  session->Show(session->TakeRevision(), {}, "another");
  EXPECT_TRUE(run.Save().saved.ok());
  EXPECT_EQ(store_.saves, saves + 1);
  EXPECT_EQ(store_.records.begin()->second.scene, "another");
}

TEST_F(SessionKeeperTest, ASessionThatIsStillBeingCreatedIsNotSaved) {
  ServerRun run(store_, time_);
  ASSERT_TRUE(run.sessions.Create().ok());
  EXPECT_TRUE(run.Save().saved.ok());
  EXPECT_THAT(store_.records, IsEmpty());
}

TEST_F(SessionKeeperTest, AClosedSessionIsRemoved) {
  ServerRun run(store_, time_);
  const auto session = run.Create("scene");
  EXPECT_TRUE(run.Save().saved.ok());
  ASSERT_TRUE(run.sessions.Close(session->keys().presenter).ok());
  EXPECT_TRUE(run.Save().removed.ok());
  EXPECT_THAT(store_.records, IsEmpty());
}

TEST_F(SessionKeeperTest, AnAttemptThatFailedIsRepeated) {
  ServerRun run(store_, time_);
  EXPECT_TRUE(run.Save().saved.ok());
  store_.outcome = absl::ResourceExhaustedError("disk full");
  const auto session = run.Create("scene");
  EXPECT_EQ(run.Save().saved, store_.outcome);
  EXPECT_THAT(store_.records, IsEmpty());
  store_.outcome = absl::OkStatus();
  EXPECT_TRUE(run.Save().saved.ok());
  EXPECT_THAT(store_.records, SizeIs(1));
}

TEST_F(SessionKeeperTest, AServerThatStopsKeepsItsSessions) {
  {
    ServerRun run(store_, time_);
    run.Create("scene");
    run.sessions.CloseAll(absl::UnavailableError("the server stops"));
    EXPECT_TRUE(run.Save().saved.ok());
  }
  EXPECT_THAT(store_.records, SizeIs(0)) << "never saved before the end";
  {
    ServerRun run(store_, time_);
    run.Create("scene");
    EXPECT_TRUE(run.Save().saved.ok());
    run.sessions.CloseAll(absl::UnavailableError("the server stops"));
  }
  EXPECT_THAT(store_.records, SizeIs(1));
}

TEST_F(SessionKeeperTest, ASceneThatCannotBeDecodedStaysInTheStore) {
  SessionRecord damaged{.id = "a", .keys = {"p", "v"}, .scene = "damaged", .scene_revision = 1};
  damaged.last_used = std::chrono::system_clock::now();
  SessionRecord old = damaged;
  old.id = "b";
  old.last_used -= std::chrono::hours(25);
  store_.records = {{damaged.id, damaged}, {old.id, old}};
  const ServerRun run(store_, time_);
  EXPECT_THAT(store_.records, ElementsAre(std::pair(damaged.id, damaged)));
}

}  // namespace
}  // namespace thunderhead::session
