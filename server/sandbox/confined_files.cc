#include "sandbox/confined_files.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "sandbox/plausible.h"

namespace thunderhead::sandbox {
namespace {

// The time for which an unchanged file is not read again after it made its reader fail.
constexpr std::chrono::minutes kPause{10};

class ConfinedRecordReader final : public storm_files::RecordReader {
 public:
  ConfinedRecordReader(std::shared_ptr<ConfinedFiles> files, storm_files::StormFile description)
      : files_(std::move(files)), description_(std::move(description)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(
      const storm_files::RecordPart& part, const std::optional<storm_files::VerticalGrid>& grid,
      const storm_files::ReadCheckpoint& checkpoint) const override {
    return files_->Read(description_, part, grid, checkpoint);
  }

  absl::StatusOr<storm_files::VerticalGrid> ReadVerticalGrid(std::size_t record) const override {
    return files_->ReadVerticalGrid(description_, record);
  }

 private:
  const std::shared_ptr<ConfinedFiles> files_;
  const storm_files::StormFile description_;
};

Request RequestFor(Wanted wanted, const std::string& path, std::size_t record = 0) {
  Request request;
  request.wanted = wanted;
  request.path = path;
  request.record = record;
  return request;
}

// `paths` are the files of one time. It is empty if the time is in a single file.
Request RequestFor(Wanted wanted, const std::string& path, const std::vector<std::string>& paths,
                   std::size_t record = 0) {
  Request request = RequestFor(wanted, path, record);
  request.bundle = paths.empty() ? 0 : 1;
  request.bundled = paths;
  return request;
}

}  // namespace

ConfinedFiles::ConfinedFiles(const ConfinedOptions& options)
    : options_(options),
      readers_(options.limits, *options.time, options.program, {.opened = options.check_opened}) {}

absl::Status ConfinedFiles::Probe() {
  return readers_.Run(RequestFor(Wanted::kProbe, "a probe"), Reply::kProbed, {options_.limits.time},
                      {}, [](Receiver& from_reader) {
                        Note nothing;
                        Visit(from_reader, nothing);
                        return absl::OkStatus();
                      });
}

absl::Status ConfinedFiles::Run(Request request, Reply wanted, Readers::Patience patience,
                                const storm_files::ReadCheckpoint& checkpoint,
                                const Readers::Take& take) {
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
  absl::Status status = readers_.Run(std::move(request), wanted, patience, checkpoint, take);
  const std::lock_guard lock(mutex_);
  offenders_.erase(path);
  if (stamp.has_value() && IsReaderFailure(status)) {
    offenders_.emplace(path, Offender{*stamp, options_.time->Now(), status});
  }
  return status;
}

absl::StatusOr<storm_files::StormFile> ConfinedFiles::Describe(const std::string& path) {
  return DescribeTogether(path, {});
}

absl::StatusOr<storm_files::StormFile> ConfinedFiles::DescribeTogether(
    const std::string& path, const std::vector<std::string>& paths) {
  return DescribeFor(path, paths, DescriptionPatience(storm_files::kLongestDescription, false));
}

Readers::Patience ConfinedFiles::DescriptionPatience(std::chrono::milliseconds patience,
                                                     bool is_batch) const {
  const std::chrono::milliseconds longest =
      std::min(options_.limits.time, storm_files::kLongestDescription);
  return {std::min(patience, longest), is_batch || patience < longest};
}

absl::StatusOr<storm_files::StormFile> ConfinedFiles::DescribeFor(
    const std::string& path, const std::vector<std::string>& paths, Readers::Patience patience) {
  storm_files::StormFile file;
  THUNDERHEAD_RETURN_IF_ERROR(Run(RequestFor(Wanted::kDescription, path, paths),
                                  Reply::kDescription, patience, {},
                                  [&file](Receiver& from_reader) {
                                    Visit(from_reader, file);
                                    return CheckPlausible(file);
                                  }));
  Own(path, paths, file);
  return file;
}

// Sets the members of `file`, and of the other storms in it, that the reader does not send.
void ConfinedFiles::Own(const std::string& path, const std::vector<std::string>& paths,
                        storm_files::StormFile& file) {
  std::vector<storm_files::StormFile> others = std::move(file.others);
  file.others.clear();
  file.path = path;
  file.parts = paths;
  file.reader = std::make_shared<ConfinedRecordReader>(shared_from_this(), file);
  std::size_t records = file.times.size();
  for (storm_files::StormFile& other : others) {
    other.first_record = records;
    Own(path, paths, other);
    records += other.times.size();
  }
  file.others = std::move(others);
}

std::vector<absl::StatusOr<storm_files::StormFile>> ConfinedFiles::DescribeEach(
    const std::vector<std::string>& paths, std::chrono::milliseconds patience) {
  const auto began = options_.time->Now();
  std::vector<absl::StatusOr<storm_files::StormFile>> files;
  std::vector<Description> descriptions;
  const auto take = [&](Receiver& from_reader) -> absl::Status {
    Visit(from_reader, descriptions);
    if (descriptions.size() != paths.size()) return absl::InternalError("the number of files");
    for (const Description& each : descriptions) {
      if (each.code == 0) THUNDERHEAD_RETURN_IF_ERROR(CheckPlausible(each.file));
    }
    return absl::OkStatus();
  };
  absl::Status together = absl::UnknownError("one file is described alone");
  if (paths.size() > 1) {
    together = readers_.Run(RequestFor(Wanted::kDescriptions, paths.front(), paths),
                            Reply::kDescriptions, DescriptionPatience(patience, true), {}, take);
  }
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool is_late = paths.size() > 1 && options_.time->Now() - began >= patience;
    if (absl::IsAborted(together) || (!together.ok() && is_late)) {
      files.emplace_back(absl::AbortedError(absl::StrCat(
          paths[i], ": was not read, because other files read with it are slow; open it alone")));
    } else if (!together.ok()) {
      files.push_back(DescribeFor(paths[i], {}, DescriptionPatience(patience, false)));
    } else if (descriptions[i].code != 0) {
      files.emplace_back(absl::Status(static_cast<absl::StatusCode>(descriptions[i].code),
                                      NoteText(descriptions[i].message)));
    } else {
      Own(paths[i], {}, descriptions[i].file);
      files.emplace_back(std::move(descriptions[i].file));
    }
  }
  return files;
}

absl::StatusOr<volume::HydrometeorFields> ConfinedFiles::Read(
    const storm_files::StormFile& of, const storm_files::RecordPart& part,
    const std::optional<storm_files::VerticalGrid>& grid,
    const storm_files::ReadCheckpoint& checkpoint) {
  Request request = RequestFor(Wanted::kFields, of.path, of.parts, of.first_record + part.record);
  request.window = part.window;
  request.stride = part.stride;
  request.grid = grid;
  volume::HydrometeorFields fields;
  THUNDERHEAD_RETURN_IF_ERROR(Run(std::move(request), Reply::kFields, {options_.limits.time},
                                  checkpoint, [&](Receiver& from_reader) {
                                    Visit(from_reader, fields);
                                    return CheckPlausible(fields,
                                                          ColumnsOf(part, glm::ivec2(of.cells)));
                                  }));
  return fields;
}

absl::StatusOr<storm_files::VerticalGrid> ConfinedFiles::ReadVerticalGrid(
    const storm_files::StormFile& of, std::size_t record) {
  storm_files::VerticalGrid grid;
  THUNDERHEAD_RETURN_IF_ERROR(
      Run(RequestFor(Wanted::kVerticalGrid, of.path, of.parts, of.first_record + record),
          Reply::kGrid, {options_.limits.time}, {}, [&grid](Receiver& from_reader) {
            Visit(from_reader, grid);
            return CheckPlausible(grid);
          }));
  return grid;
}

storm_files::StormFormats Confined(storm_files::StormFormats formats,
                                   const std::shared_ptr<ConfinedFiles>& files) {
  formats.LeaveTo(
      {.describe = [files](const std::string& path) { return files->Describe(path); },
       .describe_each =
           [files](const std::vector<std::string>& paths, std::chrono::milliseconds patience) {
             return files->DescribeEach(paths, patience);
           },
       .describe_together =
           [files](const std::vector<std::string>& paths) {
             return files->DescribeTogether(paths.front(), paths);
           }});
  return formats;
}

storm_files::StormFormats ConfinedFormats(const ConfinedOptions& options) {
  return Confined(storm_files::StormFormats::BuiltIn(), std::make_shared<ConfinedFiles>(options));
}

}  // namespace thunderhead::sandbox
