// Restores control to a person who steered when the connection was lost. After the client has
// joined again, this class decides at each presence message (the list of people and the person in
// control) whether the client takes control again. The server may notice the loss late, so the old
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
    kWaits,  // the client may still get control back, so it keeps its unsent edits
    kLost,   // another viewer steers
  };

  // Reports that the client has joined again. The arguments describe the lost connection: the
  // person's viewer id and the last presence message.
  void Rejoined(std::uint64_t viewer_id, const v1::Presence& presence);
  // Returns what the client should do after a presence message in which this person does not steer.
  Outcome Of(const v1::Presence& presence, bool presents);
  // Ends the resumption, because this person steers again or no longer expects to steer.
  void End() { own_ids_.clear(); }

 private:
  bool Awaits(const v1::Presence& presence, bool presents) const;

  // This person's viewer ids in all connections since this person last steered. The set is empty if
  // this person does not expect to get control back.
  std::set<std::uint64_t> own_ids_;
  // The people who were present when the connection was lost.
  std::set<std::uint64_t> known_;
  bool takes_ = false;
};

}  // namespace thunderhead::client
