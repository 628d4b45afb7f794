// Settings that techniques have in common which draw the storm's fields as a medium.
#pragma once

#include "scene/transport.h"

namespace thunderhead::scene {

// Which of the fields' own properties a picture shows.
struct FieldLook {
  bool per_field_phase = true;  // false: the phase function of cloud water for every field
  bool detail = false;          // turbulent detail finer than the grid
  bool false_colors = false;

  bool operator==(const FieldLook&) const = default;
};

struct MediumSettings {
  Transport transport = Transport::kConsistent;
  // Light scattered by less than half of this angle counts as unscattered (theta_f of the paper).
  double theta_f_deg = 20.0;
  FieldLook look;

  bool operator==(const MediumSettings&) const = default;
};

}  // namespace thunderhead::scene
