// The requests of a person who has joined a session: changes of its scene, a view of their own,
// control, pointing and marks. How their pictures are delivered is the call's affair.
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

// The call that the requests come from. Whatever is on its way to an answer holds it.
class Asker : public delivery::Viewer {
 public:
  // The answer to a request comes later, by Settle.
  virtual void Await() = 0;
  // Without an answer the request was obeyed, and nothing is to be said.
  virtual void Settle(const std::optional<v1::InteractResponse>& answer) = 0;
};

// Of one person in one call, whose asker it is part of. Obey is called by one thread at a time.
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

  // Obeys at once, or has `asker` await the outcome. An error is why the request is refused.
  absl::Status Obey(const std::shared_ptr<Asker>& asker, const v1::InteractRequest& request);
  // The session that draws the person's own view; null while they follow. Safe from any thread.
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
  // Detaches unless the person has gone back to the session's view since the request, when they
  // had done so `returns` times.
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
  std::atomic<bool> drawing_{false};  // a mark's places are being found
};

}  // namespace thunderhead::service
