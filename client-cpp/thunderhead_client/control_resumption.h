// The way back to control for somebody who steered when the connection was lost: each presence
// after joining again decides. The server may not know yet that the old connection is lost, and
// then sees it steer for some seconds.
#pragma once

#include <cstdint>
#include <set>

#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

class ControlResumption {
 public:
  enum class Outcome {
    kTakes,  // control is to be taken again
    kWaits,  // control is on its way back; edits are kept until then
    kLost,   // another steers
  };

  // Joined again; the arguments are of the connection that was lost: the person's id and the last
  // presence.
  void Rejoined(std::uint64_t viewer_id, const v1::Presence& presence);
  // Of a presence in which this person does not steer.
  Outcome Of(const v1::Presence& presence, bool presents);
  // This person steers, or no longer expects to.
  void End() { own_ids_.clear(); }

 private:
  bool Awaits(const v1::Presence& presence, bool presents) const;

  // This person's ids in the connections since it steered; empty unless control is expected back.
  std::set<std::uint64_t> own_ids_;
  // The people who were there when the connection was lost.
  std::set<std::uint64_t> known_;
  bool takes_ = false;
};

}  // namespace thunderhead::client
