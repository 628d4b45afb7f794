// Tests of requests that a proxy in front could interpret differently from the gateway. Bytes after
// such a request on its connection are never answered.
#include <gtest/gtest.h>

#include <string>

#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"

namespace thunderhead::gateway::test {
namespace {

const std::string kPost = "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\n";
const std::string kType = "Content-Type: application/grpc-web\r\n";
const std::string kHost = "Host: localhost\r\n";
const std::string kNext = "GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

class SmugglingTest : public EchoTest {
 protected:
  // Returns everything that the server answers before it ends the connection.
  std::string AnswersTo(const std::string& bytes) {
    RawClient client(Site().Port());
    client.SendUntilClosed(bytes);
    return client.ReadToEnd();
  }

  void ExpectRefused(const std::string& bytes) {
    const std::string answers = AnswersTo(bytes + kNext);
    EXPECT_TRUE(answers.starts_with("HTTP/1.1 400") || answers.starts_with("HTTP/1.0 400"))
        << bytes << answers;
    // The text of an answer may also name versions of HTTP, but not after a full stop and a line
    // break.
    EXPECT_EQ(answers.find(".\nHTTP/1."), std::string::npos) << "a second answer: " << answers;
    EXPECT_TRUE(answers.ends_with(".\n")) << answers;
  }
};

TEST_F(SmugglingTest, TransferEncodingOtherThanChunkedIsRefused) {
  for (const std::string encoding : {"xchunked", "identity", "chunked, identity", "gzip, chunked",
                                     "\vchunked", "chunked, chunked", ""}) {
    const std::string line = "Transfer-Encoding: " + encoding + "\r\n";
    ExpectRefused(kPost + kHost + kType + line + "Content-Length: 5\r\n\r\n" + Frame(""));
    ExpectRefused(kPost + kHost + kType + line + "\r\n" + Frame(""));
    ExpectRefused("GET /healthz HTTP/1.1\r\n" + kHost + line + "\r\n");
  }
}

TEST_F(SmugglingTest, TwoLengthsAreRefused) {
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  const std::string length = "Content-Length: 5\r\n";
  ExpectRefused(kPost + kHost + kType + chunked + length + "\r\n0\r\n\r\n");
  ExpectRefused(kPost + kHost + kType + chunked + chunked + "\r\n0\r\n\r\n");
  ExpectRefused(kPost + kHost + kType + length + length + "\r\n" + Frame(""));
  ExpectRefused(kPost + kHost + kType + length + "Content-Length: 6\r\n\r\n" + Frame(""));
  ExpectRefused("GET /healthz HTTP/1.0\r\n" + kHost + "Connection: keep-alive\r\n" + chunked +
                "\r\n0\r\n\r\n");
}

// The response's body gives the reason, even if the lines of the request arrive one by one.
TEST_F(SmugglingTest, LinesThatContinueOthersAreRefused) {
  for (const std::string folded :
       {"X: y\r\n Transfer-Encoding: chunked\r\n", "Transfer-Encoding:\r\n chunked\r\n",
        "X: y\r\n\tz\r\n", "X: y\r\n \r\n"}) {
    const std::string header = "GET /healthz HTTP/1.1\r\n" + kHost + folded + "\r\n";
    ExpectRefused(header);
    EXPECT_NE(AnswersTo(header).find("a line begins with a space or a tab"), std::string::npos);
    ExpectRefused(kPost + kHost + kType + "Content-Length: 5\r\n" + folded + "\r\n" + Frame(""));
    RawClient slow(Site().Port());
    for (const char one : header) slow.SendUntilClosed(std::string(1, one));
    EXPECT_EQ(slow.Read().result(), boost::beast::http::status::bad_request);
  }
  // The first line of a body may begin with a space.
  RawClient plain(Site().Port());
  plain.Send("GET /healthz HTTP/1.1\r\n" + kHost + "Content-Length: 3\r\n\r\n \r\n");
  EXPECT_EQ(plain.Read().result(), boost::beast::http::status::ok);
}

TEST_F(SmugglingTest, MalformedChunksAreRefusedWithTheReason) {
  for (const std::string body : {"zz\r\n", "-1\r\n", "10000000000000000\r\n", "5\r\nabcdefgh\r\n",
                                 "0\r\nX: y\r\n z\r\n: x\r\n\r\n"}) {
    const std::string request = kPost + kHost + kType + "Transfer-Encoding: chunked\r\n\r\n" + body;
    ExpectRefused(request);
    EXPECT_NE(AnswersTo(request).find("Cannot parse the request's body: "), std::string::npos)
        << body;
  }
}

TEST_F(SmugglingTest, RepeatedHeadersWithOneValueAreRefused) {
  const std::string get = "GET /healthz HTTP/1.1\r\n";
  ExpectRefused(get + kHost + "Host: evil.example\r\n\r\n");
  ExpectRefused(get + kHost + kHost + "\r\n");
  ExpectRefused(get + kHost + "Origin: http://localhost\r\nOrigin: http://evil.example\r\n\r\n");
  ExpectRefused(get + kHost + "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n\r\n");
  ExpectRefused(get + kHost + "Range: bytes=0-1\r\nRange: bytes=2-3\r\n\r\n");
  ExpectRefused(get + kHost + "If-Range: \"a\"\r\nIf-Range: \"b\"\r\n\r\n");
  ExpectRefused(kPost + kHost + kType + kType + "Content-Length: 5\r\n\r\n" + Frame(""));
}

// The gateway decodes no bodies, so it refuses this request.
TEST_F(SmugglingTest, AnEncodedBodyIsRefused) {
  for (const std::string coding : {"gzip", "deflate", "gzip, identity"}) {
    ExpectRefused(kPost + kHost + kType + "Content-Encoding: " + coding +
                  "\r\nContent-Length: 5\r\n\r\n" + Frame(""));
  }
}

TEST_F(SmugglingTest, APortThatIsNoNumberIsRefused) {
  for (const std::string host :
       {"localhost:80evil", "localhost:", "localhost:-1", "localhost:8080:1", "localhost:123456",
        "[::1]:a", "localhost: 80", "example:localhost"}) {
    ExpectRefused("GET /healthz HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  }
}

TEST_F(SmugglingTest, APlainRequestIsAnswered) {
  // The client keeps its side of the connection open, because its call would otherwise end.
  RawClient client(Site().Port());
  client.Send(kPost + "Host: localhost:8080\r\n" + kType +
              "Transfer-Encoding: Chunked\r\n\r\n5\r\n" + Frame("") + "\r\n0\r\n\r\n" + kNext);
  EXPECT_EQ(ParseResult(client.Read()).Trailer("grpc-status"), "0");
  EXPECT_EQ(client.Read().body(), "ok\n");
}

// A proxy forwards trailers without looking at them. If they counted as header fields, a client
// could claim another address, token or timeout than those that the proxy has checked.
TEST_F(SmugglingTest, FieldsBehindTheLastChunkAreNoHeader) {
  RawClient client(Site().Port());
  client.Send("POST /thunderhead.gateway.test.Echo/Metadata HTTP/1.1\r\nHost: localhost:8080\r\n" +
              kType + "X-Forwarded-For: 192.0.2.7\r\nX-Header: kept\r\n" +
              "Transfer-Encoding: chunked\r\n\r\n5\r\n" + Frame("") + "\r\n0\r\n" +
              "X-Forwarded-For: 203.0.113.9\r\nAuthorization: Bearer forged\r\n" +
              "X-Trailer: forged\r\nGrpc-Timeout: 1n\r\nContent-Type: text/plain\r\n\r\n" + kNext);
  const auto answer = client.Read();
  EXPECT_EQ(ParseResult(answer).Trailer("grpc-status"), "0");
  EXPECT_NE(answer.body().find("kept"), std::string::npos) << "the service shows metadata";
  EXPECT_EQ(answer.body().find("forged"), std::string::npos);
  EXPECT_EQ(answer.body().find("203.0.113.9"), std::string::npos);
  EXPECT_EQ(client.Read().body(), "ok\n");
}

TEST_F(SmugglingTest, AForeignOriginMayNotPostEvenWithoutAPreflight) {
  for (const std::string origin :
       {"https://evil.example", "null", "http://localhost:9999", "file://"}) {
    RawClient client(Site().Port());
    const Response answer =
        client.Ask("POST", "/thunderhead.gateway.test.Echo/Say",
                   {{"Content-Type", "application/grpc-web"}, {"Origin", origin}}, Frame(""));
    EXPECT_EQ(answer.result(), boost::beast::http::status::forbidden) << origin;
  }
  EXPECT_EQ(Record().started, 0);
}

}  // namespace
}  // namespace thunderhead::gateway::test
