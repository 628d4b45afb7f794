// Tests of the gateway's port over TLS: page, calls, WebSockets, and a certificate that changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "absl/strings/str_cat.h"
#include "base/certificate_files.h"
#include "base/error_details.h"
#include "gateway/tls_contexts.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using net::ip::tcp;
using ::testing::HasSubstr;

// A client that trusts only the certificate in a file.
class TlsClient {
 public:
  using Stream = net::ssl::stream<tcp::socket>;

  TlsClient(uint16_t port, const std::string& certificate) {
    context_.load_verify_file(certificate);
    socket_.emplace(io_, context_);
    Stream& tls = socket_->next_layer();
    tls.set_verify_mode(net::ssl::verify_peer);
    tls.lowest_layer().connect(tcp::endpoint(net::ip::address_v4::loopback(), port));
    tls.handshake(Stream::client);
  }

  long Serial() {
    X509* const certificate = SSL_get_peer_certificate(socket_->next_layer().native_handle());
    const long serial = ASN1_INTEGER_get(X509_get_serialNumber(certificate));
    X509_free(certificate);
    return serial;
  }

  Response Get(const std::string& target) {
    http::request<http::string_body> request(http::verb::get, target, 11);
    request.set(http::field::host, "localhost");
    http::write(socket_->next_layer(), request);
    Response response;
    http::response_parser<http::string_body> parser;
    // In Beast 1.74, boost::none refuses every body that arrives after its header.
    parser.body_limit(std::numeric_limits<uint64_t>::max());
    http::read(socket_->next_layer(), buffer_, parser);
    return parser.release();
  }

  void Upgrade() {
    socket_->set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
      request.set(http::field::sec_websocket_protocol, "grpc-websocket.v1");
    }));
    socket_->handshake("localhost", "/thunderhead.gateway.test.Echo/Converse");
    socket_->binary(true);
  }

  // Sends one message of `bytes` bytes and returns the size of the answer.
  size_t Converse(size_t bytes) {
    // The message is a ConverseRequest with text.
    std::string message = std::string("\0\x0a", 2);
    for (size_t rest = bytes; true; rest >>= 7) {
      message += static_cast<char>((rest & 0x7f) | (rest > 0x7f ? 0x80 : 0));
      if (rest <= 0x7f) break;
    }
    message += std::string(bytes, 'x');
    socket_->write(net::buffer(message));
    boost::beast::flat_buffer answer;
    return socket_->read(answer);
  }

 private:
  net::io_context io_;
  net::ssl::context context_{net::ssl::context::tls_client};
  std::optional<websocket::stream<Stream, /*deflateSupported=*/false>> socket_;
  boost::beast::flat_buffer buffer_;
};

class TlsTest : public EchoTest {
 protected:
  TlsTest() {
    WriteSelfSigned(Certificate(), Key(), 1);
    std::filesystem::create_directory(folder_.Path() / "page");
    std::ofstream(folder_.File("page/index.html")) << "<html>storm</html>";
    std::ofstream(folder_.File("page/big.js")) << std::string(9'000'000, 'x');
    options_.page_directory = folder_.File("page");
    DriveTime();
    options_.tls = TlsContexts::Open({Certificate(), Key()}, time_).value();
    Site();
  }
  ~TlsTest() override { site_.reset(); }

  void WriteSelfSigned(const std::string& certificate, const std::string& key, long serial) {
    testing::WriteSelfSigned(certificate, key, serial);
  }
  // Waits until new connections see the certificate with that serial number, which is in the file.
  bool AwaitSerial(long serial, const std::string& file) {
    return WaitWhileTimePasses([&] {
      try {
        return TlsClient(site_->Port(), file).Serial() == serial;
      } catch (const boost::system::system_error&) {
        return false;  // it does not trust the certificate that it sees
      }
    });
  }
  std::string Certificate() const { return folder_.File("certificate.pem"); }
  std::string Key() const { return folder_.File("key.pem"); }

  testing::TemporaryFolder folder_;
};

TEST_F(TlsTest, ServesPageAndCalls) {
  TlsClient client(site_->Port(), Certificate());
  EXPECT_EQ(client.Get("/").body(), "<html>storm</html>");
  EXPECT_EQ(client.Get("/big.js").body(), std::string(9'000'000, 'x'));
  client.Upgrade();
  EXPECT_GT(client.Converse(10), 10U);
  EXPECT_GT(client.Converse(300'000), 300'000U);
  EXPECT_THAT(site_->Front().Url(), HasSubstr("https://localhost"));
}

TEST_F(TlsTest, WhatIsNotTlsIsCutOff) {
  RawClient client(site_->Port());
  client.SendUntilClosed("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(client.IsEnded());
  EXPECT_EQ(TlsClient(site_->Port(), Certificate()).Get("/").result(), http::status::ok);
}

TEST_F(TlsTest, CurlTrustsIt) {
  const std::string answer = folder_.File("answer");
  const std::string command =
      absl::StrCat("curl --silent --show-error --max-time 600 --cacert ", Certificate(), " -o ",
                   answer, " https://localhost:", site_->Port(), "/");
  ASSERT_EQ(std::system(command.c_str()), 0) << "is Debian's package curl installed?";
  std::ifstream file(answer);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "<html>storm</html>");
  // curl does not trust the certificate, so it refuses.
  EXPECT_NE(std::system(
                absl::StrCat("curl --silent --max-time 600 https://localhost:", site_->Port(), "/")
                    .c_str()),
            0);
}

TEST_F(TlsTest, ANewCertificateIsForNewConnections) {
  TlsClient old(site_->Port(), Certificate());
  EXPECT_EQ(old.Serial(), 1);
  old.Upgrade();
  // The new key alone does not match the old certificate, so the old pair stays in use.
  testing::WriteSelfSigned(folder_.File("new.pem"), Key(), 2);
  for (int i = 0; i < 3; ++i) {
    time_.Advance(std::chrono::seconds(1));
    EXPECT_TRUE(time_.AwaitLooks());
  }
  EXPECT_EQ(TlsClient(site_->Port(), Certificate()).Serial(), 1);
  std::filesystem::rename(folder_.File("new.pem"), Certificate());
  EXPECT_TRUE(AwaitSerial(2, Certificate()));
  EXPECT_GT(old.Converse(10), 10U);
}

// Reading a pipe without a writer would never end, and then no later certificate would be used.
TEST_F(TlsTest, APipeInPlaceOfACertificateIsRefused) {
  TlsClient old(site_->Port(), Certificate());
  testing::WriteSelfSigned(folder_.File("kept.pem"), folder_.File("kept_key.pem"), 2);
  std::filesystem::copy_file(Certificate(), folder_.File("trusted.pem"));
  std::filesystem::copy_file(folder_.File("kept.pem"), folder_.File("next.pem"));
  std::filesystem::remove(Certificate());
  ASSERT_EQ(mkfifo(Certificate().c_str(), 0600), 0);
  for (int i = 0; i < 5; ++i) {
    time_.Advance(std::chrono::seconds(1));
    EXPECT_TRUE(time_.AwaitLooks());
    EXPECT_EQ(TlsClient(site_->Port(), folder_.File("trusted.pem")).Serial(), 1);
  }
  EXPECT_EQ(old.Get("/").result(), http::status::ok);
  std::filesystem::rename(folder_.File("kept_key.pem"), Key());
  std::filesystem::rename(folder_.File("kept.pem"), Certificate());
  EXPECT_TRUE(AwaitSerial(2, folder_.File("next.pem")));
}

TEST_F(TlsTest, OneAddressHasSoManyHandshakesASecond) {
  site_.reset();
  std::atomic<int> refused{0};
  options_.max_handshakes_per_address = 5.0;
  options_.on_refusal = [&](const GatewayRefusal& refusal) {
    EXPECT_EQ(refusal.act, "Connect");
    EXPECT_EQ(base::DetailsOf(refusal.why).reason, "TOO_MANY_HANDSHAKES");
    ++refused;
  };
  Site();
  int shaken = 0;
  for (int i = 0; i < 40; ++i) {
    try {
      TlsClient client(site_->Port(), Certificate());
      ++shaken;
    } catch (const boost::system::system_error&) {
      // The connection was closed.
    }
  }
  // The limit of 5 handshakes a second permits twice as many at once.
  EXPECT_EQ(shaken, 10);
  EXPECT_EQ(refused, 30);
  time_.Advance(std::chrono::milliseconds(250));
  EXPECT_EQ(TlsClient(site_->Port(), Certificate()).Get("/").result(), http::status::ok);
  site_.reset();
}

TEST_F(TlsTest, FilesThatDoNotFitAreNamed) {
  testing::WriteSelfSigned(folder_.File("other.pem"), folder_.File("other_key.pem"), 3);
  const base::TlsFiles files{Certificate(), folder_.File("other_key.pem")};
  const absl::Status wrong = TlsContexts::Open(files, time_).status();
  EXPECT_EQ(wrong.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(wrong.message()), HasSubstr("other_key.pem"));
}

}  // namespace
}  // namespace thunderhead::gateway::test
