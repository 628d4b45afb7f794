// Savings by drawing only what a scene requires, each row with and without; and the growth of time
// with slices, pixels, fields and cells. The camera moves every frame, or the sun if the row says
// "light".
#include <algorithm>
#include <utility>

#include "accuracy/named_settings.h"
#include "glm/geometric.hpp"
#include "tests/bench/storm_bench.h"
#include "tests/support/techniques.h"
#include "volume/coarsen.h"
#include "volume/extinction.h"

namespace thunderhead::bench {
namespace {

// Each field with an albedo of its own, so that none shares a group with another.
void PartFields(scene::Scene* scene) {
  float albedo = 1.0F;
  for (scene::FieldParameters& field : scene->fields) {
    field.optics.albedo = albedo;
    albedo -= 1e-4F;
  }
}

void ShowOnly(std::size_t count, scene::Scene* scene) {
  for (std::size_t i = 0; i < scene->fields.size(); ++i) scene->fields[i].visible = i < count;
}

// The same storm in thin haze that fills the domain: nothing is empty, and nothing else differs.
Fields InHaze(const Fields& fields) {
  auto hazy = std::make_shared<volume::HydrometeorFields>(*fields);
  const glm::dvec3 size_m = hazy->grid.HighCorner_m() - hazy->grid.low_corner_m;
  volume::HydrometeorField& cloud = hazy->fields.front();
  const float mass_extinction =
      volume::MassExtinctionOf(cloud, physics::DefaultOptics(cloud.hydrometeor),
                               physics::SizeSource::kGiven)
          .m2_per_kg;
  // Twice the limit below which extinction is skipped as negligible.
  const auto least = static_cast<float>(2.0 * volume::kNegligibleOpticalDepth /
                                        (glm::length(size_m) * mass_extinction));
  cloud.concentration_kg_per_m3.resize(hazy->grid.CellCount());
  for (float& value : cloud.concentration_kg_per_m3) value = std::max(value, least);
  hazy->condensate = {glm::ivec3(0), hazy->grid.cells};
  return hazy;
}

// Divides every cell into `factor` cells along each axis.
Fields Refined(const Fields& fields, int factor) {
  auto fine = std::make_shared<volume::HydrometeorFields>(*fields);
  fine->grid.cells *= factor;
  fine->grid.spacing_m /= static_cast<double>(factor);
  fine->condensate = {fine->condensate.low * factor, fine->condensate.high * factor};
  fine->terrain_height_m.clear();
  for (volume::HydrometeorField& field : fine->fields) {
    if (field.concentration_kg_per_m3.empty()) continue;
    const std::vector<float> coarse = std::move(field.concentration_kg_per_m3);
    field.concentration_kg_per_m3.resize(fine->grid.CellCount());
    std::size_t i = 0;
    for (int z = 0; z < fine->grid.cells.z; ++z) {
      for (int y = 0; y < fine->grid.cells.y; ++y) {
        const float* row = coarse.data() + fields->grid.Offset(0, y / factor, z / factor);
        for (int x = 0; x < fine->grid.cells.x; ++x) {
          field.concentration_kg_per_m3[i++] = row[x / factor];
        }
      }
    }
  }
  return fine;
}

std::string Name(const std::string& part, const accuracy::PlainTechnique& plain,
                 const std::string& what) {
  return part + "/" + std::string(plain.name) + "/" + what;
}

// The camera moves; and, where light is kept apart from the view, the sun.
void RegisterBoth(const std::string& name, const scene::Scene& scene, const Fields& fields) {
  Register(name, scene, fields, Moving::kCamera);
  if (test_support::PlainTechniqueOf(scene.rendering.technique) != test_support::kHalfAngle) {
    Register(name + "/light", scene, fields, Moving::kSun);
  }
}

}  // namespace

void RegisterSavings() {
  const Fields& fields = Sample::Get().fields;
  const Fields hazy = InHaze(fields);
  for (const auto& plain : accuracy::kCellTechniques) {
    scene::Scene scene = PaperScene();
    test_support::SetTechnique(&scene.rendering.technique, plain);
    RegisterBoth(Name("saving", plain, "five_fields_as_they_merge"), scene, fields);
    RegisterBoth(Name("saving", plain, "empty_space_drawn"), scene, hazy);
    scene::Scene detailed = scene;
    test_support::SetMode(&detailed.rendering.technique, test_support::kWithDetail);
    RegisterBoth(Name("saving", plain, "detail_on"), detailed, fields);
    scene::Scene parted = scene;
    PartFields(&parted);
    RegisterBoth(Name("saving", plain, "five_fields_apart"), parted, fields);
    ShowOnly(1, &parted);
    RegisterBoth(Name("saving", plain, "one_field"), parted, fields);
  }
}

void RegisterGrowth() {
  const Fields& fields = Sample::Get().fields;
  for (const auto& plain : accuracy::kCellTechniques) {
    scene::Scene paper = PaperScene();
    test_support::SetTechnique(&paper.rendering.technique, plain);
    for (const int slices : {32, 64, 128, 256, 512}) {
      scene::Scene scene = paper;
      scene::SetSlices(&scene.rendering.technique, slices);
      Register(Name("growth", plain, "slices_" + std::to_string(slices)), scene, fields,
               Moving::kCamera);
    }
    for (const int side_px : {150, 300, 600, 1200}) {
      scene::Scene scene = paper;
      scene.output = {side_px, side_px, 88};
      Register(Name("growth", plain, "pixels_" + std::to_string(side_px * side_px)), scene, fields,
               Moving::kCamera);
    }
    for (const std::size_t count : {1U, 2U, 3U, 4U, 5U}) {
      scene::Scene scene = paper;
      PartFields(&scene);
      ShowOnly(count, &scene);
      Register(Name("growth", plain, "fields_" + std::to_string(count)), scene, fields,
               Moving::kCamera);
    }
    const Fields coarse =
        std::make_shared<volume::HydrometeorFields>(volume::Coarsened(*fields, glm::ivec3(2)));
    for (const Fields& grid : {coarse, fields, Refined(fields, 2)}) {
      RegisterBoth(Name("growth", plain, "cells_" + std::to_string(grid->grid.CellCount())), paper,
                   grid);
    }
  }
}

}  // namespace thunderhead::bench
