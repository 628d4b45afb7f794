#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/finished.h"
#include "rpc_port/status_table.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

using ResultReactor = grpc::ServerWriteReactor<v1::FetchRenderResultResponse>;

constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 20;

// Returns the error for a missing file. Either it was just dropped, or an operator removed it from
// the folder.
absl::Status Gone() {
  return base::WithDetails(
      absl::NotFoundError("the picture's file no longer exists; request the picture in a new job"),
      {.reason = "NO_SUCH_RESULT"});
}

// The file of a result, read from an offset. Only one thread at a time may use it.
class ResultFile {
 public:
  ResultFile(jobs::ResultPlace place, std::uint64_t offset)
      : place_(std::move(place)), offset_(offset) {}

  // Returns the next chunk. The first one also has the description of the picture.
  absl::StatusOr<v1::FetchRenderResultResponse> Read() {
    v1::FetchRenderResultResponse response;
    if (!file_.is_open()) {
      file_.open(place_.path, std::ios::binary);
      file_.seekg(static_cast<std::streamoff>(offset_));
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::string about, base::ReadWholeFile(place_.about_path));
      if (!response.ParseFromString(about)) return Gone();
      response.set_total_bytes(place_.bytes);
      response.set_sha256(place_.sha256);
    }
    std::string& chunk = *response.mutable_chunk();
    chunk.resize(std::min(kChunkBytes, place_.bytes - offset_));
    if (!file_.read(chunk.data(), static_cast<std::streamsize>(chunk.size()))) return Gone();
    offset_ += chunk.size();
    return response;
  }

  bool AtEnd() const { return offset_ >= place_.bytes; }

  // Returns the job's folder, which identifies the storage for calls with a timeout.
  std::string Storage() const { return std::filesystem::path(place_.path).parent_path(); }

 private:
  const jobs::ResultPlace place_;
  std::uint64_t offset_;
  std::ifstream file_;
};

// Sends a file in chunks. It reads the next chunk only while no chunk is being written. It deletes
// itself when gRPC calls OnDone, which follows the call of Finish. At that time no read is in
// progress, except one that hangs, and this read does not use the object.
class ResultStream final : public ResultReactor {
 public:
  ResultStream(jobs::Jobs& jobs, const ResultReading& reading, const Limits& limits,
               grpc::CallbackServerContext* context, CallerRef caller, jobs::PicturePlace picture,
               jobs::ResultPlace place, std::uint64_t offset)
      : jobs_(jobs),
        reading_(reading),
        caller_(std::move(caller)),
        picture_(std::move(picture)),
        file_(std::make_shared<ResultFile>(std::move(place), offset)),
        delivery_(context, limits) {}

  void Next() {
    reading_.threads.Submit(caller_->identity().name, [this](const absl::Status& status) {
      const absl::Status read = status.ok() ? base::Guarded([this] { return Read(); }) : status;
      if (!read.ok()) return End(rpc_port::ToGrpcStatus(read));
      delivery_.Begin(response_.chunk().size());
      StartWrite(&response_);
    });
  }

  void OnWriteDone(bool ok) override {
    delivery_.Taken();
    if (!ok) return End(grpc::Status(grpc::StatusCode::CANCELLED, "the client disconnected"));
    if (const absl::Status known = caller_->StillKnown(); !known.ok()) {
      return End(rpc_port::ToGrpcStatus(known));
    }
    if (!file_->AtEnd()) return Next();
    jobs_.Fetched(picture_);
    End(grpc::Status::OK);
  }

  void OnDone() override { delete this; }

 private:
  void End(const grpc::Status& status) {
    delivery_.Begin(0);
    Finish(status);
  }

  absl::Status Read() {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        response_, reading_.calls.Ask(file_->Storage(), [file = file_] { return file->Read(); }));
    return absl::OkStatus();
  }

  jobs::Jobs& jobs_;
  const ResultReading reading_;
  const CallerRef caller_;  // holds the place of the stream in its quota
  const jobs::PicturePlace picture_;
  const std::shared_ptr<ResultFile> file_;
  v1::FetchRenderResultResponse response_;  // gRPC reads it during the write
  rpc_port::DeliveryDeadline delivery_;
};

absl::StatusOr<jobs::ResultPlace> FindResult(const jobs::Jobs& jobs, const access::Caller& caller,
                                             const v1::FetchRenderResultRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(jobs::ResultPlace place,
                               jobs.Result({request.job_id(), request.index()}, AskerOf(caller)));
  if (request.offset() <= place.bytes) return place;
  return base::InvalidField(
      "offset", absl::StrCat("is ", request.offset(), "; the file has ", place.bytes, " bytes"),
      "VALUE_OUT_OF_RANGE", {{"minimum", "0"}, {"maximum", absl::StrCat(place.bytes)}});
}

}  // namespace

ResultReactor* FetchRenderResult(jobs::Jobs& jobs, const ResultReading& reading,
                                 const Limits& limits, grpc::CallbackServerContext* context,
                                 CallerRef caller, const v1::FetchRenderResultRequest* request) {
  absl::StatusOr<jobs::ResultPlace> place = FindResult(jobs, *caller, *request);
  if (!place.ok()) return new rpc_port::RefusedStream<ResultReactor>(*caller, place.status());
  auto* stream =
      new ResultStream(jobs, reading, limits, context, std::move(caller),
                       {request->job_id(), request->index()}, *std::move(place), request->offset());
  stream->Next();
  return stream;
}

}  // namespace thunderhead::service
