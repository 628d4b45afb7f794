#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/probe_messages.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

bool IsExtinction(const volume::HydrometeorField& field) {
  return field.quantity == volume::Quantity::kExtinction;
}

absl::StatusOr<storm_store::StormInfoPtr> CheckMap(const Engine& engine,
                                                   const v1::GetStormMapRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(storm_store::StormInfoPtr storm,
                               FindStorm(engine.store, request.storm_id()));
  THUNDERHEAD_RETURN_IF_ERROR(CheckTime(*storm, request.time_index(), "time_index"));
  return storm;
}

absl::Status NotThere(const v1::GetStormMapRequest& request, int index,
                      const storm_store::StormInfo& storm,
                      const volume::HydrometeorFields& fields) {
  const std::string names =
      absl::StrJoin(fields.fields, ", ", [](std::string* out, const auto& field) {
        out->append(v1::Hydrometeor_Name(ToMessage(field.hydrometeor)));
      });
  return base::InvalidField(
      absl::StrCat("fields[", index, "]"),
      absl::StrCat("is ", v1::Hydrometeor_Name(request.fields(index)), ", which storm '", storm.id,
                   "' does not have; it has ", names),
      "FIELD_NOT_THERE", {{"allowed", names}});
}

// Returns the indices of the fields whose water paths are added, each index once. Water paths and
// optical depths cannot be added to each other, so a request for both is refused. Without requested
// fields, all mass fields are added, or all optical depths if there are no mass fields.
absl::StatusOr<std::vector<std::size_t>> FieldsAdded(const v1::GetStormMapRequest& request,
                                                     const storm_store::StormInfo& storm,
                                                     const volume::HydrometeorFields& fields) {
  std::vector<std::size_t> added;
  for (int i = 0; i < request.fields_size(); ++i) {
    const auto at = std::ranges::find_if(fields.fields, [&](const auto& field) {
      return ToMessage(field.hydrometeor) == request.fields(i);
    });
    if (at == fields.fields.end()) return NotThere(request, i, storm, fields);
    const auto index = static_cast<std::size_t>(at - fields.fields.begin());
    if (!added.empty() && IsExtinction(*at) != IsExtinction(fields.fields[added.front()])) {
      return base::InvalidField(absl::StrCat("fields[", i, "]"),
                                absl::StrCat("is ", v1::Hydrometeor_Name(request.fields(i)),
                                             ", whose unit differs from that of ",
                                             v1::Hydrometeor_Name(request.fields(0)),
                                             "; request mass and extinction in separate calls"),
                                "UNITS_DIFFER");
    }
    if (std::ranges::find(added, index) == added.end()) added.push_back(index);
  }
  if (!added.empty()) return added;
  const bool has_mass = !std::ranges::all_of(fields.fields, IsExtinction);
  for (std::size_t index = 0; index < fields.fields.size(); ++index) {
    if (!has_mass || !IsExtinction(fields.fields[index])) added.push_back(index);
  }
  return added;
}

absl::Status Map(Engine& engine, const storm_store::StormInfo& storm,
                 const v1::GetStormMapRequest& request, v1::GetStormMapResponse& response) {
  const int time_index = static_cast<int>(request.time_index());
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields,
                               ReadFields(engine.store, storm.id, time_index, "storm_id"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> added,
                               FieldsAdded(request, storm, *fields));
  v1::GetStormMapRequest filled = request;
  FillDefaults(filled);
  const volume::StormMap map = volume::MapOf(
      *fields, {added, static_cast<int>(filled.max_size_px()), request.with_terrain()});
  response.set_storm_id(storm.id);
  response.set_time_index(request.time_index());
  const bool depth = !added.empty() && IsExtinction(fields->fields[added.front()]);
  response.set_units(depth ? "1" : "kg m-2");
  for (const std::size_t index : added) {
    response.add_fields(ToMessage(fields->fields[index].hydrometeor));
  }
  response.set_projection(
      storm_store::ProjectionTextOf(storm, static_cast<std::size_t>(time_index)));
  const StormPlaces places(storm, time_index, *fields);
  ToMessage(map, places, response);
  if (request.with_places()) {
    if (auto table = places.Table()) *response.mutable_places() = *std::move(table);
  }
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* GetStormMap(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::GetStormMapRequest* request,
                                      v1::GetStormMapResponse* response) {
  const auto storm = CheckMap(engine, *request);
  if (!storm.ok()) return rpc_port::Refused(context, *caller, storm.status());
  return rpc_port::FinishedBy(engine.executor, engine.limits, context, caller, *response,
                              [=, &engine] { return Map(engine, **storm, *request, *response); });
}

}  // namespace thunderhead::service
