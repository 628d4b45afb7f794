// The features of a scene that a technique can show. The server, the page and the tables read them.
#pragma once

#include <span>

#include "scene/transport.h"

namespace thunderhead::scene {

// How a technique uses the fields' turbulent detail.
enum class DetailUse {
  kNone,
  kMedium,     // the medium has structure finer than the grid; a setting turns it on
  kRoughness,  // the detail of the field with the largest share roughens the technique's surfaces
};

struct Capabilities {
  bool lights = false;  // directional lights in addition to the sun
  DetailUse detail = DetailUse::kNone;
  bool field_optics = false;  // the fields' own phase functions and false colours
  bool traced_light = false;  // correction of the light by path tracing
  bool slices = false;        // images depend on a number of slices or samples
  bool sparse = false;        // can render a chosen subset of rays, which moving frames need
  // Rendered on the GPU by a renderer; false: traced separately from the renderers.
  bool images = true;
  // The accepted values, the default first; static storage.
  std::span<const Transport> transports = {};
};

}  // namespace thunderhead::scene
