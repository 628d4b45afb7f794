#include "sandbox/reader_main.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/version.h"
#include "sandbox/archive.h"
#include "sandbox/confinement.h"
#include "sandbox/messages.h"
#include "spdlog/sinks/base_sink.h"
#include "spdlog/spdlog.h"
#include "volume/netcdf_file.h"
#include "volume/storm_catalogue.h"

namespace thunderhead::sandbox {
namespace {

// Keeps what formats log, for the server to log it: this process has no log of its own.
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

// The file as memory: after this, no file need be opened.
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

// The memory for large arrays; none if it cannot be had.
std::span<std::byte> MapShared(std::size_t size) {
  if (size == 0) return {};
  void* const bytes =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, kSharedDescriptor, 0);
  close(kSharedDescriptor);
  if (bytes == MAP_FAILED) return {};
  return {static_cast<std::byte*>(bytes), size};
}

// If memory runs out, the kernel is to end this process and not the one that has asked.
void OfferToEndFirst() {
  const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  static_cast<void>(write(file, "1000", 4));
  close(file);
}

class Reader {
 public:
  Reader(const volume::StormFormats& formats, Request request, std::span<std::byte> shared)
      : formats_(formats), request_(std::move(request)), server_(STDOUT_FILENO, shared) {}

  absl::Status Prepare();
  absl::Status Answer();
  void Tell(const absl::Status& error);

 private:
  template <typename Value>
  void Send(Reply reply, Value& value) {
    for (Note& note : log_->Take()) {
      server_(Reply::kLog);
      Visit(server_, note);
    }
    server_(reply);
    Visit(server_, value);
  }
  absl::Status Describe(volume::StormFile& file);
  absl::StatusOr<volume::HydrometeorFields> ReadFields(const volume::StormFile& file);

  const volume::StormFormats& formats_;
  Request request_;
  Sender server_;
  std::shared_ptr<KeptLog> log_ = std::make_shared<KeptLog>();
};

absl::Status Reader::Prepare() {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("reader", log_));
  OfferToEndFirst();
  if (request_.wanted != Wanted::kProbe) {
    auto bytes = MapFile();
    if (!bytes.ok()) return base::Annotate(bytes.status(), request_.path);
    volume::NetcdfFile::ReadFromMemory(request_.path, *bytes);
  }
  return Confine({request_.memory_bytes, request_.processor_s});
}

absl::Status Reader::Describe(volume::StormFile& file) {
  THUNDERHEAD_ASSIGN_OR_RETURN(file, volume::DescribeFile(request_.path, formats_));
  if (request_.record < file.times.size()) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(request_.path, ": has no record ", request_.record,
                                          "; the file is shorter than it was: was it replaced?"));
}

absl::StatusOr<volume::HydrometeorFields> Reader::ReadFields(const volume::StormFile& file) {
  return file.reader->Read(request_.record, request_.grid, [this](double share) {
    server_(Reply::kProgress);
    server_(share);
    return absl::OkStatus();
  });
}

absl::Status Reader::Answer() {
  if (request_.wanted == Wanted::kProbe) {
    Note nothing;
    Send(Reply::kProbed, nothing);
    return absl::OkStatus();
  }
  volume::StormFile file;
  THUNDERHEAD_RETURN_IF_ERROR(Describe(file));
  if (request_.wanted == Wanted::kDescription) {
    Send(Reply::kDescription, file);
  } else if (request_.wanted == Wanted::kVerticalGrid) {
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::VerticalGrid grid,
                                 file.reader->ReadVerticalGrid(request_.record));
    Send(Reply::kGrid, grid);
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::HydrometeorFields fields, ReadFields(file));
    Send(Reply::kFields, fields);
  }
  return absl::OkStatus();
}

void Reader::Tell(const absl::Status& error) {
  Note note{static_cast<int>(error.code()), std::string(error.message())};
  Send(Reply::kError, note);
}

}  // namespace

int ReadStormFile(const volume::StormFormats& formats) {
  // Nobody waits for what is read after the server's end.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGPIPE, SIG_IGN);
  Request request;
  Receiver from_server(STDIN_FILENO, std::chrono::seconds(10), 1 << 10);
  Visit(from_server, request);
  // A request of another version has another layout.
  if (!from_server.Ok() || request.version != base::Version()) return 1;
  const std::span<std::byte> shared = MapShared(request.shared_bytes);
  // The other end puts arrays there without asking.
  if (shared.size() != request.shared_bytes) return 1;
  Reader reader(formats, std::move(request), shared);
  absl::Status status = reader.Prepare();
  if (status.ok()) {
    status = base::Guarded([&reader] { return reader.Answer(); });
  }
  if (!status.ok()) reader.Tell(status);
  return status.ok() ? 0 : 1;
}

}  // namespace thunderhead::sandbox
