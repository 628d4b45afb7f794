// Chooses the setting with which a scene reaches its requested accuracy or speed. The choice uses
// the tables of measured errors (accuracy/priced_settings.h) and the drawing times of frames on
// this machine. This code uses no clock and no threads.
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

// A setting with its predicted drawing time on this machine and its error.
struct Offer {
  Setting setting;
  double milliseconds = 0.0;
  double error = 0.0;

  bool operator==(const Offer&) const = default;
};

// Returns the best of `offers`, which must not be empty. Among the offers within `limit`, this is
// the fastest for MaxError and the most accurate for MaxMilliseconds. If no offer is within the
// limit, it is the offer nearest to the limit. Without a limit, it is the first offer. The setting
// `current` is kept if it exceeds the limit by at most a tenth and is little worse than the best.
// Noise in the measured times therefore does not make the picture flicker.
Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<Setting>& current);

// Returns true if the offer is within the limit.
bool Meets(const Offer& offer, const scene::Accuracy& limit);

// Returns why `offer`, with which the scene is drawn, does not meet the scene's request, or nothing
// if it does.
std::optional<Unmet> WhyUnmet(const scene::Scene& scene, const Offer& offer);

// The maximum number of settings of one view that measurements may refute; then the last setting is
// kept. Without this limit, several settings that miss the request by almost the same amount would
// alternate.
inline constexpr int kMaxRefuted = 8;

class Offers {
 public:
  // Both arguments must outlive this object.
  Offers(const OfferTables& tables, const MachineCosts& costs) : tables_(tables), costs_(costs) {}

  // Returns the scene with the setting that reaches the scene's request. A scene without a request,
  // or with the reference as its technique, is returned unchanged. The argument `current` is the
  // present setting of the scene's view, and `measured` has the errors measured for this scene.
  // Returns an error if there is no table for the scene's camera.
  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene,
                                      const std::optional<Setting>& current,
                                      const MeasuredErrors& measured = {}) const;

  // Returns true if `error`, measured for the picture of `scene` with the setting `drawn`, is
  // certainly larger than requested. In this case, it also records the error in `measured`. For
  // each view, callers stop calling it after it has returned true kMaxRefuted times.
  bool Refutes(const scene::Scene& scene, const Setting& drawn, const MeasuredError& error,
               MeasuredErrors* measured) const;

 private:
  std::vector<Offer> OffersFor(const PricedSettings& table, const scene::Scene& scene,
                               const MeasuredErrors& measured) const;

  const OfferTables& tables_;
  const MachineCosts& costs_;
};

// Returns `technique` with those settings of `asked` that the tables do not distinguish: turbulent
// detail, false colours and theta_f (MediumSettings::theta_f_deg).
scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique);

}  // namespace thunderhead::accuracy
