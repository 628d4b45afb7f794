// Settings that are common to the techniques that draw the storm's fields as a medium.
#pragma once

#include "scene/transport.h"

namespace thunderhead::scene {

// Choices of which properties of the single fields a picture shows.
struct FieldLook {
  bool per_field_phase = true;  // if false, every field has the phase function of cloud water
  bool detail = false;          // turbulent detail finer than the grid
  bool false_colors = false;

  bool operator==(const FieldLook&) const = default;
};

struct MediumSettings {
  Transport transport = Transport::kConsistent;
  // Light scattered by less than half of this angle counts as unscattered. The angle is theta_f of
  // Riley et al. 2003.
  double theta_f_deg = 20.0;
  FieldLook look;

  bool operator==(const MediumSettings&) const = default;
};

}  // namespace thunderhead::scene
