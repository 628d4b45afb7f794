// Tests of the updates that a session's participants receive: at a limited rate, only the newest,
// made once for all of them. They also test the states that time out without any action.
#include "session/audience.h"

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::session {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;

class ToldViewer : public delivery::Viewer {
 public:
  void Wake() override { ++wakes; }
  int wakes = 0;
};

Ray RayTo(double x_m) { return {.origin_m = {x_m, 0.0, 0.0}}; }

// Returns the place where the ray begins.
glm::dvec3 PlaceOf(const Ray& ray) { return ray.origin_m; }

// A fixture with a presenter and two viewers, Ana and Ben. All three received the list of
// participants a minute ago.
class AudienceTest : public ::testing::Test {
 protected:
  AudienceTest() {
    presenter_ = *audience_.Join(Role::kPresenter, "Teacher", viewers_[0], now_);
    ana_ = *audience_.Join(Role::kViewer, "Ana", viewers_[1], now_);
    ben_ = *audience_.Join(Role::kViewer, "Ben", viewers_[2], now_);
    now_ += seconds(1);
    Tick();
    now_ += seconds(59);
    Tick();
  }

  std::optional<Audience::Time> Tick() { return audience_.Tick(now_, PlaceOf); }

  absl::Status Ask(std::uint64_t id) {
    return audience_.Change([&](Roster& roster) { return roster.AskControl(id, now_); }, now_);
  }

  absl::Status Draw(std::uint64_t id) {
    return audience_.Draw(
        id, [&](Board& board) { return board.Add(id, {{}}, {}, "").status(); }, now_);
  }

  absl::Status SetRules(const Rules& rules) {
    return audience_.Change([&](Roster& roster) { return roster.SetRules(presenter_, rules); },
                            now_);
  }

  // Returns a format that writes updates as texts. They say who asks for control, who has control,
  // where each pointer is, and which marks are shown.
  AudienceFormat Format() {
    return {.presence =
                [this](const Roster& roster) {
                  ++formatted_;
                  std::string text = absl::StrCat("steers ", roster.steering());
                  for (const Person& person : roster.people()) {
                    if (person.asks) absl::StrAppend(&text, ", asks ", person.id);
                  }
                  return text + (roster.presenter_away() ? ", away" : "");
                },
            .pointers =
                [this](const std::vector<Pointer>& pointers) {
                  ++formatted_;
                  std::string text;
                  for (const Pointer& pointer : pointers) {
                    absl::StrAppend(&text, pointer.person_id, " at ", pointer.position_m.x, ";");
                  }
                  return text;
                },
            .marks =
                [this](const std::vector<Mark>& marks) {
                  ++formatted_;
                  return "all " + std::to_string(marks.size());
                },
            .marks_change =
                [this](const MarksChange& change) {
                  ++formatted_;
                  return absl::StrCat("drawn ", change.drawn.size(), ", erased ",
                                      change.erased.size());
                }};
  }

  int formatted_ = 0;
  int due_ = 0;
  Audience::Time now_ = Audience::Time() + std::chrono::hours(1);
  const std::vector<std::shared_ptr<ToldViewer>> viewers_ = {std::make_shared<ToldViewer>(),
                                                             std::make_shared<ToldViewer>(),
                                                             std::make_shared<ToldViewer>()};
  Audience audience_{Format(), {.free_when_away = true}, {}, now_, [this] { ++due_; }};
  std::uint64_t presenter_ = 0;
  std::uint64_t ana_ = 0;
  std::uint64_t ben_ = 0;
};

TEST_F(AudienceTest, EverybodyIsToldTheSameBytesMadeOnce) {
  const int formatted = formatted_;
  const std::uint64_t told = audience_.Presence(presenter_).count;
  const std::vector<int> wakes = {viewers_[0]->wakes, viewers_[1]->wakes, viewers_[2]->wakes};
  ASSERT_TRUE(Ask(ana_).ok());
  EXPECT_EQ(audience_.Presence(presenter_).count, told + 1) << "at once after a pause";
  EXPECT_EQ(*audience_.Presence(presenter_).bytes,
            absl::StrCat("steers ", presenter_, ", asks ", ana_));
  EXPECT_EQ(formatted_, formatted + 1) << "whatever the number of people";
  EXPECT_EQ(audience_.Presence(presenter_).bytes, audience_.Presence(presenter_).bytes)
      << "the same, not a copy";
  for (std::size_t i = 0; i < viewers_.size(); ++i) EXPECT_EQ(viewers_[i]->wakes, wakes[i] + 1);
}

TEST_F(AudienceTest, PresenceIsToldAtMostSoOften) {
  const std::uint64_t told = audience_.Presence(presenter_).count;
  ASSERT_TRUE(Ask(ana_).ok());
  ASSERT_TRUE(Ask(ben_).ok());
  EXPECT_EQ(audience_.Presence(presenter_).count, told + 1);
  EXPECT_EQ(Tick(), now_ + Audience::kPresencePause);
  now_ += Audience::kPresencePause - milliseconds(1);
  Tick();
  EXPECT_EQ(audience_.Presence(presenter_).count, told + 1);
  now_ += milliseconds(1);
  Tick();
  EXPECT_EQ(audience_.Presence(presenter_).count, told + 2);
  EXPECT_THAT(*audience_.Presence(presenter_).bytes,
              ::testing::HasSubstr(absl::StrCat("asks ", ben_)));
}

TEST_F(AudienceTest, MarksAreToldAtMostSoOften) {
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(Draw(presenter_).ok());
    now_ += milliseconds(1);
  }
  EXPECT_EQ(audience_.Marks(0).count, 1U);
  EXPECT_EQ(audience_.Marks(1).count, 1U) << "nothing new";
  now_ += Audience::kMarksPause;
  Tick();
  EXPECT_EQ(audience_.Marks(1).count, 2U);
  EXPECT_EQ(*audience_.Marks(1).bytes, "drawn 9, erased 0");
}

TEST_F(AudienceTest, MarksAreToldByTheirChangesMadeOnce) {
  const auto next_draws = [&] {
    now_ += Audience::kMarksPause;
    ASSERT_TRUE(Draw(presenter_).ok());
  };
  next_draws();
  EXPECT_EQ(*audience_.Marks(0).bytes, "all 1") << "to those who have had none";
  next_draws();
  next_draws();
  now_ += Audience::kMarksPause;
  ASSERT_TRUE(audience_.Erase(presenter_, {1, 2}, now_).ok());
  EXPECT_EQ(audience_.Marks(1).count, 2U) << "in order, whatever has come since";
  EXPECT_EQ(*audience_.Marks(1).bytes, "drawn 1, erased 0");
  EXPECT_EQ(*audience_.Marks(2).bytes, "drawn 1, erased 0");
  EXPECT_EQ(audience_.Marks(3).count, 4U);
  EXPECT_EQ(*audience_.Marks(3).bytes, "drawn 0, erased 2");
  EXPECT_EQ(audience_.Marks(0).count, 4U);
  EXPECT_EQ(*audience_.Marks(0).bytes, "all 1");
  const int formatted = formatted_;
  EXPECT_EQ(audience_.Marks(0).bytes, audience_.Marks(0).bytes) << "the same, not a copy";
  EXPECT_EQ(audience_.Marks(3).bytes, audience_.Marks(3).bytes);
  EXPECT_EQ(formatted_, formatted);
}

TEST_F(AudienceTest, WhoHasMissedTooManyChangesIsToldAllMarks) {
  for (std::size_t i = 0; i < Audience::kMaxMarksChanges + 2; ++i) {
    now_ += Audience::kMarksPause;
    ASSERT_TRUE(Draw(presenter_).ok());
  }
  EXPECT_EQ(*audience_.Marks(2).bytes, "drawn 1, erased 0");
  EXPECT_EQ(audience_.Marks(2).count, 3U);
  EXPECT_EQ(audience_.Marks(1).count, Audience::kMaxMarksChanges + 2);
  EXPECT_EQ(*audience_.Marks(1).bytes, absl::StrCat("all ", Audience::kMaxMarksChanges + 2));
}

// The web page sends the pointer's position for each movement of the mouse.
TEST_F(AudienceTest, PointersAreToldThirtyTimesASecondTheNewestOfThem) {
  const std::uint64_t told = audience_.Pointers().count;
  const Audience::Time start = now_;
  int searches = 0;
  for (int i = 0; i < 1000; ++i) {  // one millisecond each
    ASSERT_TRUE(audience_.Point(presenter_, RayTo(i), now_).ok());
    const std::uint64_t before = audience_.Pointers().count;
    audience_.Tick(now_, [&](const Ray& ray) {
      ++searches;
      return PlaceOf(ray);
    });
    if (audience_.Pointers().count > before) {
      EXPECT_EQ(*audience_.Pointers().bytes, absl::StrCat(presenter_, " at ", i, ";"));
    }
    now_ += milliseconds(1);
  }
  ASSERT_EQ(now_ - start, seconds(1));
  const std::uint64_t times = audience_.Pointers().count - told;
  EXPECT_LE(times, 31U) << "30 a second, and the first";
  EXPECT_GE(times, 28U);
  EXPECT_LE(searches, 31) << "places cost time, and those that nobody is told are not found";
  // The last position of the pointer is sent, too.
  EXPECT_TRUE(audience_.Point(presenter_, RayTo(5000.0), now_).ok());
  const auto next = Tick();
  if (next.has_value()) now_ = *next;
  Tick();
  EXPECT_EQ(*audience_.Pointers().bytes, absl::StrCat(presenter_, " at 5000;"));
}

TEST_F(AudienceTest, PointersThatGoAreToldAtThatPaceToo) {
  ASSERT_TRUE(SetRules({.viewers_may_mark = true}).ok());
  for (const std::uint64_t id : {presenter_, ana_, ben_}) {
    ASSERT_TRUE(audience_.Point(id, RayTo(1.0), now_).ok());
  }
  Tick();
  now_ += seconds(1);
  const std::uint64_t told = audience_.Pointers().count;
  for (const std::uint64_t id : {presenter_, ana_, ben_}) {
    ASSERT_TRUE(audience_.Point(id, std::nullopt, now_).ok());
    now_ += milliseconds(1);
  }
  EXPECT_EQ(audience_.Pointers().count, told + 1);
  now_ += Audience::kPointersPause;
  Tick();
  EXPECT_EQ(audience_.Pointers().count, told + 2);
  EXPECT_EQ(*audience_.Pointers().bytes, "");
}

TEST_F(AudienceTest, ManyWhoPointAreFoundInTurn) {
  ASSERT_TRUE(SetRules({.viewers_may_mark = true}).ok());
  constexpr std::size_t kPeople = 2 * Audience::kMaxFound + 1;
  std::vector<std::uint64_t> people;
  for (std::size_t i = 0; i < kPeople; ++i) {
    people.push_back(*audience_.Join(Role::kViewer, "", std::make_shared<ToldViewer>(), now_));
  }
  for (const std::uint64_t id : people) ASSERT_TRUE(audience_.Point(id, RayTo(1.0), now_).ok());
  std::size_t found = 0;
  for (int ticks = 0; ticks < 3; ++ticks) {
    std::size_t searches = 0;
    audience_.Tick(now_, [&](const Ray& ray) {
      ++searches;
      return PlaceOf(ray);
    });
    EXPECT_LE(searches, Audience::kMaxFound);
    found += searches;
    now_ += Audience::kPointersPause;
  }
  EXPECT_EQ(found, kPeople);
}

TEST_F(AudienceTest, APointerThatGoesWhileItsPlaceIsFoundStaysAway) {
  ASSERT_TRUE(audience_.Point(presenter_, RayTo(1.0), now_).ok());
  audience_.Tick(now_, [&](const Ray& ray) {
    EXPECT_TRUE(audience_.Point(presenter_, std::nullopt, now_).ok());
    return PlaceOf(ray);
  });
  now_ += seconds(1);
  Tick();
  EXPECT_TRUE(audience_.Drawn().pointers().empty());
}

TEST_F(AudienceTest, ARequestEndsByItselfAndThatIsTold) {
  ASSERT_TRUE(Ask(ana_).ok());
  const Audience::Time asked = now_;
  now_ += seconds(1);
  EXPECT_EQ(Tick(), asked + seconds(20)) << "when it is to be called next";
  now_ = asked + seconds(20) - milliseconds(1);
  Tick();
  EXPECT_THAT(*audience_.Presence(presenter_).bytes, ::testing::HasSubstr("asks"));
  now_ = asked + seconds(20);
  const int wakes = viewers_[1]->wakes;
  Tick();
  EXPECT_EQ(*audience_.Presence(presenter_).bytes, absl::StrCat("steers ", presenter_));
  EXPECT_EQ(viewers_[1]->wakes, wakes + 1);
}

TEST_F(AudienceTest, ControlOfAnAbsentPresenterBecomesFreeByItselfAndThatIsTold) {
  audience_.Leave(presenter_, now_);
  const Audience::Time left = now_;
  EXPECT_EQ(*audience_.Presence(presenter_).bytes, "steers 0, away");
  EXPECT_THAT(due_, Gt(0));
  EXPECT_EQ(Tick(), left + seconds(60));
  now_ = left + seconds(60) - milliseconds(1);
  Tick();
  EXPECT_EQ(*audience_.Presence(presenter_).bytes, "steers 0, away");
  now_ = left + seconds(60);
  Tick();
  EXPECT_EQ(*audience_.Presence(presenter_).bytes, "steers 0");
  now_ += seconds(1);
  ASSERT_TRUE(Ask(ben_).ok());
  EXPECT_EQ(*audience_.Presence(presenter_).bytes, absl::StrCat("steers ", ben_));
}

TEST_F(AudienceTest, ALostConnectionIsAskedForASignOfLifeAndForgotten) {
  const auto join = [&](const std::shared_ptr<ToldViewer>& viewer, std::size_t most) {
    return audience_.Join(Role::kViewer, "Eve", viewer, now_, most, "key of Eve");
  };
  const auto lost_viewer = std::make_shared<ToldViewer>();
  const std::uint64_t lost = *join(lost_viewer, 4);
  now_ += seconds(1);
  Tick();
  int wakes = lost_viewer->wakes;
  const auto again = std::make_shared<ToldViewer>();
  EXPECT_FALSE(audience_.Join(Role::kViewer, "", again, now_, 4, "another key").has_value());
  const auto back = join(again, 4);
  ASSERT_TRUE(back.has_value()) << "though four are there, of whom one is gone";
  EXPECT_FALSE(join(std::make_shared<ToldViewer>(), 4).has_value()) << "but not a third";
  EXPECT_EQ(audience_.Doubts(lost), 1U);
  EXPECT_EQ(audience_.Doubts(*back), 0U);
  EXPECT_THAT(lost_viewer->wakes, Gt(wakes)) << "to ask";
  wakes = lost_viewer->wakes;
  now_ += seconds(4);
  Tick();
  EXPECT_TRUE(audience_.IsThere(lost)) << "the question has not been sent yet";
  audience_.Checked(lost, 1U, now_);
  now_ += seconds(3);
  Tick();
  EXPECT_FALSE(audience_.IsThere(lost));
  EXPECT_TRUE(audience_.IsThere(*back));
  EXPECT_THAT(lost_viewer->wakes, Gt(wakes)) << "to end its call";
  audience_.Leave(lost, now_);  // the lost participant leaves when its call ends
  EXPECT_TRUE(audience_.IsThere(*back));
}

TEST_F(AudienceTest, WhoHasSaidSomethingIsNoLostConnection) {
  const auto join = [&] {
    return *audience_.Join(Role::kViewer, "", std::make_shared<ToldViewer>(), now_, 9, "key");
  };
  const std::uint64_t first = join();
  const std::uint64_t second = join();
  audience_.Heard(first);
  now_ += seconds(60);
  Tick();
  EXPECT_TRUE(audience_.IsThere(first));
  EXPECT_TRUE(audience_.IsThere(second));
}

// A client decides by its first presence message whether it has control, so this message must not
// be older than the join.
TEST_F(AudienceTest, TheFirstPresenceIsNotOlderThanTheJoining) {
  ASSERT_TRUE(
      audience_
          .Change([&](Roster& roster) { return roster.GiveControl(presenter_, ana_, now_); }, now_)
          .ok());
  const auto viewer = std::make_shared<ToldViewer>();
  now_ += milliseconds(50);
  const std::uint64_t carl = *audience_.Join(Role::kPresenter, "Carl", viewer, now_);
  ASSERT_TRUE(
      audience_.Change([&](Roster& roster) { return roster.TakeControl(carl); }, now_).ok());
  EXPECT_EQ(audience_.Presence(carl).count, 0);
  EXPECT_EQ(*audience_.Presence(ben_).bytes, absl::StrCat("steers ", ana_)) << "as told before";
  const int wakes = viewer->wakes;
  now_ += Audience::kPresencePause;
  Tick();
  EXPECT_EQ(viewer->wakes, wakes + 1);
  EXPECT_EQ(*audience_.Presence(carl).bytes, absl::StrCat("steers ", carl));
}

TEST_F(AudienceTest, NothingIsToldWithoutNews) {
  const Told presence = audience_.Presence(presenter_);
  const std::uint64_t marks = audience_.Marks(0).count;
  const int wakes = viewers_[0]->wakes;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(Tick(), std::nullopt);
    now_ += seconds(1);
  }
  EXPECT_TRUE(audience_.Erase(presenter_, {}, now_).ok());
  EXPECT_EQ(audience_.Presence(presenter_).count, presence.count);
  EXPECT_EQ(audience_.Marks(0).count, marks);
  EXPECT_EQ(viewers_[0]->wakes, wakes);
}

TEST_F(AudienceTest, ViewersEraseTheirOwnMarksAndWhoeverHasTheirKeyToo) {
  ASSERT_TRUE(SetRules({.viewers_may_mark = true}).ok());
  const auto draw = [&](std::uint64_t id, const std::string& key) {
    return audience_.Draw(
        id, [&](Board& board) { return board.Add(id, {{}}, {}, key).status(); }, now_);
  };
  ASSERT_TRUE(draw(ana_, "key of Ana").ok());
  ASSERT_TRUE(draw(ben_, "key of Ben").ok());
  audience_.Leave(ana_, now_);
  const auto join = [&](const std::string& key) {
    return *audience_.Join(Role::kViewer, "", viewers_[1], now_, 100, key);
  };
  EXPECT_TRUE(audience_.Erase(join(""), {}, now_).ok());
  EXPECT_TRUE(audience_.Erase(join("another key"), {}, now_).ok());
  ASSERT_EQ(audience_.Drawn().marks().size(), 2U);
  const std::uint64_t revision = audience_.MarksRevision();
  const std::uint64_t back = join("key of Ana");
  EXPECT_THAT(audience_.MarksRevision(), Gt(revision)) << "others are told whose it is now";
  EXPECT_EQ(audience_.Drawn().marks()[0].person_id, back);
  EXPECT_TRUE(audience_.Erase(back, {}, now_).ok());
  ASSERT_EQ(audience_.Drawn().marks().size(), 1U);
  EXPECT_EQ(audience_.Drawn().marks()[0].person_id, ben_);
}

}  // namespace
}  // namespace thunderhead::session
