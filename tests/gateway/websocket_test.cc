// Tests of calls by WebSocket, from Beast's client on one side and from the handlers on the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/websocket_client.h"

namespace thunderhead::gateway::test {
namespace {

namespace http = boost::beast::http;
using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::WaitFor;

constexpr char kMessage = '\0';
constexpr char kHalfClose = '\1';
constexpr char kTrailers = '\x80';

std::string Request(const ConverseRequest& request) {
  return kMessage + request.SerializeAsString();
}

std::string Saying(const std::string& payload, uint32_t repeats = 0) {
  ConverseRequest request;
  request.set_payload(payload);
  request.set_repeats(repeats);
  return Request(request);
}

std::string ReadingNoMore(uint32_t repeats = 0, size_t payload_bytes = 0) {
  ConverseRequest request;
  request.set_payload(std::string(payload_bytes, 'x'));
  request.set_repeats(repeats);
  request.set_read_no_more(true);
  return Request(request);
}

std::string Ending(int code, const std::string& message, const std::string& details = "") {
  ConverseRequest request;
  request.mutable_end()->set_code(code);
  request.mutable_end()->set_message(message);
  request.mutable_end()->set_details(details);
  return Request(request);
}

std::string PayloadOf(const std::optional<std::string>& message) {
  if (!message.has_value()) return "the connection has ended";
  if (message->empty() || message->front() != kMessage) return "this is not a message";
  ConverseResponse response;
  EXPECT_TRUE(response.ParseFromString(message->substr(1)));
  return response.payload();
}

using TrailerMap = std::map<std::string, std::string>;

// Returns the trailers in the last message, which must follow `responses` others.
TrailerMap TrailersAfter(size_t responses, WebSocketClient& client) {
  const std::deque<std::string> messages = client.ReceiveAll();
  EXPECT_EQ(messages.size(), responses + 1);
  if (messages.empty() || messages.back().front() != kTrailers) return {{"trailers", "none"}};
  TrailerMap trailers;
  const std::string lines = messages.back().substr(1);
  for (size_t begin = 0; begin < lines.size();) {
    const size_t colon = lines.find(':', begin);
    const size_t end = lines.find("\r\n", begin);
    trailers[lines.substr(begin, colon - begin)] = lines.substr(colon + 1, end - colon - 1);
    begin = end + 2;
  }
  return trailers;
}

void Upgrade(RawClient& client) {
  const Response response = client.Ask("GET", "/thunderhead.gateway.test.Echo/Converse",
                                       {{"Connection", "Upgrade"},
                                        {"Upgrade", "websocket"},
                                        {"Sec-WebSocket-Version", "13"},
                                        {"Sec-WebSocket-Key", "AAAAAAAAAAAAAAAAAAAAAA=="},
                                        {"Sec-WebSocket-Protocol", "other, grpc-websocket.v1"}});
  EXPECT_EQ(response.result(), http::status::switching_protocols);
  EXPECT_EQ(response["Sec-WebSocket-Protocol"], "grpc-websocket.v1");
}

class WebSocketTest : public EchoTest {
 protected:
  bool AllCancelled(int calls) {
    return WaitFor([&] { return Record().cancelled == calls && Record().done == calls; });
  }
  bool CancelledWhileTimePasses(int calls) {
    return WaitWhileTimePasses(
        [&] { return Record().cancelled == calls && Record().done == calls; });
  }
  int SendUntilHeldBack(WebSocketClient& client, const std::string& message, int most) {
    return client.SendUntilHeldBack(message, most, [this] { LetOthersCall(); });
  }
};

TEST_F(WebSocketTest, MessagesGoBothWaysAtOnceAndInOrder) {
  constexpr int kMessages = 2000;
  const auto payload = [](int i) { return absl::StrCat(i, std::string(i % 3000, 'x')); };
  WebSocketClient client(Site().Port());
  for (int i = 0; i < kMessages; ++i) client.SendLater(Saying(payload(i)));
  client.SendLater(std::string(1, kHalfClose));
  for (int i = 0; i < kMessages; ++i) ASSERT_EQ(PayloadOf(client.Receive()), payload(i));
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "0");
}

TEST_F(WebSocketTest, AnswersComeBeforeTheHalfClose) {
  WebSocketClient client(Site().Port());
  for (const char* text : {"first", "second"}) {
    client.Send(Saying(text));
    EXPECT_EQ(PayloadOf(client.Receive()), text);
  }
  client.Send(std::string(1, kHalfClose));
  TrailerMap trailers = TrailersAfter(0, client);
  EXPECT_EQ(trailers["grpc-status"], "0");
  EXPECT_EQ(trailers["conversed"], "yes");
  EXPECT_EQ(trailers.count("grpc-message"), 0u);
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, EmptyMessagesAreMessages) {
  WebSocketClient client(Site().Port());
  client.Send(std::string(1, kMessage));
  EXPECT_EQ(client.Receive(), std::string(1, kMessage));
  client.Send(std::string(1, kHalfClose));
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "0");
}

TEST_F(WebSocketTest, LargeMessagesStayWhole) {
  std::string payload(1 << 20, '\0');
  for (size_t i = 0; i < payload.size(); ++i) payload[i] = static_cast<char>(i * 31 >> 3);
  WebSocketClient client(Site().Port());
  client.Send(Saying(payload, /*repeats=*/2));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(PayloadOf(client.Receive()) == payload) << i;
}

TEST_F(WebSocketTest, HalfCloseAloneIsACallWithoutMessages) {
  WebSocketClient client(Site().Port());
  client.Send(std::string(1, kHalfClose));
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "0");
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, OtherKindsOfCallsAreCarriedToo) {
  CountRequest request;
  request.set_count(3);
  WebSocketClient client(Site().Port(), {"Count", {}, 0});
  client.Send(kMessage + request.SerializeAsString());
  client.Send(std::string(1, kHalfClose));
  EXPECT_EQ(TrailersAfter(3, client)["grpc-status"], "0");
}

TEST_F(WebSocketTest, FailureArrivesWithDetailsAsTrailers) {
  WebSocketClient client(Site().Port());
  client.Send(Saying("before"));
  client.Send(Ending(5, "no storm\n100%", "\x08\x05"));
  TrailerMap trailers = TrailersAfter(1, client);
  EXPECT_EQ(trailers["grpc-status"], "5");
  EXPECT_EQ(trailers["grpc-message"], "no storm%0A100%25");
  EXPECT_EQ(trailers["grpc-status-details-bin"], "CAU");
  EXPECT_EQ(trailers["conversed"], "yes");
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, ServerMayEndWhileTheClientStillSends) {
  WebSocketClient client(Site().Port());
  client.SendLater(Ending(9, "enough"));
  for (int i = 0; i < 100; ++i) client.SendLater(Saying(std::string(10'000, 'x')));
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "9");
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, UnknownMethodsAreUnimplemented) {
  WebSocketClient client(Site().Port(), {"Sing", {}, 0});
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "12");
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, ATokenBesideTheSubprotocolIsAuthorization) {
  WebSocketClient client(Site().Port(),
                         {"Metadata",
                          {{"Sec-WebSocket-Protocol", "grpc-websocket.v1, bearer.YW5uYT8_Pg"},
                           {"X-Forwarded-For", "192.0.2.7"}},
                          0});
  client.Send(std::string(1, kMessage));
  client.Send(std::string(1, kHalfClose));
  MetadataResponse response;
  ASSERT_TRUE(response.ParseFromString(client.Receive().value_or(" ").substr(1)));
  std::map<std::string, std::string> metadata;
  for (const auto& entry : response.entries()) {
    EXPECT_FALSE(metadata.contains(entry.name())) << entry.name();
    metadata[entry.name()] = entry.value();
  }
  EXPECT_EQ(metadata["authorization"],
            "Bearer anna?"
            "?>");
  // The client's own claim about its address is not passed on.
  EXPECT_THAT(metadata["x-forwarded-for"], ::testing::StartsWith("127.0.0.1:"));
}

TEST(WebSocketBehindAProxy, ItsClientIsWhomTheProxyNames) {
  GatewayOptions options;
  options.trusted_proxies = *base::TrustedProxies::Parse({"127.0.0.1"});
  const auto site = EchoSite::Start(options);
  WebSocketClient client(site->Port(),
                         {"Metadata", {{"X-Forwarded-For", "203.0.113.9, 192.0.2.7"}}, 0});
  client.Send(std::string(1, kMessage));
  client.Send(std::string(1, kHalfClose));
  MetadataResponse response;
  ASSERT_TRUE(response.ParseFromString(client.Receive().value_or(" ").substr(1)));
  std::vector<std::string> clients;
  for (const auto& entry : response.entries()) {
    if (entry.name() == "x-forwarded-for") clients.push_back(entry.value());
  }
  EXPECT_THAT(clients, ::testing::ElementsAre("192.0.2.7:0"));
}

TEST_F(WebSocketTest, HeadersOfOtherProgramsAreMetadata) {
  WebSocketClient client(
      Site().Port(), {"Metadata", {{"Echo-Text", "some text"}, {"Cookie", "other=program"}}, 0});
  client.Send(std::string(1, kMessage));
  client.Send(std::string(1, kHalfClose));
  const std::optional<std::string> message = client.Receive();
  ASSERT_TRUE(message.has_value());
  MetadataResponse response;
  ASSERT_TRUE(response.ParseFromString(message->substr(1)));
  std::map<std::string, std::string> seen;
  for (const Entry& entry : response.entries()) seen[entry.name()] = entry.value();
  EXPECT_EQ(seen["echo-text"], "some text");
  EXPECT_EQ(seen.count("cookie"), 0u);
  EXPECT_EQ(TrailersAfter(0, client)["trailing-echo-text"], "some text");
}

TEST_F(WebSocketTest, DeadlinesEndCalls) {
  WebSocketClient client(Site().Port(), {"Converse", {{"grpc-timeout", "200m"}}, 0});
  EXPECT_EQ(TrailersAfter(0, client)["grpc-status"], "4");
}

TEST_F(WebSocketTest, ClosingCancelsTheCall) {
  DriveTime();  // no timeout ends it
  WebSocketClient client(Site().Port());
  client.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(client.Receive()), "hello");
  client.Close();
  EXPECT_TRUE(AllCancelled(1));
  EXPECT_EQ(client.CloseCode(), 1000);
}

TEST_F(WebSocketTest, VanishingCancelsTheCall) {
  DriveTime();  // no timeout ends it
  WebSocketClient client(Site().Port());
  client.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(client.Receive()), "hello");
  client.Vanish();
  EXPECT_TRUE(AllCancelled(1));
}

TEST_F(WebSocketTest, VanishingIsNoticedWhileTheServerReadsNothing) {
  // The end of the connection is behind messages that are not read, so only a ping detects it.
  DriveTime();
  options_.websocket_ping_interval = seconds(15);
  WebSocketClient client(Site().Port());
  client.Send(ReadingNoMore());
  ASSERT_EQ(PayloadOf(client.Receive()), "");
  SendUntilHeldBack(client, Saying(std::string(10'000, 'x')), 3000);
  client.Vanish();
  EXPECT_TRUE(CancelledWhileTimePasses(1));
}

TEST_F(WebSocketTest, VanishingBehindFewMessagesNeedsNoPing) {
  DriveTime();  // no timeout ends it
  WebSocketClient client(Site().Port());
  client.Send(ReadingNoMore());
  ASSERT_EQ(PayloadOf(client.Receive()), "");
  // These are fewer bytes than the kernel buffers for a connection that is not read, so the end
  // arrives behind them.
  SendUntilHeldBack(client, Saying(std::string(10'000, 'x')), 5);
  client.Vanish();
  EXPECT_TRUE(AllCancelled(1));
}

TEST_F(WebSocketTest, TooLargeMessagesAreRefused) {
  options_.max_message_bytes = 1000;
  WebSocketClient client(Site().Port());
  client.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(client.Receive()), "hello");
  client.Send(kMessage + std::string(1001, 'x'));
  EXPECT_EQ(client.CloseCode(), 1009);
  EXPECT_TRUE(AllCancelled(1));
  ConverseRequest request;
  request.set_payload(std::string(997, 'x'));
  ASSERT_EQ(request.ByteSizeLong(), 1000u);
  WebSocketClient other(Site().Port());
  other.Send(Request(request));
  EXPECT_EQ(PayloadOf(other.Receive()), request.payload());
}

TEST_F(WebSocketTest, TooLargeMessageStillBeingSentIsRefused) {
  options_.max_message_bytes = 1000;
  WebSocketClient client(Site().Port());
  client.SendLater(kMessage + std::string(20'000'000, 'x'));
  EXPECT_EQ(client.CloseCode(), 1009);
}

// The client has five seconds to finish sending.
TEST_F(WebSocketTest, WhoNeverStopsSendingWhatIsTooLargeIsCutOff) {
  DriveTime();
  options_.max_message_bytes = 1000;
  RawClient client(Site().Port());
  Upgrade(client);
  ASSERT_TRUE(WaitFor([&] { return Record().started == 1; }));
  // The bytes are the head of a masked binary frame of 2^40 bytes.
  client.Send(std::string("\x82\xff\x00\x00\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00", 14) +
              kMessage);
  EXPECT_TRUE(AllCancelled(1));
  const auto begin = time_.Now();
  const std::string more(64 << 10, 'x');
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(client.SendUntilClosed(more));
  EXPECT_TRUE(WaitWhileTimePasses([&] { return !client.SendUntilClosed(more); }));
  EXPECT_GE(Since(begin), seconds(5));
}

TEST_F(WebSocketTest, BrokenRulesCloseWithTheirCode) {
  const auto code_after = [&](const std::string& message) {
    WebSocketClient client(Site().Port());
    client.Send(message);
    EXPECT_NE(client.CloseText(), "") << message.size();
    return client.CloseCode();
  };
  WebSocketClient texter(Site().Port());
  texter.SendText(std::string(1, kMessage) + "text");
  EXPECT_EQ(texter.CloseCode(), 1003);
  EXPECT_EQ(code_after(""), 1008);
  EXPECT_EQ(code_after("\x02"), 1008);
  EXPECT_EQ(code_after("\x80"), 1008);
  EXPECT_EQ(code_after("\x01with payload"), 1008);
  WebSocketClient talker(Site().Port(), {"Wait", {}, 0});
  talker.Send(std::string(1, kMessage));
  talker.Send(std::string(1, kHalfClose));
  talker.Send(std::string(1, kMessage));
  EXPECT_EQ(talker.CloseCode(), 1008);
  EXPECT_TRUE(WaitFor([&] { return Record().done == Record().started; }));
}

// These clients neither read nor close anything afterwards.
TEST_F(WebSocketTest, BrokenFramesAndCloseFramesEndTheCall) {
  DriveTime();  // no timeout ends it
  // Client frames must be masked, so the first is answered with 1002, a protocol error. A close
  // frame is answered with 1000.
  const std::pair<std::string, std::string> last_words[] = {{{"\x82\x01\x00", 3}, "\x03\xea"},
                                                            {{"\x88\x80\0\0\0\0", 6}, "\x03\xe8"}};
  for (const auto& [bytes, answer] : last_words) {
    RawClient client(Site().Port());
    Upgrade(client);
    const int before = Record().cancelled;
    ASSERT_TRUE(WaitFor([&] { return Record().started == before + 1; }));
    client.Send(bytes);
    EXPECT_TRUE(WaitFor([&] { return Record().cancelled == before + 1; }));
    const std::string closing = client.ReadToEnd();
    EXPECT_EQ(closing.substr(0, 1), "\x88");
    EXPECT_THAT(closing, HasSubstr(answer));
  }
}

// RFC 6455, 7.4.2, ends the range of close codes at 4999. Each of these is answered with 1002.
TEST_F(WebSocketTest, ForbiddenCloseCodesAreProtocolErrors) {
  DriveTime();  // no timeout ends it
  const auto answer_to = [&](int code) {
    RawClient client(Site().Port());
    Upgrade(client);
    // The mask differs in each byte, and 'x' is the first byte of a reason.
    std::string frame = "\x88\x83\x11\x22\x33\x44";
    frame += {static_cast<char>((code >> 8) ^ 0x11), static_cast<char>((code & 0xff) ^ 0x22),
              static_cast<char>('x' ^ 0x33)};
    client.Send(frame);
    const std::string closing = client.ReadToEnd();
    if (closing.size() < 4 || closing.front() != '\x88') return -1;
    return static_cast<unsigned char>(closing[2]) * 256 + static_cast<unsigned char>(closing[3]);
  };
  for (const int allowed : {1000, 1001, 1011, 3000, 4999}) EXPECT_EQ(answer_to(allowed), allowed);
  for (const int forbidden : {0, 999, 1004, 1005, 1006, 1015, 2999, 5000, 32768, 65535}) {
    EXPECT_EQ(answer_to(forbidden), 1002) << forbidden;
  }
}

// Returns a masked client frame of at most 125 bytes.
std::string ClientFrame(const std::string& payload) {
  return std::string("\x82") + static_cast<char>(0x80 | payload.size()) + std::string(4, '\0') +
         payload;
}

// Beast 1.74 never ends a read that finds a broken frame while a close frame is being written. The
// close that waits for the read does not end either. Such a connection would stay open, and keep
// the gateway from stopping. This happened in one of sixty of these connections.
TEST_F(WebSocketTest, ABrokenFrameBesideTheGatewaysCloseFrameEndsTheConnection) {
  DriveTime();  // no timeout ends it
  constexpr int kConnections = 1000;
  for (int i = 0; i < kConnections; ++i) {
    RawClient client(Site().Port());
    Upgrade(client);
    client.Send(ClientFrame(Ending(0, "")));
    // The answer, and with it the close frame, is pending. The sleep does not wait for anything; it
    // only varies the moment at which the broken frame arrives.
    std::this_thread::sleep_for(std::chrono::microseconds(i % 500));
    client.SendUntilClosed(std::string("\x82\x01\x00", 3));
    client.ShutdownSending();
    ASSERT_TRUE(client.IsEnded()) << i;
  }
}

class UpgradeTest : public EchoTest {
 protected:
  Response Upgrade(const Headers& headers, const std::string& path = "Converse",
                   const std::string& subprotocol = "grpc-websocket.v1") {
    Headers all = headers;
    all.insert(all.end(), {{"Connection", "Upgrade"},
                           {"Upgrade", "websocket"},
                           {"Sec-WebSocket-Version", "13"},
                           {"Sec-WebSocket-Key", "AAAAAAAAAAAAAAAAAAAAAA=="}});
    if (!subprotocol.empty()) all.emplace_back("Sec-WebSocket-Protocol", subprotocol);
    return RawClient(Site().Port())
        .Ask("GET", absl::StrCat("/thunderhead.gateway.test.Echo/", path), all);
  }
};

TEST_F(UpgradeTest, OnlyTheOwnAndAllowedOriginsMayCall) {
  options_.allowed_origins = {"http://localhost:5173"};
  const auto result = [&](const std::string& origin) {
    return Upgrade({{"Host", "localhost:8080"}, {"Origin", origin}}).result();
  };
  for (const char* own :
       {"http://localhost:8080", "https://localhost:8080", "http://LOCALHOST:8080"}) {
    EXPECT_EQ(result(own), http::status::switching_protocols) << own;
  }
  EXPECT_EQ(result("http://localhost:5173"), http::status::switching_protocols);
  for (const char* foreign :
       {"http://localhost", "http://localhost:8081", "http://evil.example", "null", "file://",
        "http://localhost:8080.evil.example", "ftp://localhost:8080", "localhost:8080"}) {
    EXPECT_EQ(result(foreign), http::status::forbidden) << foreign;
  }
}

TEST_F(UpgradeTest, ForeignHostsAreRefused) {
  EXPECT_EQ(Upgrade({{"Host", "evil.example"}, {"Origin", "http://evil.example"}}).result(),
            http::status::forbidden);
}

TEST_F(UpgradeTest, TheSubprotocolMustBeOffered) {
  for (const char* other : {"", "grpc-websocket.v2", "grpc-websocket.v1x"}) {
    const Response response = Upgrade({}, "Converse", other);
    EXPECT_EQ(response.result(), http::status::bad_request) << other;
    EXPECT_THAT(response.body(), HasSubstr("Sec-WebSocket-Protocol: grpc-websocket.v1"));
  }
  EXPECT_EQ(Upgrade({}, "Converse", "a, grpc-websocket.v1")["Sec-WebSocket-Protocol"],
            "grpc-websocket.v1");
}

TEST_F(UpgradeTest, OneKeyOfSixteenBytesIsNeeded) {
  const auto answer_to = [&](const std::vector<std::string>& keys) {
    Headers headers = {{"Connection", "Upgrade"},
                       {"Upgrade", "websocket"},
                       {"Sec-WebSocket-Version", "13"},
                       {"Sec-WebSocket-Protocol", "grpc-websocket.v1"}};
    for (const std::string& key : keys) headers.emplace_back("Sec-WebSocket-Key", key);
    return RawClient(Site().Port()).Ask("GET", "/thunderhead.gateway.test.Echo/Converse", headers);
  };
  const std::string key = "dGhlIHNhbXBsZSBub25jZQ==";  // that of RFC 6455, 1.3
  EXPECT_EQ(answer_to({key})["Sec-WebSocket-Accept"], "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{},
                                             {""},
                                             {"abc"},
                                             {key, key},
                                             {key + "AAAA"},
                                             {"dGhlIHNhbXBsZSBub25jZQ"},
                                             {"dGhlIHNhbXBsZSBub25jZWQ="},
                                             {"dGhlIHNhbXBsZSBub25jZ!=="},
                                             {"dGhlIHNhbXBs ZSBub25jZ=="}}) {
    const Response response = answer_to(wrong);
    EXPECT_EQ(response.result(), http::status::bad_request) << ::testing::PrintToString(wrong);
    EXPECT_THAT(response.body(), HasSubstr("Sec-WebSocket-Key")) << ::testing::PrintToString(wrong);
  }
}

TEST_F(UpgradeTest, OtherRequestsHaveTheirUsualAnswers) {
  EXPECT_EQ(Upgrade({}, "Say/More").result(), http::status::not_found);
  EXPECT_EQ(Upgrade({{"Content-Length", "1"}}).result(), http::status::method_not_allowed);
  EXPECT_EQ(Upgrade({{"x-bin", "*"}}).result(), http::status::bad_request);
  EXPECT_EQ(RawClient(Site().Port())
                .Ask("GET", "/thunderhead.gateway.test.Echo/Converse", {{"Upgrade", "websocket"}})
                .result(),
            http::status::method_not_allowed);
}

TEST_F(UpgradeTest, NothingMayBeSentBeforeTheAnswer) {
  RawClient client(Site().Port());
  client.Send(
      "GET /thunderhead.gateway.test.Echo/Converse HTTP/1.1\r\nHost: localhost\r\n"
      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
      "Sec-WebSocket-Protocol: grpc-websocket.v1\r\n\r\nearly");
  EXPECT_EQ(client.Read().result(), http::status::bad_request);
}

TEST_F(WebSocketTest, SlowReaderHoldsTheHandlerBack) {
  WebSocketClient client(Site().Port(), {"Converse", {}, /*receive_buffer_bytes=*/16 << 10});
  client.Send(ReadingNoMore(/*repeats=*/2000, /*payload_bytes=*/100'000));
  AwaitHandlersHeldBack();
  // Only a part of the 200 MB may be written. The limit allows for what the kernel buffers for a
  // client that reads nothing (tcp_wmem: mostly 4 MB, 42 messages). It also allows for gRPC's
  // windows, which grow with speed (24 messages were seen).
  EXPECT_LT(Record().written, 100);
  // The call continues when the client does.
  for (int i = 0; i < 200; ++i) ASSERT_EQ(PayloadOf(client.Receive()).size(), 100'000u);
  EXPECT_GE(Record().written, 190);
}

TEST_F(WebSocketTest, SlowHandlerHoldsTheClientBack) {
  WebSocketClient client(Site().Port());
  client.Send(ReadingNoMore());
  ASSERT_EQ(PayloadOf(client.Receive()), "");
  // Only a part of the 300 MB may be accepted: what the kernel's buffers, gRPC's windows and the
  // gateway's one message hold.
  EXPECT_LT(SendUntilHeldBack(client, Saying(std::string(100'000, 'x')), 3000), 150);
  EXPECT_EQ(Record().read, 1);
}

TEST_F(WebSocketTest, ClientHeldBackIsNotTakenForSilent) {
  DriveTime();
  options_.websocket_ping_interval = seconds(15);
  WebSocketClient client(Site().Port());
  client.Send(ReadingNoMore());
  ASSERT_EQ(PayloadOf(client.Receive()), "");
  SendUntilHeldBack(client, Saying(std::string(100'000, 'x')), 3000);
  // The client's kernel acknowledges the pings. A further ping shows that the previous ping did not
  // count as unanswered.
  for (int ping = 0; ping < 4; ++ping) {
    const int before = client.UnreadBytes();
    time_.Advance(seconds(15));
    ASSERT_TRUE(WaitFor([&] { return client.UnreadBytes() > before || Record().cancelled > 0; }));
    ASSERT_TRUE(WaitFor([&] { return client.HasAcknowledged(); }));
    ASSERT_TRUE(time_.AwaitLooks());
  }
  EXPECT_EQ(Record().cancelled, 0);
}

TEST_F(WebSocketTest, ReaderThatTakesNothingIsCut) {
  DriveTime();
  options_.write_stall_timeout = seconds(20);
  WebSocketClient client(Site().Port(), {"Converse", {}, /*receive_buffer_bytes=*/16 << 10});
  client.Send(ReadingNoMore(/*repeats=*/2000, /*payload_bytes=*/100'000));
  // A slow reader keeps its connection. In each round it reads more bytes than the buffers hold, so
  // the gateway must have written some of them since the time was advanced.
  for (int round = 0; round < 3; ++round) {
    time_.Advance(seconds(15));
    for (int i = 0; i < 200; ++i) ASSERT_EQ(PayloadOf(client.Receive()).size(), 100'000u);
    EXPECT_TRUE(time_.AwaitLooks());
  }
  EXPECT_EQ(Record().cancelled, 0);
  EXPECT_TRUE(CancelledWhileTimePasses(1));
  EXPECT_TRUE(client.IsCut());
}

TEST_F(WebSocketTest, PeerThatAnswersNoPingsIsDropped) {
  DriveTime();
  options_.websocket_ping_interval = seconds(15);
  WebSocketClient client(Site().Port());
  client.Send(Saying("hello"));
  ASSERT_TRUE(WaitFor([&] { return client.UnreadBytes() > 0; }));
  EXPECT_TRUE(time_.AwaitLooks());
  const auto begin = time_.Now();
  EXPECT_TRUE(CancelledWhileTimePasses(1));
  EXPECT_GE(Since(begin), seconds(30)) << "a ping, and the time to answer it";
  EXPECT_TRUE(client.IsCut());
}

TEST_F(WebSocketTest, WhoSaysNothingAtFirstIsClosed) {
  DriveTime();
  options_.header_timeout = seconds(10);
  WebSocketClient talks(Site().Port());
  talks.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(talks.Receive()), "hello");
  const auto begin = time_.Now();
  WebSocketClient silent(Site().Port());
  EXPECT_TRUE(WaitWhileTimePasses([&] { return silent.UnreadBytes() > 0; }));
  EXPECT_EQ(silent.CloseCode(), 1008);
  EXPECT_GE(Since(begin), seconds(10));
  talks.Send(Saying("again"));
  EXPECT_EQ(PayloadOf(talks.Receive()), "again");
}

TEST_F(WebSocketTest, QuietPeerThatAnswersPingsStays) {
  DriveTime();
  options_.websocket_ping_interval = seconds(15);
  options_.idle_timeout = seconds(15);
  options_.write_stall_timeout = seconds(15);
  WebSocketClient client(Site().Port(), {"Count", {}, 0});
  CountRequest request;
  request.set_count(1);
  request.set_hold_after(0);
  client.Send(kMessage + request.SerializeAsString());
  ASSERT_TRUE(WaitFor([&] { return Record().started == 1; }));
  // The client reads, and therefore answers pings, for ten times as long as the timeouts.
  std::thread reading([&] { EXPECT_EQ(TrailersAfter(1, client)["grpc-status"], "0"); });
  for (int ping = 1; ping <= 10; ++ping) {
    EXPECT_TRUE(time_.AwaitLooks());
    time_.Advance(seconds(15));
    EXPECT_TRUE(WaitFor([&] { return client.PingsAnswered() == ping || Record().cancelled > 0; }));
  }
  EXPECT_EQ(Record().cancelled, 0);
  Site().Release();
  reading.join();
}

TEST_F(WebSocketTest, ClientThatNeverAnswersTheCloseIsCut) {
  DriveTime();
  WebSocketClient client(Site().Port());
  client.Send(Ending(0, ""));
  ASSERT_TRUE(WaitFor([&] { return Record().done == 1; }));
  EXPECT_TRUE(time_.AwaitLooks());
  const auto begin = time_.Now();
  EXPECT_TRUE(WaitWhileTimePasses([&] { return client.HasHungUp(); }));
  EXPECT_GE(Since(begin), seconds(5)) << "it has time to answer";
  EXPECT_TRUE(client.IsCut());
}

TEST_F(WebSocketTest, StoppingTheGatewayClosesWithGoingAway) {
  DriveTime();
  WebSocketClient polite(Site().Port());
  WebSocketClient rude(Site().Port());
  WebSocketClient stalled(Site().Port(), {"Converse", {}, /*receive_buffer_bytes=*/16 << 10});
  polite.Send(Saying("hello"));
  rude.Send(Saying("hello"));
  stalled.Send(ReadingNoMore(/*repeats=*/2000, /*payload_bytes=*/100'000));
  ASSERT_TRUE(WaitFor([&] { return Record().started == 3 && Record().written > 2; }));
  std::atomic<bool> is_stopped{false};
  std::thread stop([&] {
    Site().StopGateway();
    is_stopped = true;
  });
  EXPECT_EQ(polite.CloseCode(), 1001);
  // The other clients have a second to answer.
  const auto begin = time_.Now();
  EXPECT_FALSE(is_stopped);
  EXPECT_TRUE(WaitWhileTimePasses([&] { return is_stopped.load(); }));
  EXPECT_GE(Since(begin), seconds(1));
  stop.join();
  EXPECT_TRUE(rude.IsCut());
  EXPECT_TRUE(AllCancelled(3));
}

TEST_F(WebSocketTest, StoppingTheServerEndsCallsWithTrailers) {
  WebSocketClient client(Site().Port());
  client.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(client.Receive()), "hello");
  std::thread stop([&] { Site().StopServer(); });
  const std::string status = TrailersAfter(0, client)["grpc-status"];
  EXPECT_TRUE(status == "1" || status == "14") << status;
  EXPECT_EQ(client.CloseCode(), 1000);
  stop.join();
}

TEST_F(WebSocketTest, ConnectionsBeyondTheMaximumAreRefused) {
  options_.max_connections = 1;
  WebSocketClient first(Site().Port());
  first.Send(Saying("hello"));
  EXPECT_EQ(PayloadOf(first.Receive()), "hello");
  EXPECT_ANY_THROW(WebSocketClient(Site().Port()));
  first.Close();
  EXPECT_TRUE(AllCancelled(1));
  EXPECT_TRUE(WaitFor([&] {
    try {
      const WebSocketClient again(Site().Port());
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }));
}

TEST_F(WebSocketTest, HundredClientsAtOnceOneOfThemStopped) {
  constexpr int kClients = 100;
  constexpr int kRounds = 20;
  WebSocketClient stopped(Site().Port(), {"Converse", {}, /*receive_buffer_bytes=*/16 << 10});
  stopped.Send(ReadingNoMore(/*repeats=*/2000, /*payload_bytes=*/100'000));
  std::vector<std::unique_ptr<WebSocketClient>> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.push_back(std::make_unique<WebSocketClient>(Site().Port()));
  }
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < kClients; ++i) {
      clients[i]->Send(Saying(absl::StrCat(i, ":", round, std::string(5000, 'x'))));
    }
    for (int i = 0; i < kClients; ++i) {
      EXPECT_THAT(PayloadOf(clients[i]->Receive()),
                  ::testing::StartsWith(absl::StrCat(i, ":", round, "x")));
    }
  }
  for (int i = 0; i < kClients; ++i) {
    if (i % 2 == 0) {
      clients[i]->Send(std::string(1, kHalfClose));
      EXPECT_EQ(clients[i]->CloseCode(), 1000);
    } else {
      clients[i]->Vanish();
    }
  }
  EXPECT_TRUE(WaitFor([&] { return Record().done == kClients; }));
}

TEST_F(WebSocketTest, ClientsThatComeAndGoAtAnyMoment) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([port = Site().Port(), t] {
      for (int round = 0; round < 25; ++round) {
        WebSocketClient client(port);
        if ((round + t) % 5 == 0) continue;
        client.Send(Saying(std::string(20'000, 'x'), /*repeats=*/50));
        if ((round + t) % 5 == 1) continue;
        client.Receive();
        if ((round + t) % 5 == 2) client.Send(std::string("\x07", 1));
        if ((round + t) % 5 == 3) client.Close();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(WaitFor([&] { return Record().done == Record().started; }));
}

}  // namespace
}  // namespace thunderhead::gateway::test
