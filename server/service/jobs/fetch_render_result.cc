#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/file_descriptor.h"
#include "base/guarded.h"
#include "base/line_limit.h"
#include "base/status.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/finished.h"
#include "rpc_port/status_table.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"
#include "spdlog/spdlog.h"
#include "streams/sha256_digest.h"

namespace thunderhead::service {
namespace {

using ResultReactor = grpc::ServerWriteReactor<v1::FetchRenderResultResponse>;

constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 20;
// Maximum size of a picture's description, which usually has a few kilobytes.
constexpr off_t kMostAboutBytes = 4 << 20;

// Returns the error for a missing file. Either the server has just evicted the result, or an
// operator removed the file from the folder.
absl::Status Gone() {
  return base::WithDetails(
      absl::NotFoundError("the picture's file no longer exists; request the picture in a new job"),
      {.reason = "NO_SUCH_RESULT"});
}

// Logs what is wrong with a result's file, and returns the error for the client.
absl::Status Damaged(const jobs::ResultPlace& place, const std::string& what) {
  static std::mutex mutex;
  static base::LineLimit lines(1);
  std::optional<std::uint64_t> left_out;
  {
    const std::lock_guard lock(mutex);
    left_out = lines.Take(std::chrono::system_clock::now());
  }
  if (left_out.has_value()) {
    spdlog::error("{} is not sent to its client, because {} ({} more since the last line)",
                  place.path, what, *left_out);
  }
  return base::WithDetails(
      absl::DataLossError("the picture's file was altered or damaged after it was drawn; request "
                          "the picture in a new job"),
      {.reason = "RESULT_DAMAGED"});
}

// The file of a result, read from an offset. The bytes before the offset are read too, because the
// digest of the whole file is checked. Only one thread at a time may use it.
class ResultFile {
 public:
  ResultFile(jobs::ResultPlace place, std::uint64_t offset, OpenResult open)
      : place_(std::move(place)), offset_(offset), open_(std::move(open)) {}

  // Reads the next piece. Returns the next chunk, or nothing if the piece is before the offset. The
  // first chunk also has the description of the picture. The last chunk is returned only if the
  // digest of the whole file is correct.
  absl::StatusOr<std::optional<v1::FetchRenderResultResponse>> Read() {
    v1::FetchRenderResultResponse response;
    if (!file_.IsOpen()) THUNDERHEAD_RETURN_IF_ERROR(Open());
    const bool is_before = read_ < offset_;
    const std::uint64_t end = is_before ? offset_ : place_.bytes;
    std::string& chunk = *response.mutable_chunk();
    chunk.resize(std::min(kChunkBytes, end - read_));
    THUNDERHEAD_RETURN_IF_ERROR(Fill(chunk));
    if (AtEnd()) THUNDERHEAD_RETURN_IF_ERROR(CheckDigest());
    if (is_before && !AtEnd()) return std::nullopt;
    if (is_before) chunk.clear();  // the offset is the file's end, so no bytes are sent
    if (!std::exchange(is_described_, true)) THUNDERHEAD_RETURN_IF_ERROR(Describe(response));
    return response;
  }

  bool AtEnd() const { return read_ >= place_.bytes; }

  // Returns the job's folder, which identifies the storage for calls with a timeout.
  std::string Storage() const { return std::filesystem::path(place_.path).parent_path(); }

 private:
  // Returns the error for a file that cannot be opened.
  absl::Status NotOpened(const absl::Status& why) const {
    if (absl::IsNotFound(why)) return Gone();
    return absl::IsDataLoss(why) ? Damaged(place_, std::string(why.message())) : why;
  }

  absl::Status Open() {
    absl::StatusOr<base::FileDescriptor> opened = open_(place_.path);
    if (!opened.ok()) return NotOpened(opened.status());
    struct stat found {};
    if (fstat(opened->Get(), &found) != 0 ||
        static_cast<std::uint64_t>(found.st_size) != place_.bytes) {
      return Damaged(place_,
                     absl::StrCat("it has ", found.st_size, " bytes and must have ", place_.bytes));
    }
    file_ = *std::move(opened);
    return absl::OkStatus();
  }

  // Fills the chunk with the next bytes of the file.
  absl::Status Fill(std::string& chunk) {
    std::size_t filled = 0;
    while (filled < chunk.size()) {
      const ssize_t bytes = pread(file_.Get(), chunk.data() + filled, chunk.size() - filled,
                                  static_cast<off_t>(read_));
      if (bytes < 0 && errno == EINTR) continue;
      if (bytes < 0)
        return absl::UnavailableError("the picture's file cannot be read now; try again");
      if (bytes == 0) return Damaged(place_, "it has become shorter");
      filled += static_cast<std::size_t>(bytes);
      read_ += static_cast<std::uint64_t>(bytes);
    }
    digest_.Add(chunk);
    return absl::OkStatus();
  }

  absl::Status CheckDigest() {
    const std::string found = digest_.Hexadecimal();
    if (found == place_.sha256) return absl::OkStatus();
    return Damaged(place_, absl::StrCat("its SHA-256 is ", found, " and must be ", place_.sha256));
  }

  absl::Status Describe(v1::FetchRenderResultResponse& response) const {
    const absl::StatusOr<base::FileDescriptor> opened = open_(place_.about_path);
    if (!opened.ok()) return NotOpened(opened.status());
    v1::FetchRenderResultResponse about;
    struct stat found {};
    if (fstat(opened->Get(), &found) != 0 || found.st_size > kMostAboutBytes ||
        !about.ParseFromFileDescriptor(opened->Get())) {
      return Damaged(place_, "its description cannot be parsed");
    }
    about.set_total_bytes(place_.bytes);
    about.set_sha256(place_.sha256);
    about.mutable_chunk()->swap(*response.mutable_chunk());
    response.Swap(&about);
    return absl::OkStatus();
  }

  const jobs::ResultPlace place_;
  const std::uint64_t offset_;
  const OpenResult open_;
  base::FileDescriptor file_;
  std::uint64_t read_ = 0;  // number of bytes that were read
  streams::Sha256Digest digest_;
  bool is_described_ = false;
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
        file_(std::make_shared<ResultFile>(std::move(place), offset, reading.open)),
        delivery_(context, limits) {}

  void Next() {
    reading_.threads.Submit(caller_->identity().name, [this](const absl::Status& status) {
      const absl::Status read = status.ok() ? base::Guarded([this] { return Read(); }) : status;
      if (!read.ok()) return End(rpc_port::ToGrpcStatus(read));
      auto memory = caller_->TakeUnread(rpc_port::UnreadBytes(response_));
      if (!memory.ok()) return End(rpc_port::ToGrpcStatus(memory.status()));
      memory_ = *std::move(memory);
      delivery_.Begin(response_.chunk().size());
      StartWrite(&response_);
    });
  }

  void OnWriteDone(bool ok) override {
    delivery_.Taken();
    memory_.reset();
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

  // Reads the next chunk. Each piece of the file has its own timeout.
  absl::Status Read() {
    std::optional<v1::FetchRenderResultResponse> chunk;
    while (!chunk.has_value()) {
      THUNDERHEAD_ASSIGN_OR_RETURN(
          chunk, reading_.calls.Ask(file_->Storage(), [file = file_] { return file->Read(); }));
    }
    response_ = *std::move(chunk);
    return absl::OkStatus();
  }

  jobs::Jobs& jobs_;
  const ResultReading reading_;
  const CallerRef caller_;  // the stream counts towards the caller's quota while this exists
  const jobs::PicturePlace picture_;
  const std::shared_ptr<ResultFile> file_;
  v1::FetchRenderResultResponse response_;  // gRPC reads it during the write
  std::shared_ptr<const void> memory_;      // that of the response, while it is being written
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
