#include <google/protobuf/util/json_util.h>

#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "app/commands.h"
#include "base/status.h"
#include "runs/local_service.h"
#include "service/messages/scene_messages.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct InspectFlags {
  std::string storm;
  std::optional<int> time_index;
  bool json = false;
};

std::string NameOf(v1::Hydrometeor hydrometeor) {
  return absl::AsciiStrToLower(
      absl::StripPrefix(v1::Hydrometeor_Name(hydrometeor), "HYDROMETEOR_"));
}

std::string SizesOf(const v1::FieldDescription& field) {
  switch (field.size_origin()) {
    case v1::FieldDescription::SIZE_ORIGIN_EFFECTIVE_RADIUS:
      return absl::StrCat("effective radius ", field.size_variable());
    case v1::FieldDescription::SIZE_ORIGIN_NUMBER:
      return absl::StrCat("number ", field.size_variable());
    case v1::FieldDescription::SIZE_ORIGIN_SCHEME:
      return absl::StrCat("scheme ", field.size_scheme());
    case v1::FieldDescription::SIZE_ORIGIN_OBSERVED:
      return "observed constant";
    default:
      return "none: the field is extinction";
  }
}

void AppendSizes(const v1::StormDescription& storm, std::string& text) {
  absl::StrAppend(&text, "\nfield    sizes from                  effective radius of all\n");
  for (const v1::FieldDescription& field : storm.fields()) {
    absl::StrAppendFormat(&text, "%-8s %-27s", NameOf(field.hydrometeor()), SizesOf(field));
    if (field.mean_radius_m() > 0.0F) {
      absl::StrAppendFormat(&text, " %.4g um", field.mean_radius_m() * 1e6);
    }
    absl::StrAppend(&text, "\n");
  }
}

std::string TurbulenceOf(const v1::StormDescription& storm) {
  switch (storm.turbulence_source()) {
    case v1::StormDescription::TURBULENCE_SOURCE_ENERGY:
      return absl::StrCat("energy ", storm.turbulence_variable());
    case v1::StormDescription::TURBULENCE_SOURCE_DEFORMATION:
      return "deformation of the wind";
    default:
      return "contrasts of the fields (no energy or wind in the file)";
  }
}

// Describes how turbulent detail moves: with the wind along the grid's east and north.
std::string DriftOf(const v1::StormDescription& storm) {
  if (!storm.has_steering_east_m_per_s())
    return "does not move: no wind (U, V, W) was read from the file";
  return absl::StrFormat("drifts with the mean wind of the lowest 6 km, %.1f m/s east, %.1f north",
                         storm.steering_east_m_per_s(), storm.steering_north_m_per_s());
}

// Describes the map projection, and how the grid is turned against true north.
std::string MapOf(const v1::StormDescription& storm) {
  if (!storm.has_true_north_deg()) return "no map projection is known for the grid";
  return absl::StrFormat("%s\n        true north is at azimuth %.1f from the grid's north",
                         storm.projection(), storm.true_north_deg());
}

std::string Table(const v1::StormDescription& storm) {
  const v1::Grid& grid = storm.grid();
  std::string text = absl::StrFormat(
      "%s\n  %s\n\ngrid    %d x %d x %d cells of %g x %g x %.1f m, %.1f x %.1f x %.1f km\n",
      storm.id(), storm.title(), grid.nx(), grid.ny(), grid.nz(), grid.dx_m(), grid.dy_m(),
      grid.dz_m(), grid.nx() * grid.dx_m() / 1e3, grid.ny() * grid.dy_m() / 1e3,
      grid.nz() * grid.dz_m() / 1e3);
  absl::StrAppendFormat(&text, "memory  %.1f MiB per time\n",
                        static_cast<double>(storm.bytes_per_time()) / (1 << 20));
  if (!storm.run_start().empty()) {
    absl::StrAppend(&text, "run     started ", storm.run_start(), "\n");
  }
  if (storm.has_latitude_deg()) {
    absl::StrAppendFormat(&text, "middle  %.3f N %.3f E\n", storm.latitude_deg(),
                          storm.longitude_deg());
    absl::StrAppend(&text, "map     ", MapOf(storm), "\n");
  } else {
    absl::StrAppend(&text, "middle  no place on Earth\n");
  }
  for (const std::string& assumption : storm.assumptions()) {
    absl::StrAppend(&text, "assumed ", assumption, "\n");
  }
  absl::StrAppend(&text, "\ntime  valid (UTC)           minutes\n");
  for (const v1::StormTime& time : storm.times()) {
    absl::StrAppendFormat(&text, "%4d  %-20s %8.1f%s\n", time.index(), time.valid_time(),
                          time.elapsed_s() / 60.0,
                          time.index() == storm.time_index() ? "  described below" : "");
  }
  absl::StrAppend(
      &text,
      "\nfield    variable    units    minimum    maximum    mean path  largest path  negative  "
      "missing\n"
      "                                                     kg/m2      kg/m2         cells     "
      "cells\n");
  for (const v1::FieldDescription& field : storm.fields()) {
    absl::StrAppendFormat(&text, "%-8s %-11s %-8s %-10.3g %-10.3g %-10.4g %-13.4g %-9d %d\n",
                          NameOf(field.hydrometeor()), field.variable(), field.units(),
                          field.minimum(), field.maximum(), field.mean_water_path_kg_per_m2(),
                          field.maximum_water_path_kg_per_m2(), field.negative_cells(),
                          field.missing_cells());
  }
  AppendSizes(storm, text);
  absl::StrAppend(&text, "\nturbulence from ", TurbulenceOf(storm), "\n");
  absl::StrAppend(&text, "detail ", DriftOf(storm), "\n");
  return text;
}

std::string Json(const v1::StormDescription& storm) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.always_print_primitive_fields = true;
  std::string json;
  (void)google::protobuf::util::MessageToJsonString(storm, &json, options);
  return json;
}

absl::Status Inspect(const InspectFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<storm_store::StormStore> store,
                               runs::OpenStorm(flags.storm));
  const storm_store::StormInfo& storm = *store->Storms().front();
  THUNDERHEAD_ASSIGN_OR_RETURN(const int time_index,
                               runs::TimeOf(*store, flags.storm, flags.time_index));
  THUNDERHEAD_RETURN_IF_ERROR(runs::ReadWithProgress(*store, time_index));
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields, store->Get(storm.id, time_index, {}));
  v1::StormDescription description;
  service::ToMessage(storm, *fields, time_index, description);
  std::cout << (flags.json ? Json(description) : Table(description));
  return absl::OkStatus();
}

}  // namespace

Command AddInspect(CLI::App& app) {
  auto flags = std::make_shared<InspectFlags>();
  CLI::App* inspect = app.add_subcommand("inspect", "Describe a storm file or folder");
  inspect->add_option("STORM", flags->storm, "Storm file or folder")->required();
  inspect->add_option("--time", flags->time_index,
                      "Index of the time to describe, from 0; by default the last");
  inspect->add_flag("--json", flags->json, "Print the StormDescription message as JSON");
  return {inspect, [flags] { return Inspect(*flags); }};
}

}  // namespace thunderhead::app
