#include "sandbox/reader_main.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/byte_source.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/version.h"
#include "sandbox/archive.h"
#include "sandbox/confinement.h"
#include "sandbox/file_bundle.h"
#include "sandbox/messages.h"
#include "spdlog/sinks/base_sink.h"
#include "spdlog/spdlog.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::sandbox {
namespace {

// A log sink that keeps the lines that storm formats log. They are sent to the server, because this
// process has no log.
class KeptLog final : public spdlog::sinks::base_sink<std::mutex> {
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
                      std::string(message.payload.data(), message.payload.size())});
  }
  void flush_() override {}

 private:
  std::vector<Note> notes_;
};

// Maps the file or the bundle into memory. After this, no file needs to be opened.
absl::StatusOr<std::span<const std::byte>> MapFile() {
  struct stat information = {};
  if (fstat(kFileDescriptor, &information) != 0) {
    return absl::UnavailableError(absl::StrCat("cannot be looked at: ", std::strerror(errno)));
  }
  const auto size = static_cast<std::size_t>(information.st_size);
  if (size == 0) return std::span<const std::byte>();
  void* const bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, kFileDescriptor, 0);
  if (bytes == MAP_FAILED) {
    return absl::UnavailableError(absl::StrCat("cannot be mapped: ", std::strerror(errno)));
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

// Returns the first bytes of the first file.
std::string_view StartOf(const std::vector<BundledFile>& files) {
  if (files.empty()) return {};
  const std::span<const std::byte> bytes = files.front().bytes;
  return {reinterpret_cast<const char*>(bytes.data()),
          std::min(bytes.size(), storm_files::UnknownFile::kStart_bytes)};
}

constexpr std::uint64_t kLargestRequest = 64 << 10;

// Returns unused memory to the system before large fields are copied into the shared memory.
// Otherwise this process would hold what reading needed, the fields and their copy at once. This
// takes a part of a second, so it is done for large fields only.
void ReturnUnusedMemory(const volume::HydrometeorFields& fields) {
  constexpr std::size_t kLarge_bytes = std::size_t{1} << 30;
  if (fields.Bytes() >= kLarge_bytes) malloc_trim(0);
}

// The time after which an idle reader ends. It is longer than the time for which the server keeps
// an idle reader, so normally the server ends the reader.
constexpr std::chrono::minutes kLongestRest{10};

class Reader {
 public:
  Reader(const storm_files::StormFormats& formats, std::span<std::byte> shared)
      : formats_(formats), shared_(shared) {}

  // Maps the storm file into memory, and confines the process within the limits of `first`.
  absl::Status Prepare(const Request& first);
  // Answers a request about the mapped file.
  absl::Status Answer(const Request& request);
  void Tell(const absl::Status& error);

 private:
  template <typename Value>
  void Send(Reply reply, Value& value) {
    // Each answer starts a new Sender, so that its arrays start at the first place.
    Sender server(STDOUT_FILENO, shared_);
    for (Note& note : log_->Take()) {
      server(Reply::kLog);
      Visit(server, note);
    }
    server(reply);
    Visit(server, value);
  }
  // Describes the file, or all files as one time, once for all requests.
  absl::Status Describe(const Request& request);
  // Returns the storm of the file that has the record, which becomes the record of that storm.
  // Returns null if none has it.
  const storm_files::StormFile* StormWith(std::uint64_t& record) const;
  // Describes each file separately.
  absl::Status AnswerDescriptions();

  const storm_files::StormFormats& formats_;
  const std::span<std::byte> shared_;
  std::vector<std::string> paths_;
  std::optional<storm_files::StormFile> file_;
  std::shared_ptr<KeptLog> log_ = std::make_shared<KeptLog>();
};

absl::Status Reader::Prepare(const Request& first) {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("reader", log_));
  OfferToEndFirst();
  if (first.wanted != Wanted::kProbe) {
    const auto bytes = MapFile();
    if (!bytes.ok()) return base::Annotate(bytes.status(), first.path);
    std::vector<BundledFile> files = {{first.path, *bytes}};
    if (first.bundle != 0) {
      THUNDERHEAD_ASSIGN_OR_RETURN(files, FilesOfBundle(*bytes));
    }
    for (const BundledFile& file : files) {
      paths_.push_back(file.path);
      base::ReadFromMemory(file.path, file.bytes);
    }
    // The files of a bundle have one format.
    THUNDERHEAD_RETURN_IF_ERROR(formats_.PrepareBeforeConfinement(StartOf(files)));
  }
  return Confine({first.memory_bytes, first.processor_s});
}

absl::Status Reader::Describe(const Request& request) {
  if (!file_.has_value() && request.bundle == 0) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file_, storm_store::DescribeFile(request.path, formats_));
  } else if (!file_.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file_, formats_.DescribeTogether(paths_));
  }
  return absl::OkStatus();
}

const storm_files::StormFile* Reader::StormWith(std::uint64_t& record) const {
  if (record < file_->times.size()) return &*file_;
  record -= file_->times.size();
  for (const storm_files::StormFile& other : file_->others) {
    if (record < other.times.size()) return &other;
    record -= other.times.size();
  }
  return nullptr;
}

absl::Status Reader::Answer(const Request& request) {
  if (request.wanted == Wanted::kProbe) {
    Note nothing;
    Send(Reply::kProbed, nothing);
    return absl::OkStatus();
  }
  if (request.wanted == Wanted::kDescriptions) return AnswerDescriptions();
  THUNDERHEAD_RETURN_IF_ERROR(Describe(request));
  if (request.wanted == Wanted::kDescription) {
    Send(Reply::kDescription, *file_);
    return absl::OkStatus();
  }
  std::uint64_t record = request.record;
  const storm_files::StormFile* const storm = StormWith(record);
  if (storm == nullptr) {
    return absl::DataLossError(absl::StrCat(request.path, ": has no record ", request.record,
                                            "; the file is shorter than it was: was it replaced?"));
  }
  if (request.wanted == Wanted::kVerticalGrid) {
    THUNDERHEAD_ASSIGN_OR_RETURN(storm_files::VerticalGrid grid,
                                 storm->reader->ReadVerticalGrid(record));
    Send(Reply::kGrid, grid);
  } else {
    Sender server(STDOUT_FILENO);
    const auto progress = [&server](double share) {
      server(Reply::kProgress);
      server(share);
      return absl::OkStatus();
    };
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::HydrometeorFields fields,
                                 storm->reader->Read(record, request.grid, progress));
    ReturnUnusedMemory(fields);
    Send(Reply::kFields, fields);
  }
  return absl::OkStatus();
}

absl::Status Reader::AnswerDescriptions() {
  std::vector<Description> descriptions;
  for (const std::string& path : paths_) {
    Description& each = descriptions.emplace_back();
    absl::StatusOr<storm_files::StormFile> file = storm_store::DescribeFile(path, formats_);
    if (file.ok()) {
      each.file = *std::move(file);
    } else {
      each.code = static_cast<int>(file.status().code());
      each.message = std::string(file.status().message());
    }
  }
  Send(Reply::kDescriptions, descriptions);
  return absl::OkStatus();
}

void Reader::Tell(const absl::Status& error) {
  Note note{static_cast<int>(error.code()), std::string(error.message())};
  Send(Reply::kError, note);
}

}  // namespace

int ReadStormFile(const storm_files::StormFormats& formats) {
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
  Reader reader(formats, shared);
  absl::Status status = reader.Prepare(request);
  while (status.ok()) {
    status = base::Guarded([&] { return reader.Answer(request); });
    if (!status.ok()) break;
    // Unused memory is returned to the system after each answer, because the next request may never
    // come.
    malloc_trim(0);
    Receiver next(STDIN_FILENO, kLongestRest, kLargestRequest);
    Visit(next, request);
    if (!next.Ok()) return 0;
  }
  reader.Tell(status);
  return 1;
}

}  // namespace thunderhead::sandbox
