// Decides from the traffic of a connection when to ping its peer, and when to drop the connection
// because the peer is gone. It is independent of sockets and clocks.
#pragma once

#include <chrono>
#include <cstdint>

namespace thunderhead::gateway {

class PeerLiveness {
 public:
  using Clock = std::chrono::steady_clock;

  struct Limits {
    // A peer that is silent for this interval is pinged. If it stays silent for another interval,
    // it is dropped. While the server reads nothing from the peer, it is enough that the ping is
    // delivered to the peer's machine.
    std::chrono::milliseconds ping_interval;
    // Timeout of a peer that accepts no bytes of a write.
    std::chrono::milliseconds write_stall_timeout;
    // Timeout of a peer that does not answer a close frame.
    std::chrono::milliseconds close_timeout;
  };

  struct Observation {
    uint64_t received_bytes = 0;
    uint64_t sent_bytes = 0;       // accepted by the kernel
    uint64_t delivered_bytes = 0;  // acknowledged by the peer's machine
    bool is_writing = false;
    bool is_pinging = false;  // true while a ping that was requested has not been sent yet
    bool is_reading = true;   // false while the server reads nothing from the peer
    bool is_closing = false;
  };

  enum class Verdict { kFine, kPing, kDrop };

  PeerLiveness(const Limits& limits, Clock::time_point now);

  Verdict Judge(const Observation& seen, Clock::time_point now);

 private:
  void Note(const Observation& seen, Clock::time_point now);
  void NotePing(const Observation& seen, Clock::time_point now);

  Limits limits_;
  Observation last_;
  bool awaits_pong_ = false;
  bool ping_unsent_ = false;
  // The ping counts as delivered once delivered_bytes reaches this value.
  uint64_t ping_end_bytes_ = 0;
  Clock::time_point last_sign_;  // time of the last sign of life
  Clock::time_point last_sent_;
  Clock::time_point last_delivered_;
  Clock::time_point ping_progress_;  // time of the last progress in the delivery of the ping
  Clock::time_point closing_since_;
};

}  // namespace thunderhead::gateway
