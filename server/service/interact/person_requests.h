// Handles the requests of a person who has joined a session: changes of the session's scene, the
// person's own view, control, pointers and marks. The Interact call itself delivers the frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "access/access_control.h"
#include "service/engine/engine.h"
#include "service/interact/looking_around.h"
#include "session/sessions.h"

namespace thunderhead::service {

// The Interact call through which the requests arrived. Every pending request keeps a reference to
// it.
class Asker : public delivery::Viewer {
 public:
  // Announces that the answer to a request will follow by a call of Settle.
  virtual void Await() = 0;
  // Sends the answer to a request. No answer means that the request was carried out and nothing
  // needs to be sent.
  virtual void Settle(const std::optional<v1::InteractResponse>& answer) = 0;
};

// Handles the requests of one person in one Interact call, of which it is a part. Obey must be
// called by one thread at a time.
class PersonRequests {
 public:
  PersonRequests(Engine& engine, std::shared_ptr<const access::Caller> caller,
                 std::shared_ptr<session::Session> session, std::uint64_t person_id,
                 std::string participant_key)
      : engine_(engine),
        caller_(std::move(caller)),
        session_(std::move(session)),
        person_id_(person_id),
        participant_key_(std::move(participant_key)) {}

  // Carries out a request immediately, or calls Await on `asker` and carries it out later. Returns
  // an error if the request is refused immediately. A later refusal is passed to Settle.
  absl::Status Obey(const std::shared_ptr<Asker>& asker, const v1::InteractRequest& request);
  // Returns the session that draws the person's own view. Returns null while the person sees the
  // session's view. Safe to call from any thread.
  std::shared_ptr<session::Session> OwnView();

 private:
  using TakeCamera = std::function<absl::Status(const absl::StatusOr<scene::Camera>&)>;

  absl::Status ChangeRoster(Asker& asker, const v1::InteractRequest& request);
  absl::Status SetName(const std::string& text);
  absl::Status Update(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                      const v1::SceneUpdate& update);
  absl::Status WithCamera(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                          const v1::Camera& message, TakeCamera take);
  absl::Status Detach(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                      const v1::Detach& detach);
  // Opens the person's own view, unless the person has returned to the session's view since the
  // request. `returns` is Person::returns at the time of the request. The number of the camera
  // request is `look` (LookingAround::Begin).
  absl::Status DetachTo(Asker& asker, std::uint64_t look, std::uint64_t returns,
                        const absl::StatusOr<scene::Camera>& camera);
  absl::Status MoveCamera(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                          const v1::MoveCamera& move);
  absl::Status Point(const v1::Point& point);
  absl::Status AddMark(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                       const v1::AddMark& message);
  absl::Status PlaceMark(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                         const v1::AddMark& message);
  absl::Status Draw(std::vector<glm::dvec3> positions_m, const std::optional<glm::vec3>& color);
  absl::Status EraseMarks(const v1::EraseMarks& message);

  Engine& engine_;
  const std::shared_ptr<const access::Caller> caller_;
  const std::shared_ptr<session::Session> session_;
  const std::uint64_t person_id_;
  const std::string participant_key_;
  LookingAround around_;
  std::atomic<bool> drawing_{false};  // true while the positions of a mark are computed
};

}  // namespace thunderhead::service
