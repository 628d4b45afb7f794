#include "thunderhead_client/projection.h"

namespace thunderhead::client {
namespace {

using Vector3 = std::array<double, 3>;

// Points nearer than this to the plane of a perspective eye have no place in the picture.
constexpr double kNear_m = 1.0;

Vector3 Of(const v1::Vector& vector) { return {vector.x(), vector.y(), vector.z()}; }

double Dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

std::optional<PicturePoint> Project(const v1::View& view, const v1::Position& position) {
  const Vector3 from_eye{static_cast<double>(position.x_m()) - view.eye().x_m(),
                         static_cast<double>(position.y_m()) - view.eye().y_m(),
                         static_cast<double>(position.z_m()) - view.eye().z_m()};
  const Vector3 right = Of(view.right());
  const Vector3 up = Of(view.up());
  const double depth_m = view.parallel() ? 1.0 : Dot(from_eye, Of(view.forward()));
  if (depth_m < kNear_m || Dot(right, right) <= 0.0 || Dot(up, up) <= 0.0) return {};
  return PicturePoint{Dot(from_eye, right) / (Dot(right, right) * depth_m),
                      Dot(from_eye, up) / (Dot(up, up) * depth_m)};
}

v1::Ray RayAt(const v1::View& view, const PicturePoint& point) {
  const Vector3 right = Of(view.right());
  const Vector3 up = Of(view.up());
  Vector3 origin{view.eye().x_m(), view.eye().y_m(), view.eye().z_m()};
  Vector3 direction = Of(view.forward());
  for (std::size_t i = 0; i < 3; ++i) {
    const double aside = point.x * right.at(i) + point.y * up.at(i);
    (view.parallel() ? origin : direction).at(i) += aside;
  }
  v1::Ray ray;
  ray.mutable_origin()->set_x_m(origin[0]);
  ray.mutable_origin()->set_y_m(origin[1]);
  ray.mutable_origin()->set_z_m(origin[2]);
  ray.mutable_direction()->set_x(static_cast<float>(direction[0]));
  ray.mutable_direction()->set_y(static_cast<float>(direction[1]));
  ray.mutable_direction()->set_z(static_cast<float>(direction[2]));
  return ray;
}

}  // namespace thunderhead::client
