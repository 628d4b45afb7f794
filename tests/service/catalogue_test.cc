// Tests of sessions while the catalogue of storms changes. Sessions that show a storm's newest time
// change to a newer time, other sessions keep their time, and all viewers are notified.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "service/engine/catalogue_follower.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"

namespace thunderhead::testing {
namespace {

using service::PlaceAfter;
using service::StormPlace;
using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

storm_store::StormInfoPtr StormOfHours(const std::string& id, const std::vector<int>& hours) {
  storm_store::StormInfo storm;
  storm.id = id;
  for (const int hour : hours) storm.times.push_back({"2013-05-20T0" + std::to_string(hour), 0.0});
  return std::make_shared<const storm_store::StormInfo>(storm);
}

TEST(PlaceAfter, KeepsTheTimeAndFollowsTheNewest) {
  const storm_store::StormChange grown{StormOfHours("file", {2, 4}),
                                       StormOfHours("series", {1, 2, 4, 5})};
  EXPECT_EQ(PlaceAfter(grown, 0), (StormPlace{"series", 1}));
  EXPECT_EQ(PlaceAfter(grown, 1), (StormPlace{"series", 3}));
}

TEST(PlaceAfter, GoesToTheTimeBeforeOneThatIsGone) {
  const storm_store::StormChange shrunk{StormOfHours("a", {1, 2, 3, 4}),
                                        StormOfHours("a", {1, 3, 4})};
  EXPECT_EQ(PlaceAfter(shrunk, 1), (StormPlace{"a", 0}));
  EXPECT_EQ(PlaceAfter(shrunk, 2), (StormPlace{"a", 1}));
  const storm_store::StormChange first_gone{StormOfHours("a", {1, 2, 3}),
                                            StormOfHours("a", {2, 3})};
  EXPECT_EQ(PlaceAfter(first_gone, 0), (StormPlace{"a", 0}));
  EXPECT_EQ(PlaceAfter({StormOfHours("a", {1}), nullptr}, 0), std::nullopt);
}

TEST(PlaceAfter, IsInAStormThatComesBackAtTheSameIndexOrTheLast) {
  const storm_store::StormChange back{nullptr, StormOfHours("a", {1, 2})};
  EXPECT_EQ(PlaceAfter(back, 0), (StormPlace{"a", 0}));
  EXPECT_EQ(PlaceAfter(back, 4), (StormPlace{"a", 1}));
}

class ChangingCatalogue : public ::testing::Test {
 protected:
  std::string Create(std::uint32_t time_index) {
    v1::CreateSessionRequest request;
    *request.mutable_scene() = SmallScene();
    request.mutable_scene()->set_storm_id("anvil");
    request.mutable_scene()->set_time_index(time_index);
    v1::CreateSessionResponse response;
    const grpc::Status status = Call(service_.stub(), &Stub::CreateSession, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.session_id();
  }

  void AddTime(const std::string& valid_time) {
    service_.store->Become("anvil", [&](storm_store::StormInfo& storm) {
      storm.times.push_back({valid_time, 0.0});
      std::ranges::sort(storm.times, {}, &storm_store::StormTime::valid_time);
    });
  }

  static std::uint32_t TimeOf(Interacting& person) {
    return person.AwaitNewest(Response::kScene).scene().scene().time_index();
  }

  static bool AwaitTime(Interacting& person, std::uint32_t time_index) {
    return person.Await([&](const Interacting::Messages& messages) {
      std::uint32_t shown = 0;
      for (const Response& message : messages) {
        if (message.has_scene()) shown = message.scene().scene().time_index();
      }
      return shown == time_index;
    });
  }

  FakeService service_;
};

TEST_F(ChangingCatalogue, MovesSessionsAndTellsThem) {
  Interacting newest(service_.stub(), Create(3));
  Interacting chosen(service_.stub(), Create(1));
  EXPECT_EQ(TimeOf(newest), 3U);
  EXPECT_EQ(TimeOf(chosen), 1U);
  AddTime("0001-01-01T02:00:00Z");
  EXPECT_TRUE(AwaitTime(newest, 4));
  EXPECT_TRUE(newest.AwaitNewest(Response::kCatalogueChanged).has_catalogue_changed());
  EXPECT_TRUE(chosen.AwaitNewest(Response::kCatalogueChanged).has_catalogue_changed());
  EXPECT_EQ(TimeOf(chosen), 1U);
  // Adding an earlier time moves every index.
  AddTime("0001-01-01T00:00:00Z");
  EXPECT_TRUE(AwaitTime(newest, 5));
  EXPECT_TRUE(AwaitTime(chosen, 2));
}

TEST_F(ChangingCatalogue, KeepsTheCameraOfWhoFollows) {
  Interacting person(service_.stub(), Create(3));
  const v1::Scene before = person.AwaitNewest(Response::kScene).scene().scene();
  AddTime("0001-01-01T02:00:00Z");
  ASSERT_TRUE(AwaitTime(person, 4));
  const v1::Scene after = person.AwaitNewest(Response::kScene).scene().scene();
  EXPECT_EQ(after.camera().SerializeAsString(), before.camera().SerializeAsString());
}

TEST_F(ChangingCatalogue, ATimeWhoseFileIsReplacedIsDrawnAgainWhereItIsShown) {
  Interacting there(service_.stub(), Create(1));
  const std::string key = Create(2);
  Interacting elsewhere(service_.stub(), key);
  const std::uint64_t before = there.AwaitNewest(Response::kFrame).frame().scene_revision();
  const std::uint64_t kept = elsewhere.AwaitNewest(Response::kFrame).frame().scene_revision();
  service_.store->Become("anvil", [](storm_store::StormInfo& storm) { ++storm.times[1].version; });
  EXPECT_TRUE(there.Await([&](const Interacting::Messages& messages) {
    return std::ranges::any_of(messages, [&](const Response& message) {
      return message.has_frame() && message.frame().scene_revision() > before;
    });
  }));
  EXPECT_EQ(TimeOf(there), 1U);
  // Viewers are notified after all affected scenes were changed. This scene was not changed, so its
  // next change has the next revision.
  EXPECT_TRUE(elsewhere.AwaitNewest(Response::kCatalogueChanged).has_catalogue_changed());
  EXPECT_EQ(elsewhere.AwaitNewest(Response::kScene).scene().scene_revision(), kept);
  EXPECT_EQ(service_.Update(key, SmallScene()), kept + 1);
}

TEST_F(ChangingCatalogue, TellsOnlyWhatIsNew) {
  AddTime("0001-01-01T02:00:00Z");
  Interacting late(service_.stub(), Create(0));
  late.AwaitNewest(Response::kScene);
  late.AwaitNewest(Response::kFrame);
  for (const Response& message : late.All()) EXPECT_FALSE(message.has_catalogue_changed());
}

TEST_F(ChangingCatalogue, DescribesWhichTimesAreDeleted) {
  service_.store->Become("anvil",
                         [](storm_store::StormInfo& storm) { storm.times[2].deleted = true; });
  v1::DescribeStormRequest request;
  request.set_storm_id("anvil");
  v1::DescribeStormResponse response;
  ASSERT_TRUE(Call(service_.stub(), &Stub::DescribeStorm, request, &response).ok());
  EXPECT_FALSE(response.storm().times(1).deleted());
  EXPECT_TRUE(response.storm().times(2).deleted());
}

}  // namespace
}  // namespace thunderhead::testing
