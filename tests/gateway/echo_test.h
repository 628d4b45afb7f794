// A fixture with a gateway to the test service, which starts when a test first uses it.
#pragma once

#include <chrono>
#include <memory>

#include "gtest/gtest.h"
#include "tests/gateway/echo_service.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/watched_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::gateway::test {

class EchoTest : public ::testing::Test {
 protected:
  // Sets the timeouts so long that none expires in a test, however slow the machine is. A failing
  // test that lets time pass does not reach them either. A test of a timeout sets it, and usually
  // controls it by time_.
  EchoTest() {
    constexpr std::chrono::hours kNever{24 * 30};
    options_.idle_timeout = kNever;
    options_.header_timeout = kNever;
    options_.file_timeout = kNever;
    options_.write_stall_timeout = kNever;
    options_.websocket_ping_interval = kNever;
  }

  EchoSite& Site() {
    if (site_ == nullptr) site_ = EchoSite::Start(options_);
    return *site_;
  }
  EchoRecord& Record() { return Site().Record(); }

  // Makes the gateway's timeouts use time_.
  void DriveTime() { options_.time = &time_; }
  // Lets time pass until `condition()` is true.
  template <typename Condition>
  bool WaitWhileTimePasses(Condition condition) {
    return testing::WaitFor([&] {
      time_.Advance(std::chrono::seconds(1));
      return condition();
    });
  }
  WatchedTime::Clock::duration Since(WatchedTime::Clock::time_point begin) const {
    return time_.Now() - begin;
  }

  // Returns when the gateway and the server have handled another client's call.
  void LetOthersCall() { EXPECT_EQ(Call(Site().Port(), "Say", "").Trailer("grpc-status"), "0"); }
  // Waits until handlers write no further responses, however many other calls are handled.
  void AwaitHandlersHeldBack() {
    constexpr int kCalls = 50;
    int before = -1;
    while (before != Record().written) {
      before = Record().written;
      for (int i = 0; i < kCalls; ++i) LetOthersCall();
    }
  }

  WatchedTime time_;
  GatewayOptions options_;
  std::unique_ptr<EchoSite> site_;
};

}  // namespace thunderhead::gateway::test
