// Applies the difference between two messages to a third message. The web page uses the same rules
// (client-web/src/core/scene_change.ts).
#pragma once

#include "google/protobuf/message.h"

namespace thunderhead::desktop {

// Changes `present`: each value that differs between `from` and `to` becomes the value in `to`. All
// other values stay. All three messages have the same type. A oneof counts as one value, and so
// does a list whose length differs between `from` and `to`. The items of other lists are compared
// one by one. Such a list stays unchanged if `present` has a different number of items.
void MakeChange(const google::protobuf::Message& from, const google::protobuf::Message& to,
                google::protobuf::Message& present);

}  // namespace thunderhead::desktop
