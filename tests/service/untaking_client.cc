#include "tests/service/untaking_client.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdint>
#include <utility>

#include "gtest/gtest.h"

namespace thunderhead::testing {
namespace {

// Types and flags of HTTP/2 frames.
constexpr char kData = 0;
constexpr char kHeaders = 1;
constexpr char kReset = 3;
constexpr char kSettings = 4;
constexpr char kPing = 6;
constexpr char kAck = 1;
constexpr char kEndStream = 1;
constexpr char kEndHeaders = 4;
constexpr std::size_t kCancel = 8;  // an error code

std::string Number(std::size_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>((value >> (8 * i)) & 0xff);
  return text;
}

std::string Text(const std::string& text) {
  return std::string(1, static_cast<char>(text.size())) + text;
}

std::string HeadersOf(const std::string& method, const std::string& encoding = "identity") {
  std::string headers;
  for (const auto& [name, value] : {std::pair<std::string, std::string>{":method", "POST"},
                                    {":scheme", "http"},
                                    {":path", "/" + method},
                                    {":authority", "localhost"},
                                    {"te", "trailers"},
                                    {"grpc-encoding", encoding},
                                    {"content-type", "application/grpc"}}) {
    // The header is a literal that is not indexed.
    headers += '\0' + Text(name) + Text(value);
  }
  return headers;
}

}  // namespace

UntakingClient::UntakingClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(socket_.Get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  // SETTINGS_INITIAL_WINDOW_SIZE is 0.
  Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettings, 0, 0, std::string("\0\4\0\0\0\0", 6)));
}

void UntakingClient::Announce(const std::string& method) {
  Send(Frame(kHeaders, kEndHeaders, stream_, HeadersOf(method)));
  stream_ += 2;
}

void UntakingClient::Call(const std::string& method, const std::string& message, Stream stream) {
  const std::string data = '\0' + Number(message.size(), 4) + message;
  Send(Frame(kHeaders, kEndHeaders, stream_, HeadersOf(method)) +
       Frame(kData, stream == Stream::kEnds ? kEndStream : 0, stream_, data));
  stream_ += 2;
}

void UntakingClient::CallCompressed(const std::string& method, const std::string& gzip) {
  Send(Frame(kHeaders, kEndHeaders, stream_, HeadersOf(method, "gzip")));
  const std::string data = '\1' + Number(gzip.size(), 4) + gzip;
  constexpr std::size_t kLargestFrame = 16384;
  for (std::size_t at = 0; at < data.size(); at += kLargestFrame) {
    const bool last = at + kLargestFrame >= data.size();
    Send(Frame(kData, last ? kEndStream : 0, stream_, data.substr(at, kLargestFrame)));
  }
  stream_ += 2;
}

void UntakingClient::Reset() { Send(Frame(kReset, 0, stream_ - 2, Number(kCancel, 4))); }

bool UntakingClient::CallAndReset(const std::string& method, int calls) {
  const std::string headers = HeadersOf(method);
  for (int i = 0; i < calls; ++i) {
    const std::string bytes = Frame(kHeaders, kEndHeaders, stream_, headers) +
                              Frame(kData, kEndStream, stream_, std::string(5, '\0')) +
                              Frame(kReset, 0, stream_, Number(kCancel, 4));
    const auto size = static_cast<ssize_t>(bytes.size());
    if (send(socket_.Get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) != size) return false;
    stream_ += 2;
  }
  return true;
}

void UntakingClient::TakeAll() {
  while (!closed_) {
    char bytes[4096];
    const ssize_t count = recv(socket_.Get(), bytes, sizeof(bytes), MSG_DONTWAIT);
    if (count > 0) received_.append(bytes, static_cast<std::size_t>(count));
    closed_ = count == 0 || (count < 0 && errno == ECONNRESET);
    while (TakeFrame()) {
    }
    if (count < 0) return;
  }
}

bool UntakingClient::IsAnswered() {
  TakeAll();
  return answered_;
}

bool UntakingClient::IsReset() {
  TakeAll();
  return reset_;
}

int UntakingClient::Refused() {
  TakeAll();
  return refused_;
}

bool UntakingClient::IsClosed() {
  TakeAll();
  return closed_;
}

std::string UntakingClient::Frame(char type, char flags, std::size_t stream,
                                  const std::string& payload) {
  return Number(payload.size(), 3) + type + flags + Number(stream, 4) + payload;
}

void UntakingClient::Send(const std::string& bytes) {
  EXPECT_EQ(send(socket_.Get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(bytes.size()));
}

void UntakingClient::Answer(const std::string& bytes) {
  (void)send(socket_.Get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

bool UntakingClient::TakeFrame() {
  constexpr std::size_t kHeader = 9;
  if (received_.size() < kHeader) return false;
  std::size_t bytes = 0;
  for (int i = 0; i < 3; ++i) bytes = bytes << 8 | static_cast<unsigned char>(received_[i]);
  if (received_.size() < kHeader + bytes) return false;
  const char type = received_[3];
  const char flags = received_[4];
  const std::string payload = received_.substr(kHeader, bytes);
  received_.erase(0, kHeader + bytes);
  if (type == kReset) reset_ = true;
  // Headers that end the call are a response of trailers only: no message was in flight.
  if (type == kHeaders && (flags & kEndStream) != 0) ++refused_;
  if (type == kHeaders && (flags & kEndStream) == 0) answered_ = true;
  if (type == kSettings && flags != kAck) Answer(Frame(kSettings, kAck, 0, ""));
  if (type == kPing && flags != kAck) Answer(Frame(kPing, kAck, 0, payload));
  return true;
}

}  // namespace thunderhead::testing
