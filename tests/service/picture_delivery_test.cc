// Clients that ask for a picture and do not take it.
#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "base/file_descriptor.h"
#include "gtest/gtest.h"
#include "store/sqlite_job_store.h"
#include "store/state_file.h"
#include "tests/service/fake_service.h"
#include "tests/support/temporary_folder.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Speaks HTTP/2 by itself, and grants no room for what the server sends.
class UntakingClient {
 public:
  explicit UntakingClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_.Get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    const timeval patience{0, 20'000};
    setsockopt(socket_.Get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    // SETTINGS_INITIAL_WINDOW_SIZE is 0.
    Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(4, 0, 0, std::string("\0\4\0\0\0\0", 6)));
  }

  // `method` with its service.
  void Call(const std::string& method, const std::string& message) {
    std::string headers;
    for (const auto& [name, value] : {std::pair<std::string, std::string>{":method", "POST"},
                                      {":scheme", "http"},
                                      {":path", "/thunderhead.v1." + method},
                                      {":authority", "localhost"},
                                      {"te", "trailers"},
                                      {"content-type", "application/grpc"}}) {
      // A literal that is not indexed.
      headers += '\0' + Text(name) + Text(value);
    }
    const std::string data = '\0' + Number(message.size(), 4) + message;
    Send(Frame(1, kEndHeaders, 1, headers) + Frame(0, kEndStream, 1, data));
  }

  // Answers pings until the server resets the call; false if it does not within that time.
  bool IsReset(milliseconds patience) {
    const auto until = steady_clock::now() + patience;
    while (steady_clock::now() < until) {
      char bytes[4096];
      const ssize_t count = recv(socket_.Get(), bytes, sizeof(bytes), 0);
      if (count > 0) received_.append(bytes, static_cast<std::size_t>(count));
      while (TakeFrame()) {
      }
      if (reset_) return true;
    }
    return false;
  }

 private:
  static constexpr char kAck = 1;
  static constexpr char kEndStream = 1;
  static constexpr char kEndHeaders = 4;

  static std::string Number(std::size_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>((value >> (8 * i)) & 0xff);
    return text;
  }
  static std::string Text(const std::string& text) {
    return std::string(1, static_cast<char>(text.size())) + text;
  }
  static std::string Frame(char type, char flags, std::size_t stream, const std::string& payload) {
    return Number(payload.size(), 3) + type + flags + Number(stream, 4) + payload;
  }
  void Send(const std::string& bytes) {
    EXPECT_EQ(send(socket_.Get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }

  bool TakeFrame() {
    constexpr std::size_t kHeader = 9;
    if (received_.size() < kHeader) return false;
    std::size_t bytes = 0;
    for (int i = 0; i < 3; ++i) bytes = bytes << 8 | static_cast<unsigned char>(received_[i]);
    if (received_.size() < kHeader + bytes) return false;
    const char type = received_[3];
    const bool is_answer = received_[4] == kAck;
    const std::string payload = received_.substr(kHeader, bytes);
    received_.erase(0, kHeader + bytes);
    if (type == 3) reset_ = true;
    if (type == 4 && !is_answer) Send(Frame(4, kAck, 0, ""));
    if (type == 6 && !is_answer) Send(Frame(6, kAck, 0, payload));
    return true;
  }

  base::FileDescriptor socket_;
  std::string received_;
  bool reset_ = false;
};

class PictureDelivery : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string Asking() {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.set_in_chunks(true);
    return request.SerializeAsString();
  }
  static bool AwaitPictures(FakeService& fake, int pictures, std::chrono::seconds patience) {
    const auto until = steady_clock::now() + patience;
    while (fake.server().Load().pictures != pictures && steady_clock::now() < until) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    return fake.server().Load().pictures == pictures;
  }
};

TEST_P(PictureDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = milliseconds(500);
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  ASSERT_TRUE(AwaitPictures(fake, 1, std::chrono::seconds(5)));
  EXPECT_TRUE(client.IsReset(milliseconds(10'000)));
  EXPECT_TRUE(AwaitPictures(fake, 0, std::chrono::seconds(5)))
      << "the picture and its memory are given back";
}

TEST_P(PictureDelivery, ItHasItsTime) {
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  FakeService fake(options);
  UntakingClient client(fake.server().Port());
  client.Call(GetParam(), Asking());
  EXPECT_FALSE(client.IsReset(milliseconds(1500)));
  EXPECT_EQ(fake.server().Load().pictures, 1) << "it waits for its client";
}

INSTANTIATE_TEST_SUITE_P(Calls, PictureDelivery,
                         ::testing::Values("ThunderheadService/RenderImage",
                                           "ThunderheadService/RenderImageWithProgress"));

TEST(JobDelivery, WhoTakesNothingIsCancelledAfterAWhile) {
  const TemporaryFolder folder;
  service::ServerOptions options;
  options.address = "127.0.0.1:0";
  options.limits.delivery_time = milliseconds(500);
  auto file = store::StateFile::Open(folder.File("state.db"));
  ASSERT_TRUE(file.ok()) << file.status();
  options.jobs.store = *store::SqliteJobStore::In(*file);
  options.jobs.folder = folder.File("jobs");
  FakeService fake(options);
  const auto stub = v1::RenderJobService::NewStub(fake.server().LocalChannel());
  v1::CreateRenderJobRequest create;
  *create.add_pictures()->mutable_scene() = SmallScene();
  v1::CreateRenderJobResponse created;
  grpc::ClientContext creating;
  ASSERT_TRUE(stub->CreateRenderJob(&creating, create, &created).ok());
  v1::WatchRenderJobRequest watch;
  watch.set_job_id(created.job().id());
  grpc::ClientContext watching;
  const auto reader = stub->WatchRenderJob(&watching, watch);
  v1::WatchRenderJobResponse news;
  while (reader->Read(&news)) {
  }
  ASSERT_TRUE(reader->Finish().ok());

  UntakingClient watcher(fake.server().Port());
  watcher.Call("RenderJobService/WatchRenderJob", watch.SerializeAsString());
  EXPECT_TRUE(watcher.IsReset(milliseconds(10'000)));
  v1::FetchRenderResultRequest fetch;
  fetch.set_job_id(created.job().id());
  UntakingClient fetcher(fake.server().Port());
  fetcher.Call("RenderJobService/FetchRenderResult", fetch.SerializeAsString());
  EXPECT_TRUE(fetcher.IsReset(milliseconds(10'000)));
}

}  // namespace
}  // namespace thunderhead::testing
