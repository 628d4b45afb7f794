// Measures the capacity of one gateway thread with many viewers of one stream by WebSocket. Each
// client starts a call that sends messages at a rate, and reads them; some clients may stop
// reading. Prints messages per second, the processor time of the gateway's thread and of all
// threads, and delays.
//
// Arguments: [clients] [messages a second] [bytes a message] [seconds] [clients that stop reading]
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/gateway/echo_service.h"

namespace thunderhead::gateway::test {
namespace {

namespace net = boost::asio;
namespace websocket = boost::beast::websocket;
using Clock = std::chrono::steady_clock;

struct Load {
  int clients = 200;
  int rate_per_s = 20;
  int message_bytes = 45'000;
  int seconds = 10;
  int stopped = 1;
};

struct Tally {
  int messages = 0;
  int ended = 0;
  std::vector<double> late_ms;
};

// A client that reads messages and measures how late each of them is. A message is due one interval
// after the previous one.
class Viewer {
 public:
  Viewer(net::io_context& io, uint16_t port, const Load& load, bool is_stopped, Tally& tally)
      : socket_(io), interval_ms_(1000 / load.rate_per_s), tally_(tally) {
    socket_.next_layer().socket().connect({net::ip::address_v4::loopback(), port});
    socket_.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
      request.set("Sec-WebSocket-Protocol", "grpc-websocket.v1");
    }));
    socket_.handshake("localhost", "/thunderhead.gateway.test.Echo/Count");
    socket_.binary(true);
    CountRequest request;
    request.set_count(load.seconds * load.rate_per_s);
    request.set_interval_ms(interval_ms_);
    request.set_payload_bytes(load.message_bytes);
    socket_.write(net::buffer(std::string(1, '\0') + request.SerializeAsString()));
    socket_.write(net::buffer(std::string(1, '\1')));
    if (!is_stopped) Read();
  }

 private:
  void Read() {
    received_.clear();
    socket_.async_read(received_, [this](boost::system::error_code error, size_t) {
      if (error) {
        ++tally_.ended;
        return;
      }
      const auto now = Clock::now();
      ++tally_.messages;
      // The pause begins when the previous message was written, so the gap between messages counts.
      if (last_ != Clock::time_point()) {
        const std::chrono::duration<double, std::milli> gap = now - last_;
        tally_.late_ms.push_back(std::max(0.0, gap.count() - interval_ms_));
      }
      last_ = now;
      Read();
    });
  }

  websocket::stream<boost::beast::tcp_stream, /*deflateSupported=*/false> socket_;
  const int interval_ms_;
  Tally& tally_;
  boost::beast::flat_buffer received_;
  Clock::time_point last_;
};

double ProcessorSeconds() {
  rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return time.tv_sec + time.tv_usec * 1e-6; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double ThisThreadSeconds() {
  timespec time = {};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec + time.tv_nsec * 1e-9;
}

long ResidentKb() {
  rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

void Run(const Load& load) {
  GatewayOptions options;
  options.max_connections = load.clients;
  const auto site = EchoSite::Start(options);
  net::io_context io(1);
  Tally tally;
  std::vector<std::unique_ptr<Viewer>> viewers;
  const auto begin = Clock::now();
  const double processor_before = ProcessorSeconds();
  for (int i = 0; i < load.clients; ++i) {
    viewers.push_back(std::make_unique<Viewer>(io, site->Port(), load, i < load.stopped, tally));
  }
  const int reading = load.clients - load.stopped;
  while (tally.ended < reading) io.run_one();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::sort(tally.late_ms.begin(), tally.late_ms.end());
  const auto late = [&](double share) {
    return tally.late_ms[static_cast<size_t>(share * (tally.late_ms.size() - 1))];
  };
  std::printf("%d clients, %d stopped: %.1f s, %.0f messages/s of %d wanted, %.0f MB/s\n",
              load.clients, load.stopped, seconds, tally.messages / seconds,
              reading * load.rate_per_s, tally.messages / seconds * load.message_bytes * 1e-6);
  std::printf("gaps over the interval: median %.1f ms, p99 %.1f ms, largest %.1f ms\n", late(0.5),
              late(0.99), late(1));
  std::printf("processor time a second: all %.2f s, of it clients %.2f s; resident %ld MB\n",
              (ProcessorSeconds() - processor_before) / seconds, ThisThreadSeconds() / seconds,
              ResidentKb() / 1024);
}

}  // namespace
}  // namespace thunderhead::gateway::test

int main(int argc, char** argv) {
  thunderhead::gateway::test::Load load;
  int* const fields[] = {&load.clients, &load.rate_per_s, &load.message_bytes, &load.seconds,
                         &load.stopped};
  for (int i = 1; i < argc && i <= 5; ++i) *fields[i - 1] = std::atoi(argv[i]);
  thunderhead::gateway::test::Run(load);
  return 0;
}
