// The features of a scene that a technique can show. The server, the web page and the tables of
// measured techniques read them.
#pragma once

#include <span>

#include "scene/transport.h"

namespace thunderhead::scene {

// How a technique uses the fields' turbulent detail.
enum class DetailUse {
  kNone,
  kMedium,     // the medium has structure finer than the grid; a setting turns it on
  kRoughness,  // the strongest detail of any field (largest Detail::share) roughens the surfaces
};

struct Capabilities {
  bool lights = false;  // directional lights (Scene::lights) in addition to the sun
  DetailUse detail = DetailUse::kNone;
  bool field_optics = false;  // the fields' own phase functions and false colours
  bool traced_light = false;  // path tracing can correct the technique's light
  bool slices = false;        // images depend on a number of slices or of samples along a ray
  // True if the technique can render a chosen subset of the rays, which frames of a moving camera
  // need.
  bool sparse = false;
  // True if a renderer draws the technique on the GPU. False if the technique is path-traced
  // without a renderer.
  bool images = true;
  // The transports that the technique accepts, the default first. The span refers to static
  // storage.
  std::span<const Transport> transports = {};
};

}  // namespace thunderhead::scene
