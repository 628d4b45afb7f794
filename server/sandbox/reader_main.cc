#include "sandbox/reader_main.h"

#include <malloc.h>

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

// Returns the first bytes of each file.
std::vector<std::string_view> StartsOf(const std::vector<BundledFile>& files) {
  std::vector<std::string_view> starts;
  starts.reserve(files.size());
  for (const BundledFile& file : files) {
    starts.emplace_back(reinterpret_cast<const char*>(file.bytes.data()),
                        std::min(file.bytes.size(), storm_files::UnknownFile::kStart_bytes));
  }
  return starts;
}

// Returns unused memory to the system before large fields are copied into the shared memory.
// Otherwise this process would hold three things at the same time: the memory that reading needed,
// the fields, and their copy. Returning memory takes a fraction of a second, so it is done for
// large fields only.
void ReturnUnusedMemory(const volume::HydrometeorFields& fields) {
  constexpr std::size_t kLarge_bytes = std::size_t{1} << 30;
  if (fields.Bytes() >= kLarge_bytes) malloc_trim(0);
}

class StormReader final : public FileReader {
 public:
  explicit StormReader(const storm_files::StormFormats& formats) : formats_(formats) {}

  absl::Status Prepare(const std::vector<BundledFile>& files) override {
    for (const BundledFile& file : files) paths_.push_back(file.path);
    return formats_.PrepareBeforeConfinement(StartsOf(files));
  }
  absl::Status Answer(const Request& request, Replies& replies) override;

 private:
  // Sets `file_` to the description of the file, or of all files if together they are one time.
  // Later requests use the same description.
  absl::Status Describe(const Request& request);
  // Returns the storm of the file that contains `record`, and changes `record` to its number within
  // that storm. Returns null if no storm contains it.
  const storm_files::StormFile* StormWith(std::uint64_t& record) const;
  // Describes each file separately and sends the descriptions.
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
  // A file that is only a part of a time can be described, but not read.
  if (request.wanted == Wanted::kDescription) return absl::OkStatus();
  if (file_->reader == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(
        request.path, ": is only a part of a time; give all files of the time together"));
  }
  return absl::OkStatus();
}

const storm_files::StormFile* StormReader::StormWith(std::uint64_t& record) const {
  if (record < file_->times.size()) return &*file_;
  record -= file_->times.size();
  for (const storm_files::StormFile& other : file_->others) {
    if (record < other.times.size()) return &other;
    record -= other.times.size();
  }
  return nullptr;
}

absl::Status StormReader::Answer(const Request& request, Replies& replies) {
  if (request.wanted == Wanted::kDescriptions) return AnswerDescriptions(replies);
  THUNDERHEAD_RETURN_IF_ERROR(Describe(request));
  if (request.wanted == Wanted::kDescription) {
    replies.Send(Reply::kDescription, *file_);
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
    replies.Send(Reply::kGrid, grid);
  } else {
    const auto progress = [](double share) {
      Replies::SendProgress(share);
      return absl::OkStatus();
    };
    storm_files::RecordPart part = record;
    part.window = request.window;
    part.stride = request.stride;
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::HydrometeorFields fields,
                                 storm->reader->Read(part, request.grid, progress));
    ReturnUnusedMemory(fields);
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
      const absl::string_view message = file.status().message();
      each.message = NoteText({message.data(), message.size()});
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
