// The stages of rendering that a change of the scene can dirty.
#pragma once

namespace thunderhead::scene {

// The stages in their order. A change reruns the first stage that it dirties and every later one.
enum class Stage { kStorm, kExtinction, kLight, kView, kTone, kNothing };

}  // namespace thunderhead::scene
