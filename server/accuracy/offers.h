// Chooses the setting that reaches the accuracy or speed that a scene asks for, by tables measured
// against the reference (accuracy/priced_settings.h) and the cost of frames on this machine. Plain
// values, no clock, no threads.
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

// The best of `offers`, which are not empty: of those within the limit the cheapest for MaxError,
// the most accurate for MaxMilliseconds; where none is, the nearest to it. `current` stays while it
// keeps within a tenth of the limit and is little worse than the best, so that noise in the times
// does not flicker on the screen. No limit: the first.
Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<Setting>& current);

// True if the offer is within the limit.
bool Meets(const Offer& offer, const scene::Accuracy& limit);

// Why `offer`, which the scene is drawn with, misses what the scene asks for; none if it does not.
std::optional<Unmet> WhyUnmet(const scene::Scene& scene, const Offer& offer);

// Settings of one view that may be refuted before the last one stays: several that miss the limit
// by nearly the same are not drawn in turns.
inline constexpr int kMaxRefuted = 8;

class Offers {
 public:
  // Both must outlive it.
  Offers(const OfferTables& tables, const MachineCosts& costs) : tables_(tables), costs_(costs) {}

  // The scene with the setting that reaches what it asks for, or as it is if it asks for nothing.
  // `current` is the setting that its view is drawn with so far, `measured` what measuring it has
  // told. Fails where there is no table.
  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene,
                                      const std::optional<Setting>& current,
                                      const MeasuredErrors& measured = {}) const;

  // True if the picture of `scene`, drawn with that setting, surely has more error than it asks
  // for. `measured` knows it then. Callers ask kMaxRefuted times at most.
  bool Refutes(const scene::Scene& scene, const Setting& drawn, const MeasuredError& error,
               MeasuredErrors* measured) const;

 private:
  std::vector<Offer> OffersFor(const PricedSettings& table, const scene::Scene& scene,
                               const MeasuredErrors& measured) const;

  const OfferTables& tables_;
  const MachineCosts& costs_;
};

// The table's settings know nothing of the scene's taste: turbulent detail, false colours and
// theta_f stay those of `asked`.
scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique);

}  // namespace thunderhead::accuracy
