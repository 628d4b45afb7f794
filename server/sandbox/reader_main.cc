#include "sandbox/reader_main.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "sandbox/messages.h"
#include "sandbox/reader_process.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::sandbox {
namespace {

// Returns the first bytes of the first file.
std::string_view StartOf(const std::vector<BundledFile>& files) {
  if (files.empty()) return {};
  const std::span<const std::byte> bytes = files.front().bytes;
  return {reinterpret_cast<const char*>(bytes.data()),
          std::min(bytes.size(), storm_files::UnknownFile::kStart_bytes)};
}

class StormReader final : public FileReader {
 public:
  explicit StormReader(const storm_files::StormFormats& formats) : formats_(formats) {}

  absl::Status Prepare(const std::vector<BundledFile>& files) override {
    for (const BundledFile& file : files) paths_.push_back(file.path);
    // The files of a bundle have one format.
    return formats_.PrepareBeforeConfinement(StartOf(files));
  }
  absl::Status Answer(const Request& request, Replies& replies) override;

 private:
  // Describes the file, or all files as one time, once for all requests.
  absl::Status Describe(const Request& request);
  // Describes each file separately.
  absl::Status AnswerDescriptions(Replies& replies);

  const storm_files::StormFormats& formats_;
  std::vector<std::string> paths_;
  std::optional<storm_files::StormFile> file_;
};

absl::Status StormReader::Describe(const Request& request) {
  if (!file_.has_value() && request.bundle == 0) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file_, storm_store::DescribeFile(request.path, formats_));
  } else if (!file_.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file_, formats_.DescribeTogether(paths_));
  }
  // A part that belongs to all times has no time itself.
  if (request.wanted == Wanted::kDescription) return absl::OkStatus();
  if (request.record < file_->times.size()) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(request.path, ": has no record ", request.record,
                                          "; the file is shorter than it was: was it replaced?"));
}

absl::Status StormReader::Answer(const Request& request, Replies& replies) {
  if (request.wanted == Wanted::kDescriptions) return AnswerDescriptions(replies);
  THUNDERHEAD_RETURN_IF_ERROR(Describe(request));
  if (request.wanted == Wanted::kDescription) {
    replies.Send(Reply::kDescription, *file_);
  } else if (request.wanted == Wanted::kVerticalGrid) {
    THUNDERHEAD_ASSIGN_OR_RETURN(storm_files::VerticalGrid grid,
                                 file_->reader->ReadVerticalGrid(request.record));
    replies.Send(Reply::kGrid, grid);
  } else {
    const auto progress = [](double share) {
      Replies::SendProgress(share);
      return absl::OkStatus();
    };
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::HydrometeorFields fields,
                                 file_->reader->Read(request.record, request.grid, progress));
    replies.Send(Reply::kFields, fields);
  }
  return absl::OkStatus();
}

absl::Status StormReader::AnswerDescriptions(Replies& replies) {
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
  replies.Send(Reply::kDescriptions, descriptions);
  return absl::OkStatus();
}

}  // namespace

int ReadStormFile(const storm_files::StormFormats& formats) {
  StormReader reader(formats);
  return RunReader(reader);
}

}  // namespace thunderhead::sandbox
