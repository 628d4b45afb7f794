// The light of sky and ground on a white surface as a function of the surface's normal. This is
// Neyret's spherical light map (2000, section 4.1). It consists of the first nine spherical
// harmonics, which suffice for a diffuse surface. Source: Ramamoorthi and Hanrahan 2001, "An
// Efficient Representation for Irradiance Environment Maps", eq. 12-13. This code does not use a
// sky or GL.
#pragma once

#include <functional>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// Returns the radiance of a surface of albedo 1 as a function of its normal. `radiance_from` must
// return the radiance that arrives from a direction. The result holds the coefficients of 1, y, z,
// x, xy, yz, 3 z^2 - 1, xz and x^2 - y^2 of the normal. Because of the truncation, the radiance can
// be below 0 by up to 3 % of the brightest value.
std::vector<glm::vec3> LightMapOf(
    const std::function<glm::vec3(const glm::vec3& direction)>& radiance_from);

}  // namespace thunderhead::renderers
