// Tests that every limit of the schema is checked, and that the error has the value's full path,
// the value and its range.
#include <algorithm>
#include <cmath>
#include <limits>

#include "gmock/gmock.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"
#include "tests/support/technique_infos.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;

// Returns the server's error for a scene; empty if the server accepts it.
std::string Complaint(const v1::Scene& scene) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = scene;
  absl::Status status = service::CheckLimits(request);
  if (status.ok()) status = service::CheckScene(scene);
  if (status.ok()) {
    status = service::CheckRendering(scene.rendering(), {{"light_volume", {}},
                                                         {"half_angle", {}},
                                                         {"metaball", {}},
                                                         {"reference", {}},
                                                         {"toy", {}}});
  }
  EXPECT_TRUE(status.ok() || status.code() == absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

v1::Scene SceneFrom(const std::string& json) {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &scene).ok()) << json;
  return scene;
}

struct Case {
  const char* json;
  const char* complaint;
};

class WrongSceneTest : public ::testing::TestWithParam<Case> {};

TEST_P(WrongSceneTest, IsNamed) {
  EXPECT_EQ(Complaint(SceneFrom(GetParam().json)), GetParam().complaint);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, WrongSceneTest,
    ::testing::Values(
        Case{R"({"fields": [{"hydrometeor": 1}, {"hydrometeor": 2, "radiusM": 5}]})",
             "scene.fields[1].radius_m is 5; it must be between 1e-07 and 0.1 m"},
        Case{R"({"fields": [{"hydrometeor": 1, "albedo": -0.25}]})",
             "scene.fields[0].albedo is -0.25; it must be between 0 and 1"},
        Case{R"({"fields": [{"hydrometeor": 1, "phase": {"asymmetry": 1}}]})",
             "scene.fields[0].phase.asymmetry is 1; it must be between -0.99 and 0.99"},
        Case{R"({"fields": [{"hydrometeor": 1, "falseColor": {"green": 2}}]})",
             "scene.fields[0].false_color.green is 2; it must be between 0 and 1"},
        Case{R"({"rendering": {"cumulus": {"scales": 0}}})",
             "scene.rendering.cumulus.scales is 0; it must be between 1 and 5"},
        Case{R"({"rendering": {"cumulus": {"trap": 1}}})",
             "scene.rendering.cumulus.trap is 1; it must be between 0 and 0.9"},
        Case{R"({"rendering": {"cumulus": {"corona": -1}}})",
             "scene.rendering.cumulus.corona is -1; it must be between 0 and 1"},
        Case{R"({"rendering": {"cumulus": {"leastExtinctionPerM": 0}}})",
             "scene.rendering.cumulus.least_extinction_per_m is 0; it must be between 1e-06 and 1 "
             "1/m"},
        Case{R"({"accuracy": {"maxError": 0}})",
             "scene.accuracy.max_error is 0; it must be between 0.001 and 10"},
        Case{R"({"accuracy": {"maxMilliseconds": 1e9}})",
             "scene.accuracy.max_milliseconds is 1e+09; it must be between 0.1 and 60000 ms"},
        Case{R"({"sun": {"elevationDeg": "NaN"}})",
             "scene.sun.elevation_deg is nan; it must be between -90 and 90 deg"},
        Case{R"({"sun": {"irradiance": "Infinity"}})",
             "scene.sun.irradiance is inf; it must be between 0 and 100"},
        Case{R"({"camera": {"orbit": {"target": {"zM": "-Infinity"}}}})",
             "scene.camera.orbit.target.z_m is -inf; it must be between -1e+06 and 1e+06 m"},
        Case{R"({"camera": {"orbit": {"distanceM": 0}}})",
             "scene.camera.orbit.distance_m is 0; it must be between 1 and 5e+07 m"},
        Case{R"({"lights": [{}, {"azimuthDeg": 400}]})",
             "scene.lights[1].azimuth_deg is 400; it must be between -360 and 360 deg"},
        Case{R"({"lights": [{"elevationDeg": "NaN"}]})",
             "scene.lights[0].elevation_deg is nan; it must be between -90 and 90 deg"},
        Case{R"({"lights": [{"irradiance": -1}]})",
             "scene.lights[0].irradiance is -1; it must be between 0 and 100"},
        Case{R"({"lights": [{"color": {"blue": 2}}]})",
             "scene.lights[0].color.blue is 2; it must be between 0 and 1"},
        Case{R"({"lights": [{}, {}, {}, {}, {}]})",
             "scene.lights has 5 items; it may have at most 4"},
        Case{R"({"rendering": {"lightVolume": {"slices": 0}}})",
             "scene.rendering.light_volume.slices is 0; it must be between 1 and 4096"},
        Case{R"({"rendering": {"halfAngle": {"slices": 4294967295}}})",
             "scene.rendering.half_angle.slices is 4294967295; it must be between 1 and 4096"},
        Case{R"({"rendering": {"lightVolume": {"tracedLight": 77}}})",
             "scene.rendering.light_volume.traced_light is 77; it must be one of "
             "TRACED_LIGHT_UNSPECIFIED, TRACED_LIGHT_OFF, TRACED_LIGHT_AT_REST, "
             "TRACED_LIGHT_AWAITED"},
        Case{R"({"rendering": {"halfAngle": {"transport": "TRANSPORT_DIFFUSION"}}})",
             "scene.rendering.half_angle.transport is TRANSPORT_DIFFUSION, which this technique "
             "does not support; it must be one of TRANSPORT_CONSISTENT, TRANSPORT_LOW_ALBEDO, "
             "TRANSPORT_PAPER, TRANSPORT_PAPER_LOW_ALBEDO"},
        Case{R"({"rendering": {"metaball": {"transport": "TRANSPORT_PAPER_LOW_ALBEDO"}}})",
             "scene.rendering.metaball.transport is TRANSPORT_PAPER_LOW_ALBEDO, which this "
             "technique does not support; it must be one of TRANSPORT_CONSISTENT, "
             "TRANSPORT_LOW_ALBEDO, "
             "TRANSPORT_PAPER"},
        Case{R"({"rendering": {"other": {"name": "voxels"}}})",
             "scene.rendering.other.name is 'voxels'; the server has the techniques light_volume, "
             "half_angle, metaball, reference, toy"},
        Case{R"({"rendering": {"other": {"name": "half_angle"}}})",
             "scene.rendering.other.name is 'half_angle'; that technique has a field of its own in "
             "scene.rendering"},
        Case{R"({"output": {"widthPx": 8193}})",
             "scene.output.width_px is 8193; it must be between 1 and 8192"},
        Case{
            R"({"output": {"widthPx": 8192, "heightPx": 8192}})",
            "scene.output.width_px times scene.output.height_px is 8192 x 8192 = 67108864; it must "
            "be at most 33554432 pixels"},
        Case{R"({"fields": [{"scale": 1}]})",
             "scene.fields[0].hydrometeor is not given; it must name the field that the settings "
             "are for"},
        Case{R"({"fields": [{"hydrometeor": 2}, {"hydrometeor": 1}, {"hydrometeor": 2}]})",
             "scene.fields[2].hydrometeor is HYDROMETEOR_RAIN, as is scene.fields[0]; "
             "each hydrometeor may be listed once"}));

TEST(LimitsTest, TooManyItemsAndTooLongStrings) {
  v1::Scene scene;
  for (int i = 0; i < 17; ++i) scene.add_fields();
  EXPECT_EQ(Complaint(scene), "scene.fields has 17 items; it may have at most 16");
  v1::Scene named;
  named.set_storm_id(std::string(257, 'x'));
  EXPECT_EQ(Complaint(named), "scene.storm_id is 257 bytes long; it may be at most 256 bytes");
}

TEST(LimitsTest, TheLimitsThemselvesAreAllowed) {
  v1::Scene scene;
  v1::FieldParameters& field = *scene.add_fields();
  field.set_hydrometeor(v1::HYDROMETEOR_HAIL);
  // As floats, 0.1 and 1e-7 lie outside the range of the doubles 0.1 and 1e-7.
  for (const float radius_m : {1e-7F, 0.1F}) {
    field.set_radius_m(radius_m);
    EXPECT_EQ(Complaint(scene), "");
  }
  field.set_radius_m(std::nextafter(0.1F, 1.0F));
  EXPECT_THAT(Complaint(scene), HasSubstr("scene.fields[0].radius_m is 0.1000000"));
  field.clear_radius_m();
  for (const float asymmetry : {-0.99F, 0.99F}) {
    field.mutable_phase()->set_asymmetry(asymmetry);
    EXPECT_EQ(Complaint(scene), "");
  }
  scene.mutable_output()->set_width_px(8192);
  scene.mutable_output()->set_height_px(4096);
  EXPECT_EQ(Complaint(scene), "");
}

// A technique's description lists the transports that a scene may have, the default first.
TEST(LimitsTest, TransportsOnOfferAreThoseAllowed) {
  int with_transport = 0;
  for (const scene::TechniqueInfo& info : test_support::TechniquesOfTheSchema()) {
    v1::TechniqueDescription technique;
    service::ToMessage(info, technique);
    const auto* field = v1::Rendering::descriptor()->FindFieldByName(technique.name());
    ASSERT_NE(field, nullptr) << technique.name();
    v1::Scene scene;
    v1::Rendering& rendering = *scene.mutable_rendering();
    google::protobuf::Message* settings =
        rendering.GetReflection()->MutableMessage(&rendering, field);
    const auto* transport = settings->GetDescriptor()->FindFieldByName("transport");
    EXPECT_EQ(transport == nullptr, technique.transports().empty()) << technique.name();
    if (transport == nullptr) continue;
    ++with_transport;
    v1::Rendering filled = rendering;
    service::FillTechniqueDefaults(filled);
    const auto& defaults = filled.GetReflection()->GetMessage(filled, field);
    EXPECT_EQ(technique.transports(0), defaults.GetReflection()->GetEnumValue(defaults, transport));
    for (int i = v1::Transport_MIN + 1; i <= v1::Transport_MAX; ++i) {
      settings->GetReflection()->SetEnumValue(settings, transport, i);
      const bool offered = std::ranges::count(technique.transports(), i) == 1;
      EXPECT_EQ(Complaint(scene).empty(), offered) << technique.name() << " by " << i;
    }
  }
  EXPECT_EQ(with_transport, 3);
}

TEST(SceneMessages, LightsAreWhatTheMessageSaysAndWhiteWhereItIsSilent) {
  v1::Scene message = SceneFrom(
      R"({"lights": [{}, {"azimuthDeg": -30, "elevationDeg": -5, "irradiance": 0.25,
          "color": {"red": 0.5, "blue": 1}}]})");
  storm_store::StormInfo storm;
  storm.id = "a";
  service::FillSceneDefaults(message, storm);
  EXPECT_EQ(Complaint(message), "");
  const scene::Scene scene = service::ToScene(message);
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(scene.lights[0], scene::DirectionalLight()) << "the defaults of both";
  EXPECT_EQ(scene.lights[1],
            (scene::DirectionalLight{-30.0, -5.0, glm::dvec3(0.5, 0.0, 1.0), 0.25}));
  v1::Scene again = message;
  service::FillSceneDefaults(again, storm);
  EXPECT_EQ(again.SerializeAsString(), message.SerializeAsString());
}

TEST(Limits, AGivenRadiusIsAFieldsAlone) {
  EXPECT_EQ(Complaint(SceneFrom(R"({"particleSizes": "PARTICLE_SIZES_PAPERS"})")), "");
  EXPECT_THAT(
      Complaint(SceneFrom(R"({"particleSizes": "PARTICLE_SIZES_GIVEN"})")),
      HasSubstr(
          "scene.particle_sizes is PARTICLE_SIZES_GIVEN, which is allowed only in scene.fields"));
}

}  // namespace
}  // namespace thunderhead::testing
