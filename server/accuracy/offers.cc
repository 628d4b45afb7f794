#include "accuracy/offers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "accuracy/embedded_trade_tables.h"
#include "accuracy/named_settings.h"
#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

constexpr std::array<const char*, std::variant_size_v<scene::Camera>> kViews = {"orbit", "spotter",
                                                                                "top-down"};

// How far beyond the limit a setting may go, and how much worse than the best it may be, that is
// drawn already.
constexpr double kLimitSlack = 1.1;
constexpr double kWorthChanging = 1.25;
// Tracing light costs a frame nothing, but takes the machine's time at rest: it is worth that where
// nothing else is as accurate, not where it only seems a little faster.
constexpr double kTracingIsDearer = 1.2;
// The weight of a new measurement.
constexpr double kFollow = 0.3;

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

double PixelsOf(const glm::ivec2& size_px) { return static_cast<double>(size_px.x) * size_px.y; }

// What the table says of a picture of that size: what grows with the pixels is nearly all.
double TableMs(const PricedSettings& table, const PricedSetting& row, const scene::Scene& scene) {
  const glm::ivec2 size_px(scene.output.width_px, scene.output.height_px);
  return row.milliseconds * PixelsOf(size_px) / PixelsOf(table.size_px);
}

// The same technique and model of light; turbulent detail does not change the mean light that the
// tables compare.
bool SameModel(const scene::Technique& a, const scene::Technique& b) {
  const auto key = [](const scene::Technique& technique) {
    const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
    return std::tuple(scene::NameOf(technique), TransportNameOf(technique),
                      medium == nullptr || scene::IsTranslucent(medium->transport),
                      scene::FieldLookOf(technique).per_field_phase);
  };
  return key(a) == key(b);
}

bool SameDrawing(const Setting& a, const Setting& b) {
  return SameModel(a.technique, b.technique) && CountOf(a.technique) == CountOf(b.technique) &&
         a.image_scale == b.image_scale && (a.million_paths > 0.0) == (b.million_paths > 0.0);
}

// Factors of two between slices and scales.
double Distance(const Setting& a, const Setting& b) {
  return std::abs(std::log2(static_cast<double>(CountOf(a.technique)) / CountOf(b.technique))) +
         std::abs(std::log2(a.image_scale / b.image_scale));
}

// The row of the same technique and model that is most like `setting`, if any: where its
// light is traced, of the rows with traced light and no more paths, if there are such.
const PricedSetting* Nearest(const PricedSettings& table, const Setting& setting) {
  const PricedSetting* nearest = nullptr;
  for (const PricedSetting& row : table.rows) {
    const Setting& other = row.setting;
    const bool alike = SameModel(other.technique, setting.technique);
    if (!alike || other.million_paths > setting.million_paths) continue;
    const auto order = [&](const Setting& of) {
      return std::tuple(of.million_paths == 0.0, Distance(of, setting), -of.million_paths);
    };
    if (nearest == nullptr || order(other) < order(nearest->setting)) nearest = &row;
  }
  return nearest;
}

// Paths cost a frame nothing.
Setting Untraced(Setting setting) {
  setting.million_paths = 0.0;
  return setting;
}

absl::StatusOr<PricedSettings> ReadBuiltIn(const char* view) {
  const auto& texts = EmbeddedTradeTableTexts();
  const auto text = texts.find(view);
  if (text == texts.end()) return absl::NotFoundError("there is none");
  return ReadPricedSettings(text->second);
}

}  // namespace

bool Meets(const Offer& offer, const scene::Accuracy& limit) {
  return Within(MeasuresOf(offer, limit), 1.0);
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

void TableCorrection::Mean::Follow(double log_measured) {
  ++count;
  log_factor += std::max(kFollow, 1.0 / count) * (log_measured - log_factor);
}

TableCorrection::Key TableCorrection::KeyOf(const Setting& setting) {
  return {scene::NameOf(setting.technique), ModeOf(setting.technique).name,
          TransportNameOf(setting.technique), CountOf(setting.technique), setting.image_scale};
}

void TableCorrection::Observe(const Setting& setting, double table_ms, double measured_ms) {
  if (!(table_ms > 0.0) || !(measured_ms > 0.0)) return;
  const double log_factor = std::log(measured_ms / table_ms);
  settings_[KeyOf(setting)].Follow(log_factor);
  techniques_[scene::NameOf(setting.technique)].Follow(log_factor);
  machine_.Follow(log_factor);
}

double TableCorrection::Factor(const Setting& setting) const {
  if (const auto own = settings_.find(KeyOf(setting)); own != settings_.end()) {
    return std::exp(own->second.log_factor);
  }
  const auto technique = techniques_.find(scene::NameOf(setting.technique));
  return std::exp(technique != techniques_.end() ? technique->second.log_factor
                                                 : machine_.log_factor);
}

bool TableCorrection::Knows(const Setting& setting) const {
  return settings_.count(KeyOf(setting)) > 0;
}

OfferTables BuiltInOfferTables() {
  OfferTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    tables[i] = ReadBuiltIn(kViews[i]);
    if (tables[i].ok()) continue;
    tables[i] = absl::FailedPreconditionError(
        absl::StrCat("no accuracy can be offered for ", kViews[i],
                     " views; their table: ", tables[i].status().message()));
  }
  return tables;
}

Setting SettingOf(const scene::Scene& scene) {
  const scene::Rendering& rendering = scene.rendering;
  Setting setting{rendering.technique, rendering.image_scale, scene.output.jpeg_quality};
  if (scene::TracedLightOf(rendering.technique) != scene::TracedLight::kOff) {
    setting.million_paths = kTracedPaths / 1e6;
  }
  return setting;
}

scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique) {
  const scene::MediumSettings* taste = scene::MediumSettingsOf(asked);
  scene::MediumSettings* medium = scene::MediumSettingsOf(&technique);
  if (taste == nullptr || medium == nullptr) return technique;
  medium->theta_f_deg = taste->theta_f_deg;
  medium->look.detail = taste->look.detail && scene::CapabilitiesOf(technique).detail;
  medium->look.false_colors = taste->look.false_colors;
  return technique;
}

std::vector<Offer> Offers::OffersFor(const PricedSettings& table, const scene::Scene& scene) const {
  std::vector<Offer> offers;
  const bool limits_time = std::holds_alternative<scene::MaxMilliseconds>(scene.accuracy);
  for (const PricedSetting& row : table.rows) {
    const bool traced = row.setting.million_paths > 0.0;
    if (traced && limits_time) continue;
    const double ms = TableMs(table, row, scene) * correction_.Factor(row.setting);
    offers.push_back({row.setting, traced ? kTracingIsDearer * ms : ms, row.relative_rmse});
  }
  return offers;
}

absl::StatusOr<scene::Scene> Offers::Decide(const scene::Scene& scene,
                                            const std::optional<Setting>& current) const {
  if (std::holds_alternative<std::monostate>(scene.accuracy)) return scene;
  if (std::holds_alternative<scene::Reference>(scene.rendering.technique)) return scene;
  const auto& table = TableOf(scene);
  if (!table.ok()) return table.status();
  const Setting setting = BestOffer(OffersFor(*table, scene), scene.accuracy, current).setting;
  scene::Scene decided = scene;
  decided.rendering.technique = WithTasteOf(scene.rendering.technique, setting.technique);
  decided.rendering.image_scale = setting.image_scale;
  if (auto* light_volume = std::get_if<scene::LightVolume>(&decided.rendering.technique)) {
    // Who asks for an error that only tracing reaches waits for it.
    light_volume->traced_light =
        setting.million_paths > 0.0 ? scene::TracedLight::kAwaited : scene::TracedLight::kOff;
  }
  return decided;
}

void Offers::Observe(const scene::Scene& scene, double milliseconds) {
  const auto& table = TableOf(scene);
  if (!table.ok()) return;
  const Setting setting = Untraced(SettingOf(scene));
  const PricedSetting* row = Nearest(*table, setting);
  // Frames of settings that the table has no row for would teach the distance to the nearest.
  if (row == nullptr || Distance(row->setting, setting) > 0.0) return;
  correction_.Observe(setting, TableMs(*table, *row, scene), milliseconds);
}

std::optional<AccuracyReport> Offers::Report(const scene::Scene& scene, const FrameQuality& quality,
                                             const std::optional<double>& discretisation_error,
                                             std::int64_t traced_paths) const {
  const auto& table = TableOf(scene);
  if (!table.ok()) return std::nullopt;
  const Setting full = SettingOf(scene);
  Setting drawn = full;
  if (const auto slices = scene::SlicesOf(full.technique); slices.has_value()) {
    scene::SetSlices(&drawn.technique,
                     std::max(static_cast<int>(std::ceil(*slices * quality.slice_share)), 1));
  }
  drawn.image_scale *= quality.image_scale;
  drawn.million_paths = static_cast<double>(traced_paths) / 1e6;
  const PricedSetting* row = Nearest(*table, drawn);
  if (row == nullptr) return std::nullopt;
  AccuracyReport report;
  report.technique = full.technique;
  report.slices = CountOf(drawn.technique);
  report.image_scale = drawn.image_scale;
  report.model_error = row->relative_rmse;
  report.discretisation_error = discretisation_error;
  // The table's error has some of the slices' in it already; counting it twice errs on the safe
  // side.
  report.estimated_error = std::hypot(row->relative_rmse, discretisation_error.value_or(0.0));
  const PricedSetting* full_row = Nearest(*table, full);
  const bool asks = !std::holds_alternative<std::monostate>(scene.accuracy);
  const PricedSetting& timed = *Nearest(*table, Untraced(full));
  const double expected_ms = TableMs(*table, timed, scene) * correction_.Factor(timed.setting);
  if (asks || correction_.Knows(full)) report.expected_ms = expected_ms;
  // A coarse frame, or one with few paths, is on its way to the full one, which is what was asked
  // for.
  const bool is_full =
      quality == FrameQuality{} && row->setting.million_paths == full_row->setting.million_paths;
  const double error = is_full ? report.estimated_error : full_row->relative_rmse;
  report.unmet = WhyUnmet(scene, {full, expected_ms, error});
  return report;
}

std::int64_t Offers::PathsFor(const scene::Scene& scene) const {
  const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy);
  const auto& table = TableOf(scene);
  if (limit == nullptr || !table.ok()) return kImagePaths;
  std::int64_t fewest = kTracedPaths;
  for (const PricedSetting& row : table->rows) {
    const std::int64_t paths = std::llround(1e6 * row.setting.million_paths);
    if (row.relative_rmse > limit->relative_rmse || paths >= fewest) continue;
    const auto report = Report(scene, {}, std::nullopt, paths);
    if (report.has_value() && report->estimated_error <= limit->relative_rmse) fewest = paths;
  }
  return fewest;
}

std::optional<Unmet> Offers::WhyUnmet(const scene::Scene& scene, const Offer& offer) const {
  if (std::holds_alternative<std::monostate>(scene.accuracy) || Meets(offer, scene.accuracy)) {
    return std::nullopt;
  }
  const char* view = kViews[scene.camera.index()];
  if (const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy)) {
    return Unmet{Unmet::Code::kErrorOutOfReach,
                 absl::StrFormat("an error of %.3g is out of reach for %s views; the nearest is "
                                 "%.3g, in %.3g ms a frame. The reference refines to any error",
                                 limit->relative_rmse, view, offer.error, offer.milliseconds)};
  }
  return Unmet{Unmet::Code::kTimeOutOfReach,
               absl::StrFormat(
                   "%.3g ms a frame are out of reach for %s views of %dx%d on this machine; the "
                   "nearest is %.3g ms, with an error of %.3g",
                   std::get<scene::MaxMilliseconds>(scene.accuracy).milliseconds, view,
                   scene.output.width_px, scene.output.height_px, offer.milliseconds, offer.error)};
}

}  // namespace thunderhead::accuracy
