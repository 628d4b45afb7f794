#include "thunderhead_client/back_off.h"

#include <memory>

#include "client-cpp/tests/cases/runners.h"

namespace thunderhead::client::testing {

Actions RunBackOff(Arguments& /*given*/) {
  const auto random = std::make_shared<double>(0.0);
  const auto back_off = std::make_shared<BackOff>([random] { return *random; });
  const auto attempts = [back_off] { return JsonOf(static_cast<double>(back_off->attempts())); };
  Actions actions;
  actions["next"] = [=](Arguments& step) -> Results {
    *random = step.Number("random");
    const std::chrono::milliseconds least(static_cast<int>(step.Number("least_ms", 0.0)));
    const auto delay = static_cast<double>(back_off->Next(least).count());
    return {{"delay_ms", JsonOf(delay)}, {"attempts", attempts()}};
  };
  actions["reset"] = [=](Arguments&) -> Results {
    back_off->Reset();
    return {{"attempts", attempts()}};
  };
  return actions;
}

}  // namespace thunderhead::client::testing
