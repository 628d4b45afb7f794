// Deadlines of a socket's reads and writes, measured by the gateway's time source. Runs on one
// thread.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <memory>

#include "base/time_source.h"

namespace thunderhead::gateway {

// The deadlines of one socket. Beast's own streams have such deadlines too, but measure them only
// with the real clock.
class StreamDeadlines : public std::enable_shared_from_this<StreamDeadlines> {
 public:
  using TimePoint = base::TimeSource::Clock::time_point;
  enum class Way { kRead, kWrite };

  // Both arguments must outlive every operation for which Begin() was called.
  StreamDeadlines(boost::asio::ip::tcp::socket& socket, const base::TimeSource& time)
      : socket_(socket), time_(time), timer_(socket.get_executor()) {}

  // Sets the deadline of later operations. Pending operations keep theirs.
  void Set(TimePoint deadline) { next_ = deadline; }

  // Starts the deadline of an operation. At most one operation per direction may be pending. If the
  // operation has not ended by its deadline, the socket is closed.
  void Begin(Way way);
  void End(Way way) { Pending(way) = kNever; }

 private:
  static constexpr TimePoint kNever = TimePoint::max();

  TimePoint& Pending(Way way) { return pending_[static_cast<std::size_t>(way)]; }
  void Arm();
  void Look();

  boost::asio::ip::tcp::socket& socket_;
  const base::TimeSource& time_;
  TimePoint next_ = kNever;
  std::array<TimePoint, 2> pending_ = {kNever, kNever};
  boost::asio::steady_timer timer_;
  TimePoint armed_for_ = kNever;  // deadline for which the timer is set
};

}  // namespace thunderhead::gateway
