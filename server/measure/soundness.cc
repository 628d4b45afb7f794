#include "measure/soundness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"

namespace thunderhead::measure {
namespace {

// Mean intensity of multiply scattered light, over the sun's irradiance: deep in an infinite
// conservative cloud with the sun in the zenith the fluence is five times the incident flux
// (Eddington).
constexpr double kMaxMeanIntensity = 5.0 / (4.0 * std::numbers::pi);

// Two floats a texel, x fastest.
std::vector<float> TwoChannels(const gl::Texture3D& texture) {
  const glm::ivec3 size = texture.Size();
  std::vector<float> texels(2 * static_cast<std::size_t>(size.x) *
                            static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z));
  texture.Download(GL_RG, GL_FLOAT, texels.size() * sizeof(float), texels.data());
  return texels;
}

void InspectRoot(float root, const char* where, Soundness* found) {
  const double depth = static_cast<double>(root) * root;
  if (std::isfinite(root) && root >= 0.0F) {
    found->least_light = std::min(found->least_light, std::exp(-depth));
  } else if (found->unsound.empty()) {
    found->unsound = absl::StrFormat("root of the light's depth %g %s", root, where);
  }
}

// Both optical depths only grow along the ray. Layers that no cell reads are never written and are
// 0.
void InspectRays(const gl::Texture3D& carried, Soundness* found) {
  const std::vector<float> texels = TwoChannels(carried);
  const glm::ivec3 size = carried.Size();
  const std::size_t layer = 2 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    if (i % 2 == 0) InspectRoot(texels[i], "along the sun's rays", found);
    const bool grows = i < layer || texels[i] == 0.0F || texels[i] >= texels[i - layer];
    if (grows || !found->unsound.empty()) continue;
    found->unsound = absl::StrFormat("light's optical depth %g after %g on its ray", texels[i],
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
        mean_intensity <= kMaxMeanIntensity) {
      continue;
    }
    if (found.unsound.empty()) {
      found.unsound = absl::StrFormat("mean intensity %g at a cell", mean_intensity);
    }
  }
  return found;
}

}  // namespace thunderhead::measure
