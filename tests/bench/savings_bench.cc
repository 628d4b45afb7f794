// Benchmarks of the savings from drawing only what a scene requires, each row with and without, and
// of the growth of time with slices, pixels, fields and cells. The camera moves every frame, or the
// sun if the row says "light".
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accuracy/named_settings.h"
#include "accuracy/presets.h"
#include "glm/geometric.hpp"
#include "tests/bench/storm_bench.h"
#include "tests/support/techniques.h"
#include "volume/coarsen.h"
#include "volume/extinction.h"

namespace thunderhead::bench {
namespace {

// Gives each field a different albedo, so that no two fields share a group.
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

// Returns the same storm in thin haze that fills the domain: no cell is empty, and nothing else
// differs.
Fields InHaze(const Fields& fields) {
  auto hazy = std::make_shared<volume::HydrometeorFields>(*fields);
  const glm::dvec3 size_m = hazy->grid.HighCorner_m() - hazy->grid.low_corner_m;
  volume::HydrometeorField& cloud = hazy->fields.front();
  const float mass_extinction =
      volume::MassExtinctionOf(cloud, physics::DefaultOptics(cloud.hydrometeor),
                               physics::SizeSource::kGiven)
          .m2_per_kg;
  // The haze has twice the extinction below which cells are skipped as negligible.
  const auto least = static_cast<float>(2.0 * volume::kNegligibleOpticalDepth /
                                        (glm::length(size_m) * mass_extinction));
  cloud.concentration_kg_per_m3.resize(hazy->grid.CellCount());
  for (float& value : cloud.concentration_kg_per_m3) value = std::max(value, least);
  hazy->condensate = {glm::ivec3(0), hazy->grid.cells};
  return hazy;
}

// Repeats the values of the cells of `coarse` for those of `fine`, which has `factor` times as many
// along each axis.
template <typename Value>
std::vector<Value> Repeated(const volume::RegularGrid& coarse, const volume::RegularGrid& fine,
                            int factor, const std::vector<Value>& values) {
  std::vector<Value> repeated(fine.CellCount());
  std::size_t i = 0;
  for (int z = 0; z < fine.cells.z; ++z) {
    for (int y = 0; y < fine.cells.y; ++y) {
      const Value* row = values.data() + coarse.Offset(0, y / factor, z / factor);
      for (int x = 0; x < fine.cells.x; ++x) repeated[i++] = row[x / factor];
    }
  }
  return repeated;
}

// Divides every cell into `factor` cells along each axis.
Fields Refined(const Fields& fields, int factor) {
  auto fine = std::make_shared<volume::HydrometeorFields>();
  fine->grid = fields->grid;
  fine->grid.cells *= factor;
  fine->grid.spacing_m /= static_cast<double>(factor);
  fine->condensate = {fields->condensate.low * factor, fields->condensate.high * factor};
  const auto repeated = [&](const auto& values) {
    return Repeated(fields->grid, fine->grid, factor, values);
  };
  for (const volume::HydrometeorField& field : fields->fields) {
    volume::HydrometeorField& copy = fine->fields.emplace_back();
    copy.hydrometeor = field.hydrometeor;
    copy.variable = field.variable;
    copy.quantity = field.quantity;
    if (field.concentration_kg_per_m3.empty()) continue;
    copy.concentration_kg_per_m3 = repeated(field.concentration_kg_per_m3);
    if (field.sizes.Empty()) continue;
    copy.sizes = volume::SizesOf(field.sizes, copy.concentration_kg_per_m3,
                                 repeated(volume::ConcentrationPerRadius(field)));
  }
  fine->motion = fields->motion;
  for (std::vector<std::uint8_t>* values : {&fine->motion.turbulence, &fine->motion.ascent}) {
    if (!values->empty()) *values = repeated(*values);
  }
  return fine;
}

std::string Name(const std::string& part, std::string_view technique, const std::string& what) {
  return part + "/" + std::string(technique) + "/" + what;
}

// Registers a row with a moving camera. If light is computed separately from the view, also
// registers a row with a moving sun.
void RegisterBoth(const std::string& name, const scene::Scene& scene, const MakeFields& make) {
  Register(name, scene, make, Moving::kCamera);
  if (test_support::PlainTechniqueOf(scene.rendering.technique) != test_support::kHalfAngle) {
    Register(name + "/light", scene, make, Moving::kSun);
  }
}

void RegisterBoth(const std::string& name, const scene::Scene& scene, const Fields& fields) {
  RegisterBoth(name, scene, [fields] { return fields; });
}

void RegisterGrowthOf(std::string_view technique, const scene::Scene& paper,
                      const std::vector<Fields>& grids) {
  const Fields& fields = Sample::Get().fields;
  for (const int slices : {32, 64, 128, 256, 512}) {
    scene::Scene scene = paper;
    scene::SetSlices(&scene.rendering.technique, slices);
    Register(Name("growth", technique, "slices_" + std::to_string(slices)), scene, fields,
             Moving::kCamera);
  }
  for (const int side_px : {150, 300, 600, 1200}) {
    scene::Scene scene = paper;
    scene.output = {side_px, side_px, 88};
    Register(Name("growth", technique, "pixels_" + std::to_string(side_px * side_px)), scene,
             fields, Moving::kCamera);
  }
  for (const std::size_t count : {1U, 2U, 3U, 4U, 5U}) {
    scene::Scene scene = paper;
    PartFields(&scene);
    ShowOnly(count, &scene);
    Register(Name("growth", technique, "fields_" + std::to_string(count)), scene, fields,
             Moving::kCamera);
  }
  for (const Fields& grid : grids) {
    RegisterBoth(Name("growth", technique, "cells_" + std::to_string(grid->grid.CellCount())),
                 paper, grid);
  }
}

}  // namespace

void RegisterSavings() {
  const Fields& fields = Sample::Get().fields;
  const Fields hazy = InHaze(fields);
  for (const auto& plain : accuracy::kCellTechniques) {
    scene::Scene scene = PaperScene();
    test_support::SetTechnique(&scene.rendering.technique, plain);
    RegisterBoth(Name("saving", plain.name, "five_fields_as_they_merge"), scene, fields);
    RegisterBoth(Name("saving", plain.name, "empty_space_drawn"), scene, hazy);
    scene::Scene detailed = scene;
    test_support::SetMode(&detailed.rendering.technique, test_support::kWithDetail);
    RegisterBoth(Name("saving", plain.name, "detail_on"), detailed, fields);
    scene::Scene parted = scene;
    PartFields(&parted);
    RegisterBoth(Name("saving", plain.name, "five_fields_apart"), parted, fields);
    ShowOnly(1, &parted);
    RegisterBoth(Name("saving", plain.name, "one_field"), parted, fields);
  }
}

void RegisterGrowth() {
  const Fields& fields = Sample::Get().fields;
  const std::vector<Fields> grids = {
      std::make_shared<volume::HydrometeorFields>(volume::Coarsened(*fields, glm::ivec3(2))),
      fields, Refined(fields, 2)};
  scene::Scene paper = PaperScene();
  for (const auto& plain : accuracy::kCellTechniques) {
    test_support::SetTechnique(&paper.rendering.technique, plain);
    RegisterGrowthOf(plain.name, paper, grids);
  }
  paper.rendering.technique = accuracy::TechniqueOf(accuracy::kDefaultPreset);
  RegisterGrowthOf("default", paper, grids);
  const std::size_t cells = 27 * fields->grid.CellCount();
  RegisterBoth(Name("growth", "default", "cells_" + std::to_string(cells)), paper,
               [] { return Refined(Sample::Get().fields, 3); });
}

}  // namespace thunderhead::bench
