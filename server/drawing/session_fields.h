// The fields of the storm that a session shows. They are requested, read on another thread than the
// render loop's, and prefetched while a series plays. Used by the render loop's thread only. Knows
// no GL.
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

// The sources of fields; all must outlive their users.
struct FieldsAccess {
  storm_store::StormStore& store;
  FieldsReader& reader;
  std::shared_ptr<Preparation> preparation;  // null if no scene needs any
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

  // Returns the scene to draw now: the newest if its fields are available. Otherwise requests the
  // fields and returns the scene whose fields have just been read, if it is newer than
  // `shown_revision`. So a time slider that moves faster than the disk still shows something.
  std::optional<session::NewestScene> Drawable(const session::NewestScene& newest,
                                               std::uint64_t shown_revision);

  // Requests unreadable fields again.
  void TryAgain() { unreadable_revision_ = 0; }

  // Returns the fields of the scene that Drawable returned last.
  const std::shared_ptr<const volume::HydrometeorFields>& Fields() const { return fields_; }

  // Prefetches the next time if a series is playing step by step. Call it after `shown` was drawn.
  void PrepareNext(const scene::Scene& shown);

  // Adds the time that reading and preparing took since the last frame.
  void AddStages(std::vector<StageTime>* stages);

  // Releases the fields for others that need memory. Drawable requests them again.
  void Yield();

  // Frees the memory and drops pending requests.
  void Release();

 private:
  bool IsPrepared(const scene::Scene& scene,
                  const std::shared_ptr<const volume::HydrometeorFields>& fields) const;
  void Ask(const session::NewestScene& newest);
  // Returns the key of the newest scene's fields. It is looked up once for each revision: when a
  // file is replaced, the sessions that show it get a new revision.
  const FieldsKey& KeyFor(const session::NewestScene& newest);

  const FieldsAccess& access_;
  const std::string id_;
  std::uint64_t newest_revision_ = 0;
  FieldsKey newest_key_;  // of that revision
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
