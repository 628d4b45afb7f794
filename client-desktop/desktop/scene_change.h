// Applies the difference of two messages, member by member, to a third message that may differ
// elsewhere. The rules are those of the page (client-web/src/core/scene_change.ts).
#pragma once

#include "google/protobuf/message.h"

namespace thunderhead::desktop {

// Sets what differs between `from` and `to` in `present` to its value in `to`, and leaves the rest.
// A oneof counts as one value. So does a list whose length differs between `from` and `to`. The
// items of other lists are compared one by one. They are left unchanged if `present` has a
// different number of items. All three messages have the same type.
void MakeChange(const google::protobuf::Message& from, const google::protobuf::Message& to,
                google::protobuf::Message& present);

}  // namespace thunderhead::desktop
