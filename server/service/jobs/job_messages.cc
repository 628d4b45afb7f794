#include "service/jobs/job_messages.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/time.h"
#include "base/digits.h"
#include "base/utf8.h"
#include "rpc_port/status_table.h"
#include "service/messages/enum_tables.h"
#include "service/messages/prepare_scene.h"

namespace thunderhead::service {
namespace {

using jobs::PictureState;
using State = v1::RenderJobPictureState;

constexpr std::array kStates = {
    std::pair{State::STATE_WAITING, PictureState::kWaiting},
    std::pair{State::STATE_DRAWING, PictureState::kDrawing},
    std::pair{State::STATE_DRAWN, PictureState::kDrawn},
    std::pair{State::STATE_FAILED, PictureState::kFailed},
    std::pair{State::STATE_CANCELLED, PictureState::kCancelled},
    std::pair{State::STATE_DROPPED, PictureState::kDropped},
};

std::string Iso(jobs::Time time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%E3SZ", absl::FromChrono(time), absl::UTCTimeZone());
}

std::uint32_t Count(const jobs::JobView& job, PictureState state) {
  return static_cast<std::uint32_t>(job.counts[static_cast<std::size_t>(state)]);
}

void SetProblem(const jobs::Problem& problem, v1::RenderJobProblem& message) {
  const absl::Status status(problem.code, problem.message);
  message.set_code(rpc_port::CodeOf(status));
  message.set_reason(problem.reason.empty() ? rpc_port::ReasonOf(status) : problem.reason);
  message.set_message(rpc_port::SendableMessage(status));
}

// Reads digits without leading zeros, so each picture has one path only.
bool ReadPlace(const std::string& text, std::size_t& place) {
  const bool has_leading_zero = text.size() > 1 && text.front() == '0';
  const std::optional<std::uint64_t> number = base::ParseDigits(text);
  if (has_leading_zero || !number.has_value()) return false;
  place = *number;
  return true;
}

}  // namespace

std::string ResultPathOf(const std::string& result_key) {
  return absl::StrCat("/results/", result_key);
}

std::optional<ResultPath> ParseResultPath(std::string_view path) {
  const std::vector<std::string> parts =
      absl::StrSplit(absl::string_view(path.data(), path.size()), '/');
  ResultPath result;
  if (parts.size() != 4 || parts[1] != "results" || !ReadPlace(parts[3], result.place)) {
    return std::nullopt;
  }
  result.key = parts[2];
  return result;
}

void ToMessage(const jobs::JobView& job, v1::RenderJob& message) {
  message.set_id(job.id);
  message.set_label(base::Printable(job.label));
  message.set_owner(base::Printable(job.owner));
  message.set_state(!job.ended_at.has_value() ? v1::RenderJob::STATE_RUNNING
                    : job.cancelled           ? v1::RenderJob::STATE_CANCELLED
                                              : v1::RenderJob::STATE_DONE);
  message.set_created_at(Iso(job.created_at));
  if (job.ended_at.has_value()) message.set_ended_at(Iso(*job.ended_at));
  if (job.expires_at.has_value()) message.set_expires_at(Iso(*job.expires_at));
  v1::RenderJobCounts& counts = *message.mutable_counts();
  counts.set_waiting(Count(job, PictureState::kWaiting));
  counts.set_drawing(Count(job, PictureState::kDrawing));
  counts.set_drawn(Count(job, PictureState::kDrawn));
  counts.set_failed(Count(job, PictureState::kFailed));
  counts.set_cancelled(Count(job, PictureState::kCancelled));
  counts.set_dropped(Count(job, PictureState::kDropped));
  message.set_result_bytes(job.result_bytes);
  message.set_result_path(ResultPathOf(job.result_key));
  if (job.paused.has_value()) SetProblem(*job.paused, *message.mutable_paused());
}

void ToMessage(const jobs::PictureView& picture, v1::RenderJobPictureState& message) {
  message.set_index(static_cast<std::uint32_t>(picture.place));
  message.set_name(base::Printable(picture.name));
  message.set_state(MessageOf(kStates, picture.state));
  message.set_bytes(picture.bytes);
  message.set_sha256(picture.sha256);
  message.set_milliseconds(picture.milliseconds);
  if (picture.problem.code == absl::StatusCode::kOk) return;
  SetProblem(picture.problem, *message.mutable_problem());
}

jobs::Asker AskerOf(const access::Caller& caller) {
  return {caller.identity().name, caller.identity().role == access::Role::kOperator};
}

jobs::PictureOrder OrderOf(const storm_store::StormStore& store,
                           const v1::RenderJobPicture& picture) {
  v1::RenderImageRequest request;
  *request.mutable_scene() = picture.scene();
  request.set_format(picture.format());
  request.DiscardUnknownFields();
  v1::Scene& scene = *request.mutable_scene();
  jobs::PictureOrder order;
  order.name = picture.name();
  if (const auto storm = FindStorm(store, scene.storm_id()); storm.ok()) {
    scene.set_storm_id((*storm)->id);
    const std::size_t times = (*storm)->times.size();
    if (!scene.has_time_index()) scene.set_time_index(static_cast<std::uint32_t>(times - 1));
    if (scene.time_index() < times)
      order.valid_time = (*storm)->times[scene.time_index()].valid_time;
  }
  order.request = request.SerializeAsString();
  return order;
}

}  // namespace thunderhead::service
