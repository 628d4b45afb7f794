#include "service/messages/cloud_messages.h"

#include "base/status.h"
#include "clouds/presets.h"

namespace thunderhead::service {
namespace {

using Request = v1::GenerateCloudRequest;

const char* PresetOf(Request::Preset preset) {
  switch (preset) {
    case Request::PRESET_CONGESTUS:
      return "congestus";
    case Request::PRESET_CUMULUS_FIELD:
      return "cumulus-field";
    default:
      return "fair-weather-cumulus";
  }
}

void SetNoise(const Request& request, clouds::CloudShape* shape) {
  if (request.has_octaves()) shape->noise.octaves = static_cast<int>(request.octaves());
  if (request.has_persistence()) shape->noise.persistence = request.persistence();
  if (request.has_feature_size_m()) shape->feature_m = request.feature_size_m();
  switch (request.interpolation()) {
    case Request::INTERPOLATION_LINEAR:
      shape->noise.interpolation = clouds::NoiseInterpolation::kLinear;
      break;
    case Request::INTERPOLATION_COSINE:
      shape->noise.interpolation = clouds::NoiseInterpolation::kCosine;
      break;
    case Request::INTERPOLATION_CUBIC:
      shape->noise.interpolation = clouds::NoiseInterpolation::kCubic;
      break;
    default:
      break;
  }
}

clouds::Ellipsoid EllipsoidOf(const Request::Ellipsoid& message) {
  return {{message.x_m(), message.y_m(), message.z_m()},
          {message.radius_x_m(), message.radius_y_m(), message.radius_z_m()},
          {message.rotation_x_deg(), message.rotation_y_deg(), message.rotation_z_deg()}};
}

}  // namespace

clouds::CloudOrigin OriginOf(const Request& request) {
  return {PresetOf(request.preset()), request.has_seed() ? request.seed() : 1};
}

absl::StatusOr<clouds::CloudShape> ShapeOf(const Request& request) {
  const clouds::CloudOrigin origin = OriginOf(request);
  THUNDERHEAD_ASSIGN_OR_RETURN(clouds::CloudShape shape,
                               clouds::PresetNamed(origin.preset, origin.seed));
  SetNoise(request, &shape);
  if (request.has_threshold()) shape.threshold = request.threshold();
  if (request.has_dynamics()) shape.dynamics = request.dynamics();
  if (request.has_water_kg_per_m3()) shape.water_kg_per_m3 = request.water_kg_per_m3();
  if (request.ellipsoids_size() > 0) {
    shape.ellipsoids.clear();
    shape.base_m.reset();  // the preset's base height fits only its own ellipsoids
  }
  for (const Request::Ellipsoid& ellipsoid : request.ellipsoids()) {
    shape.ellipsoids.push_back(EllipsoidOf(ellipsoid));
  }
  if (request.has_base_m()) shape.base_m = request.base_m();
  THUNDERHEAD_RETURN_IF_ERROR(clouds::CheckShape(shape));
  return shape;
}

}  // namespace thunderhead::service
