#include "gateway/peer_liveness.h"

#include <algorithm>

namespace thunderhead::gateway {

PeerLiveness::PeerLiveness(const Limits& limits, Clock::time_point now)
    : limits_(limits),
      last_sign_(now),
      last_sent_(now),
      last_delivered_(now),
      ping_progress_(now),
      closing_since_(now) {}

PeerLiveness::Verdict PeerLiveness::Judge(const Observation& seen, Clock::time_point now) {
  Note(seen, now);
  const bool is_sending = seen.is_writing || seen.is_pinging;
  if (is_sending && now - last_sent_ >= limits_.write_stall_timeout) return Verdict::kDrop;
  if (seen.is_closing) {
    // The timeout begins again with each delivery, because data sent before the close frame may
    // still be in flight on a slow link.
    const Clock::time_point since = std::max(closing_since_, last_delivered_);
    return now - since >= limits_.close_timeout ? Verdict::kDrop : Verdict::kFine;
  }
  if (awaits_pong_) {
    return now - ping_progress_ >= limits_.ping_interval ? Verdict::kDrop : Verdict::kFine;
  }
  if (now - last_sign_ < limits_.ping_interval) return Verdict::kFine;
  awaits_pong_ = true;
  ping_unsent_ = true;
  ping_progress_ = now;
  return Verdict::kPing;
}

void PeerLiveness::Note(const Observation& seen, Clock::time_point now) {
  const bool was_sending = last_.is_writing || last_.is_pinging;
  if (seen.sent_bytes != last_.sent_bytes || !was_sending) last_sent_ = now;
  if (seen.delivered_bytes != last_.delivered_bytes) last_delivered_ = now;
  NotePing(seen, now);
  if (!last_.is_closing && seen.is_closing) closing_since_ = now;
  last_ = seen;
}

void PeerLiveness::NotePing(const Observation& seen, Clock::time_point now) {
  // The ping is queued behind earlier data. A peer that still receives this data is alive.
  const bool was_delivered = !ping_unsent_ && last_.delivered_bytes >= ping_end_bytes_;
  if (seen.delivered_bytes != last_.delivered_bytes && !was_delivered) ping_progress_ = now;
  if (ping_unsent_ && !seen.is_pinging) {
    ping_unsent_ = false;
    ping_end_bytes_ = seen.sent_bytes;
  }
  const bool is_delivered = !ping_unsent_ && seen.delivered_bytes >= ping_end_bytes_;
  if (seen.received_bytes != last_.received_bytes ||
      (awaits_pong_ && !seen.is_reading && is_delivered)) {
    last_sign_ = now;
    awaits_pong_ = false;
  }
}

}  // namespace thunderhead::gateway
