// Accuracy on offer: which setting reaches what a scene asks for, by tables measured against the
// reference (measure/priced_settings.h) and corrected by what frames cost on this machine. Plain
// values, no clock, no threads.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/priced_settings.h"
#include "scene/scene.h"
#include "session/frame_source.h"

namespace thunderhead::session {

// A setting with what it is believed to cost and to miss here.
struct Offer {
  measure::TradeSetting setting;
  double milliseconds = 0.0;
  double error = 0.0;

  bool operator==(const Offer&) const = default;
};

// The best of `offers`, which are not empty: of those within the limit the cheapest for MaxError,
// the most accurate for MaxMilliseconds; where none is, the nearest to it. `current` stays while it
// keeps within a tenth of the limit and is little worse than the best, so that noise in the times
// does not flicker on the screen. No limit: the first.
Offer BestOffer(const std::vector<Offer>& offers, const scene::Accuracy& limit,
                const std::optional<measure::TradeSetting>& current);

// Whether it is within the limit.
bool Meets(const Offer& offer, const scene::Accuracy& limit);

// How much longer frames take here than a table says: of each setting that was drawn, of each
// renderer, and of the machine, whichever is known first.
class TableCorrection {
 public:
  // A frame of `setting` took `measured_ms` where the table says `table_ms`.
  void Observe(const measure::TradeSetting& setting, double table_ms, double measured_ms);
  double Factor(const measure::TradeSetting& setting) const;
  // True if a frame of that setting was observed.
  bool Knows(const measure::TradeSetting& setting) const;

 private:
  // A running mean of logarithms: times scatter by factors.
  struct Mean {
    double log_factor = 0.0;
    int count = 0;

    void Follow(double log_measured);
  };
  using Key = std::tuple<scene::Renderer, scene::Mode, scene::Transport, int, double>;
  static Key KeyOf(const measure::TradeSetting& setting);

  std::map<Key, Mean> settings_;
  std::map<scene::Renderer, Mean> renderers_;
  Mean machine_;
};

// A table for each kind of camera, in the order of scene::Camera; why there is none otherwise.
using OfferTables =
    std::array<absl::StatusOr<measure::PricedSettings>, std::variant_size_v<scene::Camera>>;

// Those that the program is built with.
OfferTables BuiltInOfferTables();

class Offers {
 public:
  explicit Offers(OfferTables tables) : tables_(std::move(tables)) {}

  // The scene with the setting that reaches what it asks for, or as it is if it asks for nothing.
  // `current` is the setting that its view is drawn with so far. Fails where there is no table.
  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene,
                                      const std::optional<measure::TradeSetting>& current) const;

  // A frame of `scene` (decided) at full quality took so long, view and all after it.
  void Observe(const scene::Scene& scene, double milliseconds);

  // How accurate a frame of `scene` (decided) of that quality, its light corrected by so many
  // paths, is believed to be; none where the tables do not know its renderer, mode and transport.
  std::optional<AccuracyReport> Report(const scene::Scene& scene, const FrameQuality& quality,
                                       const std::optional<double>& discretisation_error,
                                       std::int64_t traced_paths) const;

 private:
  const absl::StatusOr<measure::PricedSettings>& TableOf(const scene::Scene& scene) const {
    return tables_[scene.camera.index()];
  }
  std::vector<Offer> OffersFor(const measure::PricedSettings& table,
                               const scene::Scene& scene) const;
  std::string WhyUnmet(const scene::Scene& scene, const Offer& offer) const;

  OfferTables tables_;
  TableCorrection correction_;
};

// Paths that are traced for a view that rests, if its light is traced; more change what is seen by
// less than a hundredth.
inline constexpr std::int64_t kTracedPaths = 4'000'000;

// The setting that a decided scene is drawn with in the end; of metaballs, `slices` is their
// number, as in the tables.
measure::TradeSetting SettingOf(const scene::Scene& scene);

// Whether its pictures depend on a number of slices or samples.
bool HasSlices(scene::Renderer renderer);

}  // namespace thunderhead::session
