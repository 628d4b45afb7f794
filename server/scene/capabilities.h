// The parts of a scene that a technique can show; read by the server, the page and the tables.
#pragma once

#include <span>

#include "scene/transport.h"

namespace thunderhead::scene {

// The use that a technique makes of the fields' turbulent detail.
enum class DetailUse {
  kNone,
  kMedium,     // structure finer than the grid, by a setting of its own
  kRoughness,  // that of the field with the largest share roughens its surfaces
};

struct Capabilities {
  bool lights = false;  // lights besides the sun
  DetailUse detail = DetailUse::kNone;
  bool field_optics = false;  // the fields' phase functions and false colours
  bool traced_light = false;  // correction by traced paths
  bool slices = false;        // pictures depend on a number of slices or samples
  bool sparse = false;        // draws chosen rays alone, as moving pictures are made of
  bool images = true;         // drawn by a renderer; false: traced beside the renderers
  std::span<const Transport> transports = {};  // that it accepts, its default first; static
};

}  // namespace thunderhead::scene
