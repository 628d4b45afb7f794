#include "accuracy/table_correction.h"

#include <algorithm>
#include <cmath>

#include "accuracy/named_settings.h"

namespace thunderhead::accuracy {
namespace {

// The weight of a new measurement in the running mean.
constexpr double kFollow = 0.3;

}  // namespace

void TableCorrection::Mean::Follow(double log_measured) {
  ++count;
  log_factor += std::max(kFollow, 1.0 / count) * (log_measured - log_factor);
}

TableCorrection::Key TableCorrection::KeyOf(const Setting& setting) {
  // The rows of the tables have no detail. They also represent settings with detail, so detail is
  // removed from the key.
  scene::Technique technique = setting.technique;
  if (scene::MediumSettings* medium = scene::MediumSettingsOf(&technique); medium != nullptr) {
    medium->look.detail = false;
  }
  return {scene::NameOf(setting.technique), ModeOf(technique).name,
          TransportNameOf(setting.technique), scene::CountOf(setting.technique),
          setting.image_scale};
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

}  // namespace thunderhead::accuracy
