// The difference of two messages, member by member, made to a third one that differs elsewhere; the
// page's rules (client-web/src/core/scene_change.ts).
#pragma once

#include "google/protobuf/message.h"

namespace thunderhead::desktop {

// Gives `present` what differs between `from` and `to` as `to` has it, and leaves the rest. A oneof
// counts as one value. A list whose length differs between the two, too; the items of others are
// compared one by one, and left where `present` has another number of them. All three are of one
// type.
void MakeChange(const google::protobuf::Message& from, const google::protobuf::Message& to,
                google::protobuf::Message& present);

}  // namespace thunderhead::desktop
