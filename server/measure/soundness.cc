#include "measure/soundness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "physics/optics.h"

namespace thunderhead::measure {
namespace {

// Returns the texels of a texture with `channels` floats each, which must suit `format`. x varies
// fastest.
std::vector<float> Texels(const gl::Texture3D& texture, GLenum format, std::size_t channels) {
  const glm::ivec3 size = texture.Size();
  std::vector<float> texels(channels * static_cast<std::size_t>(size.x) *
                            static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z));
  texture.Download(format, GL_FLOAT, texels.size() * sizeof(float), texels.data());
  return texels;
}

std::vector<float> TwoChannels(const gl::Texture3D& texture) { return Texels(texture, GL_RG, 2); }

void InspectRoot(float root, const char* where, Soundness* found) {
  const double depth = static_cast<double>(root) * root;
  if (std::isfinite(root) && root >= 0.0F) {
    found->least_light = std::min(found->least_light, std::exp(-depth));
  } else if (found->unsound.empty()) {
    found->unsound =
        absl::StrFormat("square root of the sunlight's optical depth is %g %s", root, where);
  }
}

// Checks that both optical depths do not decrease along the ray. A value of 0 is skipped, because
// layers that no cell reads are never written and are 0.
void InspectRays(const gl::Texture3D& carried, Soundness* found) {
  const std::vector<float> texels = TwoChannels(carried);
  const glm::ivec3 size = carried.Size();
  const std::size_t layer = 2 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (i % 2 == 0) InspectRoot(texels[i], "along the sun's rays", found);
    const bool grows = i < layer || texels[i] == 0.0F || texels[i] >= texels[i - layer];
    if (grows || !found->unsound.empty()) continue;
    found->unsound = absl::StrFormat("optical depth %g after %g on the same sun ray", texels[i],
                                     texels[i - layer]);
  }
}

}  // namespace

std::string UnsoundPicture(const std::vector<float>& eye) {
  for (std::size_t i = 0; i < eye.size(); ++i) {
    const bool share = i % 4 == 3;
    if (std::isfinite(eye[i]) && eye[i] >= 0.0F && (!share || eye[i] <= kMaxShare)) continue;
    return absl::StrFormat("%s %g in pixel %d", share ? "transmittance" : "radiance", eye[i],
                           i / 4);
  }
  return {};
}

Soundness LightBufferSoundness(const std::vector<float>& light) {
  Soundness found;
  for (std::size_t i = 0; i < light.size(); ++i) {
    if (i % 4 > 1) continue;
    const bool share = i % 4 == 0;
    if (std::isfinite(light[i]) && light[i] >= 0.0F && (!share || light[i] <= kMaxShare)) {
      if (share) found.least_light = std::min<double>(found.least_light, light[i]);
    } else if (found.unsound.empty()) {
      found.unsound =
          absl::StrFormat("%s %g in the light buffer", share ? "light" : "depth", light[i]);
    }
  }
  return found;
}

Soundness LightVolumeSoundness(const renderers::LightVolumeRenderer& renderer) {
  Soundness found;
  InspectRays(renderer.Carried(), &found);
  const std::vector<float> arrived = TwoChannels(renderer.Arrived());
  for (std::size_t i = 0; i < arrived.size(); i += 2) {
    InspectRoot(arrived[i], "at a cell", &found);
    const float mean_intensity = arrived[i + 1];
    if (std::isfinite(mean_intensity) && mean_intensity >= 0.0F &&
        mean_intensity <= kMaxFluence / (4.0 * std::numbers::pi)) {
      continue;
    }
    if (found.unsound.empty()) {
      found.unsound = absl::StrFormat("mean intensity %g at a cell", mean_intensity);
    }
  }
  return found;
}

Soundness DiffusionSoundness(const renderers::LightVolumeRenderer& renderer,
                             double transport_share) {
  Soundness found;
  const std::vector<float> arrived = TwoChannels(renderer.Arrived());
  const std::vector<float> exits = Texels(renderer.Diffusion().Exits(), GL_RGBA, 4);
  const std::vector<float> inward = Texels(renderer.Diffusion().NetInward(), GL_RGBA, 4);
  for (std::size_t i = 0; i < exits.size() && found.unsound.empty(); i += 4) {
    const float exit = exits[i] * exits[i];
    const float sun_depth = arrived[i / 2] * arrived[i / 2];
    const float fluence = physics::glsl::diffuse_fluence(
        exit, sun_depth, static_cast<float>(transport_share) * exit, inward[i], inward[i + 1]);
    if (std::isfinite(fluence) && fluence <= kMaxFluence) continue;
    found.unsound = absl::StrFormat("fluence %g of diffuse light in cell %d", fluence, i / 4);
  }
  return found;
}

}  // namespace thunderhead::measure
