#include "thunderhead_client/session_state.h"

#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

Results ObservedOf(const SessionState& state) {
  const v1::Person* const steerer = state.Steerer();
  return {{"steers", JsonOf(state.Steers())},
          {"presents", JsonOf(state.Presents())},
          {"alone", JsonOf(state.Alone())},
          {"asks_control", JsonOf(state.AsksControl())},
          {"gets_control_at_once", JsonOf(state.SteersWhoAsks())},
          {"may_look_around", JsonOf(state.MayLookAround())},
          {"may_mark", JsonOf(state.MayMark())},
          {"steerer", steerer == nullptr ? Null() : JsonOf(state.NameOf(*steerer))}};
}

Json MarksOf(const SessionState& state) {
  std::vector<Json> marks;
  for (const v1::Mark& mark : state.marks.marks()) {
    Json json;
    auto& fields = *json.mutable_struct_value()->mutable_fields();
    fields["mark_id"] = JsonOf(static_cast<double>(mark.mark_id()));
    fields["viewer_id"] = JsonOf(static_cast<double>(mark.viewer_id()));
    marks.push_back(json);
  }
  return JsonOf(marks);
}

}  // namespace

Actions RunSessionState(Arguments& given) {
  const auto state = std::make_shared<SessionState>();
  state->link = Link::kLive;
  const auto me = given.Read<v1::Person>("me");
  state->viewer_id = me.viewer_id();
  state->role = me.role();
  Actions actions;
  actions["presence"] = [=](Arguments& step) {
    state->presence = step.Read<v1::Presence>("presence");
    return ObservedOf(*state);
  };
  actions["marks"] = [=](Arguments& step) -> Results {
    state->Take(step.Read<v1::Marks>("marks"));
    return {{"marks", MarksOf(*state)}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
