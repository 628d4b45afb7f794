// Decides from the bytes of a connection whether its peer is still there: when to ping it, and when
// to drop it. Knows no socket and no clock.
#pragma once

#include <chrono>
#include <cstdint>

namespace thunderhead::gateway {

class PeerLiveness {
 public:
  using Clock = std::chrono::steady_clock;

  struct Limits {
    // A peer that sends nothing for this time is pinged; one that then sends nothing for this time
    // again is dropped. While the server holds the peer back and reads nothing, it is enough that
    // the ping is delivered.
    std::chrono::milliseconds ping_interval;
    // A peer that accepts no bytes of a write for this time is dropped.
    std::chrono::milliseconds write_stall_timeout;
    // A peer that does not answer a close frame within this time is dropped.
    std::chrono::milliseconds close_timeout;
  };

  struct Observation {
    uint64_t received_bytes = 0;
    uint64_t sent_bytes = 0;       // taken by the kernel
    uint64_t delivered_bytes = 0;  // acknowledged by the peer's machine
    bool is_writing = false;
    bool is_pinging = false;  // a ping was asked for and is not yet sent
    bool is_reading = true;   // false while the server holds the peer back
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
  uint64_t ping_end_bytes_ = 0;  // the ping is delivered when these are
  Clock::time_point last_sign_;  // of life
  Clock::time_point last_sent_;
  Clock::time_point last_delivered_;
  Clock::time_point ping_progress_;  // last step of its delivery
  Clock::time_point closing_since_;
};

}  // namespace thunderhead::gateway
