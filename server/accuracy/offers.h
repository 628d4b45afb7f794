// Chooses the setting that reaches the accuracy or speed that a scene asks for, by tables measured
// against the reference (accuracy/priced_settings.h), corrected by the cost of frames on this
// machine. Plain values, no clock, no threads.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/accuracy_report.h"
#include "accuracy/frame_quality.h"
#include "accuracy/priced_settings.h"
#include "accuracy/setting.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A setting with what it is believed to cost and to miss here.
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

// Whether it is within the limit.
bool Meets(const Offer& offer, const scene::Accuracy& limit);

// How much longer frames take here than a table says: by each setting that was drawn, each
// technique and the machine, the most specific that is known.
class TableCorrection {
 public:
  // A frame of `setting` took `measured_ms` where the table says `table_ms`.
  void Observe(const Setting& setting, double table_ms, double measured_ms);
  double Factor(const Setting& setting) const;
  // True if a frame of that setting was observed.
  bool Knows(const Setting& setting) const;

 private:
  // A running mean of logarithms: times scatter by factors.
  struct Mean {
    double log_factor = 0.0;
    int count = 0;

    void Follow(double log_measured);
  };
  // Names of technique, mode and transport; the number of slices; the image scale.
  using Key = std::tuple<std::string_view, std::string_view, std::string_view, int, double>;
  static Key KeyOf(const Setting& setting);

  std::map<Key, Mean> settings_;
  std::map<std::string_view, Mean> techniques_;
  Mean machine_;
};

// A table for each kind of camera, in the order of scene::Camera; why there is none otherwise.
using OfferTables = std::array<absl::StatusOr<PricedSettings>, std::variant_size_v<scene::Camera>>;

// Those that the program is built with.
OfferTables BuiltInOfferTables();

class Offers {
 public:
  explicit Offers(OfferTables tables) : tables_(std::move(tables)) {}

  // The scene with the setting that reaches what it asks for, or as it is if it asks for nothing.
  // `current` is the setting that its view is drawn with so far. Fails where there is no table.
  absl::StatusOr<scene::Scene> Decide(const scene::Scene& scene,
                                      const std::optional<Setting>& current) const;

  // A frame of `scene` (decided) at full quality took so long, view and all after it.
  void Observe(const scene::Scene& scene, double milliseconds);

  // How accurate a frame of `scene` (decided) of that quality, its light corrected by so many
  // paths, is believed to be; none where the tables do not know its renderer, mode and transport.
  std::optional<AccuracyReport> Report(const scene::Scene& scene, const FrameQuality& quality,
                                       const std::optional<double>& discretisation_error,
                                       std::int64_t traced_paths) const;

  // The paths that a picture of `scene` (decided) outside any session waits for, if it waits: the
  // fewest with which it keeps within the error that it asks for.
  std::int64_t PathsFor(const scene::Scene& scene) const;

 private:
  const absl::StatusOr<PricedSettings>& TableOf(const scene::Scene& scene) const {
    return tables_[scene.camera.index()];
  }
  std::vector<Offer> OffersFor(const PricedSettings& table, const scene::Scene& scene) const;
  std::optional<Unmet> WhyUnmet(const scene::Scene& scene, const Offer& offer) const;

  OfferTables tables_;
  TableCorrection correction_;
};

// Paths that are traced for a view that rests, if its light is traced; more change what is seen by
// less than a hundredth.
inline constexpr std::int64_t kTracedPaths = 4'000'000;
// Paths that a picture outside any session waits for if it asks for no error.
inline constexpr std::int64_t kImagePaths = 1'000'000;

// The setting that a decided scene is drawn with in the end; of metaballs, `slices` is their
// number, as in the tables.
Setting SettingOf(const scene::Scene& scene);

// The table's settings know nothing of the scene's taste: turbulent detail, false colours and
// theta_f stay those of `asked`.
scene::Technique WithTasteOf(const scene::Technique& asked, scene::Technique technique);

}  // namespace thunderhead::accuracy
