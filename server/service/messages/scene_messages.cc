#include "service/messages/scene_messages.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "base/utf8.h"
#include "service/messages/camera_messages.h"
#include "service/messages/enum_tables.h"
#include "service/messages/limits_check.h"
#include "service/messages/sun_messages.h"
#include "service/messages/technique_messages.h"
#include "volume/visible_box.h"

namespace thunderhead::service {
namespace {

// Maximum number of pixels, a little more than 8K UHD. It limits the memory that one request can
// use.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 25;

// Returns the hydrometeor's index from 0. HYDROMETEOR_UNSPECIFIED is 0, so the enumerators begin at
// 1.
std::size_t IndexOf(v1::Hydrometeor hydrometeor) {
  return static_cast<std::size_t>(hydrometeor) - 1;
}

// Returns the enumerator of the message for each kind of phase function. Both have the same names.
const std::map<physics::PhaseKind, v1::PhaseFunction::Kind>& PhaseKindMessages() {
  static const auto* const messages = [] {
    auto* found = new std::map<physics::PhaseKind, v1::PhaseFunction::Kind>;
    for (const auto& [kind, name] : physics::kPhaseKindNames) {
      const std::string enumerator =
          absl::StrCat("KIND_", absl::AsciiStrToUpper(std::string(name)));
      THUNDERHEAD_CHECK(v1::PhaseFunction::Kind_Parse(enumerator, &(*found)[kind]), enumerator);
    }
    return found;
  }();
  return *messages;
}

v1::PhaseFunction::Kind KindMessage(physics::PhaseKind kind) {
  return PhaseKindMessages().at(kind);
}

// Converts a kind of phase function. An unknown enumerator, which a damaged record can have,
// becomes the first kind.
physics::PhaseKind ToPhaseKind(v1::PhaseFunction::Kind message) {
  for (const auto& [kind, its_message] : PhaseKindMessages()) {
    if (its_message == message) return kind;
  }
  return physics::kPhaseKindNames.front().kind;
}

constexpr std::array kSizeSources = {
    std::pair{v1::PARTICLE_SIZES_MODEL, physics::SizeSource::kModel},
    std::pair{v1::PARTICLE_SIZES_PAPERS, physics::SizeSource::kPapers},
    std::pair{v1::PARTICLE_SIZES_GIVEN, physics::SizeSource::kGiven},
};
constexpr std::array kSizeOrigins = {
    std::pair{v1::FieldDescription::SIZE_ORIGIN_EFFECTIVE_RADIUS,
              volume::SizeOrigin::kEffectiveRadius},
    std::pair{v1::FieldDescription::SIZE_ORIGIN_NUMBER, volume::SizeOrigin::kNumber},
    std::pair{v1::FieldDescription::SIZE_ORIGIN_SCHEME, volume::SizeOrigin::kScheme},
    std::pair{v1::FieldDescription::SIZE_ORIGIN_OBSERVED, volume::SizeOrigin::kObserved},
};
constexpr std::array kTurbulenceSources = {
    std::pair{v1::StormDescription::TURBULENCE_SOURCE_GRADIENT,
              volume::TurbulenceSource::kGradient},
    std::pair{v1::StormDescription::TURBULENCE_SOURCE_DEFORMATION,
              volume::TurbulenceSource::kDeformation},
    std::pair{v1::StormDescription::TURBULENCE_SOURCE_ENERGY, volume::TurbulenceSource::kEnergy},
};
constexpr std::array kToneMaps = {
    std::pair{v1::TONE_MAP_FILMIC, scene::ToneMap::kFilmic},
    std::pair{v1::TONE_MAP_LINEAR, scene::ToneMap::kLinear},
};

constexpr std::array kGroundCovers = {
    std::pair{v1::Ground::COVER_PLAIN, scene::GroundCover::kPlain},
    std::pair{v1::Ground::COVER_FIELDS, scene::GroundCover::kFields},
    std::pair{v1::Ground::COVER_LAND_USE, scene::GroundCover::kLandUse},
};

void FillFieldDefaults(v1::FieldParameters& field, physics::Hydrometeor hydrometeor) {
  const physics::ParticleOptics& optics = physics::DefaultOptics(hydrometeor);
  field.set_hydrometeor(ToMessage(hydrometeor));
  if (field.has_radius_m()) {
    field.set_sizes(v1::PARTICLE_SIZES_GIVEN);
  } else if (field.sizes() == v1::PARTICLE_SIZES_GIVEN) {
    field.set_radius_m(optics.radius_m);
  }
  if (!field.has_density_kg_per_m3()) field.set_density_kg_per_m3(optics.density_kg_per_m3);
  if (!field.has_albedo()) field.set_albedo(optics.albedo);
  v1::PhaseFunction& phase = *field.mutable_phase();
  if (phase.kind() == v1::PhaseFunction::KIND_UNSPECIFIED) {
    phase.set_kind(KindMessage(optics.phase.kind));
  }
  if (!phase.has_asymmetry()) phase.set_asymmetry(optics.phase.asymmetry);
  if (!field.has_false_color()) {
    v1::Color& color = *field.mutable_false_color();
    color.set_red(optics.false_color.r);
    color.set_green(optics.false_color.g);
    color.set_blue(optics.false_color.b);
  }
  v1::Detail& detail = *field.mutable_detail();
  if (!detail.has_share()) detail.set_share(scene::DefaultDetail(hydrometeor).share);
  FillDefaults(field);
}

v1::FieldParameters& FieldOf(v1::Scene& scene, physics::Hydrometeor hydrometeor) {
  for (v1::FieldParameters& field : *scene.mutable_fields()) {
    if (field.hydrometeor() == ToMessage(hydrometeor)) return field;
  }
  v1::FieldParameters& field = *scene.add_fields();
  field.set_hydrometeor(ToMessage(hydrometeor));
  return field;
}

template <typename Repeated>
std::optional<int> FirstWith(const Repeated& fields, v1::Hydrometeor hydrometeor) {
  for (int i = 0; i < fields.size(); ++i) {
    if (fields[i].hydrometeor() == hydrometeor) return i;
  }
  return std::nullopt;
}

// Copies the settings in `message` to `field`. `field` must already have the message's hydrometeor
// and the scene's source of particle sizes.
void SetField(const v1::FieldParameters& message, scene::FieldParameters& field) {
  field.visible = message.visible();
  if (message.sizes() != v1::PARTICLE_SIZES_UNSPECIFIED) {
    field.sizes = ValueOf(kSizeSources, message.sizes());
  }
  field.scale = message.scale();
  if (message.has_radius_m()) field.optics.radius_m = message.radius_m();
  field.optics.density_kg_per_m3 = message.density_kg_per_m3();
  field.optics.albedo = message.albedo();
  field.optics.phase = {ToPhaseKind(message.phase().kind()), message.phase().asymmetry()};
  const v1::Color& color = message.false_color();
  field.optics.false_color = {color.red(), color.green(), color.blue()};
  const v1::Detail& detail = message.detail();
  field.detail = {detail.share(), detail.wavelength_m(), static_cast<int>(detail.octaves()),
                  detail.seed()};
}

scene::DirectionalLight ToLight(const v1::DirectionalLight& message) {
  const v1::Color& color = message.color();
  return {message.azimuth_deg(), message.elevation_deg(),
          glm::dvec3(color.red(), color.green(), color.blue()), message.irradiance()};
}

scene::Accuracy ToAccuracy(const v1::Accuracy& message) {
  switch (message.limit_case()) {
    case v1::Accuracy::kMaxError:
      return scene::MaxError{message.max_error()};
    case v1::Accuracy::kMaxMilliseconds:
      return scene::MaxMilliseconds{message.max_milliseconds()};
    case v1::Accuracy::LIMIT_NOT_SET:
      break;
  }
  return {};
}

volume::WorldBox BoxOf(const volume::RegularGrid& grid, const volume::CellBox& cells) {
  return {grid.low_corner_m + glm::dvec3(cells.low) * grid.spacing_m,
          grid.low_corner_m + glm::dvec3(cells.high) * grid.spacing_m};
}

void SetGrid(const volume::RegularGrid& grid, v1::Grid& message) {
  message.set_nx(static_cast<std::uint32_t>(grid.cells.x));
  message.set_ny(static_cast<std::uint32_t>(grid.cells.y));
  message.set_nz(static_cast<std::uint32_t>(grid.cells.z));
  message.set_dx_m(grid.spacing_m.x);
  message.set_dy_m(grid.spacing_m.y);
  message.set_dz_m(grid.spacing_m.z);
  SetPosition(grid.low_corner_m, *message.mutable_low());
  SetPosition(grid.HighCorner_m(), *message.mutable_high());
}

void SetSizes(const volume::HydrometeorField& field, v1::FieldDescription& message) {
  const volume::ParticleSizes& sizes = field.sizes;
  const bool by_scheme = sizes.origin == volume::SizeOrigin::kScheme;
  message.set_size_origin(MessageOf(kSizeOrigins, sizes.origin));
  *(by_scheme ? message.mutable_size_scheme() : message.mutable_size_variable()) =
      base::Printable(sizes.name);
  message.set_papers_radius_m(physics::PapersRadius_m(field.hydrometeor));
  if (field.concentration_kg_per_m3.empty()) return;
  const physics::ParticleOptics& optics = physics::DefaultOptics(field.hydrometeor);
  message.set_mean_radius_m(
      volume::WithDrawnRadius(field, optics, physics::SizeSource::kModel).radius_m);
}

void SetField(const volume::HydrometeorField& field, const volume::RegularGrid& grid,
              v1::FieldDescription& message) {
  const volume::FieldStatistics& statistics = field.statistics;
  message.set_hydrometeor(ToMessage(field.hydrometeor));
  message.set_variable(base::Printable(field.variable));
  if (field.quantity == volume::Quantity::kMixingRatio) {
    message.set_minimum_kg_per_kg(statistics.minimum);
    message.set_maximum_kg_per_kg(statistics.maximum);
  }
  message.set_units(std::string(volume::UnitOf(field.quantity)));
  message.set_minimum(statistics.minimum);
  message.set_maximum(statistics.maximum);
  message.set_mean_water_path_kg_per_m2(statistics.mean_water_path_kg_per_m2);
  message.set_maximum_water_path_kg_per_m2(statistics.maximum_water_path_kg_per_m2);
  message.set_negative_cells(static_cast<std::uint64_t>(statistics.negative_cells));
  message.set_missing_cells(static_cast<std::uint64_t>(statistics.missing_cells));
  if (field.quantity != volume::Quantity::kExtinction) SetSizes(field, message);
  FillFieldDefaults(*message.mutable_defaults(), field.hydrometeor);
  message.mutable_defaults()->mutable_detail()->set_wavelength_m(
      scene::DefaultDetailWavelength_m(grid.spacing_m));
}

}  // namespace

v1::Hydrometeor ToMessage(physics::Hydrometeor hydrometeor) {
  return static_cast<v1::Hydrometeor>(physics::IndexOf(hydrometeor) + 1);
}

absl::Status CheckScene(const v1::Scene& scene) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckSun(scene.sun()));
  if (scene.particle_sizes() == v1::PARTICLE_SIZES_GIVEN) {
    return base::InvalidField(
        "scene.particle_sizes",
        "is PARTICLE_SIZES_GIVEN, which is allowed only in scene.fields, with radius_m",
        "VALUE_UNKNOWN");
  }
  for (int i = 0; i < scene.fields_size(); ++i) {
    const v1::Hydrometeor hydrometeor = scene.fields(i).hydrometeor();
    const std::string path = absl::StrCat("scene.fields[", i, "].hydrometeor");
    if (hydrometeor == v1::HYDROMETEOR_UNSPECIFIED) {
      return base::InvalidField(
          path, "is not given; it must name the field that the settings are for", "FIELD_MISSING");
    }
    const int first = *FirstWith(scene.fields(), hydrometeor);
    if (first != i) {
      return base::InvalidField(
          path,
          absl::StrCat("is ", v1::Hydrometeor_Name(hydrometeor), ", as is scene.fields[", first,
                       "]; each hydrometeor may be listed once"),
          "HYDROMETEOR_REPEATED");
    }
  }
  v1::Output output = scene.output();
  FillDefaults(output);
  const std::uint64_t pixels = std::uint64_t{output.width_px()} * output.height_px();
  if (pixels > kMaxPixels) {
    return base::WithDetails(
        absl::InvalidArgumentError(absl::StrCat(
            "scene.output.width_px times scene.output.height_px is ", output.width_px(), " x ",
            output.height_px(), " = ", pixels, "; it must be at most ", kMaxPixels, " pixels")),
        {.reason = "PICTURE_TOO_LARGE",
         .field = "scene.output",
         .metadata = {{"maximum", absl::StrCat(kMaxPixels)}, {"unit", "pixels"}}});
  }
  return absl::OkStatus();
}

void FillSizesDefault(v1::Scene& scene) {
  if (scene.particle_sizes() != v1::PARTICLE_SIZES_UNSPECIFIED) return;
  scene.set_particle_sizes(IsOfThePapers(scene.rendering()) ? v1::PARTICLE_SIZES_PAPERS
                                                            : v1::PARTICLE_SIZES_MODEL);
}

namespace {

// Fills in the ground's defaults. The source of the particle sizes must have been filled in before.
void FillGroundDefaults(v1::Scene& scene, const storm_store::StormInfo& storm) {
  v1::Ground& ground = *scene.mutable_ground();
  if (ground.cover() == v1::Ground::COVER_UNSPECIFIED) {
    const bool of_the_papers = scene.particle_sizes() == v1::PARTICLE_SIZES_PAPERS;
    ground.set_cover(of_the_papers                    ? v1::Ground::COVER_PLAIN
                     : storm.latitude_deg.has_value() ? v1::Ground::COVER_LAND_USE
                                                      : v1::Ground::COVER_FIELDS);
  }
  if (!ground.has_borders()) {
    ground.set_borders(ground.cover() == v1::Ground::COVER_LAND_USE && !storm.projection.empty());
  }
}

}  // namespace

void ToMessage(const scene::Ground& ground, v1::Ground& message) {
  message.set_cover(MessageOf(kGroundCovers, ground.cover));
  message.set_rings(ground.rings);
  message.set_borders(ground.borders);
}

void FillSceneDefaults(v1::Scene& scene, const storm_store::StormInfo& storm) {
  scene.set_storm_id(storm.id);
  v1::Camera& camera = *scene.mutable_camera();
  if (camera.kind_case() == v1::Camera::KIND_NOT_SET) camera.mutable_orbit();
  FillSunDefaults(*scene.mutable_sun(), storm, static_cast<int>(scene.time_index()));
  scene.mutable_sky();
  for (v1::DirectionalLight& light : *scene.mutable_lights()) {
    if (light.has_color()) continue;
    v1::Color& white = *light.mutable_color();
    white.set_red(1.0F);
    white.set_green(1.0F);
    white.set_blue(1.0F);
  }
  scene.mutable_output();
  FillSizesDefault(scene);
  FillGroundDefaults(scene, storm);
  FillTechniqueDefaults(*scene.mutable_rendering());
  scene.mutable_display();
  for (physics::Hydrometeor hydrometeor : storm.fields) FieldOf(scene, hydrometeor);
  for (v1::FieldParameters& field : *scene.mutable_fields()) {
    FillFieldDefaults(field, physics::kHydrometeors[IndexOf(field.hydrometeor())]);
  }
  FillDefaults(scene);
}

physics::SizeSource SizesOf(const v1::Scene& scene) {
  return ValueOf(kSizeSources, scene.particle_sizes());
}

scene::Scene ToScene(const v1::Scene& message) {
  scene::Scene scene;
  scene.storm_id = message.storm_id();
  scene.time_index = static_cast<int>(message.time_index());
  scene.camera = ToCamera(message.camera());
  scene.sun = {message.sun().azimuth_deg(), message.sun().elevation_deg(),
               message.sun().irradiance()};
  scene.sky = {message.sky().brightness(), message.sky().ground_albedo(),
               message.sky().turbidity()};
  scene.ground = {.cover = ValueOf(kGroundCovers, message.ground().cover()),
                  .borders = message.ground().borders(),
                  .rings = message.ground().rings()};
  for (scene::FieldParameters& field : scene.fields) field.sizes = SizesOf(message);
  for (const v1::FieldParameters& field : message.fields()) {
    SetField(field, scene.fields[IndexOf(field.hydrometeor())]);
  }
  for (const v1::DirectionalLight& light : message.lights()) {
    scene.lights.push_back(ToLight(light));
  }
  scene.rendering.technique = ToTechnique(message.rendering());
  if (message.display().has_exposure_ev()) {
    scene.display.exposure_ev = message.display().exposure_ev();
  }
  scene.display.tone_map = ValueOf(kToneMaps, message.display().tone_map());
  scene.display.white_balance = message.display().white_balance();
  scene.output.width_px = static_cast<int>(message.output().width_px());
  scene.output.height_px = static_cast<int>(message.output().height_px());
  scene.output.jpeg_quality = static_cast<int>(message.output().jpeg_quality());
  scene.accuracy = ToAccuracy(message.accuracy());
  return scene;
}

void ToMessage(const storm_store::StormInfo& storm, v1::StormSummary& message) {
  message.set_id(storm.id);
  message.set_title(storm.title);
  message.set_time_count(static_cast<std::uint32_t>(storm.times.size()));
}

bool ToMessage(const std::string& path, v1::StormFile& message) {
  const std::optional<base::FileStamp> stamp = base::StampOf(path);
  if (!stamp.has_value()) return false;
  message.set_name(base::Printable(std::filesystem::path(path).filename().string()));
  message.set_bytes(static_cast<std::uint64_t>(stamp->size_bytes));
  message.set_modified_ns(stamp->modified_ns);
  return true;
}

void ToMessage(const storm_store::StormInfo& storm, const volume::HydrometeorFields& fields,
               int time_index, v1::StormDescription& message) {
  message.set_id(storm.id);
  message.set_title(storm.title);
  for (std::size_t i = 0; i < storm.times.size(); ++i) {
    v1::StormTime& time = *message.add_times();
    time.set_index(static_cast<std::uint32_t>(i));
    time.set_valid_time(storm.times[i].valid_time);
    time.set_elapsed_s(storm.times[i].elapsed_s);
    time.set_lead_s(storm.times[i].lead_s);
    time.set_deleted(storm.times[i].deleted);
    if (v1::StormFile file; ToMessage(storm.times[i].file, file)) *time.mutable_file() = file;
  }
  if (storm.run_start.has_value()) message.set_run_start(base::Printable(*storm.run_start));
  SetGrid(fields.grid, *message.mutable_grid());
  for (const volume::HydrometeorField& field : fields.fields) {
    SetField(field, fields.grid, *message.add_fields());
  }
  message.set_time_index(static_cast<std::uint32_t>(time_index));
  const auto middle = storm_store::MiddleOf(storm, static_cast<std::size_t>(time_index));
  if (middle.has_value()) {
    message.set_latitude_deg(middle->latitude_deg);
    message.set_longitude_deg(middle->longitude_deg);
  }
  message.set_projection(
      storm_store::ProjectionTextOf(storm, static_cast<std::size_t>(time_index)));
  if (!message.projection().empty()) {
    message.set_true_north_deg(
        storm_store::TrueNorthOf_deg(storm, static_cast<std::size_t>(time_index)));
  }
  for (const std::string& assumption : storm.assumptions) message.add_assumptions(assumption);
  FillClockDefaults(*message.mutable_sun_clock(), storm, time_index);
  message.set_bytes_per_time(fields.Bytes());
  message.set_turbulence_source(MessageOf(kTurbulenceSources, fields.motion.source));
  message.set_turbulence_variable(base::Printable(fields.motion.variable));
  if (const glm::dvec2& steering = fields.motion.steering_m_per_s; steering != glm::dvec2(0.0)) {
    message.set_steering_east_m_per_s(static_cast<float>(steering.x));
    message.set_steering_north_m_per_s(static_cast<float>(steering.y));
  }
  if (!fields.condensate.Empty()) {
    const volume::WorldBox box = BoxOf(fields.grid, fields.condensate);
    SetPosition(box.low_m, *message.mutable_condensate_low());
    SetPosition(box.high_m, *message.mutable_condensate_high());
  }
}

}  // namespace thunderhead::service
