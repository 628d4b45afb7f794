#include "thunderhead_client/projection.h"

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

v1::Position PositionOf(const std::vector<double>& point_m) {
  v1::Position position;
  position.set_x_m(static_cast<float>(point_m.at(0)));
  position.set_y_m(static_cast<float>(point_m.at(1)));
  position.set_z_m(static_cast<float>(point_m.at(2)));
  return position;
}

Json Pair(const PicturePoint& point) {
  return JsonOf(std::vector<Json>{JsonOf(point.x), JsonOf(point.y)});
}

Json Triple(double x, double y, double z) {
  return JsonOf(std::vector<Json>{JsonOf(x), JsonOf(y), JsonOf(z)});
}

Json LineOf(const v1::View& view, const Json& points_m) {
  v1::Mark mark;
  for (const Json& point_m : points_m.list_value().values()) {
    *mark.add_positions() = PositionOf(NumbersOf(point_m));
  }
  std::vector<Json> parts;
  for (const auto& part : ProjectLine(view, mark.positions())) {
    std::vector<Json> points;
    points.reserve(part.size());
    for (const PicturePoint& point : part) points.push_back(Pair(point));
    parts.push_back(JsonOf(points));
  }
  return JsonOf(parts);
}

}  // namespace

Actions RunProjection(Arguments& given) {
  const auto view = given.Read<v1::View>("view");
  Actions actions;
  actions["project"] = [=](Arguments& step) -> Results {
    const auto point = Project(view, PositionOf(step.Numbers("point_m")));
    return {{"at", point ? Pair(*point) : Null()}};
  };
  actions["project_line"] = [=](Arguments& step) -> Results {
    return {{"parts", LineOf(view, step.Get("points_m"))}};
  };
  actions["ray"] = [=](Arguments& step) -> Results {
    const v1::Ray ray = RayAt(view, {step.Number("x"), step.Number("y")});
    return {{"origin_m", Triple(ray.origin().x_m(), ray.origin().y_m(), ray.origin().z_m())},
            {"direction", Triple(ray.direction().x(), ray.direction().y(), ray.direction().z())}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
