#include "scene/ray_probe.h"

#include <algorithm>

#include "scene/drawn_fields.h"
#include "volume/field_values.h"

namespace thunderhead::scene {
namespace {

// Returns the distances of samples spread evenly over the part of the ray in the domain, including
// both ends. A single sample is in the middle.
std::vector<double> SampleDistances_m(const Span& in_domain, int samples) {
  std::vector<double> distances_m;
  if (in_domain.end_m <= in_domain.begin_m || samples <= 0) return distances_m;
  const double length_m = in_domain.end_m - in_domain.begin_m;
  if (samples == 1) return {in_domain.begin_m + length_m / 2.0};
  distances_m.reserve(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i) {
    distances_m.push_back(in_domain.begin_m + length_m * i / (samples - 1));
  }
  return distances_m;
}

// Reads the values of one field around a place.
class FieldReader {
 public:
  FieldReader(const volume::HydrometeorFields& fields, std::size_t index)
      : fields_(fields), field_(fields.fields[index]) {}

  bool Empty() const { return field_.concentration_kg_per_m3.empty(); }
  bool IsEmptyAt(const Corners& corners) const {
    return std::ranges::none_of(corners.cells, [&](std::size_t cell) {
      return field_.concentration_kg_per_m3[cell] > 0.0F;
    });
  }

  CornerValues Values(const Corners& corners) const {
    CornerValues values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const glm::ivec3 cell((i & 1U) != 0 ? corners.high.x : corners.low.x,
                            (i & 2U) != 0 ? corners.high.y : corners.low.y,
                            (i & 4U) != 0 ? corners.high.z : corners.low.z);
      values[i] = volume::ValueAt(fields_, field_, cell);
    }
    return values;
  }
  CornerValues Masses_kg_per_m3(const Corners& corners) const {
    CornerValues values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = volume::MassOf(field_, field_.concentration_kg_per_m3[corners.cells[i]]);
    }
    return values;
  }
  CornerValues Extinctions_per_m(const Corners& corners,
                                 const volume::MassExtinction& mass_extinction) const {
    CornerValues values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      float extinction_per_m = 0.0F;
      volume::AddExtinction(field_, mass_extinction, corners.cells[i], 1, &extinction_per_m);
      values[i] = extinction_per_m;
    }
    return values;
  }

 private:
  const volume::HydrometeorFields& fields_;
  const volume::HydrometeorField& field_;
};

// Probes one field. `drawn` is null for a field that is not drawn.
FieldOnRay Probe(const FieldReader& reader, const DrawnField* drawn,
                 const std::vector<RayPiece>& pieces) {
  FieldOnRay result;
  if (reader.Empty()) return result;
  for (const RayPiece& piece : pieces) {
    if (reader.IsEmptyAt(piece.corners)) continue;
    const Cubic mass_kg_per_m3 = piece.Of(reader.Masses_kg_per_m3(piece.corners));
    result.path_kg_per_m2 += piece.Length_m() * mass_kg_per_m3.Integral(1.0);
    if (drawn != nullptr) {
      const Cubic extinction_per_m =
          piece.Of(reader.Extinctions_per_m(piece.corners, drawn->mass_extinction));
      result.optical_depth += piece.Length_m() * extinction_per_m.Integral(1.0);
    }
    const Cubic values = piece.Of(reader.Values(piece.corners));
    const double largest = values.Largest();
    if (values.At(largest) <= result.maximum) continue;
    result.maximum = values.At(largest);
    result.maximum_m = piece.Along_m(largest);
    result.maximum_kg_per_m3 = mass_kg_per_m3.At(largest);
  }
  return result;
}

}  // namespace

RayProbe ProbeRay(const Scene& scene, const volume::HydrometeorFields& fields, const StormRay& ray,
                  const ProbeSettings& settings) {
  RayProbe probe;
  probe.first_cloud_m = ray.WhereDepthIs_m(settings.first_cloud_depth);
  probe.depth_one_m = ray.WhereDepthIs_m(1.0);
  probe.distances_m = SampleDistances_m(ray.InDomain(), settings.samples);
  probe.extinctions_per_m.assign(probe.distances_m.size(), 0.0F);
  const std::vector<DrawnField> drawn = DrawnFieldsOf(scene, fields);
  for (std::size_t index = 0; index < fields.fields.size(); ++index) {
    const auto at = std::ranges::find(drawn, index, &DrawnField::index);
    const DrawnField* const shown = at == drawn.end() ? nullptr : &*at;
    const FieldReader reader(fields, index);
    FieldOnRay field = Probe(reader, shown, ray.Pieces());
    field.index = index;
    if (!reader.Empty()) {
      for (std::size_t i = 0; i < probe.distances_m.size(); ++i) {
        const glm::dvec3 place_m = ray.At_m(probe.distances_m[i]);
        const Corners corners = Corners::Around(fields.grid, place_m);
        const glm::dvec3 share = corners.ShareOf(fields.grid, place_m);
        field.values.push_back(static_cast<float>(Linear(reader.Values(corners), share)));
        if (shown == nullptr) continue;
        probe.extinctions_per_m[i] += static_cast<float>(
            Linear(reader.Extinctions_per_m(corners, shown->mass_extinction), share));
      }
    }
    probe.fields.push_back(std::move(field));
  }
  return probe;
}

}  // namespace thunderhead::scene
