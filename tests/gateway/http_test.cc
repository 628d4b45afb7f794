// Tests of the gateway's port over HTTP: page, health, methods, hosts, origins and the life of
// connections.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <boost/beast/http/field.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "streams/sha256_digest.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

namespace http = boost::beast::http;
using std::chrono::seconds;
using ::testing::HasSubstr;

std::string Header(const Response& response, const std::string& name) {
  return response[name].to_string();
}

std::string DigestOf(const std::string& bytes) {
  streams::Sha256Digest digest;
  digest.Add(bytes);
  return digest.Hexadecimal();
}

class HttpTest : public EchoTest {
 protected:
  HttpTest() {
    std::filesystem::create_directories(folder_.Path() / "assets");
    std::ofstream(folder_.File("index.html")) << "<html>storm</html>";
    // The file is larger than the kernel's buffers.
    std::ofstream(folder_.File("assets/big-1a2b.js")) << std::string(9'000'000, 'x');
    options_.page_directory = folder_.Path().string();
  }

  ~HttpTest() override { site_.reset(); }

  Response Ask(const std::string& method, const std::string& target, const Headers& headers = {},
               const std::string& body = "") {
    return RawClient(Site().Port()).Ask(method, target, headers, body);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(HttpTest, AKeptFileThatWasSentToItsEndIsTold) {
  std::ofstream(folder_.File("kept.png")) << std::string(9'000'000, 'x');
  std::atomic<int> sent{0};
  options_.find_kept_file = [&](std::string_view path) -> std::optional<KeptFile> {
    if (path != "/results/key/0") return std::nullopt;
    return KeptFile{folder_.File("kept.png"), "tag", [&sent] { ++sent; }};
  };
  const auto eventually = [&](int count) {
    return testing::WaitFor([&] { return sent == count; });
  };
  EXPECT_EQ(Ask("GET", "/results/key/0").body().size(), 9'000'000U);
  EXPECT_TRUE(eventually(1));
  EXPECT_EQ(Ask("GET", "/results/key/0", {{"Connection", "close"}}).result(), http::status::ok);
  EXPECT_TRUE(eventually(2)) << "also where the connection ends with it";
  EXPECT_EQ(Ask("GET", "/results/key/0", {{"Range", "bytes=8999990-"}}).body().size(), 10U);
  EXPECT_TRUE(eventually(3)) << "its last part";
  EXPECT_EQ(Ask("GET", "/results/key/0", {{"Range", "bytes=0-9"}}).body().size(), 10U);
  RawClient head(Site().Port());
  head.Send("HEAD /results/key/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(head.Read(true).result(), http::status::ok);
  {
    RawClient leaves(Site().Port(), 4096);
    leaves.Send("GET /results/key/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    leaves.ReadHeaders();
    leaves.Close();
  }
  EXPECT_EQ(Ask("GET", "/results/key/1").result(), http::status::not_found);
  Site().StopGateway();  // its thread reports the refusals
  EXPECT_EQ(sent, 3);
}

class KeptFileTest : public HttpTest {
 protected:
  KeptFileTest() {
    std::ofstream(path_) << written_;
    options_.find_kept_file = [this](std::string_view) {
      return KeptFile{path_, "tag", [this] { ++sent_; },
                      FileContents{written_.size(), DigestOf(written_)}};
    };
  }
  ~KeptFileTest() override { site_.reset(); }

  // Expects an error for each request that would get a part of the file.
  void ExpectRefused() {
    for (const Headers& headers : {Headers{}, Headers{{"Range", "bytes=0-9"}}}) {
      const Response answer = Ask("GET", "/results/key/0", headers);
      EXPECT_EQ(answer.result(), http::status::internal_server_error);
      EXPECT_THAT(answer.body(), HasSubstr("was altered or damaged after it was written"));
      EXPECT_FALSE(answer.count("ETag"));
    }
    RawClient head(Site().Port());
    head.Send("HEAD /results/key/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(head.Read(true).result(), http::status::internal_server_error);
  }

  const std::string path_ = folder_.File("result.png");
  const std::string written_ = std::string(9'000'000, 'x');
  std::atomic<int> sent_{0};
};

TEST_F(KeptFileTest, IsSentAsItWasWritten) {
  EXPECT_EQ(Ask("GET", "/results/key/0").body(), written_);
  EXPECT_EQ(Ask("GET", "/results/key/0", {{"Range", "bytes=8999990-"}}).body(), "xxxxxxxxxx");
  EXPECT_TRUE(testing::WaitFor([&] { return sent_ == 2; }));
}

TEST_F(KeptFileTest, AnAlteredFileIsRefused) {
  std::fstream(path_, std::ios::in | std::ios::out).seekp(8'999'999).put('y');
  ExpectRefused();
  Site().StopGateway();
  EXPECT_EQ(sent_, 0);
}

TEST_F(KeptFileTest, AFileOfAnotherSizeIsRefused) {
  std::filesystem::resize_file(path_, written_.size() - 1);
  ExpectRefused();
  std::ofstream(path_) << written_ << "x";
  ExpectRefused();
}

TEST_F(KeptFileTest, ALinkOrAPipeIsRefused) {
  // The link leads to a file with the same contents.
  std::filesystem::rename(path_, folder_.File("other.png"));
  std::filesystem::create_symlink("other.png", path_);
  ExpectRefused();
  std::filesystem::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  ExpectRefused();
  std::filesystem::remove(path_);
  EXPECT_EQ(Ask("GET", "/results/key/0").result(), http::status::not_found);
}

// A large file is checked while it is sent. If the check fails, its last bytes are not sent.
TEST_F(KeptFileTest, TheConnectionBreaksBeforeTheEndOfALargeAlteredFile) {
  constexpr std::uint64_t kBytes = KeptFile::kCheckedFirst_bytes + 1;
  std::filesystem::resize_file(path_, kBytes);  // the additional bytes take no space
  options_.find_kept_file = [this](std::string_view) {
    return KeptFile{path_, "tag", [this] { ++sent_; },
                    FileContents{kBytes, DigestOf("another file")}};
  };
  RawClient client(Site().Port());
  client.Send("GET /results/key/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::string answer = client.ReadToEnd();
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200"));
  EXPECT_LT(answer.size() - (answer.find("\r\n\r\n") + 4), kBytes);
  Site().StopGateway();
  EXPECT_EQ(sent_, 0);
}

TEST_F(HttpTest, ServesThePage) {
  const Response page = Ask("GET", "/?session=1");
  EXPECT_EQ(page.result(), http::status::ok);
  EXPECT_EQ(page.body(), "<html>storm</html>");
  EXPECT_EQ(Header(page, "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(Header(page, "Cache-Control"), "no-cache");
  EXPECT_EQ(Header(page, "X-Content-Type-Options"), "nosniff");
  const std::string policy = Header(page, "Content-Security-Policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'self'"));
  EXPECT_THAT(policy, HasSubstr("img-src 'self' blob: data:"));
  EXPECT_THAT(policy, HasSubstr("worker-src 'self' blob:"));
  EXPECT_THAT(policy, HasSubstr("style-src 'self' 'unsafe-inline'"));
}

TEST_F(HttpTest, ServesALargeAssetWhole) {
  const Response asset = Ask("GET", "/assets/big-1a2b.js");
  EXPECT_EQ(asset.body(), std::string(9'000'000, 'x'));
  EXPECT_THAT(Header(asset, "Cache-Control"), HasSubstr("immutable"));
}

TEST_F(HttpTest, HeadHasTheHeadersOfGetAndNoBody) {
  RawClient client(Site().Port());
  const Response head = client.Ask("HEAD", "/");
  EXPECT_EQ(Header(head, "Content-Length"), "18");
  EXPECT_EQ(Header(head, "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(client.Ask("HEAD", "/nothing").result(), http::status::not_found);
  // A body after the header would be read as part of this response.
  EXPECT_EQ(client.Ask("GET", "/").body(), "<html>storm</html>");
}

TEST_F(HttpTest, UnchangedFilesAreNotSentAgain) {
  RawClient client(Site().Port());
  const std::string tag = Header(client.Ask("GET", "/"), "ETag");
  const Response again = client.Ask("GET", "/", {{"If-None-Match", tag}});
  EXPECT_EQ(again.result(), http::status::not_modified);
  EXPECT_EQ(Header(again, "ETag"), tag);
  EXPECT_EQ(client.Ask("GET", "/", {{"If-None-Match", "\"old\""}}).result(), http::status::ok);
}

TEST_F(HttpTest, FilesThatAreNotSentAreNotOpened) {
  RawClient client(Site().Port());
  const std::string tag = Header(client.Ask("GET", "/"), "ETag");
  const int opened = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  ASSERT_GE(inotify_add_watch(opened, folder_.File("index.html").c_str(), IN_OPEN), 0);
  EXPECT_EQ(client.Ask("GET", "/", {{"If-None-Match", tag}}).result(), http::status::not_modified);
  EXPECT_EQ(Ask("POST", "/").result(), http::status::method_not_allowed);
  char event[4096];
  EXPECT_EQ(read(opened, event, sizeof(event)), -1);
  EXPECT_EQ(client.Ask("GET", "/").result(), http::status::ok);
  EXPECT_GT(read(opened, event, sizeof(event)), 0);
  close(opened);
}

TEST_F(HttpTest, SendsTheGzipFileToWhoAcceptsIt) {
  std::ofstream(folder_.File("index.html.gz")) << "packed";
  options_.allowed_origins = {"http://localhost:5173"};
  RawClient client(Site().Port());
  const Response plain = client.Ask("GET", "/");
  const Response packed = client.Ask("GET", "/", {{"Accept-Encoding", "gzip, deflate, br"}});
  EXPECT_EQ(plain.body(), "<html>storm</html>");
  EXPECT_EQ(Header(plain, "Content-Encoding"), "");
  EXPECT_EQ(packed.body(), "packed");
  EXPECT_EQ(Header(packed, "Content-Encoding"), "gzip");
  EXPECT_EQ(Header(packed, "Content-Length"), "6");
  EXPECT_EQ(Header(packed, "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(Header(packed, "Cache-Control"), "no-cache");
  for (const Response& response : {plain, packed}) {
    EXPECT_EQ(Header(response, "Vary"), "Accept-Encoding, Origin");
  }
  EXPECT_NE(Header(plain, "ETag"), Header(packed, "ETag"));
  EXPECT_EQ(client.Ask("GET", "/", {{"Accept-Encoding", "gzip;q=0"}}).body(), plain.body());

  const Response head = client.Ask("HEAD", "/", {{"Accept-Encoding", "gzip"}});
  EXPECT_EQ(Header(head, "Content-Length"), "6");
  EXPECT_EQ(Header(head, "Content-Encoding"), "gzip");
}

TEST_F(HttpTest, EachEncodingIsRevalidatedByItsOwnTag) {
  std::ofstream(folder_.File("index.html.gz")) << "packed";
  RawClient client(Site().Port());
  const std::string plain = Header(client.Ask("GET", "/"), "ETag");
  const Response same =
      client.Ask("GET", "/", {{"Accept-Encoding", "identity"}, {"If-None-Match", plain}});
  EXPECT_EQ(same.result(), http::status::not_modified);
  EXPECT_EQ(Header(same, "Vary"), "Accept-Encoding");
  const Response other =
      client.Ask("GET", "/", {{"Accept-Encoding", "gzip"}, {"If-None-Match", plain}});
  EXPECT_EQ(other.result(), http::status::ok);
  EXPECT_EQ(other.body(), "packed");
}

TEST_F(HttpTest, HealthIsTold) {
  const Response health = Ask("GET", "/healthz");
  EXPECT_EQ(health.result(), http::status::ok);
  EXPECT_EQ(health.body(), "ok\n");
  EXPECT_EQ(Header(health, "Cache-Control"), "no-store");
}

TEST_F(HttpTest, WithoutAPageHealthAndCallsAreServed) {
  options_.page_directory = "";
  EXPECT_EQ(Ask("GET", "/").result(), http::status::not_found);
  EXPECT_EQ(Ask("GET", "/healthz").result(), http::status::ok);
  EXPECT_EQ(Call(Site().Port(), "Say", "").Trailer("grpc-status"), "0");
}

TEST_F(HttpTest, NothingOutsideThePageIsServed) {
  for (const char* target : {"/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/nothing",
                             "/..%2f..%2fetc%2fpasswd", "/assets"}) {
    EXPECT_EQ(Ask("GET", target).result(), http::status::not_found) << target;
  }
  EXPECT_EQ(Ask("GET", "http://localhost/").result(), http::status::bad_request);
}

TEST_F(HttpTest, WrongMethodsSayWhichAreRight) {
  const Response get = Ask("GET", "/thunderhead.gateway.test.Echo/Say");
  EXPECT_EQ(get.result(), http::status::method_not_allowed);
  EXPECT_EQ(Header(get, "Allow"), "POST, OPTIONS");
  const Response post = Ask("POST", "/", {{"Content-Type", "application/grpc-web"}});
  EXPECT_EQ(post.result(), http::status::method_not_allowed);
  EXPECT_EQ(Header(post, "Allow"), "GET, HEAD");
  for (const char* method : {"PUT", "DELETE", "PATCH", "TRACE", "CONNECT"}) {
    EXPECT_EQ(Ask(method, "/thunderhead.gateway.test.Echo/Say").result(),
              http::status::method_not_allowed)
        << method;
  }
}

TEST_F(HttpTest, OnlyBinaryGrpcWebIsTaken) {
  const std::string say = "/thunderhead.gateway.test.Echo/Say";
  for (const char* type : {"application/grpc-web-text", "application/grpc", "application/json"}) {
    const Response response = Ask("POST", say, {{"Content-Type", type}}, Frame(""));
    EXPECT_EQ(response.result(), http::status::unsupported_media_type) << type;
    EXPECT_THAT(response.body(), HasSubstr("application/grpc-web+proto"));
  }
  EXPECT_EQ(Ask("POST", say, {}, Frame("")).result(), http::status::unsupported_media_type);
  EXPECT_EQ(Ask("POST", "/a/b/c", {{"Content-Type", "application/grpc-web"}}, Frame("")).result(),
            http::status::not_found);
}

TEST_F(HttpTest, CallsNeedHttp11) {
  RawClient client(Site().Port());
  client.Send(
      "POST /thunderhead.gateway.test.Echo/Say HTTP/1.0\r\nHost: localhost\r\n"
      "Content-Type: application/grpc-web\r\nContent-Length: 5\r\n\r\n" +
      Frame(""));
  EXPECT_EQ(client.Read().result(), http::status::http_version_not_supported);
}

TEST_F(HttpTest, OnLoopbackForeignHostsAreRefused) {
  for (const char* host :
       {"localhost", "LocalHost:1234", "127.0.0.1", "127.0.0.1:80", "[::1]", "[::1]:8080"}) {
    EXPECT_EQ(Ask("GET", "/", {{"Host", host}}).result(), http::status::ok) << host;
  }
  for (const char* host : {"storms.example", "localhost.example", "127.0.0.1.example:80", "",
                           "[::2]", "10.0.0.1", "localhost@example"}) {
    EXPECT_EQ(Ask("GET", "/", {{"Host", host}}).result(), http::status::forbidden) << host;
  }
  // The gateway refuses the call before it makes it.
  const Response call =
      Ask("POST", "/thunderhead.gateway.test.Echo/Wait",
          {{"Host", "evil.example"}, {"Content-Type", "application/grpc-web"}}, Frame(""));
  EXPECT_EQ(call.result(), http::status::forbidden);
  EXPECT_EQ(Site().Record().started, 0);
  RawClient without(Site().Port());
  without.Send("GET / HTTP/1.1\r\n\r\n");
  EXPECT_EQ(without.Read().result(), http::status::forbidden);
}

TEST_F(HttpTest, BeyondLoopbackNamesMustBeKnownToo) {
  options_.address = "0.0.0.0";
  options_.allowed_hosts = {"Storms.example"};
  const auto answer = [&](const std::string& host) {
    return Ask("GET", "/", {{"Host", host}}).result();
  };
  EXPECT_EQ(answer("storms.EXAMPLE:8080"), http::status::ok);
  EXPECT_EQ(answer("192.0.2.7:8080"), http::status::ok);
  EXPECT_EQ(answer("[2001:db8::7]"), http::status::ok);
  EXPECT_EQ(answer("localhost"), http::status::ok);
  EXPECT_EQ(answer("evil.example"), http::status::forbidden);
  EXPECT_EQ(answer("storms.example.evil.example"), http::status::forbidden);
  EXPECT_EQ(answer("192.0.2.7.evil.example"), http::status::forbidden);
  EXPECT_EQ(answer(""), http::status::forbidden);
}

TEST_F(HttpTest, ForeignOriginsGetNothingUnlessAllowed) {
  options_.allowed_origins = {"http://localhost:5173"};
  const std::string say = "/thunderhead.gateway.test.Echo/Say";
  const Headers preflight = {{"Access-Control-Request-Method", "POST"},
                             {"Access-Control-Request-Headers", "content-type,x-grpc-web,x-own"}};
  Headers allowed = preflight;
  allowed.emplace_back("Origin", "http://localhost:5173");
  const Response yes = Ask("OPTIONS", say, allowed);
  EXPECT_EQ(yes.result(), http::status::no_content);
  EXPECT_EQ(Header(yes, "Access-Control-Allow-Origin"), "http://localhost:5173");
  EXPECT_THAT(Header(yes, "Access-Control-Allow-Methods"), HasSubstr("POST"));
  EXPECT_EQ(Header(yes, "Access-Control-Allow-Headers"), "content-type,x-grpc-web,x-own");
  EXPECT_EQ(Header(yes, "Vary"), "Origin");

  Headers foreign = preflight;
  foreign.emplace_back("Origin", "http://evil.example");
  const Response no = Ask("OPTIONS", say, foreign);
  EXPECT_EQ(no.result(), http::status::forbidden);
  EXPECT_EQ(no.count("Access-Control-Allow-Origin"), 0u);
  EXPECT_EQ(no.count("Access-Control-Allow-Headers"), 0u);
}

TEST_F(HttpTest, AllowedOriginsMayReadCalls) {
  options_.allowed_origins = {"http://localhost:5173"};
  const auto call = [&](const std::string& origin) {
    return Ask("POST", "/thunderhead.gateway.test.Echo/Say",
               {{"Content-Type", "application/grpc-web"}, {"Origin", origin}}, Frame(""));
  };
  const Response yes = call("http://localhost:5173");
  EXPECT_EQ(Header(yes, "Access-Control-Allow-Origin"), "http://localhost:5173");
  EXPECT_EQ(Header(yes, "Access-Control-Expose-Headers"), "*");
  const Response no = call("http://localhost:51730");
  EXPECT_EQ(no.result(), http::status::forbidden);
  EXPECT_EQ(no.count("Access-Control-Allow-Origin"), 0u);
  EXPECT_EQ(no.count("Access-Control-Expose-Headers"), 0u);
}

TEST_F(HttpTest, ConnectionsServeManyRequests) {
  RawClient client(Site().Port());
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(client.Ask("GET", "/").result(), http::status::ok);
    client.Send(CallRequest("Say", Frame("")));
    EXPECT_EQ(ParseResult(client.Read()).Trailer("grpc-status"), "0");
  }
  const Response last = client.Ask("GET", "/", {{"Connection", "close"}});
  EXPECT_EQ(last.result(), http::status::ok);
  EXPECT_TRUE(client.IsClosed());
}

TEST_F(HttpTest, RequestsSentAtOnceAreAnsweredInOrder) {
  RawClient client(Site().Port());
  client.Send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" + CallRequest("Say", Frame("\x0a\x01z")) +
              "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.Read().body(), "<html>storm</html>");
  EXPECT_THAT(ParseResult(client.Read()).messages, ::testing::ElementsAre("\x0a\x01z"));
  EXPECT_EQ(client.Read().body(), "ok\n");
}

TEST_F(HttpTest, IdleConnectionsAreClosed) {
  DriveTime();
  options_.idle_timeout = seconds(60);
  RawClient before_one(Site().Port());
  RawClient after_one(Site().Port());
  EXPECT_EQ(after_one.Ask("GET", "/").result(), http::status::ok);
  EXPECT_TRUE(WaitWhileTimePasses([&] { return after_one.HasInput(); }));
  EXPECT_TRUE(after_one.IsClosed());
  EXPECT_EQ(before_one.Ask("GET", "/").result(), http::status::ok);
}

TEST_F(HttpTest, ConnectionsWithoutAWholeRequestAreClosed) {
  DriveTime();
  options_.header_timeout = seconds(10);
  const auto begin = time_.Now();
  RawClient silent(Site().Port());
  RawClient half_said(Site().Port());
  half_said.Send("GET / HTTP/1.1\r\nHo");
  RawClient body_missing(Site().Port());
  std::string call = CallRequest("Say", Frame("abc"));
  call.pop_back();
  body_missing.Send(call);
  for (RawClient* const client : {&silent, &half_said, &body_missing}) {
    EXPECT_TRUE(WaitWhileTimePasses([&] { return client->HasInput(); }));
    EXPECT_GE(Since(begin), options_.header_timeout);
    EXPECT_TRUE(client->IsClosed());
  }
}

TEST_F(HttpTest, UnreadableRequestsAreRefused) {
  RawClient nonsense(Site().Port());
  nonsense.Send("storm\r\n\r\n");
  EXPECT_EQ(nonsense.Read().result(), http::status::bad_request);
  EXPECT_TRUE(nonsense.IsClosed());
  RawClient endless(Site().Port());
  endless.Send("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'x'));
  EXPECT_EQ(endless.Read().result(), http::status::request_header_fields_too_large);
  RawClient twofold(Site().Port());
  twofold.Send(
      "POST /a.B/C HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n"
      "Transfer-Encoding: chunked\r\n\r\n");
  EXPECT_EQ(twofold.Read().result(), http::status::bad_request);
}

TEST_F(HttpTest, ConnectionsBeyondTheMostTakeThePlaceOfTheOneIdleLongest) {
  options_.max_connections = 2;
  RawClient first(Site().Port());
  RawClient second(Site().Port());
  EXPECT_EQ(second.Ask("GET", "/").result(), http::status::ok);
  EXPECT_EQ(first.Ask("GET", "/").result(), http::status::ok);
  EXPECT_EQ(Ask("GET", "/").result(), http::status::ok);
  EXPECT_TRUE(second.IsClosed());
  EXPECT_EQ(first.Ask("GET", "/").result(), http::status::ok);
}

TEST_F(HttpTest, ATakenPortIsAnErrorThatNamesIt) {
  GatewayOptions same = options_;
  same.port = Site().Port();
  const absl::Status error = Gateway::Start(same, nullptr).status();
  EXPECT_EQ(error.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(error.message()), HasSubstr(absl::StrCat("127.0.0.1:", same.port)));
  EXPECT_THAT(std::string(error.message()), HasSubstr("choose another"));
}

TEST_F(HttpTest, AddressesAreChecked) {
  const auto start = [&](const std::string& address) {
    GatewayOptions options = options_;
    options.address = address;
    return std::string(Gateway::Start(options, nullptr).status().message());
  };
  EXPECT_THAT(start("storms.example"), HasSubstr("'storms.example' is not an IP address"));
  // The address is reserved for documentation, so no machine has it.
  EXPECT_THAT(start("192.0.2.1"), HasSubstr("choose an address of this machine"));
  EXPECT_EQ(start("localhost"), "");
}

TEST_F(HttpTest, UrlIsWhereThePageIs) {
  EXPECT_EQ(Site().Front().Url(), absl::StrCat("http://localhost:", Site().Port(), "/"));
}

}  // namespace
}  // namespace thunderhead::gateway::test
