// Tests one toy for each kind of extension of a scene, added to the files that docs/extending.md
// names. The toys are read from files and messages, and used, by the same code as the program's
// own. The tests of defaults and parts of a scene (tests/service) run with the toys as well.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "accuracy/named_settings.h"
#include "app/phase_flag.h"
#include "glm/geometric.hpp"
#include "gmock/gmock.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "physics/optics.h"
#include "physics/phase_table.h"
#include "reference/sampled_phase.h"
#include "runs/legend.h"
#include "sandbox/plausible.h"
#include "scene/drawn_fields.h"
#include "scene/scene_parts.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"
#include "storm_files/grib_parameters.h"
#include "storm_files/storm_format.h"
#include "tests/service/scene_fields.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead {
namespace {

using physics::Hydrometeor;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::HasSubstr;

// Returns the scene that a client gives as JSON.
v1::Scene Given(const std::string& json) {
  v1::Scene scene;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &scene);
  EXPECT_TRUE(status.ok()) << status.ToString();
  return scene;
}

// Returns the scene that the server draws if a client gives this JSON.
scene::Scene Drawn(const std::string& json) {
  const v1::Scene scene = Given(json);
  EXPECT_TRUE(service::CheckLimits(scene).ok()) << service::CheckLimits(scene);
  EXPECT_TRUE(service::CheckScene(scene).ok()) << service::CheckScene(scene);
  return service::ToScene(testing::Completed(scene));
}

// Reads the first time of a file that has only dust, and expects that the server accepts it.
volume::HydrometeorFields ReadDust(const std::string& path) {
  const auto file = storm_files::StormFormats::BuiltIn().Describe(path);
  EXPECT_TRUE(file.ok()) << file.status();
  if (!file.ok()) return {};
  EXPECT_THAT(file->fields, ElementsAre(Hydrometeor::kDust));
  auto fields = file->reader->Read(0, std::nullopt, [](double) { return absl::OkStatus(); });
  EXPECT_TRUE(fields.ok()) << fields.status();
  if (!fields.ok()) return {};
  const absl::Status plausible = sandbox::CheckPlausible(*fields, glm::ivec2(file->cells));
  EXPECT_TRUE(plausible.ok()) << plausible;
  return *std::move(fields);
}

volume::HydrometeorFields DustOfWrf() {
  const testing::TemporaryFolder folder;
  testing::SyntheticWrf file;
  file.mixing_ratios["QDUST"] = [](const testing::WrfCell&) { return 1e-3; };
  testing::WriteWrf(file, folder.File("wrfout"));
  return ReadDust(folder.File("wrfout"));
}

volume::HydrometeorFields DustOfCf(const std::string& name, const std::string& standard_name) {
  const testing::TemporaryFolder folder;
  testing::SyntheticCf file =
      testing::ExtinctionFile(2, 2, 2, 100.0, 100.0, 100.0, [](auto, auto, auto) { return 1e-3; });
  file.variables.front().name = name;
  file.variables.front().attributes = {{"units", "kg m-3"}};
  if (!standard_name.empty()) file.variables.front().attributes["standard_name"] = standard_name;
  testing::WriteCf(file, folder.File("cf.nc"));
  return ReadDust(folder.File("cf.nc"));
}

TEST(HydrometeorToy, IsReadFromEveryFormat) {
  for (const volume::HydrometeorFields& fields :
       {DustOfWrf(), DustOfCf("qdust", ""),
        DustOfCf("other", "mass_concentration_of_dust_in_air")}) {
    ASSERT_EQ(fields.fields.size(), 1U);
    EXPECT_EQ(fields.fields[0].hydrometeor, Hydrometeor::kDust);
    EXPECT_THAT(fields.fields[0].concentration_kg_per_m3, Contains(Gt(5e-4F)));
  }
  const storm_files::GribMeaning in_grib = storm_files::MeaningOf({0, 20, 2});
  EXPECT_EQ(in_grib.kind, storm_files::GribKind::kAmount);
  EXPECT_EQ(in_grib.hydrometeor, Hydrometeor::kDust);
}

TEST(HydrometeorToy, IsDescribedToClients) {
  v1::StormDescription description;
  service::ToMessage(testing::StormWithEveryField(), DustOfWrf(), 0, description);
  ASSERT_EQ(description.fields_size(), 1);
  EXPECT_EQ(description.fields(0).hydrometeor(), v1::HYDROMETEOR_DUST);
  EXPECT_EQ(description.fields(0).variable(), "QDUST");
  EXPECT_EQ(description.fields(0).defaults().density_kg_per_m3(), 2600.0F);
}

TEST(HydrometeorToy, IsDrawnAsTheSceneSays) {
  const volume::HydrometeorFields fields = DustOfCf("qdust", "");
  const scene::Scene scene = Drawn(
      R"({"fields": [{"hydrometeor": "HYDROMETEOR_DUST", "albedo": 0.5, "scale": 2}],
          "rendering": {"lightVolume": {"falseColors": true}}})");
  const std::vector<scene::DrawnField> drawn = scene::DrawnFieldsOf(scene, fields);
  ASSERT_EQ(drawn.size(), 1U);
  EXPECT_EQ(drawn[0].hydrometeor, Hydrometeor::kDust);
  EXPECT_EQ(drawn[0].albedo, 0.5F);
  EXPECT_EQ(drawn[0].color, glm::vec3(0.5F, 0.4F, 0.2F));
  EXPECT_EQ(drawn[0].phase, (physics::PhaseFunction{physics::PhaseKind::kHenyeyGreenstein, 0.7F}));
  std::vector<float> extinction_per_m(fields.grid.CellCount());
  volume::AddExtinction(fields.fields[0], drawn[0].mass_extinction, 0, extinction_per_m.size(),
                        extinction_per_m.data());
  const float expected_per_m = 2.0F * 1e-3F * physics::MassExtinction_m2_per_kg(2600.0F, 2e-6F);
  EXPECT_THAT(extinction_per_m, Each(::testing::FloatNear(expected_per_m, 1e-4F)));
  const scene::Scene hidden =
      Drawn(R"({"fields": [{"hydrometeor": "HYDROMETEOR_DUST", "visible": false}]})");
  EXPECT_TRUE(scene::DrawnFieldsOf(hidden, fields).empty());
}

TEST(ParameterToy, HasTheLimitsAndTheDefaultOfItsField) {
  EXPECT_EQ(Drawn("{}").moonlight, 0.25);
  EXPECT_EQ(Drawn(R"({"moonlight": 1.5})").moonlight, 1.5);
  EXPECT_THAT(std::string(service::CheckLimits(Given(R"({"moonlight": 3})")).message()),
              HasSubstr("moonlight is 3; it must be between 0 and 2"));
}

TEST(ParameterToy, InvalidatesTheStageOfItsRow) {
  const scene::Scene before = Drawn("{}");
  const scene::Scene after = Drawn(R"({"moonlight": 1.5})");
  EXPECT_EQ(scene::FirstDirtyStage(before, after), scene::Stage::kView);
  EXPECT_TRUE(scene::Agree(before, after, &scene::ScenePart::light_correction));
  EXPECT_FALSE(scene::Agree(before, after, &scene::ScenePart::measured_error));
}

TEST(TechniqueToy, IsChosenByItsMessage) {
  const std::string json = R"({"rendering": {"fog": {"depthM": 80}}})";
  EXPECT_TRUE(service::CheckRendering(Given(json).rendering(), {}).ok());
  const scene::Technique fog = Drawn(json).rendering.technique;
  EXPECT_EQ(fog, scene::Technique(scene::Fog{.depth_m = 80.0F}));
  EXPECT_EQ(scene::NameOf(fog), "fog");
  v1::Rendering rendering;
  service::ToMessage(fog, rendering);
  EXPECT_EQ(rendering.fog().depth_m(), 80.0F);
  EXPECT_THAT(
      std::string(
          service::CheckLimits(Given(R"({"rendering": {"fog": {"depthM": 0}}})")).message()),
      HasSubstr("depth_m is 0; it must be between 1 and 1000 m"));
}

// The legend needs no other change than the field `false_colors`, which is found by reflection.
TEST(TechniqueToy, HasALegendIfItPaintsFalseColors) {
  v1::RenderImageResponse picture;
  picture.mutable_modelled()->add_fields(v1::HYDROMETEOR_DUST);
  const auto draw = [&picture](const std::string& json) {
    const v1::Scene scene = testing::Completed(Given(json));
    *picture.mutable_scene() = scene;
    return service::ToScene(scene).rendering.technique;
  };
  EXPECT_FALSE(scene::FieldLookOf(draw(R"({"rendering": {"fog": {}}})")).false_colors);
  EXPECT_TRUE(runs::LegendOf(picture).empty());
  EXPECT_TRUE(
      scene::FieldLookOf(draw(R"({"rendering": {"fog": {"falseColors": true}}})")).false_colors);
  const auto legend = runs::LegendOf(picture);
  ASSERT_EQ(legend.size(), 1U);
  EXPECT_EQ(legend[0].name, "dust");
  EXPECT_EQ(legend[0].color, glm::vec3(0.5F, 0.4F, 0.2F));
}

TEST(TechniqueToy, IsMeasuredLikeEveryTechnique) {
  std::vector<std::string_view> names;
  for (const accuracy::PlainTechnique& technique : accuracy::kPlainTechniques) {
    names.push_back(technique.name);
  }
  EXPECT_THAT(names, Contains("fog"));
}

TEST(TechniqueToy, InvalidatesTheStageThatItNames) {
  const scene::Scene before = Drawn(R"({"rendering": {"fog": {}}})");
  EXPECT_EQ(scene::FirstDirtyStage(before, Drawn(R"({"rendering": {"fog": {"depthM": 80}}})")),
            scene::Stage::kView);
  EXPECT_EQ(scene::FirstDirtyStage(before, Drawn("{}")), scene::Stage::kExtinction);
}

// Returns the phase function of cloud water if a client chooses this kind, such as "KIND_MIST".
physics::PhaseFunction PhaseOf(const std::string& kind) {
  const scene::Scene scene = Drawn(absl::StrCat(
      R"({"fields": [{"hydrometeor": "HYDROMETEOR_CLOUD", "phase": {"kind": ")", kind, "\"}}]}"));
  return physics::PhaseOf(scene.fields[physics::IndexOf(Hydrometeor::kCloud)].optics);
}

// Returns the mean cosine of the angles at which traced paths are scattered.
double MeanSampledCosine(const physics::PhaseFunction& phase) {
  const reference::SampledPhase sampled = reference::SampledPhase::Of(phase);
  constexpr int kSamples = 10'000;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kSamples; ++i) {
    for (int color = 0; color < 3; ++color) {
      sum[color] += sampled.Sample((i + 0.5) / kSamples, static_cast<std::size_t>(color)).mu;
    }
  }
  return glm::dot(physics::kLuminance, sum) / kSamples;
}

TEST(FormulaToy, ScattersByItsFormula) {
  const physics::PhaseFunction phase = PhaseOf("KIND_TILTED");
  EXPECT_EQ(phase.kind, physics::PhaseKind::kTilted);
  for (const double mu : {-1.0, 0.0, 0.3, 1.0}) {
    EXPECT_DOUBLE_EQ(physics::PhaseValue(phase, mu), 1.0 + 0.5 * mu);
    EXPECT_DOUBLE_EQ(physics::PhaseColors(phase, mu).g, 1.0 + 0.5 * mu);
  }
  EXPECT_NEAR(physics::MeanCosine(phase), 1.0 / 6.0, 1e-6);
  EXPECT_NEAR(MeanSampledCosine(phase), 1.0 / 6.0, 1e-3);
}

TEST(FormulaToy, CanBeChosenForFluxes) {
  const auto phase = app::ParsePhase("tilted");
  ASSERT_TRUE(phase.ok()) << phase.status();
  EXPECT_NEAR((*phase)->Value(0.3).g, 1.15, 1e-4);
  EXPECT_THAT(app::PhaseFlagHelp(), HasSubstr("rayleigh, tilted or table:NAME"));
}

TEST(TableToy, ScattersByItsTable) {
  const physics::PhaseFunction phase = PhaseOf("KIND_MIST");
  EXPECT_EQ(phase.kind, physics::PhaseKind::kMist);
  const auto table = physics::EmbeddedPhaseTable("mist");
  ASSERT_TRUE(table.ok()) << table.status();
  for (const double mu : {-1.0, 0.0, 0.3, 1.0}) {
    EXPECT_EQ(physics::PhaseColors(phase, mu).g, table->ValueAtCosine(mu, 1));
  }
  const double asymmetry = physics::MeanCosine(phase);
  // Droplets of 2 um scatter less light forward than those of 5 um.
  EXPECT_GT(asymmetry, 0.7);
  EXPECT_LT(asymmetry, physics::MeanCosine(PhaseOf("KIND_WATER_NARROW")));
  EXPECT_NEAR(MeanSampledCosine(phase), asymmetry, 2e-3);
}

}  // namespace
}  // namespace thunderhead
