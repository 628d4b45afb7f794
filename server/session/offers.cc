#include "session/offers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "measure/embedded_trade_tables.h"

namespace thunderhead::session {
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

// What is limited, and what is to be small within the limit.
struct Measures {
  double limited = 0.0;
  double limit = 0.0;
  double wanted = 0.0;
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
  return measures.limited <= slack * measures.limit;
}

bool Better(const Measures& a, const Measures& b) {
  const bool a_within = Within(a, 1.0);
  if (a_within != Within(b, 1.0)) return a_within;
  if (a_within) return std::pair(a.wanted, a.limited) < std::pair(b.wanted, b.limited);
  return std::pair(a.limited, a.wanted) < std::pair(b.limited, b.wanted);
}

double PixelsOf(const glm::ivec2& size_px) { return static_cast<double>(size_px.x) * size_px.y; }

// What the table says of a picture of that size: what grows with the pixels is nearly all.
double TableMs(const measure::PricedSettings& table, const measure::PricedSetting& row,
               const scene::Scene& scene) {
  const glm::ivec2 size_px(scene.output.width_px, scene.output.height_px);
  return row.milliseconds * PixelsOf(size_px) / PixelsOf(table.size_px);
}

bool SameDrawing(const measure::TradeSetting& a, const measure::TradeSetting& b) {
  return a.renderer == b.renderer && a.mode == b.mode && a.transport == b.transport &&
         a.slices == b.slices && a.image_scale == b.image_scale &&
         (a.million_paths > 0.0) == (b.million_paths > 0.0);
}

// Factors of two between slices and scales.
double Distance(const measure::TradeSetting& a, const measure::TradeSetting& b) {
  return std::abs(std::log2(static_cast<double>(a.slices) / b.slices)) +
         std::abs(std::log2(a.image_scale / b.image_scale));
}

// The row of the same renderer, mode and transport that is most like `setting`, if any: where its
// light is traced, of the rows with traced light and no more paths, if there are such.
const measure::PricedSetting* Nearest(const measure::PricedSettings& table,
                                      const measure::TradeSetting& setting) {
  const measure::PricedSetting* nearest = nullptr;
  for (const measure::PricedSetting& row : table.rows) {
    const measure::TradeSetting& other = row.setting;
    const bool alike = other.renderer == setting.renderer && other.mode == setting.mode &&
                       other.transport == setting.transport;
    if (!alike || other.million_paths > setting.million_paths) continue;
    const auto order = [&](const measure::TradeSetting& of) {
      return std::tuple(of.million_paths == 0.0, Distance(of, setting), -of.million_paths);
    };
    if (nearest == nullptr || order(other) < order(nearest->setting)) nearest = &row;
  }
  return nearest;
}

// Paths cost a frame nothing.
measure::TradeSetting Untraced(measure::TradeSetting setting) {
  setting.million_paths = 0.0;
  return setting;
}

absl::StatusOr<measure::PricedSettings> ReadBuiltIn(const char* view) {
  const auto& texts = measure::EmbeddedTradeTableTexts();
  const auto text = texts.find(view);
  if (text == texts.end()) return absl::NotFoundError("there is none");
  return measure::ReadPricedSettings(text->second);
}

}  // namespace

bool Meets(const Offer& offer, const scene::Accuracy& limit) {
  return Within(MeasuresOf(offer, limit), 1.0);
}

Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<measure::TradeSetting>& current) {
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
  const bool stays =
      reachable ? Within(of_kept, kLimitSlack) && of_kept.wanted <= kWorthChanging * of_best.wanted
                : of_kept.limited <= kLimitSlack * of_best.limited;
  return stays ? *kept : *best;
}

void TableCorrection::Mean::Follow(double log_measured) {
  ++count;
  log_factor += std::max(kFollow, 1.0 / count) * (log_measured - log_factor);
}

TableCorrection::Key TableCorrection::KeyOf(const measure::TradeSetting& setting) {
  return {setting.renderer, setting.mode, setting.transport, setting.slices, setting.image_scale};
}

void TableCorrection::Observe(const measure::TradeSetting& setting, double table_ms,
                              double measured_ms) {
  if (!(table_ms > 0.0) || !(measured_ms > 0.0)) return;
  const double log_factor = std::log(measured_ms / table_ms);
  settings_[KeyOf(setting)].Follow(log_factor);
  renderers_[setting.renderer].Follow(log_factor);
  machine_.Follow(log_factor);
}

double TableCorrection::Factor(const measure::TradeSetting& setting) const {
  if (const auto own = settings_.find(KeyOf(setting)); own != settings_.end()) {
    return std::exp(own->second.log_factor);
  }
  const auto renderer = renderers_.find(setting.renderer);
  return std::exp(renderer != renderers_.end() ? renderer->second.log_factor : machine_.log_factor);
}

bool TableCorrection::Knows(const measure::TradeSetting& setting) const {
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

measure::TradeSetting SettingOf(const scene::Scene& scene) {
  const scene::Rendering& rendering = scene.rendering;
  const int slices = HasSlices(rendering.renderer) ? rendering.slices : rendering.metaballs.count;
  measure::TradeSetting setting{rendering.renderer,    rendering.mode,
                                rendering.transport,   slices,
                                rendering.image_scale, scene.output.jpeg_quality};
  if (rendering.traced_light && scene::ShowsTracedLight(rendering)) {
    setting.million_paths = kTracedPaths / 1e6;
  }
  return setting;
}

bool HasSlices(scene::Renderer renderer) {
  return renderer == scene::Renderer::kHalfAngle || renderer == scene::Renderer::kLightVolume;
}

std::vector<Offer> Offers::OffersFor(const measure::PricedSettings& table,
                                     const scene::Scene& scene) const {
  std::vector<Offer> offers;
  const bool limits_time = std::holds_alternative<scene::MaxMilliseconds>(scene.accuracy);
  for (const measure::PricedSetting& row : table.rows) {
    const bool traced = row.setting.million_paths > 0.0;
    if (traced && limits_time) continue;
    const double ms = TableMs(table, row, scene) * correction_.Factor(row.setting);
    offers.push_back({row.setting, traced ? kTracingIsDearer * ms : ms, row.relative_rmse});
  }
  return offers;
}

absl::StatusOr<scene::Scene> Offers::Decide(
    const scene::Scene& scene, const std::optional<measure::TradeSetting>& current) const {
  if (std::holds_alternative<std::monostate>(scene.accuracy)) return scene;
  if (scene.rendering.renderer == scene::Renderer::kReference) return scene;
  const auto& table = TableOf(scene);
  if (!table.ok()) return table.status();
  const measure::TradeSetting setting =
      BestOffer(OffersFor(*table, scene), scene.accuracy, current).setting;
  scene::Scene decided = scene;
  decided.rendering.renderer = setting.renderer;
  decided.rendering.mode = setting.mode;
  decided.rendering.transport = setting.transport;
  if (HasSlices(setting.renderer)) {
    decided.rendering.slices = setting.slices;
  } else if (setting.renderer == scene::Renderer::kMetaball) {
    decided.rendering.metaballs.count = setting.slices;
  }
  decided.rendering.image_scale = setting.image_scale;
  decided.rendering.traced_light = setting.million_paths > 0.0;
  return decided;
}

void Offers::Observe(const scene::Scene& scene, double milliseconds) {
  const auto& table = TableOf(scene);
  if (!table.ok()) return;
  const measure::TradeSetting setting = Untraced(SettingOf(scene));
  const measure::PricedSetting* row = Nearest(*table, setting);
  // Frames of settings that the table has no row for would teach the distance to the nearest.
  if (row == nullptr || Distance(row->setting, setting) > 0.0) return;
  correction_.Observe(setting, TableMs(*table, *row, scene), milliseconds);
}

std::optional<AccuracyReport> Offers::Report(const scene::Scene& scene, const FrameQuality& quality,
                                             const std::optional<double>& discretisation_error,
                                             std::int64_t traced_paths) const {
  const auto& table = TableOf(scene);
  if (!table.ok()) return std::nullopt;
  const measure::TradeSetting full = SettingOf(scene);
  measure::TradeSetting drawn = full;
  if (HasSlices(full.renderer)) {
    drawn.slices = std::max(static_cast<int>(std::ceil(full.slices * quality.slice_share)), 1);
  }
  drawn.image_scale *= quality.image_scale;
  drawn.million_paths = static_cast<double>(traced_paths) / 1e6;
  const measure::PricedSetting* row = Nearest(*table, drawn);
  if (row == nullptr) return std::nullopt;
  AccuracyReport report;
  report.renderer = drawn.renderer;
  report.mode = drawn.mode;
  report.transport = drawn.transport;
  report.slices = drawn.slices;
  report.image_scale = drawn.image_scale;
  report.model_error = row->relative_rmse;
  report.discretisation_error = discretisation_error;
  // The table's error has some of the slices' in it already; counting it twice errs on the safe
  // side.
  report.estimated_error = std::hypot(row->relative_rmse, discretisation_error.value_or(0.0));
  const measure::PricedSetting* full_row = Nearest(*table, full);
  const bool asks = !std::holds_alternative<std::monostate>(scene.accuracy);
  const measure::PricedSetting& timed = *Nearest(*table, Untraced(full));
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

std::string Offers::WhyUnmet(const scene::Scene& scene, const Offer& offer) const {
  if (std::holds_alternative<std::monostate>(scene.accuracy) || Meets(offer, scene.accuracy)) {
    return "";
  }
  const char* view = kViews[scene.camera.index()];
  if (const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy)) {
    return absl::StrFormat(
        "an error of %.3g is out of reach for %s views; the nearest is %.3g, in %.3g ms a frame. "
        "The reference refines to any error",
        limit->relative_rmse, view, offer.error, offer.milliseconds);
  }
  return absl::StrFormat(
      "%.3g ms a frame are out of reach for %s views of %dx%d on this machine; the nearest is "
      "%.3g ms, with an error of %.3g",
      std::get<scene::MaxMilliseconds>(scene.accuracy).milliseconds, view, scene.output.width_px,
      scene.output.height_px, offer.milliseconds, offer.error);
}

}  // namespace thunderhead::session
