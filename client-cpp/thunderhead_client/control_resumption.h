// Restores control to a person who steered when the connection was lost. Each presence after the
// client has joined again decides. The server may not have noticed the loss yet, so the old
// connection may appear to steer for some seconds.
#pragma once

#include <cstdint>
#include <set>

#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

class ControlResumption {
 public:
  enum class Outcome {
    kTakes,  // the client should take control again
    kWaits,  // control is expected back; edits are kept until then
    kLost,   // another viewer steers
  };

  // Reports that the client has joined again. The arguments describe the lost connection: the
  // person's id and its last presence.
  void Rejoined(std::uint64_t viewer_id, const v1::Presence& presence);
  // Returns what to do after a presence in which this person does not steer.
  Outcome Of(const v1::Presence& presence, bool presents);
  // Ends the resumption because this person steers, or no longer expects to.
  void End() { own_ids_.clear(); }

 private:
  bool Awaits(const v1::Presence& presence, bool presents) const;

  // This person's ids in the connections since it steered. The set is empty unless control is
  // expected back.
  std::set<std::uint64_t> own_ids_;
  // The people who were present when the connection was lost.
  std::set<std::uint64_t> known_;
  bool takes_ = false;
};

}  // namespace thunderhead::client
