#include "session/decided_setting.h"

#include <utility>
#include <variant>

namespace thunderhead::session {
namespace {

// Costs are learnt from drawn frames; after this many decisions they are known, or do not converge.
constexpr int kMaxDecidedAgain = 3;

}  // namespace

absl::StatusOr<std::optional<NewestScene>> DecidedSetting::Decide(const NewestScene& asked) {
  if (revision_ != asked.revision) {
    auto scene = offers_.Decide(*asked.scene, SettingKeptFor(*asked.scene));
    revision_ = asked.revision;
    scene_ = nullptr;
    decided_again_ = 0;
    checked_ = false;
    discretisation_error_.reset();
    settled_ = std::holds_alternative<std::monostate>(asked.scene->accuracy);
    if (!scene.ok()) return scene.status();
    scene_ = std::make_shared<const scene::Scene>(*std::move(scene));
  }
  if (scene_ == nullptr) return std::optional<NewestScene>();
  return std::optional(NewestScene{asked.revision, scene_, asked.changed_at, asked.usual_pause});
}

// The previous scene's setting, if `asked` has the same accuracy request and kind of camera.
std::optional<accuracy::Setting> DecidedSetting::SettingKeptFor(const scene::Scene& asked) const {
  if (scene_ == nullptr) return std::nullopt;
  const bool alike =
      scene_->accuracy == asked.accuracy && scene_->camera.index() == asked.camera.index();
  if (!alike) return std::nullopt;
  return accuracy::SettingOf(*scene_);
}

bool DecidedSetting::NeedsCheck() const {
  return !checked_ && scene::SlicesOf(scene_->rendering.technique).value_or(0) >= 2;
}

bool DecidedSetting::DecideAgain(const NewestScene& asked) {
  const accuracy::Setting current = accuracy::SettingOf(*scene_);
  auto again = offers_.Decide(*asked.scene, current);
  const bool better = again.ok() && accuracy::SettingOf(*again) != current;
  if (!better || decided_again_ >= kMaxDecidedAgain) {
    settled_ = true;
    return false;
  }
  scene_ = std::make_shared<const scene::Scene>(*std::move(again));
  checked_ = false;
  ++decided_again_;
  return true;
}

}  // namespace thunderhead::session
