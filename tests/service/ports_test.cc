// The ports as doors: gRPC's by TLS with a certificate that changes, and the local socket, which is
// for this user alone.
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using Stub = v1::ThunderheadService::Stub;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class TlsPort {
 public:
  TlsPort() {
    WriteSelfSigned(Certificate(), Key(), 1);
    service::ServerOptions options;
    options.address = "127.0.0.1:0";
    options.tls = {Certificate(), Key(), 1};
    service_.emplace(options);
  }

  std::string Certificate() const { return folder_.File("certificate.pem"); }
  std::string Key() const { return folder_.File("key.pem"); }

  std::unique_ptr<Stub> Connect(const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return v1::ThunderheadService::NewStub(grpc::CreateCustomChannel(
        absl::StrCat("localhost:", service_->server().Port()), credentials, arguments));
  }
  // Trusts that certificate alone.
  std::unique_ptr<Stub> Trust(const std::string& certificate) {
    return Connect(grpc::SslCredentials({certificate, "", ""}));
  }

 private:
  TemporaryFolder folder_;
  std::optional<FakeService> service_;
};

bool Answers(Stub& stub) {
  v1::ListStormsResponse response;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(3));
  return stub.ListStorms(&context, v1::ListStormsRequest(), &response).ok();
}

TEST(PortsTest, GrpcIsServedByTls) {
  TlsPort port;
  EXPECT_TRUE(Answers(*port.Trust(ReadFile(port.Certificate()))));
  EXPECT_FALSE(Answers(*port.Connect(grpc::InsecureChannelCredentials())));
}

TEST(PortsTest, ANewCertificateIsForNewConnections) {
  TlsPort port;
  const auto old = port.Trust(ReadFile(port.Certificate()));
  ASSERT_TRUE(Answers(*old));
  WriteSelfSigned(port.Certificate(), port.Key(), 2);
  const std::string renewed = ReadFile(port.Certificate());
  bool answers = false;
  for (int i = 0; i < 20 && !answers; ++i) {
    answers = Answers(*port.Trust(renewed));
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
  }
  EXPECT_TRUE(answers);
  // On the connection that was open before.
  EXPECT_TRUE(Answers(*old));
}

// The name of this process' newest local socket.
std::string LocalSocket() {
  std::ifstream sockets("/proc/net/unix");
  const std::string prefix = absl::StrCat("@thunderhead-", getpid(), "-");
  std::string newest;
  for (std::string line; std::getline(sockets, line);) {
    const std::size_t at = line.find(prefix);
    if (at != std::string::npos) newest = line.substr(at + 1);
  }
  return newest;
}

// In a process of that user: 0 if the server says something, 1 if it ends the connection, 2 for
// another failure.
int TryAs(uid_t user, const std::string& name) {
  const pid_t child = fork();
  if (child == 0) {
    if (setuid(user) != 0) _exit(2);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (connect(socket, reinterpret_cast<sockaddr*>(&address), bytes) != 0) _exit(2);
    const timeval patience{10, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    const char hello[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0";
    (void)send(socket, hello, sizeof(hello) - 1, MSG_NOSIGNAL);
    char answer[9];
    _exit(recv(socket, answer, sizeof(answer), 0) > 0 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

TEST(PortsTest, TheLocalSocketIsForThisUserAlone) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to try as another user";
  const FakeService service;
  const std::string name = LocalSocket();
  ASSERT_FALSE(name.empty());
  EXPECT_EQ(TryAs(0, name), 0);
  EXPECT_EQ(TryAs(65534, name), 1);
}

}  // namespace
}  // namespace thunderhead::testing
