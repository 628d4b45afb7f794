// Tests of the gRPC-Web bridge, from raw bytes on one side and from the handlers on the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"

namespace thunderhead::gateway::test {
namespace {

namespace http = boost::beast::http;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::WaitFor;
using Clock = std::chrono::steady_clock;

template <typename Message>
Message Parsed(const std::string& bytes) {
  Message message;
  EXPECT_TRUE(message.ParseFromString(bytes));
  return message;
}

std::string Counting(uint32_t count, uint32_t interval_ms = 0, uint32_t payload_bytes = 0) {
  CountRequest request;
  request.set_count(count);
  request.set_interval_ms(interval_ms);
  request.set_payload_bytes(payload_bytes);
  return request.SerializeAsString();
}

// Returns the request of a call that counts to `count`, but stops after `hold_after` responses
// until the site releases it.
std::string Held(uint32_t count, uint32_t hold_after) {
  CountRequest request;
  request.set_count(count);
  request.set_hold_after(hold_after);
  return request.SerializeAsString();
}

std::string Failing(int code, const std::string& message, uint32_t messages = 0,
                    const std::string& details = "") {
  FailRequest request;
  request.set_code(code);
  request.set_message(message);
  request.set_messages(messages);
  request.set_details(details);
  return request.SerializeAsString();
}

class BridgeTest : public EchoTest {
 protected:
  CallResult MakeCall(const std::string& method, const std::string& message,
                      const Headers& headers = {}) {
    return Call(Site().Port(), method, message, headers);
  }
};

TEST_F(BridgeTest, UnaryCallComesBack) {
  SayRequest request;
  request.set_text("caf\xc3\xa9");
  request.set_payload(std::string(1'000'000, '\0'));
  const CallResult result = MakeCall("Say", request.SerializeAsString());
  ASSERT_EQ(result.messages.size(), 1u);
  EXPECT_EQ(Parsed<SayResponse>(result.messages[0]).payload(), request.payload());
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
  EXPECT_EQ(result.trailers.count("grpc-message"), 0u);
}

TEST_F(BridgeTest, ContentTypeIsTheRequests) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Say", Frame("")));
  EXPECT_EQ(client.Read()["Content-Type"], "application/grpc-web+proto");
}

TEST_F(BridgeTest, EmptyMessagesAreMessages) {
  const CallResult result = MakeCall("Say", "");
  EXPECT_THAT(result.messages, ::testing::ElementsAre(""));
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, StreamComesInOrderAndWhole) {
  const CallResult result = MakeCall("Count", Counting(50, 0, 10'000));
  ASSERT_EQ(result.messages.size(), 50u);
  for (uint32_t i = 0; i < 50; ++i) {
    const auto response = Parsed<CountResponse>(result.messages[i]);
    EXPECT_EQ(response.index(), i);
    EXPECT_EQ(response.payload(), std::string(10'000, static_cast<char>(i)));
  }
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, StreamWithoutMessagesEndsWell) {
  EXPECT_EQ(MakeCall("Count", Counting(0)).Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, EachMessageIsFlushed) {
  for (const uint32_t messages : {0U, 1U}) {
    const int before = Record().written;
    RawClient client(Site().Port());
    client.Send(CallRequest("Count", Frame(Held(2, messages))));
    // The headers arrive before the first message is written, and the first message before the
    // second.
    const Response headers = client.ReadHeaders();
    EXPECT_EQ(headers["Transfer-Encoding"], "chunked");
    if (messages > 0) client.ReadBody(5);
    ASSERT_TRUE(WaitFor([&] { return Record().written == before + static_cast<int>(messages); }));
    Site().Release();
    Response whole;
    whole.body() = client.ReadBody(1'000'000);
    EXPECT_EQ(ParseResult(whole).messages.size(), 2U);
  }
}

TEST_F(BridgeTest, FailureCarriesMessageDetailsAndTrailers) {
  const CallResult result = MakeCall("FailOnce", Failing(5, "no storm\n100%", 0, "\x08\x05"));
  EXPECT_THAT(result.messages, ::testing::IsEmpty());
  EXPECT_EQ(result.Trailer("grpc-status"), "5");
  EXPECT_EQ(result.Trailer("grpc-message"), "no storm%0A100%25");
  EXPECT_EQ(result.Trailer("grpc-status-details-bin"), "CAU");
  EXPECT_EQ(result.trailers.count("grpc-status-details-bin"), 1u);
  EXPECT_EQ(result.Trailer("failed-after"), "0");
}

TEST_F(BridgeTest, FailureAfterMessagesKeepsThem) {
  const CallResult result = MakeCall("Fail", Failing(14, "gone", 3));
  EXPECT_EQ(result.messages.size(), 3u);
  EXPECT_EQ(result.Trailer("grpc-status"), "14");
  EXPECT_EQ(result.Trailer("grpc-message"), "gone");
  EXPECT_EQ(result.Trailer("failed-after"), "3");
}

TEST_F(BridgeTest, UnknownMethodsAreUnimplemented) {
  EXPECT_EQ(MakeCall("Sing", "").Trailer("grpc-status"), "12");
}

TEST_F(BridgeTest, MessageTheHandlerCannotParseIsAnError) {
  EXPECT_NE(MakeCall("Say", "\xff\xff\xff").Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, MetadataGoesBothWays) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Metadata", Frame(""),
                          {{"Echo-Text", "some text"},
                           {"Echo-Text", "more"},
                           {"Echo-Bytes-Bin", "AAH/"},
                           {"Cookie", "other=program"},
                           {"X-User-Agent", "grpc-web-javascript/0.1"},
                           {"User-Agent", "browser"}}));
  const Response response = client.Read();
  EXPECT_EQ(response["echo-bytes-bin"], "AAH/");
  EXPECT_EQ(response.count("echo-text"), 2u);
  const CallResult result = ParseResult(response);
  EXPECT_EQ(result.trailers.count("trailing-echo-text"), 2u);
  EXPECT_EQ(result.Trailer("trailing-echo-bytes-bin"), "AAH/");
  ASSERT_EQ(result.messages.size(), 1u);
  std::multimap<std::string, std::string> seen;
  const auto answer = Parsed<MetadataResponse>(result.messages[0]);
  for (const Entry& entry : answer.entries()) seen.emplace(entry.name(), entry.value());
  EXPECT_EQ(seen.count("echo-text"), 2u);
  EXPECT_EQ(seen.find("echo-bytes-bin")->second, std::string("\0\1\xff", 3));
  EXPECT_EQ(seen.count("cookie"), 0u);
  EXPECT_EQ(seen.count("x-user-agent"), 0u);
  EXPECT_EQ(seen.count("host"), 0u);
}

TEST_F(BridgeTest, MetadataThatGrpcForbidsIsAnErrorNotACrash) {
  const CallResult value = MakeCall("Say", "", {{"x-name", "caf\xc3\xa9"}});
  EXPECT_EQ(value.Trailer("grpc-status"), "3");
  EXPECT_THAT(value.Trailer("grpc-message"), HasSubstr("x-name"));
  EXPECT_EQ(MakeCall("Say", "", {{"x!name", "a"}}).Trailer("grpc-status"), "3");
  EXPECT_EQ(MakeCall("Say", "", {{"x-bin", "*"}}).Trailer("grpc-status"), "3");
  // The value is Base64 of bytes that are not printable, under "-bin", the only name ending in -bin
  // that gRPC treats as text.
  EXPECT_EQ(MakeCall("Say", "", {{"-bin", "gzip"}}).Trailer("grpc-status"), "0");
  EXPECT_EQ(MakeCall("Say", "").Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, DeadlinesEndCalls) {
  // A deadline that expires before the call reaches its handler also ends the call. Longer
  // deadlines follow until the handler has seen a call.
  for (int ms = 200; Record().started == 0; ms *= 2) {
    const auto begin = Clock::now();
    const CallResult call = MakeCall("Wait", "", {{"grpc-timeout", absl::StrCat(ms, "m")}});
    EXPECT_EQ(call.Trailer("grpc-status"), "4");
    EXPECT_GE(Clock::now() - begin, milliseconds(ms - 10));
  }
  EXPECT_TRUE(WaitFor([&] { return Record().done == Record().started; }));
  size_t messages = 0;
  for (int ms = 200; messages == 0; ms *= 2) {
    const CallResult stream =
        MakeCall("Count", Held(2, 1), {{"grpc-timeout", absl::StrCat(ms, "m")}});
    EXPECT_EQ(stream.Trailer("grpc-status"), "4");
    messages = stream.messages.size();
  }
  EXPECT_EQ(messages, 1U);
  EXPECT_EQ(MakeCall("Say", "", {{"grpc-timeout", "soon"}}).Trailer("grpc-status"), "3");
  // A deadline in centuries counts as no deadline.
  EXPECT_EQ(MakeCall("Say", "", {{"grpc-timeout", "99999999H"}}).Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, MalformedBodiesSayWhy) {
  const auto post = [&](const std::string& body) {
    RawClient client(Site().Port());
    client.Send(CallRequest("Say", body));
    return ParseResult(client.Read());
  };
  for (const std::string& body :
       {std::string(), std::string("\0\0", 2), Frame("abc").substr(0, 6), Frame("abc") + "d",
        Frame("a") + Frame("b"), Frame("", 0x80), Frame("", 0x02)}) {
    const CallResult result = post(body);
    EXPECT_EQ(result.Trailer("grpc-status"), "3") << body.size();
    EXPECT_NE(result.Trailer("grpc-message"), "") << body.size();
    EXPECT_TRUE(result.trailers_only);
  }
  EXPECT_EQ(post(Frame("x", 0x01)).Trailer("grpc-status"), "12");
}

TEST_F(BridgeTest, LargeRequestsAreRefused) {
  options_.max_message_bytes = 1000;
  EXPECT_EQ(MakeCall("Say", std::string(1001, 'x')).Trailer("grpc-status"), "8");
  SayRequest request;
  request.set_payload(std::string(990, 'x'));
  EXPECT_EQ(MakeCall("Say", request.SerializeAsString()).Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, LargeRequestsAreRefusedBeforeTheyAreRead) {
  options_.max_message_bytes = 1000;
  RawClient client(Site().Port());
  client.Send(
      "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\nHost: localhost\r\n"
      "Content-Type: application/grpc-web\r\nContent-Length: 4000000000\r\n\r\n");
  const CallResult result = ParseResult(client.Read());
  EXPECT_EQ(result.Trailer("grpc-status"), "8");
  EXPECT_THAT(result.Trailer("grpc-message"), HasSubstr("1000 bytes"));
}

TEST_F(BridgeTest, AClientStillSendingReadsTheRefusal) {
  options_.max_message_bytes = 1000;
  RawClient client(Site().Port());
  client.Send(CallRequest("Say", std::string(8'000'000, 'x')));
  EXPECT_EQ(ParseResult(client.Read()).Trailer("grpc-status"), "8");
}

TEST_F(BridgeTest, ChunkedRequestsKnowTheLimitToo) {
  options_.max_message_bytes = 1000;
  const std::string header =
      "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\nHost: localhost\r\n"
      "Content-Type: application/grpc-web\r\nTransfer-Encoding: chunked\r\n\r\n";
  const auto chunk = [](const std::string& bytes) {
    return absl::StrCat(absl::Hex(bytes.size()), "\r\n", bytes, "\r\n");
  };
  RawClient small(Site().Port());
  const std::string frame = Frame("\x0a\x02hi");
  small.Send(header + chunk(frame.substr(0, 3)) + chunk(frame.substr(3)) + "0\r\n\r\n");
  EXPECT_EQ(ParseResult(small.Read()).messages.size(), 1u);
  RawClient large(Site().Port());
  large.Send(header + chunk(std::string(800, 'x')) + chunk(std::string(800, 'x')));
  EXPECT_EQ(ParseResult(large.Read()).Trailer("grpc-status"), "8");
}

TEST_F(BridgeTest, ClientsThatAskMayGoOn) {
  RawClient client(Site().Port());
  const std::string request = CallRequest("Say", Frame(""), {{"Expect", "100-continue"}});
  client.Send(request.substr(0, request.size() - 5));
  EXPECT_EQ(client.Read().result(), http::status::continue_);
  client.Send(Frame(""));
  EXPECT_EQ(ParseResult(client.Read()).Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, QuietStreamIsCancelledWhenTheClientLeaves) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Counting(1, 3'600'000))));
  client.ReadHeaders();
  ASSERT_TRUE(WaitFor([&] { return Record().started == 1; }));
  client.Close();
  EXPECT_TRUE(WaitFor([&] { return Record().cancelled == 1 && Record().done == 1; }));
}

TEST_F(BridgeTest, UnaryCallIsCancelledWhenTheClientLeaves) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Wait", Frame("")));
  ASSERT_TRUE(WaitFor([&] { return Record().started == 1; }));
  client.ShutdownSending();
  EXPECT_TRUE(WaitFor([&] { return Record().cancelled == 1 && Record().done == 1; }));
}

TEST_F(BridgeTest, LivelyStreamIsCancelledWhenTheClientLeaves) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Counting(1'000'000'000, 1, 10'000))));
  client.ReadHeaders();
  client.ReadBody(50'000);
  client.Close();
  EXPECT_TRUE(WaitFor([&] { return Record().cancelled == 1 && Record().done == 1; }));
}

TEST_F(BridgeTest, SlowReaderHoldsTheHandlerBack) {
  RawClient client(Site().Port(), /*receive_buffer_bytes=*/16 << 10);
  client.Send(CallRequest("Count", Frame(Counting(2000, 0, 100'000))));
  client.ReadHeaders();
  AwaitHandlersHeldBack();
  // Only a part of the 200 MB may be written. The limit allows for what the kernel buffers for a
  // client that reads nothing (tcp_wmem: mostly 4 MB, 42 messages). It also allows for gRPC's
  // windows, which grow with speed (24 messages were seen).
  EXPECT_LT(Record().written, 100);
  // The call continues when the client does.
  client.ReadBody(20'000'000);
  EXPECT_GE(Record().written, 190);
  client.Close();
  EXPECT_TRUE(WaitFor([&] { return Record().done == 1; }));
}

TEST_F(BridgeTest, ReaderThatTakesNothingIsGivenUp) {
  DriveTime();
  options_.write_stall_timeout = seconds(20);
  RawClient client(Site().Port(), /*receive_buffer_bytes=*/16 << 10);
  client.Send(CallRequest("Count", Frame(Counting(2000, 0, 100'000))));
  client.ReadHeaders();
  // A slow reader keeps its connection. In each round it reads more bytes than the buffers hold, so
  // the gateway must have written some of them since the time was advanced.
  for (size_t bytes = 20'000'000; bytes <= 60'000'000; bytes += 20'000'000) {
    time_.Advance(seconds(15));
    client.ReadBody(bytes);
  }
  EXPECT_EQ(Record().cancelled, 0);
  EXPECT_TRUE(WaitWhileTimePasses([&] { return Record().cancelled == 1 && Record().done == 1; }));
}

TEST_F(BridgeTest, LiveStreamsOutlastTheIdleTimeout) {
  DriveTime();
  options_.idle_timeout = seconds(60);
  options_.write_stall_timeout = seconds(60);
  RawClient idle(Site().Port());
  EXPECT_EQ(idle.Ask("GET", "/healthz").result(), http::status::ok);
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Held(3, 1))));
  client.ReadHeaders();
  client.ReadBody(5);
  // The gateway has handled the new time once it has closed the idle connection.
  EXPECT_TRUE(WaitWhileTimePasses([&] { return idle.HasInput(); }));
  EXPECT_TRUE(idle.IsClosed());
  Site().Release();
  Response whole;
  whole.body() = client.ReadBody(1'000'000);
  const CallResult result = ParseResult(whole);
  EXPECT_EQ(result.messages.size(), 3u);
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
}

TEST_F(BridgeTest, RequestSentDuringAStreamIsAnsweredAfterIt) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Held(3, 1))));
  client.ReadHeaders();
  client.Send(CallRequest("Say", Frame("")));
  LetOthersCall();
  Site().Release();
  Response stream;
  stream.body() = client.ReadBody(1'000'000);
  EXPECT_EQ(ParseResult(stream).messages.size(), 3u);
  EXPECT_EQ(ParseResult(client.Read()).messages.size(), 1u);
}

TEST_F(BridgeTest, FloodDuringAStreamEndsIt) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Counting(1, 3'600'000))));
  client.ReadHeaders();
  client.SendUntilClosed(std::string(200'000, 'x'));
  EXPECT_TRUE(WaitFor([&] { return Record().cancelled == 1 && Record().done == 1; }));
}

TEST_F(BridgeTest, StoppingTheGatewayEndsCallsAndConnections) {
  DriveTime();
  RawClient idle(Site().Port());
  RawClient streaming(Site().Port());
  RawClient waiting(Site().Port());
  RawClient stalled(Site().Port(), 16 << 10);
  streaming.Send(CallRequest("Count", Frame(Counting(1, 3'600'000))));
  waiting.Send(CallRequest("Wait", Frame("")));
  stalled.Send(CallRequest("Count", Frame(Counting(2000, 0, 100'000))));
  ASSERT_TRUE(WaitFor([&] { return Record().started == 3 && Record().written > 0; }));
  // The manual clock stands still, so no timeout ends these connections before StopGateway() does.
  Site().StopGateway();
  EXPECT_TRUE(idle.IsClosed());
  EXPECT_TRUE(WaitFor([&] { return Record().cancelled == 3 && Record().done == 3; }));
}

TEST_F(BridgeTest, StoppingTheServerEndsStreamsWithAStatus) {
  RawClient client(Site().Port());
  client.Send(CallRequest("Count", Frame(Counting(1, 3'600'000))));
  client.ReadHeaders();
  ASSERT_TRUE(WaitFor([&] { return Record().started == 1; }));
  std::thread stop([&] { Site().StopServer(); });
  Response response;
  response.body() = client.ReadBody(1'000'000);
  stop.join();
  const std::string status = ParseResult(response).Trailer("grpc-status");
  EXPECT_TRUE(status == "1" || status == "14") << status;
  EXPECT_EQ(RawClient(Site().Port()).Ask("GET", "/healthz").result(), http::status::ok);
  EXPECT_EQ(MakeCall("Say", "").Trailer("grpc-status"), "14");
}

TEST_F(BridgeTest, ManyClientsAtOnce) {
  constexpr int kClients = 16;
  std::atomic<int> right = 0;
  std::vector<std::thread> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.emplace_back([&, port = Site().Port(), i] {
      for (int round = 0; round < 10; ++round) {
        if (i % 4 == 0) {
          // The client leaves in the middle of the stream.
          RawClient client(port);
          client.Send(CallRequest("Count", Frame(Counting(1000, 1, 100))));
          client.ReadHeaders();
          client.Close();
          ++right;
        } else if (Call(port, "Count", Counting(5, 0, 50'000)).messages.size() == 5) {
          ++right;
        }
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(right, kClients * 10);
  EXPECT_TRUE(WaitFor([&] { return Record().done == Record().started; }));
}

}  // namespace
}  // namespace thunderhead::gateway::test
