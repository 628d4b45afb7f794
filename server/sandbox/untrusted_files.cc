#include "sandbox/untrusted_files.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/status.h"
#include "sandbox/plausible.h"

namespace thunderhead::sandbox {
namespace {

namespace fs = std::filesystem;

// A description reads no fields, and the catalogue waits for it.
constexpr std::chrono::milliseconds kDescriptionTime{20'000};

// How long a file that made its reader fail is left alone while it stays the same.
constexpr std::chrono::minutes kPause{10};

// Absolute, with its links followed as far as it exists, or as it is written.
fs::path Followed(const std::string& path) {
  std::error_code error;
  fs::path followed = fs::weakly_canonical(path, error);
  return error ? fs::absolute(path).lexically_normal() : followed;
}

fs::path Written(const std::string& path) {
  std::error_code error;
  const fs::path written = fs::absolute(path, error).lexically_normal();
  // "folder/" is "folder".
  return written.has_filename() ? written : written.parent_path();
}

bool IsBelow(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

class UntrustedRecordReader final : public volume::RecordReader {
 public:
  UntrustedRecordReader(std::shared_ptr<UntrustedFiles> files, volume::StormFile description)
      : files_(std::move(files)), description_(std::move(description)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(
      std::size_t record, const std::optional<volume::VerticalGrid>& grid,
      const volume::ReadCheckpoint& checkpoint) const override {
    return files_->Read(description_, record, grid, checkpoint);
  }

  absl::StatusOr<volume::VerticalGrid> ReadVerticalGrid(std::size_t record) const override {
    return files_->ReadVerticalGrid(description_.path, record);
  }

 private:
  const std::shared_ptr<UntrustedFiles> files_;
  const volume::StormFile description_;
};

Request RequestFor(Wanted wanted, const std::string& path, std::size_t record = 0) {
  Request request;
  request.wanted = wanted;
  request.path = path;
  request.record = record;
  return request;
}

}  // namespace

UntrustedFiles::UntrustedFiles(UntrustedOptions options) : options_(std::move(options)) {}

absl::Status UntrustedFiles::Probe() const {
  return ReaderProcess(options_.limits, *options_.time)
      .Run(RequestFor(Wanted::kProbe, "a probe"), Reply::kProbed, {}, [](Receiver& from_reader) {
        Note nothing;
        Visit(from_reader, nothing);
        return absl::OkStatus();
      });
}

bool UntrustedFiles::Includes(const std::string& path) const {
  if (options_.all) return true;
  return std::ranges::any_of(options_.folders, [&path](const std::string& folder) {
    return IsBelow(Written(path), Written(folder)) || IsBelow(Followed(path), Followed(folder));
  });
}

absl::Status UntrustedFiles::Run(Request request, Reply wanted, const ReaderLimits& limits,
                                 const volume::ReadCheckpoint& checkpoint,
                                 const ReaderProcess::Take& take) {
  const std::string path = request.path;
  const std::optional<base::FileStamp> stamp = base::StampOf(path);
  {
    const std::lock_guard lock(mutex_);
    const auto known = offenders_.find(path);
    if (known != offenders_.end() && stamp == known->second.stamp &&
        options_.time->Now() - known->second.when < kPause) {
      return known->second.failure;
    }
  }
  absl::Status status =
      ReaderProcess(limits, *options_.time).Run(std::move(request), wanted, checkpoint, take);
  const std::lock_guard lock(mutex_);
  offenders_.erase(path);
  if (stamp.has_value() && IsReaderFailure(status)) {
    offenders_.emplace(path, Offender{*stamp, options_.time->Now(), status});
  }
  return status;
}

absl::StatusOr<volume::StormFile> UntrustedFiles::Describe(const std::string& path) {
  ReaderLimits limits = options_.limits;
  limits.time = std::min(limits.time, kDescriptionTime);
  volume::StormFile file;
  THUNDERHEAD_RETURN_IF_ERROR(Run(RequestFor(Wanted::kDescription, path), Reply::kDescription,
                                  limits, {}, [&file](Receiver& from_reader) {
                                    Visit(from_reader, file);
                                    return CheckPlausible(file);
                                  }));
  file.path = path;
  file.reader = ReaderOf(file);
  return file;
}

std::shared_ptr<const volume::RecordReader> UntrustedFiles::ReaderOf(
    const volume::StormFile& file) {
  return std::make_shared<UntrustedRecordReader>(shared_from_this(), file);
}

absl::StatusOr<volume::HydrometeorFields> UntrustedFiles::Read(
    const volume::StormFile& of, std::size_t record,
    const std::optional<volume::VerticalGrid>& grid, const volume::ReadCheckpoint& checkpoint) {
  Request request = RequestFor(Wanted::kFields, of.path, record);
  request.grid = grid;
  volume::HydrometeorFields fields;
  THUNDERHEAD_RETURN_IF_ERROR(Run(std::move(request), Reply::kFields, options_.limits, checkpoint,
                                  [&](Receiver& from_reader) {
                                    Visit(from_reader, fields);
                                    return CheckPlausible(fields, of);
                                  }));
  return fields;
}

absl::StatusOr<volume::VerticalGrid> UntrustedFiles::ReadVerticalGrid(const std::string& path,
                                                                      std::size_t record) {
  volume::VerticalGrid grid;
  THUNDERHEAD_RETURN_IF_ERROR(Run(RequestFor(Wanted::kVerticalGrid, path, record), Reply::kGrid,
                                  options_.limits, {}, [&grid](Receiver& from_reader) {
                                    Visit(from_reader, grid);
                                    return CheckPlausible(grid);
                                  }));
  return grid;
}

volume::StormFormats WithUntrusted(volume::StormFormats formats,
                                   const std::shared_ptr<UntrustedFiles>& untrusted) {
  formats.LeaveTo([untrusted](const std::string& path) {
    using Described = absl::StatusOr<volume::StormFile>;
    return untrusted->Includes(path) ? std::optional<Described>(untrusted->Describe(path))
                                     : std::nullopt;
  });
  return formats;
}

}  // namespace thunderhead::sandbox
