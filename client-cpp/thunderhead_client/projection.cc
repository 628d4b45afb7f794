#include "thunderhead_client/projection.h"

namespace thunderhead::client {
namespace {

using Vector3 = std::array<double, 3>;

// Minimum depth in front of a perspective camera. Nearer points have no position in the picture.
constexpr double kNear_m = 1.0;

Vector3 Of(const v1::Vector& vector) { return {vector.x(), vector.y(), vector.z()}; }
Vector3 Of(const v1::Position& position) {
  return {position.x_m(), position.y_m(), position.z_m()};
}

double Dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Interpolates linearly from a to b.
Vector3 Between(const Vector3& a, const Vector3& b, double share) {
  const auto at = [&](std::size_t i) { return a.at(i) + share * (b.at(i) - a.at(i)); };
  return {at(0), at(1), at(2)};
}

struct Projection {
  explicit Projection(const v1::View& view)
      : eye_m(Of(view.eye())),
        forward(Of(view.forward())),
        right(Of(view.right())),
        up(Of(view.up())),
        has_eye(view.has_eye()),
        parallel(view.parallel()) {}

  bool IsWhole() const {
    return has_eye && Dot(forward, forward) > 0.0 && Dot(right, right) > 0.0 && Dot(up, up) > 0.0;
  }
  Vector3 FromEye(const v1::Position& position) const {
    const Vector3 point_m = Of(position);
    return {point_m[0] - eye_m[0], point_m[1] - eye_m[1], point_m[2] - eye_m[2]};
  }
  // In a parallel view the distance does not change a point's place, so every point gets the same
  // depth.
  double Depth(const Vector3& from_eye_m) const {
    return parallel ? kNear_m : Dot(from_eye_m, forward);
  }
  // Right and up are perpendicular to each other and to forward, so x and y are computed
  // separately.
  PicturePoint Place(const Vector3& from_eye_m, double depth_m) const {
    return {Dot(from_eye_m, right) / (Dot(right, right) * depth_m),
            Dot(from_eye_m, up) / (Dot(up, up) * depth_m)};
  }

  Vector3 eye_m, forward, right, up;
  bool has_eye;
  bool parallel;
};

}  // namespace

std::optional<PicturePoint> Project(const v1::View& view, const v1::Position& position) {
  const Projection projection(view);
  const Vector3 from_eye_m = projection.FromEye(position);
  const double depth_m = projection.Depth(from_eye_m);
  if (depth_m < kNear_m || !projection.IsWhole()) return {};
  return projection.Place(from_eye_m, depth_m);
}

std::vector<std::vector<PicturePoint>> ProjectLine(
    const v1::View& view, const google::protobuf::RepeatedPtrField<v1::Position>& positions) {
  const Projection projection(view);
  if (!projection.IsWhole()) return {};
  std::vector<std::vector<PicturePoint>> parts;
  bool visible_before = false;
  double depth_before_m = 0.0;
  Vector3 before_m{};
  for (int i = 0; i < positions.size(); ++i) {
    const Vector3 from_eye_m = projection.FromEye(positions[i]);
    const double depth_m = projection.Depth(from_eye_m);
    const bool visible = depth_m >= kNear_m;
    if (visible && !visible_before) parts.emplace_back();
    if (i > 0 && visible != visible_before) {
      const double share = (kNear_m - depth_before_m) / (depth_m - depth_before_m);
      parts.back().push_back(projection.Place(Between(before_m, from_eye_m, share), kNear_m));
    }
    if (visible) parts.back().push_back(projection.Place(from_eye_m, depth_m));
    visible_before = visible;
    depth_before_m = depth_m;
    before_m = from_eye_m;
  }
  return parts;
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
