// Chooses the setting that reaches the accuracy or speed that a scene requests. It uses tables
// measured against the reference (accuracy/priced_settings.h) and the cost of frames on this
// machine. Plain values, no clock, no threads.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/accuracy_report.h"
#include "accuracy/machine_costs.h"
#include "accuracy/measured_errors.h"
#include "accuracy/offer_tables.h"
#include "accuracy/setting.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A setting with its predicted cost and error on this machine.
struct Offer {
  Setting setting;
  double milliseconds = 0.0;
  double error = 0.0;

  bool operator==(const Offer&) const = default;
};

// Returns the best of `offers`, which must not be empty. Among those within the limit it is the
// cheapest for MaxError and the most accurate for MaxMilliseconds. If none is within the limit, it
// is the nearest. `current` is kept while it exceeds the limit by at most a tenth and is little
// worse than the best. So noise in the times does not make the picture flicker. Without a limit it
// is the first.
Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<Setting>& current);

// Returns true if the offer is within the limit.
bool Meets(const Offer& offer, const scene::Accuracy& limit);

// Returns why `offer`, with which the scene is drawn, misses the scene's request. None if it does
// not.
std::optional<Unmet> WhyUnmet(const scene::Scene& scene, const Offer& offer);

// Maximum number of refuted settings of one view; then the last one stays. Otherwise several
// settings that miss the limit by almost the same amount would alternate.
inline constexpr int kMaxRefuted = 8;

class Offers {
 public:
  // Both must outlive it.
  Offers(const OfferTables& tables, const MachineCosts& costs) : tables_(tables), costs_(costs) {}

  // Returns the scene with the setting that reaches its request. A scene without a request is not
  // changed. `current` is the present setting of its view. `measured` holds the errors measured on
  // it. Fails if there is no table.
  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene,
                                      const std::optional<Setting>& current,
                                      const MeasuredErrors& measured = {}) const;

  // Returns true if the picture of `scene`, drawn with that setting, certainly has a larger error
  // than requested, and records it in `measured`. Callers ask kMaxRefuted times at most.
  bool Refutes(const scene::Scene& scene, const Setting& drawn, const MeasuredError& error,
               MeasuredErrors* measured) const;

 private:
  std::vector<Offer> OffersFor(const PricedSettings& table, const scene::Scene& scene,
                               const MeasuredErrors& measured) const;

  const OfferTables& tables_;
  const MachineCosts& costs_;
};

// Returns `technique` with the look of `asked`, because the table's settings do not include it:
// turbulent detail, false colours and theta_f.
scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique);

}  // namespace thunderhead::accuracy
