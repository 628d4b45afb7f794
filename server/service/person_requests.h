// Handles the requests of a person who has joined a session: changes of its scene, the person's own
// view, control, pointers and marks. The call itself delivers the frames.
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
#include "access/door.h"
#include "service/engine.h"
#include "service/looking_around.h"
#include "session/sessions.h"

namespace thunderhead::service {

// The call that sends the requests. Every pending request keeps a reference to it.
class Asker : public delivery::Viewer {
 public:
  // Announces that the answer to a request will follow by Settle.
  virtual void Await() = 0;
  // Sends the answer to a request. Without an answer, the request was obeyed and nothing needs to
  // be sent.
  virtual void Settle(const std::optional<v1::InteractResponse>& answer) = 0;
};

// Handles the requests of one person in one call, and is a part of the call's asker. Obey must be
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

  // Obeys a request at once, or calls Await on `asker` and obeys it later. An error is the reason
  // for a refusal.
  absl::Status Obey(const std::shared_ptr<Asker>& asker, const v1::InteractRequest& request);
  // Returns the session that draws the person's own view; null while the person follows. Safe to
  // call from any thread.
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
  // Detaches unless the person has returned to the session's view since the request. `returns` is
  // the number of returns at the time of the request.
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
