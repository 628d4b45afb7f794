#include "reference/flux.h"

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/phase_flag.h"
#include "app/seed_flag.h"
#include "base/status.h"
#include "reference/scene_problem.h"
#include "runs/local_service.h"
#include "runs/progress_bar.h"
#include "scene/view.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct FluxFlags {
  std::string storm;
  std::optional<double> slab;
  std::optional<int> time_index;
  std::string phase;
  std::optional<double> albedo;
  double sun_elevation_deg = 90.0;
  double sun_azimuth_deg = 180.0;
  bool periodic = false;
  double ground_albedo = 0.0;
  std::int64_t photons = 1'000'000;
  std::uint64_t seed = 0;
  bool json = false;
};

absl::Status CheckShare(const char* flag, double value) {
  if (value >= 0.0 && value <= 1.0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", value, "; it must be from 0 to 1"));
}

absl::Status CheckFlags(const FluxFlags& flags) {
  if (flags.storm.empty() == !flags.slab.has_value()) {
    return absl::InvalidArgumentError("flux needs either a STORM or --slab TAU");
  }
  if (flags.slab.has_value() && !(std::isfinite(*flags.slab) && *flags.slab >= 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--slab is ", *flags.slab, "; an optical depth is 0 or more"));
  }
  if (!(flags.sun_elevation_deg > 0.0 && flags.sun_elevation_deg <= 90.0)) {
    return absl::InvalidArgumentError(absl::StrCat("--sun-elevation is ", flags.sun_elevation_deg,
                                                   "; it must be above 0 and at most 90 degrees"));
  }
  if (!(std::abs(flags.sun_azimuth_deg) <= 720.0)) {
    return absl::InvalidArgumentError(absl::StrCat("--sun-azimuth is ", flags.sun_azimuth_deg,
                                                   "; it must be from -720 to 720 degrees"));
  }
  if (flags.photons < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("--photons is ", flags.photons, "; it must be 1 or more"));
  }
  if (flags.albedo.has_value()) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckShare("--albedo", *flags.albedo));
  }
  return CheckShare("--ground-albedo", flags.ground_albedo);
}

absl::StatusOr<reference::FluxProblem> SlabProblem(const FluxFlags& flags,
                                                   const glm::dvec3& towards_sun) {
  const std::string phase_text = flags.phase.empty() ? "table:cloud_re10" : flags.phase;
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto phase, ParsePhase(phase_text));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      auto medium, reference::SlabMedium(*flags.slab, *phase, flags.albedo.value_or(1.0)));
  return reference::FluxProblem::Of(std::move(medium), towards_sun);
}

// Returns how to interpolate the extinction. Extinction that the file gives directly is constant in
// each cell. Extinction computed from hydrometeors is interpolated linearly, as it is drawn.
reference::Interpolation InterpolationOf(const volume::HydrometeorFields& fields) {
  const bool direct =
      !fields.fields.empty() && fields.fields.front().quantity == volume::Quantity::kExtinction;
  return direct ? reference::Interpolation::kConstant : reference::Interpolation::kLinear;
}

absl::StatusOr<reference::FluxProblem> StormProblem(const FluxFlags& flags,
                                                    const glm::dvec3& towards_sun) {
  reference::MediumOptions options;
  if (!flags.phase.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(options.phase, ParsePhase(flags.phase));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields, runs::ReadStorm(flags.storm, flags.time_index));
  scene::Scene scene;
  for (scene::FieldParameters& field : scene.fields) {
    if (flags.albedo.has_value()) field.optics.albedo = static_cast<float>(*flags.albedo);
  }
  options.sides = flags.periodic ? reference::Sides::kPeriodic : reference::Sides::kOpen;
  options.interpolation = InterpolationOf(*fields);
  reference::FluxProblem problem;
  THUNDERHEAD_ASSIGN_OR_RETURN(problem.medium, reference::MediumOf(scene, *fields, options));
  problem.domain_low_m = fields->grid.low_corner_m;
  problem.domain_high_m = fields->grid.HighCorner_m();
  problem.towards_sun = towards_sun;
  return problem;
}

std::vector<std::pair<const char*, reference::FluxShare>> Shares(
    const reference::FluxResult& result) {
  return {{"reflectance", result.reflectance},
          {"transmittance", result.transmittance},
          {"transmittance_direct", result.transmittance_direct},
          {"transmittance_diffuse", result.transmittance_diffuse},
          {"absorptance", result.absorptance},
          {"sides", result.sides},
          {"ground_absorptance", result.ground_absorptance}};
}

std::string Json(const reference::FluxResult& result, bool complete) {
  std::string text = "{\n";
  for (const auto& [name, share] : Shares(result)) {
    absl::StrAppendFormat(&text, "  \"%s\": %.9g,\n  \"%s_stderr\": %.3g,\n", name, share.value,
                          name, share.standard_error);
  }
  absl::StrAppendFormat(&text, "  \"photons\": %d,\n  \"complete\": %s\n}\n", result.photons,
                        complete ? "true" : "false");
  return text;
}

std::string Table(const reference::FluxResult& result) {
  std::string text =
      absl::StrFormat("shares of the sunlight on the domain's top, %d photons\n\n", result.photons);
  for (const auto& [name, share] : Shares(result)) {
    absl::StrAppendFormat(&text, "%-22s %.6f +- %.6f\n", name, share.value, share.standard_error);
  }
  return text;
}

absl::Status Flux(const FluxFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_RETURN_IF_ERROR(CheckFlags(flags));
  const glm::dvec3 towards_sun = scene::Direction(flags.sun_azimuth_deg, flags.sun_elevation_deg);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      reference::FluxProblem problem,
      flags.slab.has_value() ? SlabProblem(flags, towards_sun) : StormProblem(flags, towards_sun));
  problem.ground_albedo = flags.ground_albedo;
  reference::FluxOptions options;
  options.photons = flags.photons;
  options.seed = flags.seed;
  const Interruption interruption;
  absl::StatusOr<reference::FluxResult> result;
  {
    runs::ProgressBar bar("tracing photons");
    result = reference::ComputeFlux(
        problem, options, [&bar](double share) { bar.Set(share); }, interruption.Token());
  }
  THUNDERHEAD_RETURN_IF_ERROR(result.status());
  const bool complete = result->photons == flags.photons;
  std::cout << (flags.json ? Json(*result, complete) : Table(*result));
  if (!complete) {
    std::cerr << absl::StrFormat("thunderhead: stopped after %d of %d photons\n", result->photons,
                                 flags.photons);
  }
  return absl::OkStatus();
}

}  // namespace

Command AddFlux(CLI::App& app) {
  auto flags = std::make_shared<FluxFlags>();
  CLI::App* flux = app.add_subcommand("flux", "Compute the fluxes of sunlight through a storm");
  flux->add_option("STORM", flags->storm, "Storm file or folder");
  flux->add_option("--slab", flags->slab,
                   "A plane-parallel slab of this optical depth instead of a storm");
  flux->add_option("--time", flags->time_index,
                   "Index of the storm's time, from 0; by default the last");
  flux->add_option(
      "--phase", flags->phase,
      PhaseFlagHelp() + "; by default each field's own, for a slab that of cloud water");
  flux->add_option("--albedo", flags->albedo,
                   "Single-scattering albedo, 0 to 1; by default each field's own");
  flux->add_option("--sun-elevation", flags->sun_elevation_deg, "Elevation of the sun in degrees")
      ->capture_default_str();
  flux->add_option("--sun-azimuth", flags->sun_azimuth_deg,
                   "Azimuth of the sun, clockwise from north")
      ->capture_default_str();
  flux->add_flag("--periodic", flags->periodic, "Periodic boundaries in x and y");
  flux->add_option("--ground-albedo", flags->ground_albedo, "Albedo of the ground, 0 to 1")
      ->capture_default_str();
  flux->add_option("--photons", flags->photons, "Number of photons to trace")
      ->capture_default_str();
  AddSeedFlag(*flux, "Seed of the random numbers", &flags->seed);
  flux->add_flag("--json", flags->json, "Print JSON");
  return {flux, [flags] { return Flux(*flags); }};
}

}  // namespace thunderhead::app
