#include "accuracy/offers.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "absl/strings/str_format.h"
#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

// The current setting is kept if it exceeds the limit by at most the factor kLimitSlack, and is
// worse than the best offer by at most the factor kWorthChanging.
constexpr double kLimitSlack = 1.1;
constexpr double kWorthChanging = 1.25;
// The factor by which the time of settings with path-traced correction is multiplied in
// comparisons. Tracing adds nothing to a frame's time, but uses the machine while the scene is at
// rest. The correction should be chosen only if it is clearly better than other settings.
constexpr double kTracingIsDearer = 1.2;

// The constrained quantity, its bound, and the objective to minimise within the bound.
struct Measures {
  double constrained = 0.0;
  double bound = 0.0;
  double objective = 0.0;
};

Measures MeasuresOf(const Offer& offer, const scene::Accuracy& limit) {
  if (const auto* error = std::get_if<scene::MaxError>(&limit)) {
    return {offer.error, error->relative_rmse, offer.milliseconds};
  }
  if (const auto* time = std::get_if<scene::MaxMilliseconds>(&limit)) {
    return {offer.milliseconds, time->milliseconds, offer.error};
  }
  return {};
}

bool Within(const Measures& measures, double slack) {
  return measures.constrained <= slack * measures.bound;
}

bool Better(const Measures& a, const Measures& b) {
  const bool a_within = Within(a, 1.0);
  if (a_within != Within(b, 1.0)) return a_within;
  if (a_within)
    return std::pair(a.objective, a.constrained) < std::pair(b.objective, b.constrained);
  return std::pair(a.constrained, a.objective) < std::pair(b.constrained, b.objective);
}

}  // namespace

bool Meets(const Offer& offer, const scene::Accuracy& limit) {
  return Within(MeasuresOf(offer, limit), 1.0);
}

std::optional<Unmet> WhyUnmet(const scene::Scene& scene, const Offer& offer) {
  if (std::holds_alternative<std::monostate>(scene.accuracy) || Meets(offer, scene.accuracy)) {
    return std::nullopt;
  }
  const std::string view(ViewNameOf(scene.camera));
  if (const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy)) {
    return Unmet{
        Unmet::Code::kErrorOutOfReach,
        absl::StrFormat("no setting reaches an error of %.3g for %s views; the best has %.3g "
                        "in %.3g ms a frame; for a smaller error, choose the technique reference",
                        limit->relative_rmse, view, offer.error, offer.milliseconds)};
  }
  return Unmet{
      Unmet::Code::kTimeOutOfReach,
      absl::StrFormat(
          "no setting reaches %.3g ms a frame for %s views of %dx%d on this machine; the best "
          "takes %.3g ms, with an error of %.3g; for less time, choose a smaller picture",
          std::get<scene::MaxMilliseconds>(scene.accuracy).milliseconds, view,
          scene.output.width_px, scene.output.height_px, offer.milliseconds, offer.error)};
}

Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<Setting>& current) {
  THUNDERHEAD_CHECK(!offers.empty(), "nothing to choose from");
  const auto best =
      std::min_element(offers.begin(), offers.end(), [&](const auto& a, const auto& b) {
        return Better(MeasuresOf(a, limit), MeasuresOf(b, limit));
      });
  if (!current.has_value()) return *best;
  const Offer* kept = nullptr;
  for (const Offer& offer : offers) {
    if (!SameDrawing(offer.setting, *current)) continue;
    const bool first = kept == nullptr;
    if (first || Better(MeasuresOf(offer, limit), MeasuresOf(*kept, limit))) kept = &offer;
  }
  if (kept == nullptr) return *best;
  const Measures of_best = MeasuresOf(*best, limit);
  const Measures of_kept = MeasuresOf(*kept, limit);
  const bool reachable = Within(of_best, 1.0);
  const bool stays = reachable ? Within(of_kept, kLimitSlack) &&
                                     of_kept.objective <= kWorthChanging * of_best.objective
                               : of_kept.constrained <= kLimitSlack * of_best.constrained;
  return stays ? *kept : *best;
}

scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique) {
  const scene::MediumSettings* taste = scene::MediumSettingsOf(asked);
  scene::MediumSettings* medium = scene::MediumSettingsOf(&technique);
  if (taste == nullptr || medium == nullptr) return technique;
  medium->theta_f_deg = taste->theta_f_deg;
  medium->look.detail =
      taste->look.detail && scene::CapabilitiesOf(technique).detail == scene::DetailUse::kMedium;
  medium->look.false_colors = taste->look.false_colors;
  return technique;
}

std::vector<Offer> Offers::OffersFor(const PricedSettings& table, const scene::Scene& scene,
                                     const MeasuredErrors& measured) const {
  std::vector<Offer> offers;
  const bool limits_time = std::holds_alternative<scene::MaxMilliseconds>(scene.accuracy);
  for (const PricedSetting& row : table.rows) {
    const bool traced = row.setting.million_paths > 0.0;
    if (traced && limits_time) continue;
    const double ms = costs_.SettingMs(table, row, scene);
    offers.push_back({row.setting, traced ? kTracingIsDearer * ms : ms,
                      row.relative_rmse * measured.FactorOf(row.setting)});
  }
  return offers;
}

absl::StatusOr<scene::Scene> Offers::Decide(const scene::Scene& scene,
                                            const std::optional<Setting>& current,
                                            const MeasuredErrors& measured) const {
  if (std::holds_alternative<std::monostate>(scene.accuracy)) return scene;
  if (scene::IsTraced(scene.rendering.technique)) return scene;
  const auto& table = TableFor(tables_, scene);
  if (!table.ok()) return table.status();
  const std::vector<Offer> offers = OffersFor(*table, scene, measured);
  const Setting setting = BestOffer(offers, scene.accuracy, current).setting;
  scene::Scene decided = scene;
  decided.rendering.technique = WithTasteOf(scene.rendering.technique, setting.technique);
  decided.rendering.image_scale = setting.image_scale;
  // If the requested error is reached only with the path-traced correction, the picture waits for
  // it.
  scene::SetTracedLight(&decided.rendering.technique, setting.million_paths > 0.0
                                                          ? scene::TracedLight::kAwaited
                                                          : scene::TracedLight::kOff);
  return decided;
}

bool Offers::Refutes(const scene::Scene& scene, const Setting& drawn, const MeasuredError& error,
                     MeasuredErrors* measured) const {
  const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy);
  const auto& table = TableFor(tables_, scene);
  if (limit == nullptr || !table.ok() || error.relative_rmse.low <= limit->relative_rmse) {
    return false;
  }
  const PricedSetting* const row = NearestRow(*table, drawn);
  if (row == nullptr) return false;
  measured->Observe(drawn, row->relative_rmse, error.relative_rmse.value);
  return true;
}

}  // namespace thunderhead::accuracy
