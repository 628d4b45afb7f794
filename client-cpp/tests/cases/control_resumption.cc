#include "thunderhead_client/control_resumption.h"

#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {
namespace {

std::string NameOf(ControlResumption::Outcome outcome) {
  switch (outcome) {
    case ControlResumption::Outcome::kTakes:
      return "takes";
    case ControlResumption::Outcome::kWaits:
      return "waits";
    case ControlResumption::Outcome::kLost:
      return "lost";
  }
  return "";
}

}  // namespace

Actions RunControlResumption(Arguments& /*given*/) {
  const auto resumption = std::make_shared<ControlResumption>();
  Actions actions;
  actions["rejoin"] = [=](Arguments& step) -> Results {
    resumption->Rejoined(static_cast<std::uint64_t>(step.Number("viewer_id")),
                         step.Read<v1::Presence>("presence"));
    return {};
  };
  actions["presence"] = [=](Arguments& step) -> Results {
    const auto outcome = resumption->Of(step.Read<v1::Presence>("presence"), step.Flag("presents"));
    return {{"outcome", JsonOf(NameOf(outcome))}};
  };
  actions["end"] = [=](Arguments&) -> Results {
    resumption->End();
    return {};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
