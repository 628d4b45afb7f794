#include "service/engine/scene_update.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/utf8.h"
#include "google/protobuf/util/field_mask_util.h"
#include "service/messages/camera_messages.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

using google::protobuf::util::FieldMaskUtil;

using google::protobuf::FieldDescriptor;

// Returns the fields that a path of an update mask names, from the scene's own field to the last
// one. Returns INVALID_ARGUMENT for an empty component, for a name that does not exist, or for a
// path that continues after a field that is not a single message. Every later step uses this
// result, so reflection never gets an unchecked name.
absl::StatusOr<std::vector<const FieldDescriptor*>> FieldsOf(const std::string& path) {
  std::vector<const FieldDescriptor*> fields;
  const google::protobuf::Descriptor* message = v1::Scene::descriptor();
  for (const absl::string_view name : absl::StrSplit(path, '.')) {
    const FieldDescriptor* const field =
        message == nullptr ? nullptr : message->FindFieldByName(std::string(name));
    if (field == nullptr) {
      return base::InvalidField("update_mask",
                                absl::StrCat("names '", base::Printable(path),
                                             "', which a scene does not have; name fields as in "
                                             "'camera.orbit.azimuth_deg'"),
                                "FIELD_UNKNOWN");
    }
    fields.push_back(field);
    message = field->is_repeated() ? nullptr : field->message_type();
  }
  return fields;
}

// Returns INVALID_ARGUMENT for a path into another kind of camera or technique than the scene has,
// because setting it would replace the scene's kind.
absl::Status CheckKinds(const v1::Scene& scene, const std::string& path,
                        const std::vector<const FieldDescriptor*>& fields) {
  const google::protobuf::Message* message = &scene;
  for (std::size_t i = 0; i + 1 < fields.size(); ++i) {
    const FieldDescriptor* const field = fields[i];
    const auto& reflection = *message->GetReflection();
    if (field->real_containing_oneof() != nullptr && !reflection.HasField(*message, field)) {
      return base::InvalidField(
          "update_mask",
          absl::StrCat("names '", path, "', but the scene's ",
                       field->real_containing_oneof()->name(), " is not ", field->name(),
                       "; name the whole of it, as in 'camera' or 'rendering'"),
          "KIND_DIFFERS");
    }
    message = &reflection.GetMessage(*message, field);
  }
  return absl::OkStatus();
}

// Returns the session's newest scene in which the fields that the mask names are replaced.
absl::StatusOr<v1::Scene> Merged(v1::Scene scene, const SceneChange& change) {
  for (const std::string& path : change.update_mask.paths()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields, FieldsOf(path));
    THUNDERHEAD_RETURN_IF_ERROR(CheckKinds(scene, path, fields));
  }
  FieldMaskUtil::MergeOptions options;
  options.set_replace_message_fields(true);
  options.set_replace_repeated_fields(true);
  FieldMaskUtil::MergeMessageTo(change.scene, change.update_mask, options, &scene);
  return scene;
}

absl::StatusOr<ReadScene> Read(std::uint64_t revision, const std::string& serialized) {
  ReadScene read{.revision = revision};
  if (!read.scene.ParseFromString(serialized)) {
    return absl::InternalError("the session's scene cannot be read back");
  }
  return read;
}

// Returns the scene of the newest accepted update, even if this scene still waits for its storm.
absl::StatusOr<ReadScene> NewestTakenOf(session::Session& session) {
  const std::optional<session::SerializedScene> newest = session.NewestTaken();
  if (!newest.has_value()) return absl::InternalError("the session has no scene yet");
  return Read(newest->revision, newest->scene);
}

struct Changed {
  std::uint64_t revision = 0;
  std::shared_ptr<v1::Scene> scene;
};

absl::StatusOr<Changed> Take(Engine& engine, session::Session& session, const SceneChange& change,
                             std::function<bool()> still_counts) {
  Changed changed{0, std::make_shared<v1::Scene>(change.scene)};
  std::optional<std::uint64_t> expected = change.expected_revision;
  if (change.update_mask.paths_size() > 0) {
    // Fields that the mask does not name come from the newest scene.
    THUNDERHEAD_ASSIGN_OR_RETURN(ReadScene newest, NewestTakenOf(session));
    if (!expected.has_value()) expected = newest.revision;
    THUNDERHEAD_ASSIGN_OR_RETURN(*changed.scene, Merged(std::move(newest.scene), change));
  }
  THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine.store, engine.loop.Techniques(), *changed.scene));
  THUNDERHEAD_RETURN_IF_ERROR(CheckSize(engine.limits, *changed.scene));
  // Framing the scene (placing its camera) may wait for a read of the storm. The update takes its
  // revision before that read, so that of several updates the last one to arrive wins.
  session::IncompleteUpdate update{.still_counts = std::move(still_counts)};
  if (NeedsFraming(*changed.scene)) update.serialized = changed.scene->SerializeAsString();
  if (!expected.has_value()) {
    changed.revision = session.TakeRevision(std::move(update));
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(changed.revision,
                                 session.TakeRevisionAfter(*expected, std::move(update)));
  }
  return changed;
}

// Returns the error for a person who lost control and then regained it. Meanwhile another person
// changed the scene, so the update is no longer valid.
absl::Status Overruled() {
  return base::WithDetails(
      absl::AbortedError("another person changed the scene while the storm of this update was "
                         "read; make the change to the newest scene"),
      {.reason = "REVISION_CHANGED"});
}

}  // namespace

absl::StatusOr<ReadScene> NewestSceneOf(const session::Session& session) {
  const std::optional<session::NewestScene> newest = session.Newest();
  if (!newest.has_value()) return absl::InternalError("the session has no scene yet");
  return Read(newest->revision, *newest->serialized);
}

bool ShowScene(const storm_store::StormStore& store, session::Session& session,
               std::uint64_t revision, const v1::Scene& scene) {
  const storm_store::StormInfoPtr storm = store.Find(scene.storm_id());
  std::optional<std::string> domain;
  if (storm != nullptr) domain = storm_store::DomainOf(*storm);
  return session.Show(revision, ToScene(scene), scene.SerializeAsString(), domain);
}

void ChangeScene(Engine& engine, const std::string& owner,
                 const std::shared_ptr<session::Session>& session, const SceneChange& change,
                 std::function<absl::Status()> may,
                 std::function<void(const absl::StatusOr<std::uint64_t>&)> done) {
  if (const absl::Status allowed = may(); !allowed.ok()) return done(allowed);
  const auto changed = Take(engine, *session, change, [may] { return may().ok(); });
  if (!changed.ok()) return done(changed.status());
  const std::uint64_t revision = changed->revision;
  const std::shared_ptr<v1::Scene> scene = changed->scene;
  FrameThen(engine, owner, *scene,
            [&store = engine.store, revision, scene, session, may = std::move(may),
             done = std::move(done)](const absl::Status& framed) {
              const absl::Status shown = !framed.ok() ? framed : base::Guarded([&] {
                THUNDERHEAD_RETURN_IF_ERROR(may());
                return ShowScene(store, *session, revision, *scene) ? absl::OkStatus()
                                                                    : Overruled();
              });
              if (shown.ok()) return done(revision);
              session->Drop(revision);
              done(shown);
            });
}

}  // namespace thunderhead::service
