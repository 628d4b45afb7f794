#include "sandbox/reader_process.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "base/byte_source.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/version.h"
#include "sandbox/confinement.h"
#include "spdlog/sinks/base_sink.h"
#include "spdlog/spdlog.h"

namespace thunderhead::sandbox {

// A log sink that keeps the lines that libraries and formats log. They are sent to the server,
// because this process has no log.
class Replies::KeptLog final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<Note> Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(notes_, {});
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    constexpr std::size_t kMaxNotes = 20;
    if (notes_.size() >= kMaxNotes) return;
    notes_.push_back({static_cast<int>(message.level),
                      NoteText({message.payload.data(), message.payload.size()})});
  }
  void flush_() override {}

 private:
  std::vector<Note> notes_;
};

namespace {

// Maps the file or the bundle into memory. After this, these files need not be opened again.
absl::StatusOr<std::span<const std::byte>> MapFile() {
  struct stat information = {};
  if (fstat(kFileDescriptor, &information) != 0) {
    return absl::UnavailableError(absl::StrCat("cannot be examined: ", std::strerror(errno)));
  }
  const auto size = static_cast<std::size_t>(information.st_size);
  if (size == 0) return std::span<const std::byte>();
  void* const bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, kFileDescriptor, 0);
  if (bytes == MAP_FAILED) {
    return absl::UnavailableError(
        absl::StrCat("cannot be mapped into memory: ", std::strerror(errno)));
  }
  close(kFileDescriptor);
  return std::span(static_cast<const std::byte*>(bytes), size);
}

// Maps the memory for large arrays, or returns none if that fails.
std::span<std::byte> MapShared(std::size_t size) {
  if (size == 0) return {};
  void* const bytes =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, kSharedDescriptor, 0);
  close(kSharedDescriptor);
  if (bytes == MAP_FAILED) return {};
  return {static_cast<std::byte*>(bytes), size};
}

// Makes the kernel end this process, and not the server, if memory runs out.
void OfferToEndFirst() {
  const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  static_cast<void>(write(file, "1000", 4));
  close(file);
}

constexpr std::uint64_t kLargestRequest = 64 << 10;

// The time after which an idle reader ends. It is longer than the time for which the server keeps
// an idle reader, so normally the server ends the reader.
constexpr std::chrono::minutes kLongestRest{10};

// Maps the files into memory, and confines the process within the limits of `first`.
absl::Status Prepare(FileReader& reader, const Request& first) {
  OfferToEndFirst();
  if (first.wanted != Wanted::kProbe) {
    const auto bytes = MapFile();
    if (!bytes.ok()) return base::Annotate(bytes.status(), first.path);
    std::vector<BundledFile> files = {{first.path, *bytes}};
    if (first.bundle != 0) {
      THUNDERHEAD_ASSIGN_OR_RETURN(files, FilesOfBundle(*bytes));
    }
    for (const BundledFile& file : files) base::ReadFromMemory(file.path, file.bytes);
    THUNDERHEAD_RETURN_IF_ERROR(reader.Prepare(files));
  }
  return Confine({first.memory_bytes, first.processor_s});
}

absl::Status Answer(FileReader& reader, const Request& request, Replies& replies) {
  if (request.wanted != Wanted::kProbe) return reader.Answer(request, replies);
  Note nothing;
  replies.Send(Reply::kProbed, nothing);
  return absl::OkStatus();
}

// Answers a request, or returns an error that names the file if the answer needs too much memory.
absl::Status AnswerWithinMemory(FileReader& reader, const Request& request, Replies& replies) {
  absl::Status status = base::Guarded([&] { return Answer(reader, request, replies); });
  if (base::DetailsOf(status).reason != base::DetailsOf(base::OutOfMemory()).reason) return status;
  return absl::ResourceExhaustedError(absl::StrCat(
      request.path, ": needs more memory to be read than its limit; cut a smaller domain"));
}

}  // namespace

Replies::Replies(std::span<std::byte> shared) : shared_(shared), log_(std::make_shared<KeptLog>()) {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("reader", log_));
}

std::vector<Note> Replies::TakeLog() { return log_->Take(); }

void Replies::SendError(const absl::Status& error) {
  Note note{static_cast<int>(error.code()),
            NoteText({error.message().data(), error.message().size()})};
  Send(Reply::kError, note);
}

void Replies::SendProgress(double share) {
  Sender server(STDOUT_FILENO);
  server(Reply::kProgress);
  server(share);
}

int RunReader(FileReader& reader) {
  // The kernel must kill this process when the server ends, because then no process needs the
  // result.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGPIPE, SIG_IGN);
  Request request;
  Receiver from_server(STDIN_FILENO, std::chrono::seconds(10), kLargestRequest);
  Visit(from_server, request);
  // A request of another version of the program may have another layout, so it is refused.
  if (!from_server.Ok() || request.version != base::Version()) return 1;
  const std::span<std::byte> shared = MapShared(request.shared_bytes);
  // Without the memory this process must exit, because the server expects large arrays there.
  if (shared.size() != request.shared_bytes) return 1;
  Replies replies(shared);
  absl::Status status = Prepare(reader, request);
  while (status.ok()) {
    status = AnswerWithinMemory(reader, request, replies);
    if (!status.ok()) break;
    // Unused memory is returned to the system after each answer, because the next request may never
    // come.
    malloc_trim(0);
    Receiver next(STDIN_FILENO, kLongestRest, kLargestRequest);
    Visit(next, request);
    if (!next.Ok()) return 0;
  }
  replies.SendError(status);
  return 1;
}

}  // namespace thunderhead::sandbox
