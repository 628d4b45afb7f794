#include "drawing/decided_setting.h"

#include <utility>
#include <variant>

namespace thunderhead::drawing {
namespace {

// The maximum number of times that a scene's setting is decided again. The costs of settings become
// known by drawing frames. After this many decisions, the costs are either known or do not
// converge.
constexpr int kMaxDecidedAgain = 3;

}  // namespace

absl::StatusOr<std::optional<session::NewestScene>> DecidedSetting::Decide(
    const session::NewestScene& asked) {
  if (revision_ != asked.revision) {
    const bool continues = ContinuesWith(*asked.scene);
    if (!continues) measured_ = {};
    const auto current = continues ? std::optional(accuracy::SettingOf(*scene_)) : std::nullopt;
    auto scene = offers_.Decide(*asked.scene, current, measured_);
    revision_ = asked.revision;
    scene_ = nullptr;
    decided_again_ = 0;
    refuted_ = 0;
    checked_ = false;
    discretisation_error_.reset();
    settled_ = std::holds_alternative<std::monostate>(asked.scene->accuracy);
    if (!scene.ok()) return scene.status();
    scene_ = std::make_shared<const scene::Scene>(*std::move(scene));
  }
  if (scene_ == nullptr) return std::optional<session::NewestScene>();
  return std::optional(
      session::NewestScene{asked.revision, scene_, asked.changed_at, asked.usual_pause});
}

// Returns true if `asked` has the same accuracy, the same storm and the same kind of camera as the
// previous scene.
bool DecidedSetting::ContinuesWith(const scene::Scene& asked) const {
  return scene_ != nullptr && scene_->accuracy == asked.accuracy &&
         scene_->storm_id == asked.storm_id && scene_->camera.index() == asked.camera.index();
}

bool DecidedSetting::NeedsCheck() const {
  return !checked_ && scene::SlicesOf(scene_->rendering.technique).value_or(0) >= 2;
}

bool DecidedSetting::DecideAgain(const session::NewestScene& asked) {
  if (decided_again_ >= kMaxDecidedAgain || !DecideAnew(asked)) {
    settled_ = true;
    return false;
  }
  ++decided_again_;
  return true;
}

bool DecidedSetting::DecideAnew(const session::NewestScene& asked) {
  const accuracy::Setting current = accuracy::SettingOf(*scene_);
  auto again = offers_.Decide(*asked.scene, current, measured_);
  if (!again.ok() || accuracy::SettingOf(*again) == current) return false;
  scene_ = std::make_shared<const scene::Scene>(*std::move(again));
  checked_ = false;
  discretisation_error_.reset();
  return true;
}

bool DecidedSetting::Measured(const accuracy::MeasuredError& error,
                              const session::NewestScene& asked) {
  if (scene_ == nullptr || refuted_ >= accuracy::kMaxRefuted) return false;
  const accuracy::Setting drawn = accuracy::SettingOf(*scene_);
  if (!offers_.Refutes(*scene_, drawn, error, &measured_) || !DecideAnew(asked)) return false;
  settled_ = false;
  ++refuted_;
  return true;
}

}  // namespace thunderhead::drawing
