// Tests of access to the ports: gRPC's port by TLS with a certificate that changes, and the local
// socket, which only this user may use.
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/guarded_service.h"
#include "tests/service/untaking_client.h"
#include "tests/support/manual_time.h"
#include "tests/support/running_time.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class TlsPort {
 public:
  explicit TlsPort(service::ServerOptions options = Patient()) {
    WriteSelfSigned(Certificate(), Key(), 1);
    options.address = "127.0.0.1:0";
    options.tls = {Certificate(), Key()};
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
  // Returns a client that trusts only that certificate.
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
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  return stub.ListStorms(&context, v1::ListStormsRequest(), &response).ok();
}

TEST(PortsTest, OneAddressBeginsTlsOnlySoOften) {
  ManualTime time;
  service::ServerOptions options = Patient(time);
  options.limits.max_handshakes_per_address = 1.0;
  TlsPort port(options);
  const std::string certificate = ReadFile(port.Certificate());
  int answers = 0;
  for (int i = 0; i < 20; ++i) answers += Answers(*port.Trust(certificate)) ? 1 : 0;
  EXPECT_EQ(answers, 2) << "of two seconds";
  time.Advance(std::chrono::seconds(1));
  EXPECT_TRUE(Answers(*port.Trust(certificate)));
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
  // The server checks the files once a second (rpc_port/grpc_certificate.h).
  EXPECT_TRUE(WaitFor([&] { return Answers(*port.Trust(renewed)); }));
  // The connection that was open before still works.
  EXPECT_TRUE(Answers(*old));
}

// A client's socket that sends nothing.
class SilentClient {
 public:
  // Connects from the address `from`, in the host's byte order.
  explicit SilentClient(int port, in_addr_t from = INADDR_LOOPBACK)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(from);
    EXPECT_EQ(bind(socket_.Get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        connect(socket_.Get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }

  // Returns whether the server has ended the connection. Ignores anything that it sent before.
  bool IsClosed() const {
    if (!connected_) return true;
    while (true) {
      char bytes[256];
      const ssize_t count = recv(socket_.Get(), bytes, sizeof(bytes), MSG_DONTWAIT);
      if (count <= 0) return count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
    }
  }

 private:
  base::FileDescriptor socket_;
  bool connected_ = false;
};

// Returns true if a call is answered, even with a refusal.
bool IsReached(int port) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  const auto stub = v1::ThunderheadService::NewStub(grpc::CreateCustomChannel(
      absl::StrCat("127.0.0.1:", port), grpc::InsecureChannelCredentials(), arguments));
  v1::ListStormsResponse response;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  const auto code = stub->ListStorms(&context, v1::ListStormsRequest(), &response).error_code();
  return code == grpc::StatusCode::OK || code == grpc::StatusCode::UNAUTHENTICATED;
}

// A client whose call stays open.
class WatchingClient {
 public:
  WatchingClient(int port, const v1::CreateSessionResponse& session) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    stub_ = v1::ThunderheadService::NewStub(grpc::CreateCustomChannel(
        absl::StrCat("127.0.0.1:", port), grpc::InsecureChannelCredentials(), arguments));
    v1::WatchFramesRequest watch;
    watch.set_session_id(session.session_id());
    context_.AddMetadata("authorization", "Bearer " + TokenOf("presenter"));
    stream_ = stub_->WatchFrames(&context_, watch);
  }
  ~WatchingClient() {
    context_.TryCancel();
    stream_->Finish();
  }

  bool Receives() {
    v1::WatchFramesResponse event;
    return stream_->Read(&event);
  }

 private:
  std::unique_ptr<Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchFramesResponse>> stream_;
};

TEST(PortsTest, SilentConnectionsOfGrpcMakeRoomWithinTheirAddress) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  options.limits.max_connections_per_address = 5;
  GuardedService guarded(options);
  const int port = guarded.service().server().Port();
  std::vector<SilentClient> clients;
  for (int i = 0; i < 5; ++i) clients.emplace_back(port);
  // The server accepts connections one after another, so by now it has all of them.
  EXPECT_TRUE(IsReached(port));
  EXPECT_TRUE(WaitFor([&] { return clients[0].IsClosed(); })) << "the oldest made room";
  for (std::size_t i = 1; i < clients.size(); ++i) EXPECT_FALSE(clients[i].IsClosed()) << i;
  // Opens new connections repeatedly.
  for (int i = 0; i < 20; ++i) clients.emplace_back(port);
  EXPECT_TRUE(IsReached(port));
}

TEST(PortsTest, AllTogetherHaveSoManyConnectionsOfGrpcAndTheSilentMakeRoom) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  options.limits.max_connections = 3;
  FakeService fake(options);
  std::vector<SilentClient> clients;
  for (int i = 0; i < 3; ++i) clients.emplace_back(fake.server().Port());
  EXPECT_TRUE(IsReached(fake.server().Port()));
  EXPECT_TRUE(WaitFor([&] { return clients[0].IsClosed(); }));
  EXPECT_FALSE(clients[2].IsClosed());
}

TEST(PortsTest, ConnectionsWithCallsOfGrpcDoNotMakeRoom) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  options.limits.max_connections = 2;
  GuardedService guarded(options);
  const int port = guarded.service().server().Port();
  const v1::CreateSessionResponse session = guarded.Create();
  WatchingClient first(port, session);
  WatchingClient second(port, session);
  ASSERT_TRUE(first.Receives());
  ASSERT_TRUE(second.Receives());
  const SilentClient newcomer(port);
  EXPECT_TRUE(WaitFor([&] { return newcomer.IsClosed(); }));
  EXPECT_FALSE(IsReached(port));
  EXPECT_THAT(guarded.Audit(), Contains(AllOf(HasSubstr("act=Connect"), HasSubstr("127.0.0.1:"),
                                              HasSubstr("TOO_MANY_CONNECTIONS"))));
  EXPECT_EQ(guarded.service().server().Load().viewers, 2);
}

TEST(PortsTest, ConnectionsWhoseCallsAreOnlyAnnouncedAreClosed) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.address = "127.0.0.1:0";
  options.limits.unused_connection = std::chrono::hours(1);
  GuardedService guarded(options);
  const int port = guarded.service().server().Port();
  UntakingClient announcing(port);
  for (int i = 0; i < 100; ++i) announcing.Announce("thunderhead.v1.ThunderheadService/ListStorms");
  WatchingClient watching(port, guarded.Create());
  ASSERT_TRUE(watching.Receives());
  EXPECT_FALSE(announcing.IsClosed());
  time.Advance(options.limits.unused_connection);
  EXPECT_TRUE(WaitFor([&] { return announcing.IsClosed(); }));
  EXPECT_EQ(guarded.service().server().Load().viewers, 1) << "others stay";
}

// A client that resets each call at once has never many open calls, but gRPC keeps the memory of a
// reset call until its handler has run.
class ResetCallsTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ResetCallsTest, CloseTheConnectionsOfTheirAddress) {
  ManualTime time;
  service::ServerOptions options = Patient(time);
  options.address = "127.0.0.1:0";
  options.limits.max_calls_per_address = 10.0;
  GuardedService guarded(options);
  const int port = guarded.service().server().Port();
  const SilentClient beside(port);
  const SilentClient foreign(port, INADDR_LOOPBACK + 1);
  UntakingClient flooding(port);
  const auto call = [&] {
    flooding.Call(GetParam(), "");
    flooding.Reset();
  };
  for (int i = 0; i < 20; ++i) call();
  EXPECT_FALSE(flooding.IsClosed());
  call();
  EXPECT_TRUE(WaitFor([&] { return flooding.IsClosed(); }));
  EXPECT_TRUE(WaitFor([&] { return beside.IsClosed(); }));
  const SilentClient newcomer(port);
  EXPECT_TRUE(WaitFor([&] { return newcomer.IsClosed(); }));
  EXPECT_FALSE(foreign.IsClosed()) << "another address";
  EXPECT_FALSE(guarded.Create().session_id().empty()) << "the gateway's calls";
  EXPECT_THAT(guarded.Audit(), Contains(AllOf(HasSubstr("act=Connect"), HasSubstr("127.0.0.1:"),
                                              HasSubstr("TOO_MANY_CALLS"))));
  time.Advance(std::chrono::seconds(2));
  EXPECT_TRUE(IsReached(port));
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, ResetCallsTest,
                         ::testing::Values("thunderhead.v1.ThunderheadService/ListStorms",
                                           "thunderhead.v1.ThunderheadService/Interact",
                                           "thunderhead.v1.ThunderheadService/NoSuchMethod",
                                           "grpc.reflection.v1alpha.ServerReflection/"
                                           "ServerReflectionInfo"));

// Returns a value of /proc/self/status, in MiB.
double OwnStatusMib(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name + ":")) return std::stod(line.substr(name.size() + 1)) / 1024.0;
  }
  return 0.0;
}

// All these calls together would take more than 600 MiB.
TEST(PortsTest, AFloodOfResetCallsOfReflectionTakesLittleMemory) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer keeps what is freed";
#endif
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  GuardedService guarded(options);
  UntakingClient flooding(guarded.service().server().Port());
  // Resets VmHWM, which is from now on the process's peak memory.
  std::ofstream("/proc/self/clear_refs") << 5;
  const double before_mib = OwnStatusMib("VmHWM");
  EXPECT_FALSE(flooding.CallAndReset(
      "grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", 40'000));
  EXPECT_LT(OwnStatusMib("VmHWM") - before_mib, 200.0);
  EXPECT_THAT(guarded.Audit(), Contains(HasSubstr("TOO_MANY_CALLS")));
}

TEST(PortsTest, GrpcListensOnAddressesOfIpv6) {
  service::ServerOptions options = Patient();
  options.address = "[::]:0";
  FakeService fake(options);
  EXPECT_TRUE(IsReached(fake.server().Port())) << "and of IPv4, by any address";
}

std::string Gzip(const std::string& text) {
  z_stream stream{};
  constexpr int kGzip = 16;
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string compressed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  return compressed;
}

TEST(PortsTest, CompressedRequestsAreRefused) {
  FakeService fake;
  for (const auto algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    grpc::ClientContext unary;
    unary.set_compression_algorithm(algorithm);
    v1::ListStormsResponse storms;
    EXPECT_EQ(fake.stub().ListStorms(&unary, v1::ListStormsRequest(), &storms).error_code(),
              grpc::StatusCode::UNIMPLEMENTED);
    grpc::ClientContext stream;
    stream.set_compression_algorithm(algorithm);
    const auto call = fake.stub().Interact(&stream);
    v1::InteractRequest request;
    request.mutable_join()->set_session_key(std::string(1000, 'x'));
    call->Write(request);
    EXPECT_EQ(call->Finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
  }
  v1::ListStormsResponse storms;
  grpc::ClientContext plain;
  EXPECT_TRUE(fake.stub().ListStorms(&plain, v1::ListStormsRequest(), &storms).ok());
}

// The request has some 60 kB that would expand to 60 MiB.
TEST(PortsTest, CompressedRequestsAreNotInflated) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer keeps what is freed";
#endif
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  FakeService fake(options);
  const std::string bomb = Gzip(std::string(60 << 20, '\0'));
  // Resets VmHWM, which is from now on the process's peak memory.
  std::ofstream("/proc/self/clear_refs") << 5;
  const double before_mib = OwnStatusMib("VmHWM");
  std::vector<std::unique_ptr<UntakingClient>> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(std::make_unique<UntakingClient>(fake.server().Port()));
    clients.back()->CallCompressed("thunderhead.v1.ThunderheadService/ListStorms", bomb);
  }
  for (const auto& client : clients) {
    EXPECT_TRUE(WaitFor([&] { return client->Refused() > 0 || client->IsReset(); }));
  }
  EXPECT_LT(OwnStatusMib("VmHWM") - before_mib, 40.0);
}

// Returns the name of this process's newest local socket.
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

// Connects once. Returns 0 if the server sends something, 1 if it ends the connection, 2 for
// another failure.
int TryOnce(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);
  const base::FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (connect(socket.Get(), reinterpret_cast<sockaddr*>(&address), bytes) != 0) return 2;
  const timeval patience{kPatience.count(), 0};
  setsockopt(socket.Get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  const char hello[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0";
  (void)send(socket.Get(), hello, sizeof(hello) - 1, MSG_NOSIGNAL);
  char answer[9];
  return recv(socket.Get(), answer, sizeof(answer), 0) > 0 ? 0 : 1;
}

// Connects `times` times in a process of that user. Returns how the last attempt ended.
int TryAs(uid_t user, const std::string& name, int times = 1) {
  const pid_t child = fork();
  if (child == 0) {
    int end = 2;
    if (setuid(user) == 0) {
      for (int i = 0; i < times; ++i) end = TryOnce(name);
    }
    _exit(end);
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

TEST(PortsTest, ForeignersAtTheLocalSocketDoNotFloodTheLog) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to try as another user";
  const FakeService service;
  ::testing::internal::CaptureStdout();
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(TryAs(65534, LocalSocket(), 500), 1);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  const std::string logged = ::testing::internal::GetCapturedStdout();
  const auto lines = static_cast<double>(std::ranges::count(logged, '\n'));
  EXPECT_GE(lines, 1.0);
  EXPECT_LE(lines, 5.0 * (took.count() + 2.0)) << "five a second";
}

}  // namespace
}  // namespace thunderhead::testing
