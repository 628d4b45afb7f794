// Decides from the traffic of a connection whether its peer is still connected: when to ping it,
// and when to drop it. It is independent of sockets and clocks.
#pragma once

#include <chrono>
#include <cstdint>

namespace thunderhead::gateway {

class PeerLiveness {
 public:
  using Clock = std::chrono::steady_clock;

  struct Limits {
    // Interval after which a silent peer is pinged. A peer that stays silent for another interval
    // is dropped. While the server reads nothing from the peer, it is enough that the ping is
    // delivered.
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
    bool is_pinging = false;  // true while a requested ping is not sent yet
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
  uint64_t ping_end_bytes_ = 0;  // delivered_bytes at which the ping counts as delivered
  Clock::time_point last_sign_;  // the last sign of life
  Clock::time_point last_sent_;
  Clock::time_point last_delivered_;
  Clock::time_point ping_progress_;  // the last progress of the ping's delivery
  Clock::time_point closing_since_;
};

}  // namespace thunderhead::gateway
