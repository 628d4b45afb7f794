// The light of sky and ground on a white surface, by its normal: Neyret's spherical light map
// (2000, 4.1). It consists of the nine spherical harmonics that a diffuse surface can distinguish.
// Source: Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment
// Maps", eq. 12-13. This code does not use a sky or GL.
#pragma once

#include <functional>
#include <vector>

#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// Returns the radiance of a surface of albedo 1 by its normal. The result holds the coefficients of
// 1, y, z, x, xy, yz, 3 z^2 - 1, xz and x^2 - y^2 of the normal. The radiance is at least 0 within
// 3 % of the brightest.
std::vector<glm::vec3> LightMapOf(
    const std::function<glm::vec3(const glm::vec3& direction)>& radiance_from);

}  // namespace thunderhead::renderers
