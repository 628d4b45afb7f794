// Tests that the listener is notified of requests that the gateway refuses before there is a call.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>
#include <string>
#include <vector>

#include "base/error_details.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/websocket_client.h"

namespace thunderhead::gateway::test {
namespace {

namespace http = boost::beast::http;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class RefusalsTest : public EchoTest {
 protected:
  RefusalsTest() {
    options_.on_refusal = [this](const GatewayRefusal& refusal) {
      const std::lock_guard lock(mutex_);
      told_.push_back(refusal.act + " " + base::DetailsOf(refusal.why).reason);
      peers_.push_back(refusal.peer);
    };
  }
  // Stops the gateway, because its thread reports refusals.
  ~RefusalsTest() override {
    if (started_) Site().StopGateway();
  }

  uint16_t Port() {
    started_ = true;
    return Site().Port();
  }
  http::status Ask(const std::string& method, const std::string& target, const Headers& headers,
                   const std::string& body = "") {
    return RawClient(Port()).Ask(method, target, headers, body).result();
  }
  std::vector<std::string> Told() {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  std::vector<std::string> Peers() {
    const std::lock_guard lock(mutex_);
    return peers_;
  }

  const std::string say_ = "/thunderhead.gateway.test.Echo/Say";

 private:
  bool started_ = false;
  std::mutex mutex_;
  std::vector<std::string> told_;
  std::vector<std::string> peers_;
};

TEST_F(RefusalsTest, ForeignHostsAndOriginsAreTold) {
  EXPECT_EQ(Ask("GET", "/", {{"Host", "evil.example"}}), http::status::forbidden);
  EXPECT_EQ(Ask("OPTIONS", say_, {{"Origin", "http://evil.example"}}), http::status::forbidden);
  WebSocketClient::Options foreign;
  foreign.headers = {{"Origin", "http://evil.example"}};
  EXPECT_ANY_THROW(WebSocketClient(Port(), foreign));
  EXPECT_THAT(Told(), ElementsAre("Request HOST_NOT_ALLOWED", "Preflight ORIGIN_NOT_ALLOWED",
                                  "WebSocket ORIGIN_NOT_ALLOWED"));
  for (const std::string& peer : Peers()) EXPECT_THAT(peer, StartsWith("127.0.0.1:"));
}

TEST_F(RefusalsTest, WhatIsTooLargeIsTold) {
  options_.max_message_bytes = 1000;
  EXPECT_EQ(
      Ask("POST", say_, {{"Content-Type", "application/grpc-web"}}, Frame(std::string(1001, 'x'))),
      http::status::ok)
      << "the refusal is in the trailers";
  WebSocketClient client(Port());
  client.Send(std::string(2000, '\0'));
  EXPECT_EQ(client.CloseCode(), 1009);
  RawClient endless(Port());
  endless.Send("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'x'));
  EXPECT_EQ(endless.Read().result(), http::status::request_header_fields_too_large);
  EXPECT_TRUE(testing::WaitFor([&] { return Told().size() == 3; }));
  EXPECT_THAT(Told(), ElementsAre("Message MESSAGE_TOO_LARGE", "Message MESSAGE_TOO_LARGE",
                                  "Request HEADER_TOO_LARGE"));
}

TEST_F(RefusalsTest, AConnectionWithoutRoomIsTold) {
  options_.max_connections = 1;
  WebSocketClient calling(Port());
  calling.Send(std::string("\0\x0a\x05storm", 8));
  EXPECT_TRUE(calling.Receive().has_value());
  EXPECT_TRUE(RawClient(Port()).IsClosed());
  EXPECT_THAT(Told(), ElementsAre("Connect TOO_MANY_CONNECTIONS"));
  calling.Vanish();
}

TEST_F(RefusalsTest, ATrustedProxySaysWhoItWas) {
  options_.trusted_proxies = base::TrustedProxies::Parse({"127.0.0.1"}).value();
  Ask("GET", "/", {{"Host", "evil.example"}, {"X-Forwarded-For", "198.51.100.9"}});
  EXPECT_THAT(Peers(), ElementsAre("198.51.100.9:0"));
}

TEST_F(RefusalsTest, MistakesAreNotTold) {
  EXPECT_EQ(Ask("GET", "/nothing", {}), http::status::not_found);
  EXPECT_EQ(Ask("PUT", "/", {}), http::status::method_not_allowed);
  EXPECT_EQ(Ask("POST", say_, {{"Content-Type", "text/plain"}}),
            http::status::unsupported_media_type);
  RawClient nonsense(Port());
  nonsense.Send("storm\r\n\r\n");
  EXPECT_EQ(nonsense.Read().result(), http::status::bad_request);
  EXPECT_THAT(Told(), IsEmpty());
}

}  // namespace
}  // namespace thunderhead::gateway::test
