#include "volume/storm_format.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace thunderhead::volume {

absl::StatusOr<StormFile> StormFormats::Describe(const std::string& path) const {
  const UnknownFile file{path, NetcdfFile::Open(path)};
  FormatFit best = FormatFit::kNone;
  std::vector<const StormFormat*> fitting;  // as well as `best`
  for (const std::shared_ptr<const StormFormat>& format : formats_) {
    const FormatFit fit = format->Sniff(file);
    if (fit == FormatFit::kNone || fit < best) continue;
    if (fit > best) fitting.clear();
    best = fit;
    fitting.push_back(format.get());
  }
  if (fitting.empty()) return NoneFits(file);
  if (fitting.size() == 1) return fitting.front()->Describe(file);
  const auto append_name = [](std::string* out, const StormFormat* format) {
    out->append(format->Name());
  };
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": could be any of ", absl::StrJoin(fitting, ", ", append_name),
                   ", which are read differently; give a file with the marks of one only"));
}

absl::Status StormFormats::NoneFits(const UnknownFile& file) const {
  if (!file.netcdf.ok()) return file.netcdf.status();
  std::string message = absl::StrCat(file.path, ": is ");
  for (std::size_t i = 0; i < formats_.size(); ++i) {
    const char* first = formats_.size() > 1 ? "neither " : "not ";
    absl::StrAppend(&message, i == 0 ? first : " nor ", std::string(formats_[i]->Requirement()));
  }
  return absl::InvalidArgumentError(absl::StrCat(message, "; give a file that is"));
}

std::string StormFormats::Examples() const {
  std::string examples;
  for (std::size_t i = 0; i < formats_.size(); ++i) {
    const char* next = i + 1 < formats_.size() ? ", " : ", or ";
    absl::StrAppend(&examples, i == 0 ? "" : next, std::string(formats_[i]->Example()));
  }
  return examples;
}

}  // namespace thunderhead::volume
