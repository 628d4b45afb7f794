// Tests of sessions that outlive the server. The next server with the same store restores them.
// Store and engine are fakes.
#include <algorithm>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "base/timed_calls.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "service/stored_scene.h"
#include "store/timed_stores.h"
#include "telemetry/metrics.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"
#include "tests/support/manual_time.h"
#include "tests/support/running_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using session::SessionRecord;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

// A store in memory, which the test also reads and changes.
class FakeSessionStore final : public session::SessionStore {
 public:
  absl::Status Save(const std::vector<SessionRecord>& records) override {
    saving.Pass();
    const std::lock_guard lock(mutex_);
    if (!save_failure_.ok()) return save_failure_;
    last_saved_.clear();
    for (const SessionRecord& record : records) {
      records_[record.id] = record;
      last_saved_.insert(record.keys.presenter);
    }
    ++saves_;
    changed_.notify_all();
    return absl::OkStatus();
  }

  absl::Status Remove(const std::vector<std::string>& ids) override {
    const std::lock_guard lock(mutex_);
    if (!remove_failure_.ok()) return remove_failure_;
    for (const std::string& id : ids) records_.erase(id);
    changed_.notify_all();
    return absl::OkStatus();
  }

  absl::Status Check() override { return absl::OkStatus(); }

  absl::StatusOr<std::vector<SessionRecord>> Load() override {
    const std::lock_guard lock(mutex_);
    std::vector<SessionRecord> records;
    for (const auto& [id, record] : records_) records.push_back(record);
    return records;
  }

  std::vector<SessionRecord> Records() { return *Load(); }

  void Change(const std::function<void(SessionRecord&)>& change) {
    const std::lock_guard lock(mutex_);
    for (auto& [id, record] : records_) change(record);
  }

  void FailWith(const absl::Status& failure) {
    const std::lock_guard lock(mutex_);
    save_failure_ = failure;
    remove_failure_ = failure;
  }
  void FailSavesWith(const absl::Status& failure) {
    const std::lock_guard lock(mutex_);
    save_failure_ = failure;
  }

  int Saves() {
    const std::lock_guard lock(mutex_);
    return saves_;
  }

  // Returns the presenters' keys of the sessions that were saved last.
  std::set<std::string> LastSaved() {
    const std::lock_guard lock(mutex_);
    return last_saved_;
  }

  // Waits until `wanted` returns true for the saved records.
  bool Await(const std::function<bool(const std::map<std::string, SessionRecord>&)>& wanted) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return wanted(records_); });
  }

  Gate saving;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, SessionRecord> records_;
  absl::Status save_failure_;
  absl::Status remove_failure_;
  std::set<std::string> last_saved_;
  int saves_ = 0;
};

class KeptSessionsTest : public ::testing::Test {
 protected:
  KeptSessionsTest() {
    options_.session_store = store_;
    Start();
  }

  void Start() {
    service_.reset();
    service_ = std::make_unique<FakeService>(options_);
  }

  v1::CreateSessionResponse Create(const v1::SessionRules& rules = {}) {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    *request.mutable_rules() = rules;
    v1::CreateSessionResponse response;
    const grpc::Status status = Call(service_->stub(), &Stub::CreateSession, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  grpc::Status Close(const std::string& key) {
    v1::CloseSessionRequest request;
    request.set_session_id(key);
    v1::CloseSessionResponse response;
    return Call(service_->stub(), &Stub::CloseSession, request, &response);
  }

  void TurnSun(const std::string& key, float azimuth_deg) {
    v1::Scene scene = SmallScene();
    scene.mutable_sun()->set_azimuth_deg(azimuth_deg);
    service_->Update(key, scene);
  }

  // Returns the status of an update by that key; NOT_FOUND if no session has the key.
  grpc::StatusCode CodeOf(const std::string& key) {
    v1::UpdateSceneRequest request;
    request.set_session_id(key);
    v1::UpdateSceneResponse response;
    return Call(service_->stub(), &Stub::UpdateScene, request, &response).error_code();
  }

  const std::shared_ptr<FakeSessionStore> store_ = std::make_shared<FakeSessionStore>();
  RunningTime time_;
  service::ServerOptions options_ = Patient(time_);
  std::unique_ptr<FakeService> service_;
};

v1::InteractRequest DrawsDown() {
  v1::InteractRequest request;
  v1::Ray& ray = *request.mutable_add_mark()->add_rays();
  ray.mutable_origin()->set_x_m(-5500.0F);
  ray.mutable_origin()->set_y_m(-500.0F);
  ray.mutable_origin()->set_z_m(20000.0F);
  ray.mutable_direction()->set_z(-1.0F);
  return request;
}

TEST_F(KeptSessionsTest, TheNextServerHasTheSameSession) {
  v1::SessionRules rules;
  rules.set_viewers_may_steer(false);
  rules.set_viewers_may_mark(true);
  const auto created = Create(rules);
  v1::Marks marks;
  v1::SceneState before;
  {
    Interacting presenter(service_->stub(), created.session_id());
    presenter.AwaitNewest(Response::kJoined);
    v1::InteractRequest locks;
    locks.mutable_set_rules()->mutable_rules()->set_following_locked(true);
    presenter.Send(locks);
    presenter.Send(DrawsDown());
    v1::InteractRequest turns;
    *turns.mutable_update_scene()->mutable_scene() = SmallScene();
    turns.mutable_update_scene()->mutable_scene()->mutable_sun()->set_azimuth_deg(123.0F);
    ASSERT_EQ(presenter.AnswerCode(presenter.Send(turns)), grpc::StatusCode::OK);
    marks = presenter.AwaitNewest(Response::kMarks).marks();
    ASSERT_TRUE(presenter.Await([&](const Interacting::Messages& messages) {
      return std::ranges::any_of(messages, [&](const Response& message) {
        before = message.scene();
        return message.scene().scene().sun().azimuth_deg() == 123.0F;
      });
    }));
  }
  Start();
  Interacting viewer(service_->stub(), created.viewer_key());
  const auto joined = viewer.AwaitNewest(Response::kJoined).joined();
  EXPECT_EQ(joined.role(), v1::ROLE_VIEWER);
  const v1::SceneState after = viewer.AwaitNewest(Response::kScene).scene();
  EXPECT_EQ(after.scene().SerializeAsString(), before.scene().SerializeAsString());
  // The new revision is larger than any that a client has seen, even of scenes that a killed server
  // did not save.
  EXPECT_GT(after.scene_revision(), before.scene_revision() + 1000);
  ASSERT_TRUE(viewer.AwaitFrame(after.scene_revision()));
  EXPECT_EQ(viewer.AwaitNewest(Response::kMarks).marks().SerializeAsString(),
            marks.SerializeAsString());
  EXPECT_GT(joined.viewer_id(), marks.marks(0).viewer_id())
      << "else the mark would be the viewer's";
  ASSERT_TRUE(viewer.AwaitPresence([](const v1::Presence& presence) {
    return presence.presenter_away() && presence.steering_viewer_id() == 0 &&
           !presence.rules().viewers_may_steer() && presence.rules().viewers_may_mark() &&
           presence.rules().following_locked();
  }));
  // Control was reserved for the presenter.
  Interacting presenter(service_->stub(), created.session_id());
  EXPECT_EQ(presenter.AwaitNewest(Response::kJoined).joined().role(), v1::ROLE_PRESENTER);
  EXPECT_EQ(presenter.AwaitNewest(Response::kJoined).joined().viewer_key(), created.viewer_key());
  EXPECT_TRUE(viewer.AwaitPresence([&](const v1::Presence& presence) {
    return presence.steering_viewer_id() == presenter.viewer_id();
  }));
}

TEST_F(KeptSessionsTest, ControlThatWasLetGoIsFreeInTheNextServer) {
  const auto created = Create();
  {
    Interacting presenter(service_->stub(), created.session_id());
    v1::InteractRequest lets_go;
    lets_go.mutable_give_control();
    presenter.AwaitNewest(Response::kJoined);
    presenter.Send(lets_go);
    ASSERT_TRUE(
        store_->Await([](const auto& records) { return records.begin()->second.control.is_free; }));
  }
  Start();
  Interacting viewer(service_->stub(), created.viewer_key());
  v1::InteractRequest asks;
  asks.mutable_ask_control();
  viewer.AwaitNewest(Response::kJoined);
  viewer.Send(asks);
  EXPECT_TRUE(viewer.AwaitPresence([&](const v1::Presence& presence) {
    return presence.steering_viewer_id() == viewer.viewer_id();
  }));
  EXPECT_TRUE(
      store_->Await([](const auto& records) { return !records.begin()->second.control.is_free; }));
}

TEST_F(KeptSessionsTest, AViewerWhoSteeredSteersAgainInTheNextServer) {
  const auto created = Create();
  std::string key;
  {
    Interacting presenter(service_->stub(), created.session_id());
    Interacting ana(service_->stub(), created.viewer_key(), {.name = "Ana"});
    ana.AwaitNewest(Response::kJoined);
    key = ana.participant_key();
    v1::InteractRequest gives;
    gives.mutable_give_control()->set_viewer_id(ana.viewer_id());
    presenter.AwaitNewest(Response::kJoined);
    presenter.Send(gives);
    ASSERT_TRUE(store_->Await(
        [&](const auto& records) { return records.begin()->second.control.viewer_key == key; }));
  }
  Start();
  Interacting presenter(service_->stub(), created.session_id());
  EXPECT_TRUE(presenter.AwaitPresence([](const v1::Presence& presence) {
    return presence.steering_viewer_id() == 0 && presence.awaited().name() == "Ana";
  }));
  Interacting ana(service_->stub(), created.viewer_key(), {.name = "Ana", .participant_key = key});
  EXPECT_TRUE(presenter.AwaitPresence([&](const v1::Presence& presence) {
    return presence.steering_viewer_id() == ana.viewer_id() && !presence.has_awaited();
  }));
}

// After the restart, the clients that opened the sessions may not open more sessions than before.
TEST_F(KeptSessionsTest, SessionsStillCountForWhoOpenedThem) {
  options_.sessions.max_sessions_per_owner = 2;
  Start();
  const auto create = [this](const std::string& address) {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    v1::CreateSessionResponse response;
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    context.AddMetadata("x-forwarded-for", address + ":4711");  // the gateway adds this header, too
    return service_->stub().CreateSession(&context, request, &response).error_code();
  };
  EXPECT_EQ(create("192.0.2.7"), grpc::StatusCode::OK);
  EXPECT_EQ(create("192.0.2.7"), grpc::StatusCode::OK);
  Start();
  EXPECT_EQ(create("192.0.2.7"), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(create("192.0.2.8"), grpc::StatusCode::OK);
}

TEST_F(KeptSessionsTest, AViewerHasTheOwnMarksAgain) {
  v1::SessionRules rules;
  rules.set_viewers_may_mark(true);
  const auto created = Create(rules);
  std::string participant_key;
  {
    Interacting viewer(service_->stub(), created.viewer_key());
    participant_key = viewer.participant_key();
    viewer.Send(DrawsDown());
    ASSERT_TRUE(viewer.AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == 1; }));
  }
  Start();
  Interacting other(service_->stub(), created.viewer_key());
  Interacting back(service_->stub(), created.viewer_key(), {.participant_key = participant_key});
  ASSERT_TRUE(other.AwaitMarks([&](const v1::Marks& marks) {
    return marks.marks_size() == 1 && marks.marks(0).viewer_id() == back.viewer_id();
  }));
  v1::InteractRequest erase;
  erase.mutable_erase_marks();
  back.Send(erase);
  EXPECT_TRUE(other.AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == 0; }));
}

TEST_F(KeptSessionsTest, MarksOfAnotherDomainAreKeptAndNotSeen) {
  const auto created = Create();
  {
    Interacting presenter(service_->stub(), created.session_id());
    presenter.Send(DrawsDown());
    ASSERT_TRUE(
        presenter.AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == 1; }));
  }
  service_.reset();
  store_->Change([](SessionRecord& record) {
    ASSERT_EQ(record.marks.size(), 1U);
    EXPECT_FALSE(record.marks[0].domain.empty());
    record.marks.push_back(record.marks[0]);
    record.marks[1].id = 2;
    record.marks[1].domain = "elsewhere";
  });
  Start();
  {
    Interacting back(service_->stub(), created.session_id());
    back.Send(DrawsDown());
    EXPECT_TRUE(back.AwaitMarks([](const v1::Marks& marks) {
      return marks.marks_size() == 2 && marks.marks(0).mark_id() == 1 &&
             marks.marks(1).mark_id() == 3;
    }));
  }
  service_.reset();
  EXPECT_EQ(store_->Records().at(0).marks.size(), 3U);
}

TEST_F(KeptSessionsTest, ASessionHasAtMostSoManyMarks) {
  const auto created = Create();
  service_.reset();
  store_->Change([](SessionRecord& record) {
    for (std::uint64_t id = 1; id < session::Board::kMaxMarks; ++id) {
      record.marks.push_back({.id = id, .person_id = 1, .positions_m = {{0.0, 0.0, 1000.0}}});
    }
  });
  Start();
  constexpr int kMaxMarks = session::Board::kMaxMarks;
  Interacting presenter(service_->stub(), created.session_id());
  presenter.Send(DrawsDown());
  ASSERT_TRUE(
      presenter.AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == kMaxMarks; }));
  const v1::Refused refused = presenter.Answer(presenter.Send(DrawsDown())).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::FAILED_PRECONDITION));
  EXPECT_EQ(ReasonOf(refused.status()), "TOO_MANY_MARKS");
  // After a mark was erased, another mark may be added.
  v1::InteractRequest erase;
  erase.mutable_erase_marks()->add_mark_ids(7);
  presenter.Send(erase);
  ASSERT_TRUE(presenter.AwaitMarks(
      [](const v1::Marks& marks) { return marks.marks_size() == kMaxMarks - 1; }));
  presenter.Send(DrawsDown());
  EXPECT_TRUE(
      presenter.AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == kMaxMarks; }));
}

TEST_F(KeptSessionsTest, ASessionIsSavedBeforeItsClientKnowsIt) {
  store_->saving.Close();
  std::thread opener([this] { Create(); });
  ASSERT_TRUE(store_->saving.AwaitWaiting(1));
  EXPECT_THAT(store_->Records(), IsEmpty());
  // A disk that hangs does not delay other calls.
  v1::ListStormsResponse storms;
  EXPECT_TRUE(Call(service_->stub(), &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
  store_->saving.Open();
  opener.join();
  EXPECT_EQ(store_->Records().size(), 1U);
}

TEST_F(KeptSessionsTest, AClosedSessionIsGoneBeforeItsClientKnowsIt) {
  const auto closed = Create();
  const auto other = Create();
  ASSERT_TRUE(Close(closed.session_id()).ok());
  ASSERT_EQ(store_->Records().size(), 1U);
  EXPECT_EQ(store_->Records().front().keys.presenter, other.session_id());
  Start();
  EXPECT_EQ(CodeOf(closed.session_id()), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(CodeOf(closed.viewer_key()), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(CodeOf(other.session_id()), grpc::StatusCode::OK);
}

TEST_F(KeptSessionsTest, ChangesAreSavedWhileTheServerRunsAndOnlyThey) {
  const auto created = Create();
  TurnSun(created.session_id(), 77.0F);
  ASSERT_TRUE(store_->Await([&](const auto& records) {
    v1::Scene scene;
    return scene.ParseFromString(records.begin()->second.scene) &&
           scene.sun().azimuth_deg() == 77.0F;
  }));
  Create();  // before it returns, all changes have been saved
  const int saves = store_->Saves();
  time_.Advance(3 * session::SessionKeeper::kPause);
  const auto other = Create();
  EXPECT_EQ(store_->Saves(), saves + 1) << "nothing else has changed";
  EXPECT_THAT(store_->LastSaved(), ElementsAre(other.session_id()));
  // A drag that changes the scene many times causes few saves: one in each pause.
  time_.Stop();
  for (int i = 0; i < 100; ++i) TurnSun(created.session_id(), static_cast<float>(i));
  EXPECT_LE(store_->Saves() - saves, 2) << "one may have begun before the time stopped";
  time_.Advance(session::SessionKeeper::kPause);
  ASSERT_TRUE(store_->Await([&](const auto& records) {
    return std::ranges::any_of(records, [](const auto& record) {
      v1::Scene scene;
      return scene.ParseFromString(record.second.scene) && scene.sun().azimuth_deg() == 99.0F;
    });
  }));
  EXPECT_LE(store_->Saves() - saves, 3);
}

TEST_F(KeptSessionsTest, RevisionsGoOnOverSeveralRestarts) {
  const auto created = Create();
  std::uint64_t last = created.scene_revision();
  for (int i = 0; i < 3; ++i) {
    Start();
    const std::uint64_t revision = store_->Records().front().scene_revision;
    EXPECT_GT(revision, last) << "saved before anybody can see it";
    last = service_->Update(created.session_id(), SmallScene());
    EXPECT_GT(last, revision);
  }
}

// An outage, or a clock that was wrong at boot, does not expire sessions that no viewer could have
// returned to.
TEST_F(KeptSessionsTest, TheTimeThatTheServerWasDownDoesNotCount) {
  options_.sessions.idle_timeout = std::chrono::minutes(10);
  const auto created = Create();
  for (const std::chrono::hours ago :
       {std::chrono::hours(24 * 29), std::chrono::hours(-24 * 365)}) {
    service_.reset();
    store_->Change([&](SessionRecord& record) { record.last_used -= ago; });
    Start();
    EXPECT_EQ(CodeOf(created.session_id()), grpc::StatusCode::OK);
  }
}

TEST_F(KeptSessionsTest, SessionsThatAreTooOldAreDropped) {
  const auto created = Create();
  service_.reset();
  store_->Change([](SessionRecord& record) { record.last_used -= std::chrono::hours(24 * 31); });
  Start();
  EXPECT_EQ(CodeOf(created.session_id()), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(store_->Records(), IsEmpty());
}

TEST_F(KeptSessionsTest, ARestoredSessionHasItsFullTimeToBeComeBackToAndNoMore) {
  options_.sessions.idle_timeout = std::chrono::hours(1);
  service_.reset();
  const auto created = (Start(), Create());
  service_.reset();
  store_->Change([](SessionRecord& record) { record.last_used -= std::chrono::hours(1); });
  Start();
  time_.Advance(std::chrono::minutes(50));
  const auto later = Create();
  EXPECT_EQ(store_->Records().size(), 2U);
  time_.Advance(std::chrono::minutes(10));
  EXPECT_TRUE(store_->Await([&](const auto& records) {
    return records.size() == 1 && records.begin()->second.keys.presenter == later.session_id();
  }));
}

TEST_F(KeptSessionsTest, ASceneThatCannotBeReadIsSkippedAndKeptUntilItIsTooOld) {
  const auto damaged = Create();
  const auto other = Create();
  service_.reset();
  store_->Change([&](SessionRecord& record) {
    if (record.keys.presenter == damaged.session_id()) record.scene = "\xff\xff";
  });
  ::testing::internal::CaptureStdout();
  Start();
  EXPECT_THAT(
      ::testing::internal::GetCapturedStdout(),
      HasSubstr(
          "cannot be restored; its record is kept until it is too old: its scene is damaged"));
  EXPECT_EQ(CodeOf(damaged.session_id()), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(CodeOf(other.session_id()), grpc::StatusCode::OK);
  EXPECT_EQ(store_->Records().size(), 2U);
}

TEST_F(KeptSessionsTest, ASessionWhoseStormIsGoneSaysSo) {
  const auto created = Create();
  service_.reset();
  store_->Change([](SessionRecord& record) {
    v1::Scene scene;
    ASSERT_TRUE(scene.ParseFromString(record.scene));
    scene.set_storm_id("gone");
    record.scene = scene.SerializeAsString();
  });
  Start();
  Interacting viewer(service_->stub(), created.viewer_key());
  EXPECT_EQ(viewer.AwaitNewest(Response::kProblem).problem().code(), v1::Problem::CODE_STORM_GONE);
}

TEST_F(KeptSessionsTest, AStoreThatFailsIsLoggedOnceAndTriedAgain) {
  ::testing::internal::CaptureStdout();
  const auto failures = telemetry::Counted().session_save_failures.Value();
  store_->FailWith(absl::UnavailableError("the disk is full"));
  const auto created = Create();
  EXPECT_TRUE(WaitFor([&] {
    time_.Advance(session::SessionKeeper::kPause);
    return telemetry::Counted().session_save_failures.Value() >= failures + 3;
  }));
  const std::string logged = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(logged, HasSubstr("trying again: the disk is full"));
  EXPECT_EQ(std::ranges::count(logged, '\n'), 1) << logged;
  store_->FailWith(absl::OkStatus());
  EXPECT_TRUE(store_->Await([](const auto& records) { return records.size() == 1; }));
}

TEST_F(KeptSessionsTest, ASessionThatCannotBeSavedSaysSo) {
  const auto saved = Create();
  EXPECT_TRUE(saved.has_durable());
  EXPECT_TRUE(saved.durable());
  store_->FailWith(absl::UnavailableError("the disk is full"));
  const auto unsaved = Create();
  EXPECT_TRUE(unsaved.has_durable());
  EXPECT_FALSE(unsaved.durable());
  EXPECT_EQ(CodeOf(unsaved.session_id()), grpc::StatusCode::OK) << "it is open all the same";
  store_->FailWith(absl::OkStatus());
  EXPECT_TRUE(Create().durable());
  EXPECT_EQ(store_->Records().size(), 3U) << "what could not be saved was tried again";
  options_.session_store = nullptr;
  Start();
  EXPECT_FALSE(Create().has_durable()) << "this server saves no sessions";
}

TEST_F(KeptSessionsTest, AnEndThatCannotBeSavedSaysSo) {
  const auto closed = Create();
  const auto other = Create();
  store_->FailWith(absl::ResourceExhaustedError("the disk is full"));
  const grpc::Status unsaved = Close(closed.session_id());
  EXPECT_EQ(unsaved.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(
      unsaved.error_message(),
      "the session is closed, but exists again if the server restarts before this is saved: the "
      "disk is full");
  EXPECT_EQ(ReasonOf(unsaved), "SESSION_END_NOT_SAVED");
  EXPECT_EQ(CodeOf(closed.session_id()), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(store_->Records().size(), 2U);
  store_->FailWith(absl::OkStatus());
  EXPECT_TRUE(Close(other.session_id()).ok());
  EXPECT_THAT(store_->Records(), IsEmpty()) << "what could not be removed was tried again";
}

// The end of a session is reported as saved although other sessions cannot be saved, because each
// call reports only its own session.
TEST_F(KeptSessionsTest, AnEndIsSavedWhereOnlyOthersCannotBe) {
  const auto closed = Create();
  store_->FailSavesWith(absl::UnavailableError("the disk is full"));
  Create();
  EXPECT_TRUE(Close(closed.session_id()).ok());
  EXPECT_THAT(store_->Records(), IsEmpty());
}

TEST_F(KeptSessionsTest, AStoreThatHangsRefusesWhatItWouldHaveToKeep) {
  constexpr std::chrono::hours kStorePatience{1};
  options_.session_store = store::WithPatience(
      store_, std::make_shared<base::TimedCalls>(kStorePatience, time_), "/state");
  Start();
  const auto stays = Create();
  const auto goes = Create();
  store_->saving.Close();
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SmallScene();
  v1::CreateSessionResponse response;
  std::future<grpc::Status> creating = std::async(std::launch::async, [&] {
    return Call(service_->stub(), &Stub::CreateSession, request, &response);
  });
  ASSERT_TRUE(store_->saving.AwaitWaiting(1));
  time_.Advance(kStorePatience);
  const grpc::Status refused = creating.get();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE) << refused.error_message();
  EXPECT_THAT(refused.error_message(), HasSubstr("the state folder /state does not answer"));
  EXPECT_EQ(ReasonOf(refused), "STORAGE_HANGS");
  EXPECT_EQ(service_->server().Load().sessions, 2) << "nobody could enter it";
  const grpc::Status closed = Close(goes.session_id());
  EXPECT_EQ(closed.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(closed.error_message(), HasSubstr("the session is closed, but exists again"));
  EXPECT_EQ(CodeOf(goes.session_id()), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(CodeOf(stays.session_id()), grpc::StatusCode::OK);
  store_->saving.Open();
  EXPECT_TRUE(store_->Await([](const auto& records) { return records.size() == 1; }));
  Create();
}

TEST(SessionRecordTest, AWatchedSessionIsInUse) {
  struct SilentViewer : delivery::Viewer {
    void Wake() override {}
  };
  ManualTime time;
  session::SessionsOptions options;
  options.time = &time;
  session::Sessions sessions(options, {[] {}, [] {}});
  const auto session = *sessions.Create();
  time.Advance(std::chrono::minutes(1));
  const auto now = std::chrono::system_clock::now();
  EXPECT_LT(session->Record().last_used,
            std::chrono::system_clock::now() - std::chrono::seconds(59));
  ASSERT_TRUE(session->hub().Join(std::make_shared<SilentViewer>()).ok());
  EXPECT_GE(session->Record().last_used, now);
}

TEST(StoredSceneTest, OlderScenesGetTheDefaultsOfWhatTheirWriterDidNotKnow) {
  FakeService service;
  v1::CreateSessionResponse created;
  ASSERT_TRUE(
      Call(service.stub(), &Stub::CreateSession, v1::CreateSessionRequest(), &created).ok());
  const std::vector<scene::TechniqueInfo> techniques{{"light_volume", {}}};
  const auto decoded = [&](const v1::Scene& scene) {
    return service::DecodeStoredScene(*service.store, techniques, scene.SerializeAsString());
  };
  v1::Scene older = created.scene();
  older.clear_ground();
  older.mutable_sky()->clear_turbidity();
  ASSERT_TRUE(decoded(older).ok());
  EXPECT_EQ(decoded(older)->serialized, created.scene().SerializeAsString());
  EXPECT_EQ(decoded(older)->scene.sky.turbidity, created.scene().sky().turbidity());
  v1::Scene wrong = created.scene();
  wrong.mutable_sun()->set_elevation_deg(300.0F);
  EXPECT_FALSE(decoded(wrong).ok());
}

}  // namespace
}  // namespace thunderhead::testing
