// Tests of the catalogue against the fake service.
#include "thunderhead_client/catalogue.h"

#include <atomic>
#include <future>
#include <string>

#include "client-cpp/tests/fake_service.h"
#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::client::testing {
namespace {

TEST(CatalogueTest, ADescriptionThatABusyServerRefusedIsRequestedAgain) {
  std::atomic<int> requests = 0;
  FakeService service;
  service.answer_description = [&](const auto& request, auto& response) {
    if (++requests == 1) return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "busy");
    response.mutable_storm()->set_id(request.storm_id());
    return grpc::Status::OK;
  };
  Catalogue catalogue(service.Connect(), [] {});
  catalogue.Describe("moore", 2);
  EXPECT_TRUE(
      thunderhead::testing::WaitFor([&] { return catalogue.State().storm.id() == "moore"; }));
  EXPECT_EQ(requests, 2);
}

TEST(CatalogueTest, TheLastStormThatWasChosenIsDescribed) {
  std::promise<void> others_chosen;
  std::atomic<int> requests = 0;
  FakeService service;
  service.answer_description = [&](const auto& request, auto& response) {
    if (++requests == 1) others_chosen.get_future().wait();
    response.mutable_storm()->set_id(request.storm_id() + (requests == 1 ? "" : " again"));
    return grpc::Status::OK;
  };
  Catalogue catalogue(service.Connect(), [] {});
  catalogue.Describe("moore", 0);
  ASSERT_TRUE(thunderhead::testing::WaitFor([&] { return requests == 1; }));
  // While the first storm is being described, a viewer chooses another one and comes back.
  catalogue.Describe("joplin", 0);
  catalogue.Describe("moore", 0);
  others_chosen.set_value();
  ASSERT_TRUE(thunderhead::testing::WaitFor([&] { return requests == 2; }));
  EXPECT_TRUE(thunderhead::testing::WaitFor(
      [&] { return catalogue.State().storm.id().ends_with(" again"); }));
  EXPECT_EQ(catalogue.State().storm.id(), "moore again");
}

TEST(CatalogueTest, AnUnknownStormIsRequestedOnceUntilTheCatalogueChanges) {
  std::atomic<int> unknown = 0;
  FakeService service;
  service.answer_description = [&](const auto& request, auto& response) {
    if (request.storm_id() == "gone") {
      ++unknown;
      return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such storm");
    }
    response.mutable_storm()->set_id(request.storm_id());
    return grpc::Status::OK;
  };
  Catalogue catalogue(service.Connect(), [] {});
  catalogue.Describe("gone", 0);
  ASSERT_TRUE(thunderhead::testing::WaitFor([&] { return unknown == 1; }));
  // The catalogue makes its requests one after the other. If it repeated the request for "gone",
  // the server would get that request before the one for "moore".
  catalogue.Describe("moore", 0);
  ASSERT_TRUE(
      thunderhead::testing::WaitFor([&] { return catalogue.State().storm.id() == "moore"; }));
  EXPECT_EQ(unknown, 1);
}

}  // namespace
}  // namespace thunderhead::client::testing
