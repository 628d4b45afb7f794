// The fields of the storm that a session shows. They are requested from a FieldsReader, which reads
// them on another thread than the render loop's. While a time series plays, the fields of the next
// time are prepared in advance if scenes need preparation. Used by the render loop's thread only.
// This code does not use GL.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "drawing/fields_reader.h"
#include "drawing/frame_source.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"

namespace thunderhead::drawing {

// The sources of fields. All must outlive the objects that use them.
struct FieldsAccess {
  storm_store::StormStore& store;
  FieldsReader& reader;
  std::shared_ptr<Preparation> preparation;  // null if no scene needs preparation
};

class SessionFields {
 public:
  SessionFields(const FieldsAccess& access, std::string session_id)
      : access_(access), id_(std::move(session_id)) {}

  // A read that failed.
  struct Unreadable {
    std::uint64_t revision = 0;
    absl::Status why;
  };
  // Takes the result of a finished read; returns its error, if any.
  std::optional<Unreadable> TakeRead();

  // Returns the scene to draw now: the newest scene if its fields are available. Otherwise requests
  // the fields of the newest scene, and returns the scene whose fields have just been read, if its
  // revision is above `shown_revision`. A time slider that moves faster than the disk therefore
  // still shows something.
  std::optional<session::NewestScene> Drawable(const session::NewestScene& newest,
                                               std::uint64_t shown_revision);

  // Requests fields again that could not be read.
  void TryAgain() { unreadable_revision_ = 0; }

  // Returns the fields of the scene that Drawable returned last.
  const std::shared_ptr<const volume::HydrometeorFields>& Fields() const { return fields_; }

  // If the series is playing step by step and `shown` needs preparation, reads and prepares the
  // fields of the next time in advance. Call it after `shown` was drawn.
  void PrepareNext(const scene::Scene& shown);

  // Adds the time that reading and preparing fields took since the last frame.
  void AddStages(std::vector<StageTime>* stages);

  // Releases the fields so that others can use the memory. Drawable requests them again.
  void Yield();

  // Releases the fields and drops pending requests.
  void Release();

 private:
  bool IsPrepared(const scene::Scene& scene,
                  const std::shared_ptr<const volume::HydrometeorFields>& fields) const;
  void Ask(const session::NewestScene& newest);
  // Returns the key of the newest scene's fields. It is looked up once for each revision. That is
  // sufficient, because sessions that show a file get a new revision when the file is replaced.
  const FieldsKey& KeyFor(const session::NewestScene& newest);

  const FieldsAccess& access_;
  const std::string id_;
  std::uint64_t newest_revision_ = 0;
  FieldsKey newest_key_;  // key of the fields of newest_revision_
  std::optional<FieldsKey> key_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  std::optional<session::NewestScene> reading_for_;  // the scene whose fields are being read
  FieldsKey reading_key_;
  std::optional<session::NewestScene> arrived_for_;  // the scene whose fields have just been read
  std::uint64_t unreadable_revision_ = 0;
  std::optional<FieldsKey> drawn_key_;
  double read_ms_ = 0.0;  // to be reported with the next frame
  double prepare_ms_ = 0.0;
};

}  // namespace thunderhead::drawing
