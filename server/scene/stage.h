// The stages of rendering that a change of the scene can dirty.
#pragma once

namespace thunderhead::scene {

// The stages in their order. After a change, the first stage that the change dirties and every
// later stage run again.
enum class Stage { kStorm, kExtinction, kLight, kView, kTone, kNothing };

}  // namespace thunderhead::scene
