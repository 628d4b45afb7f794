#include "accuracy/offer_tables.h"

#include <cmath>
#include <string>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "accuracy/embedded_trade_tables.h"

namespace thunderhead::accuracy {
namespace {

constexpr std::array<const char*, std::variant_size_v<scene::Camera>> kViews = {"orbit", "spotter",
                                                                                "top-down"};

double PixelsOf(const glm::ivec2& size_px) { return static_cast<double>(size_px.x) * size_px.y; }

absl::StatusOr<PricedSettings> ReadBuiltIn(const char* view) {
  const auto& texts = EmbeddedTradeTableTexts();
  const auto text = texts.find(view);
  if (text == texts.end()) {
    return absl::NotFoundError("the program has no accuracy table for them");
  }
  absl::StatusOr<PricedSettings> table = ReadPricedSettings(text->second);
  if (table.ok()) return table;
  return absl::Status(table.status().code(),
                      absl::StrCat("the program cannot read their accuracy table (",
                                   table.status().message(), ")"));
}

}  // namespace

OfferTables BuiltInOfferTables() {
  OfferTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    tables[i] = ReadBuiltIn(kViews[i]);
    if (tables[i].ok()) continue;
    tables[i] = absl::FailedPreconditionError(absl::StrCat(
        "max_error and max_milliseconds are not available for ", kViews[i], " views, because ",
        tables[i].status().message(), "; choose a preset instead"));
  }
  return tables;
}

const absl::StatusOr<PricedSettings>& TableFor(const OfferTables& tables,
                                               const scene::Scene& scene) {
  return tables[scene.camera.index()];
}

std::string_view ViewNameOf(const scene::Camera& camera) { return kViews[camera.index()]; }

const PricedSetting* NearestRow(const PricedSettings& table, const Setting& setting) {
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

double TableMs(const PricedSettings& table, const PricedSetting& row, const scene::Scene& scene) {
  const glm::ivec2 size_px(scene.output.width_px, scene.output.height_px);
  return row.milliseconds * PixelsOf(size_px) / PixelsOf(table.size_px);
}

}  // namespace thunderhead::accuracy
