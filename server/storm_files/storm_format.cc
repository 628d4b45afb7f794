#include "storm_files/storm_format.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/civil_time.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "base/utf8.h"
#include "storm_files/vdb_start.h"

namespace thunderhead::storm_files {
namespace {

// Checks conditions on files of every format that other libraries rely on.
absl::Status CheckDescribed(const StormFile& file) {
  const auto& cells = file.cells;
  THUNDERHEAD_RETURN_IF_ERROR(
      base::CountThatFits(absl::StrCat(file.path, ": one time of a field"),
                          {static_cast<std::size_t>(cells.x), static_cast<std::size_t>(cells.y),
                           static_cast<std::size_t>(cells.z)},
                          sizeof(float))
          .status());
  constexpr double kSmallest_m = 1e-3;
  constexpr double kLargest_m = 1e6;
  for (const double spacing_m : {file.dx_m, file.dy_m}) {
    if (spacing_m >= kSmallest_m && spacing_m <= kLargest_m) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.path, ": its cells are ", spacing_m,
                     " m wide; 1 mm to 1000 km can be shown: check the grid's spacing"));
  }
  static const absl::Time kFirst = absl::FromCivil(absl::CivilYear(0), absl::UTCTimeZone());
  static const absl::Time kEnd = absl::FromCivil(absl::CivilYear(10'000), absl::UTCTimeZone());
  for (const absl::Time time : file.times) {
    if (time >= kFirst && time < kEnd) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.path, ": has a time outside the years 0 to 9999 (",
                     absl::FormatTime(time, absl::UTCTimeZone()), "); check its units"));
  }
  return absl::OkStatus();
}

// Makes the texts that the file contains printable, and shortens them. A long text would otherwise
// exceed what a reader may send, and the storm would be lost.
void CleanTexts(StormFile& file) {
  for (std::string* text : {&file.grid, &file.about, &file.run, &file.member, &file.part.of}) {
    *text = base::Printable(*text);
  }
  for (std::string& assumption : file.assumptions) assumption = base::Printable(assumption);
}

// Checks the storms of a file and cleans their texts. A file with only a part of a time is not
// checked, because it does not describe a whole storm.
absl::Status CheckStorms(StormFile& file) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckStormCount(file.path, file.others.size() + 1));
  if (file.part.of.empty()) THUNDERHEAD_RETURN_IF_ERROR(CheckDescribed(file));
  CleanTexts(file);
  for (StormFile& other : file.others) {
    if (other.part.of.empty()) THUNDERHEAD_RETURN_IF_ERROR(CheckDescribed(other));
    CleanTexts(other);
  }
  return absl::OkStatus();
}

}  // namespace

std::vector<StormFile> StormsOf(StormFile file) {
  std::vector<StormFile> storms;
  std::vector<StormFile> others = std::move(file.others);
  file.others.clear();
  storms.push_back(std::move(file));
  for (StormFile& other : others) {
    const StormFile& first = storms.front();
    const StormFile& before = storms.back();
    other.first_record = before.first_record + before.times.size();
    other.parts = first.parts;
    other.version = first.version;
    other.id = first.id;
    other.device = first.device;
    other.modified_ns = first.modified_ns;
    storms.push_back(std::move(other));
  }
  return storms;
}

absl::Status CheckStormCount(const std::string& path, std::size_t storms) {
  if (storms <= kMaxStorms) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(path, ": has ", storms,
                                                 " storms (runs or members), and ", kMaxStorms,
                                                 " are the most; split it"));
}

absl::Status CheckRecords(const std::string& path, std::size_t records) {
  if (records <= kMaxTimes) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(path, ": has ", records, " times, and ", kMaxTimes,
                                                 " are the most; split it, or correct its size"));
}

UnknownFile::UnknownFile(const std::string& path) : path_(path), bytes_(base::OpenBytes(path)) {
  if (!bytes_.ok()) return;
  start_.resize(std::min<std::uint64_t>(kStart_bytes, (*bytes_)->Size_bytes()));
  if (!(*bytes_)->Read(0, std::as_writable_bytes(std::span(start_))).ok()) start_.clear();
}

const absl::StatusOr<netcdf::NetcdfFile>& UnknownFile::Netcdf() const {
  if (!netcdf_.has_value()) netcdf_.emplace(netcdf::NetcdfFile::Open(path_));
  return *netcdf_;
}

bool StormFormat::MayBegin(std::string_view) const { return false; }

absl::Status StormFormats::CheckStart(const std::string& path, int file) const {
  std::string start(UnknownFile::kStart_bytes, '\0');
  const ssize_t count = pread(file, start.data(), start.size(), 0);
  start.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (BeginsLikeVdb(start)) return RefuseVdb(path);
  struct stat information = {};
  const bool has_size = fstat(file, &information) == 0;
  bool known = false;
  for (const std::shared_ptr<const StormFormat>& format : formats_) {
    if (!format->MayBegin(start)) continue;
    known = true;
    if (!has_size) continue;
    THUNDERHEAD_RETURN_IF_ERROR(
        format->CheckNeighbours(path, start, static_cast<std::uint64_t>(information.st_size)));
  }
  // NetCDF files may be locked by their writer.
  const bool checked = known && !netcdf::NetcdfFile::BeginsLikeNetcdf(start);
  return checked ? absl::OkStatus() : netcdf::NetcdfFile::CheckStart(path, file);
}

absl::Status StormFormats::PrepareBeforeConfinement(
    const std::vector<std::string_view>& starts) const {
  for (const std::shared_ptr<const StormFormat>& format : formats_) {
    const auto may_begin = [&](std::string_view start) { return format->MayBegin(start); };
    if (std::ranges::none_of(starts, may_begin)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(format->PrepareBeforeConfinement());
  }
  return absl::OkStatus();
}

absl::StatusOr<StormFile> StormFormat::DescribeTogether(
    const std::vector<UnknownFile>& files) const {
  return absl::InternalError(absl::StrCat(files.front().Path(), ": ", std::string(Name()),
                                          " does not spread a time over several files"));
}

absl::StatusOr<const StormFormat*> StormFormats::FormatOf(const UnknownFile& file) const {
  FormatFit best = FormatFit::kNone;
  std::vector<const StormFormat*> fitting;  // the formats whose fit is `best`
  for (const std::shared_ptr<const StormFormat>& format : formats_) {
    const FormatFit fit = format->Sniff(file);
    if (fit == FormatFit::kNone || fit < best) continue;
    if (fit > best) fitting.clear();
    best = fit;
    fitting.push_back(format.get());
  }
  if (fitting.empty()) return NoneFits(file);
  // A file that is only related to formats cannot be read. The first of them is returned, because
  // its Describe gives the reason.
  if (fitting.size() == 1 || best == FormatFit::kRelated) return fitting.front();
  const auto append_name = [](std::string* out, const StormFormat* format) {
    out->append(format->Name());
  };
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": could be any of ", absl::StrJoin(fitting, ", ", append_name),
      ", which are read differently; give a file that matches only one of these formats"));
}

absl::StatusOr<StormFile> StormFormats::Describe(const std::string& path) const {
  if (elsewhere_.describe) return elsewhere_.describe(path);
  const UnknownFile file(path);
  THUNDERHEAD_ASSIGN_OR_RETURN(const StormFormat* const format, FormatOf(file));
  THUNDERHEAD_ASSIGN_OR_RETURN(StormFile described, format->Describe(file));
  THUNDERHEAD_RETURN_IF_ERROR(CheckStorms(described));
  return described;
}

std::vector<absl::StatusOr<StormFile>> StormFormats::DescribeEach(
    const std::vector<std::string>& paths, std::chrono::milliseconds patience) const {
  if (elsewhere_.describe_each) return elsewhere_.describe_each(paths, patience);
  std::vector<absl::StatusOr<StormFile>> files;
  files.reserve(paths.size());
  for (const std::string& path : paths) files.push_back(Describe(path));
  return files;
}

absl::StatusOr<StormFile> StormFormats::DescribeTogether(
    const std::vector<std::string>& paths) const {
  if (elsewhere_.describe_together) return elsewhere_.describe_together(paths);
  std::vector<UnknownFile> files;
  files.reserve(paths.size());
  for (const std::string& path : paths) files.emplace_back(path);
  THUNDERHEAD_ASSIGN_OR_RETURN(const StormFormat* const format, FormatOf(files.front()));
  THUNDERHEAD_ASSIGN_OR_RETURN(StormFile described, format->DescribeTogether(files));
  described.path = paths.front();
  described.parts = paths;
  THUNDERHEAD_RETURN_IF_ERROR(CheckStorms(described));
  return described;
}

absl::Status StormFormats::NoneFits(const UnknownFile& file) const {
  if (!file.Netcdf().ok()) return file.Netcdf().status();
  std::string message = absl::StrCat(file.Path(), ": is ");
  for (std::size_t i = 0; i < formats_.size(); ++i) {
    const char* first = formats_.size() > 1 ? "neither " : "not ";
    absl::StrAppend(&message, i == 0 ? first : " nor ", std::string(formats_[i]->Requirement()));
  }
  const char* formats = formats_.size() > 1 ? "one of these formats" : "this format";
  return absl::InvalidArgumentError(absl::StrCat(message, "; give a file in ", formats));
}

std::string StormFormats::Examples() const {
  std::string examples;
  for (std::size_t i = 0; i < formats_.size(); ++i) {
    const char* next = i + 1 < formats_.size() ? ", " : ", or ";
    absl::StrAppend(&examples, i == 0 ? "" : next, std::string(formats_[i]->Example()));
  }
  return examples;
}

}  // namespace thunderhead::storm_files
