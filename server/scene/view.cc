#include "scene/view.h"

#include <algorithm>
#include <cmath>

#include "glm/geometric.hpp"
#include "glm/matrix.hpp"
#include "glm/trigonometric.hpp"
#include "volume/terrain.h"

namespace thunderhead::scene {

glm::dvec3 Direction(double azimuth_deg, double elevation_deg) {
  const double azimuth = glm::radians(azimuth_deg);
  const double elevation = glm::radians(elevation_deg);
  return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

namespace {

constexpr double kMargin = 1.05;

// An altitude above practically all air, so that a picture from there shows what a satellite sees.
constexpr double kSatelliteAltitude_m = 1e5;

// Sets the axes of a view along `forward`. The picture's vertical is that of `zenith`.
void LookAlong(const glm::dvec3& forward, const glm::dvec3& zenith, View* view) {
  view->forward = forward;
  view->right = glm::normalize(glm::cross(forward, zenith));
  view->up = glm::cross(view->right, forward);
}

// Returns half the width and height of the picture divided by the focal length. The picture is cut
// out of a frame of 36 x 24 mm.
glm::dvec2 HalfFrame(double focal_length_mm, double aspect_ratio) {
  const double half_width_mm = aspect_ratio >= 1.5 ? 18.0 : 12.0 * aspect_ratio;
  return glm::dvec2(half_width_mm, half_width_mm / aspect_ratio) / focal_length_mm;
}

// Sets the members of a view that follow from the Earth's curvature and the eye's place. Returns
// how far sea level at the eye is below the plane of world coordinates. A paraboloid approximates
// the sphere. At a distance of 150 km the two differ by less than 0.2 m.
double StandOnEarth(const Site& site, View* view) {
  view->touch_m = site.storm_middle_m;
  view->ground_curvature_per_m = 1.0 / kEffectiveEarthRadius_m;
  const glm::dvec2 off_m = glm::dvec2(view->eye_m) - site.storm_middle_m;
  const double distance_m = glm::length(off_m);
  const glm::dvec2 away = distance_m > 0.0 ? off_m / distance_m : glm::dvec2(0.0, -1.0);
  const double angle = std::atan(distance_m / kEffectiveEarthRadius_m);
  const glm::dvec3 outwards(away, 0.0);
  const glm::dvec3 sideways(-away.y, away.x, 0.0);
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const glm::dvec3 leaning = std::sin(angle) * outwards + std::cos(angle) * up;
  const glm::dvec3 falling = std::cos(angle) * outwards - std::sin(angle) * up;
  view->local_from_world =
      glm::dmat3(outwards, sideways, up) * glm::transpose(glm::dmat3(falling, sideways, leaning));
  return 0.5 * distance_m * distance_m / kEffectiveEarthRadius_m;
}

double AzimuthOf(const glm::dvec2& towards) {
  return glm::degrees(std::atan2(towards.x, towards.y));
}

}  // namespace

View ViewOf(const OrbitCamera& camera, double aspect_ratio) {
  View view;
  const glm::dvec3 towards_eye = Direction(camera.azimuth_deg, camera.elevation_deg);
  view.eye_m = camera.target_m + camera.distance_m * towards_eye;
  LookAlong(-towards_eye, {0.0, 0.0, 1.0}, &view);
  view.altitude_m = view.eye_m.z;
  view.tan_half_height = std::tan(glm::radians(camera.field_of_view_deg) / 2.0);
  view.tan_half_width = view.tan_half_height * aspect_ratio;
  return view;
}

View ViewOf(const OrbitCamera& camera, const Site& site, double aspect_ratio) {
  View view = ViewOf(camera, aspect_ratio);
  const double drop_m = StandOnEarth(site, &view);
  view.altitude_m = view.eye_m.z + drop_m;
  return view;
}

View ViewOf(const SpotterCamera& camera, const Site& site, double aspect_ratio) {
  View view;
  view.altitude_m = site.ground_height_m + camera.eye_height_m;
  view.eye_m = glm::dvec3(camera.place_m, 0.0);
  const double drop_m = StandOnEarth(site, &view);
  view.eye_m.z = view.altitude_m - drop_m;
  const glm::dmat3 world_from_local = glm::transpose(view.local_from_world);
  LookAlong(world_from_local * Direction(camera.azimuth_deg, camera.elevation_deg),
            world_from_local[2], &view);
  const glm::dvec2 half_frame = HalfFrame(camera.focal_length_mm, aspect_ratio);
  view.tan_half_width = half_frame.x;
  view.tan_half_height = half_frame.y;
  return view;
}

View ViewOf(const TopDownCamera& camera, double aspect_ratio) {
  View view;
  view.eye_m = glm::dvec3(camera.center_m, kSatelliteAltitude_m);
  view.altitude_m = kSatelliteAltitude_m;
  view.forward = {0.0, 0.0, -1.0};
  view.up = {0.0, 1.0, 0.0};
  view.tan_half_width = 0.0;
  view.tan_half_height = 0.0;
  view.half_width_m = camera.width_m / 2.0;
  view.half_height_m = view.half_width_m / aspect_ratio;
  return view;
}

ViewRay RayThrough(const View& view, double x, double y) {
  return {view.eye_m + x * view.half_width_m * view.right + y * view.half_height_m * view.up,
          glm::normalize(view.forward + x * view.tan_half_width * view.right +
                         y * view.tan_half_height * view.up)};
}

Site SiteOf(const volume::HydrometeorFields& fields, const glm::dvec2& place_m) {
  const volume::RegularGrid& grid = fields.grid;
  const volume::CellBox& cells = fields.condensate;
  const glm::dvec3 middle_cell =
      cells.Empty() ? glm::dvec3(grid.cells) / 2.0 : glm::dvec3(cells.low + cells.high) / 2.0;
  return {volume::TerrainHeight_m(fields, place_m),
          glm::dvec2(grid.low_corner_m + middle_cell * grid.spacing_m)};
}

View ViewOf(const Scene& scene, const volume::HydrometeorFields& fields) {
  const double aspect_ratio = static_cast<double>(scene.output.width_px) / scene.output.height_px;
  if (const auto* top_down = std::get_if<TopDownCamera>(&scene.camera)) {
    return ViewOf(*top_down, aspect_ratio);
  }
  if (const auto* orbit = std::get_if<OrbitCamera>(&scene.camera)) {
    return ViewOf(*orbit, SiteOf(fields, glm::dvec2(0.0)), aspect_ratio);
  }
  const auto& spotter = std::get<SpotterCamera>(scene.camera);
  return ViewOf(spotter, SiteOf(fields, spotter.place_m), aspect_ratio);
}

double FramingElevation_deg(const glm::dvec3& low_m, const glm::dvec3& high_m) {
  constexpr double kStormElevation_deg = OrbitCamera().elevation_deg;
  constexpr double kDomainElevation_deg = 35.0;
  constexpr double kStormHeight = 0.1;  // height / width of a single storm
  constexpr double kDomainHeight = 0.02;
  const glm::dvec3 size_m = high_m - low_m;
  const double height = size_m.z / std::max(std::max(size_m.x, size_m.y), 1.0);
  const double flatness = std::clamp(
      std::log(kStormHeight / std::max(height, 1e-6)) / std::log(kStormHeight / kDomainHeight), 0.0,
      1.0);
  return std::lerp(kStormElevation_deg, kDomainElevation_deg, flatness);
}

OrbitCamera Framing(OrbitCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    double aspect_ratio) {
  camera.target_m = (low_m + high_m) / 2.0;
  const View view = ViewOf(camera, aspect_ratio);
  double distance_m = 1.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 point((corner & 1) != 0 ? high_m.x : low_m.x,
                           (corner & 2) != 0 ? high_m.y : low_m.y,
                           (corner & 4) != 0 ? high_m.z : low_m.z);
    const glm::dvec3 offset = point - camera.target_m;
    const double towards_eye = -glm::dot(offset, view.forward);
    const double across = std::abs(glm::dot(offset, view.right)) / view.tan_half_width;
    const double along = std::abs(glm::dot(offset, view.up)) / view.tan_half_height;
    distance_m = std::max(distance_m, towards_eye + kMargin * std::max(across, along));
  }
  camera.distance_m = distance_m;
  return camera;
}

SpotterCamera Framing(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio) {
  OrbitCamera level;
  level.azimuth_deg = camera.azimuth_deg + 180.0;
  level.elevation_deg = 0.0;
  const double tan_half_height = HalfFrame(camera.focal_length_mm, aspect_ratio).y;
  level.field_of_view_deg = 2.0 * glm::degrees(std::atan(tan_half_height));
  camera.place_m = glm::dvec2(ViewOf(Framing(level, low_m, high_m, aspect_ratio), 1.0).eye_m);
  return camera;
}

TopDownCamera Framing(TopDownCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m,
                      double aspect_ratio) {
  const glm::dvec2 size_m(high_m - low_m);
  camera.center_m = glm::dvec2(low_m + high_m) / 2.0;
  camera.width_m = kMargin * std::max(size_m.x, size_m.y * aspect_ratio);
  return camera;
}

SpotterCamera LookingAt(SpotterCamera camera, const glm::dvec3& low_m, const glm::dvec3& high_m) {
  const glm::dvec2 towards_m = glm::dvec2(low_m + high_m) / 2.0 - camera.place_m;
  const double distance_m = glm::length(towards_m);
  if (distance_m > 0.0) camera.azimuth_deg = AzimuthOf(towards_m);
  // The camera looks up at half the elevation of the storm's top. The top is then as far above the
  // picture's middle as the ground at the storm's foot is below it.
  camera.elevation_deg = 0.5 * glm::degrees(std::atan2(high_m.z - low_m.z, distance_m));
  return camera;
}

}  // namespace thunderhead::scene
