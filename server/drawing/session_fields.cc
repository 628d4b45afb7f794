#include "drawing/session_fields.h"

#include <utility>

namespace thunderhead::drawing {
namespace {

// Preparations that took less time than this are not reported, because their results already
// existed.
constexpr double kMinReported_ms = 1.0;

FieldsKey KeyOf(const storm_store::StormStore& store, const scene::Scene& scene) {
  FieldsKey key{scene.storm_id, scene.time_index};
  const storm_store::StormInfoPtr storm = store.Find(scene.storm_id);
  const auto time = static_cast<std::size_t>(scene.time_index);
  if (storm != nullptr && time < storm->times.size()) key.version = storm->times[time].version;
  return key;
}

}  // namespace

const FieldsKey& SessionFields::KeyFor(const session::NewestScene& newest) {
  if (std::exchange(newest_revision_, newest.revision) != newest.revision) {
    newest_key_ = KeyOf(access_.store, *newest.scene);
  }
  return newest_key_;
}

std::optional<SessionFields::Unreadable> SessionFields::TakeRead() {
  std::optional<FieldsRead> read = access_.reader.Take(id_);
  if (!read.has_value() || !reading_for_.has_value()) return std::nullopt;
  const session::NewestScene reading_for = *std::exchange(reading_for_, std::nullopt);
  if (!read->fields.ok()) {
    unreadable_revision_ = reading_for.revision;
    return Unreadable{reading_for.revision, read->fields.status()};
  }
  fields_ = *std::move(read->fields);
  key_ = reading_key_;
  arrived_for_ = reading_for;
  read_ms_ += read->milliseconds;
  prepare_ms_ += read->prepare_ms;
  return std::nullopt;
}

std::optional<session::NewestScene> SessionFields::Drawable(const session::NewestScene& newest,
                                                            std::uint64_t shown_revision) {
  const FieldsKey& key = KeyFor(newest);
  if (key_ == key && IsPrepared(*newest.scene, fields_)) return newest;
  if (unreadable_revision_ == newest.revision) return std::nullopt;
  if (auto cached = access_.store.Peek(key.storm_id, key.time_index);
      cached != nullptr && IsPrepared(*newest.scene, cached)) {
    fields_ = std::move(cached);
    key_ = key;
    // The fields are requested although they are already here, because the store prefetches the
    // following times in Get.
    reading_for_.reset();
    access_.reader.Ask(id_, key);
    return newest;
  }
  if (!reading_for_.has_value()) {
    reading_for_ = newest;
    reading_key_ = key;
    Ask(newest);
  }
  const bool is_news = arrived_for_.has_value() && arrived_for_->revision > shown_revision;
  return is_news ? arrived_for_ : std::nullopt;
}

bool SessionFields::IsPrepared(
    const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  return access_.preparation == nullptr || access_.preparation->IsDone(scene, fields);
}

void SessionFields::Ask(const session::NewestScene& newest) {
  PrepareFields prepare;
  if (access_.preparation != nullptr) {
    prepare = [preparation = access_.preparation, scene = newest.scene](const auto& fields) {
      return preparation->Prepare(*scene, fields);
    };
  }
  access_.reader.Ask(id_, reading_key_, std::move(prepare));
}

void SessionFields::PrepareNext(const scene::Scene& shown) {
  const FieldsKey key = KeyOf(access_.store, shown);
  const std::optional<FieldsKey> before = std::exchange(drawn_key_, key);
  const bool goes_on = before.has_value() && before->storm_id == key.storm_id &&
                       before->time_index + 1 == key.time_index;
  if (!goes_on || access_.preparation == nullptr || !access_.preparation->IsNeeded(shown)) return;
  const storm_store::StormInfoPtr storm = access_.store.Find(key.storm_id);
  if (storm == nullptr || key.time_index + 1 >= static_cast<int>(storm->times.size())) return;
  auto next = std::make_shared<scene::Scene>(shown);
  ++next->time_index;
  access_.reader.AskAhead(id_, KeyOf(access_.store, *next),
                          [preparation = access_.preparation, next](const auto& fields) {
                            return preparation->Prepare(*next, fields);
                          });
}

void SessionFields::AddStages(std::vector<StageTime>* stages) {
  const double prepare_ms = std::exchange(prepare_ms_, 0.0);
  const double read_ms = std::exchange(read_ms_, 0.0);
  if (prepare_ms > kMinReported_ms) {
    stages->insert(stages->begin(), {scene::FrameStage::kFit, prepare_ms});
  }
  if (read_ms > 0.0) stages->insert(stages->begin(), {scene::FrameStage::kRead, read_ms});
}

void SessionFields::Yield() {
  fields_.reset();
  key_.reset();
  arrived_for_.reset();
}

void SessionFields::Release() {
  access_.reader.Forget(id_);
  fields_.reset();
  key_.reset();
  reading_for_.reset();
  arrived_for_.reset();
  drawn_key_.reset();
}

}  // namespace thunderhead::drawing
