#include "storm_store/assembled_storm.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "base/status.h"
#include "base/utf8.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;

// Maximum number of notes about one storm, and of its times whose own map projection is checked. A
// file may have 100 000 times.
constexpr std::size_t kMostNotes = 100;
constexpr std::size_t kMostProjections = 10'000;

// Formats a time as ISO 8601, e.g. "0001-01-01T00:40:00Z".
std::string FormatValidTime(absl::Time time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", time, absl::UTCTimeZone());
}

// Returns an id that is safe in a URL and on a command line. Colons become hyphens in
// "wrfout_d01_0001-01-01_00:10:00", for example.
std::string IdFrom(const std::string& name) {
  constexpr std::size_t kLongest = 128;
  std::string id = name.substr(0, kLongest);
  for (char& c : id) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '_' && c != '-') {
      c = '-';
    }
  }
  return id.empty() ? "storm" : id;
}

std::string TitleOf(const std::string& name, const storm_files::StormFile& file) {
  return base::Printable(file.about.empty() ? name : absl::StrCat(name, " (", file.about, ")"));
}

// Returns the middle of the domain at a record if it differs from that of the storm's first file,
// because the domain moves.
std::optional<volume::EarthPlace> MiddleAt(const storm_files::StormFile& file, std::size_t record,
                                           const storm_files::StormFile& first) {
  if (!file.middles.empty()) return file.middles[record];
  const bool stays =
      file.latitude_deg == first.latitude_deg && file.longitude_deg == first.longitude_deg;
  if (stays || !file.latitude_deg.has_value() || !file.longitude_deg.has_value()) {
    return std::nullopt;
  }
  return volume::EarthPlace{*file.latitude_deg, *file.longitude_deg};
}

const std::string& ProjectionAt(const storm_files::StormFile& file, std::size_t record) {
  return file.projections.empty() ? file.projection : file.projections[record];
}

// Returns whether `later` was written at least as late as `file`. If both were written at the same
// time, the one with the later name counts as written later.
bool WasWrittenLater(const storm_files::StormFile& file, const storm_files::StormFile& later) {
  return std::tie(later.modified_ns, later.path) >= std::tie(file.modified_ns, file.path);
}

// Returns a note for users about a time that two records have.
std::string NoteOfDouble(const std::vector<storm_files::StormFile>& files, absl::Time time,
                         const TimeSource& used, const TimeSource& other) {
  const storm_files::StormFile& file = files[used.file];
  if (used.file == other.file) {
    return absl::StrCat(file.path, ": has the time ", FormatValidTime(time), " twice, in records ",
                        other.record, " and ", used.record, "; the later record is used");
  }
  const bool newer = file.modified_ns != files[other.file].modified_ns;
  return absl::StrCat(FormatValidTime(time), " is in ", files[other.file].path, " and in ",
                      file.path, "; the latter is used, ",
                      newer ? "because it was written later" : "because its name is later");
}

// Leaves out the earliest times of a series that has more than a storm may have, and adds a note.
void LeaveOutEarliest(const std::string& name, std::map<absl::Time, TimeSource>& sources,
                      std::vector<std::string>& notes) {
  if (sources.size() <= storm_files::kMaxTimes) return;
  const std::size_t left_out = sources.size() - storm_files::kMaxTimes;
  sources.erase(sources.begin(), std::next(sources.begin(), static_cast<std::ptrdiff_t>(left_out)));
  notes.push_back(absl::StrCat(name, ": its earliest ", left_out,
                               " times are left out, because a storm has at most ",
                               storm_files::kMaxTimes, " times"));
}

// Returns the fields that any of the files has, and adds a note for each field that some lack.
std::vector<physics::Hydrometeor> FieldsOfAny(const std::vector<storm_files::StormFile>& files,
                                              std::vector<std::string>& notes) {
  std::vector<physics::Hydrometeor> fields;
  for (const physics::Hydrometeor field : physics::kHydrometeors) {
    const auto lacks = [field](const storm_files::StormFile& file) {
      return std::ranges::find(file.fields, field) == file.fields.end();
    };
    const std::ptrdiff_t lacking = std::ranges::count_if(files, lacks);
    if (lacking == std::ssize(files)) continue;
    fields.push_back(field);
    if (lacking == 0) continue;
    const std::string& first = std::ranges::find_if(files, lacks)->path;
    const std::string field_name(physics::NameOf(field));
    notes.push_back(
        lacking == 1
            ? absl::StrCat(first, ": has no ", field_name,
                           ", which other files of the run have; its times are drawn without it")
            : absl::StrCat(first, " and ", lacking - 1, " more files have no ", field_name,
                           ", which other files of the run have; their times are drawn without "
                           "it"));
  }
  return fields;
}

// Adds the first of the notes to the texts that users see. These users need not know in which
// folders the server has its files.
void AddNotes(const std::vector<std::string>& notes,
              const std::vector<storm_files::StormFile>& files, std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 5;
  for (std::size_t i = 0; i < std::min(notes.size(), kMost); ++i) {
    std::string text = notes[i];
    for (const storm_files::StormFile& file : files) {
      const std::string folder = fs::path(file.path).parent_path().string() + "/";
      if (folder != "/") text = absl::StrReplaceAll(text, {{folder, ""}});
    }
    texts.push_back(base::Printable(text));
  }
  if (notes.size() > kMost) {
    texts.push_back(absl::StrCat("There are ", notes.size() - kMost, " more notes in the log."));
  }
}

// Returns the map projection at a time of the storm if PROJ accepts it, and an empty text
// otherwise. The file is untrusted, so this is also the check of its text.
std::string CheckedProjection(std::size_t time, CataloguedStorm& storm) {
  const storm_files::StormFile& file = FileOf(storm, time);
  const std::string& text = ProjectionAt(file, storm.sources[time].record);
  const std::optional<volume::EarthPlace> middle = MiddleOf(storm.info, time);
  if (text.empty() || !middle.has_value()) return "";
  const auto projection = volume::MapProjection::Of(text, *middle);
  if (projection.ok()) return text;
  std::string note = absl::StrCat(file.path, ": the storm is shown without a map: ",
                                  std::string(projection.status().message()));
  if (storm.notes.size() > kMostNotes) return "";
  if (std::ranges::find(storm.notes, note) == storm.notes.end()) {
    storm.notes.push_back(std::move(note));
  }
  return "";
}

// Sets the map projection of the storm's first time, and that of other times if it differs.
void SetProjections(CataloguedStorm& storm) {
  StormInfo& info = storm.info;
  info.projection = CheckedProjection(0, storm);
  if (const auto projection = ProjectionOf(info, 0); projection.has_value()) {
    info.true_north_deg = projection->TrueNorth_deg(*MiddleOf(info, 0)).value_or(0.0);
  }
  const std::string& first = ProjectionAt(FileOf(storm, 0), storm.sources[0].record);
  std::size_t checked = 0;
  for (std::size_t time = 1; time < info.times.size(); ++time) {
    if (ProjectionAt(FileOf(storm, time), storm.sources[time].record) == first) continue;
    const bool is_checked = ++checked <= kMostProjections;
    info.times[time].projection = is_checked ? CheckedProjection(time, storm) : "";
  }
  if (checked > kMostProjections) {
    storm.notes.push_back(absl::StrCat(info.id, ": ", checked - kMostProjections,
                                       " of its times are shown without a map, because more than ",
                                       kMostProjections, " have a map projection of their own"));
  }
}

}  // namespace

void CountTimes(CataloguedStorm& storm) {
  const absl::Time first = ValidTimeOf(storm, 0);
  for (std::size_t time = 0; time < storm.sources.size(); ++time) {
    const storm_files::StormFile& file = FileOf(storm, time);
    const absl::Time start =
        storm.info.run_start.has_value() ? file.run_start.value_or(first) : first;
    const absl::Time valid = ValidTimeOf(storm, time);
    storm.info.times[time].elapsed_s =
        absl::ToDoubleSeconds(storm_files::DurationIn(file.calendar, first, valid));
    storm.info.times[time].lead_s =
        absl::ToDoubleSeconds(storm_files::DurationIn(file.calendar, start, valid));
  }
}

CataloguedStorm AssembleStorm(const std::string& name, std::vector<storm_files::StormFile> files) {
  THUNDERHEAD_CHECK(!files.empty(), name);
  std::ranges::sort(files, {}, &storm_files::StormFile::path);
  CataloguedStorm storm;
  std::map<absl::Time, TimeSource> sources;
  std::size_t more_doubles = 0;
  for (std::size_t file = 0; file < files.size(); ++file) {
    for (std::size_t record = 0; record < files[file].times.size(); ++record) {
      const absl::Time time = files[file].times[record];
      const TimeSource source{file, record};
      const auto [at, added] = sources.try_emplace(time, source);
      if (added) continue;
      TimeSource& kept = at->second;
      const TimeSource other = kept;
      if (WasWrittenLater(files[kept.file], files[file])) kept = source;
      if (storm.notes.size() >= kMostNotes) {
        ++more_doubles;
        continue;
      }
      storm.notes.push_back(NoteOfDouble(files, time, kept, kept.file == file ? other : source));
    }
  }
  if (more_doubles > 0) {
    storm.notes.push_back(
        absl::StrCat(name, ": ", more_doubles, " more of its times are there several times"));
  }
  LeaveOutEarliest(name, sources, storm.notes);
  StormInfo& info = storm.info;
  storm.stem = IdFrom(name);
  info.id = storm.stem;
  for (const auto& [time, source] : sources) {
    const storm_files::StormFile& file = files[source.file];
    info.times.push_back(
        {.valid_time = FormatValidTime(time), .file = file.path, .version = file.version});
    info.times.back().middle = MiddleAt(file, source.record, files[sources.begin()->second.file]);
    storm.sources.push_back(source);
  }
  for (const storm_files::StormFile& file : files) info.files.push_back(file.path);
  const storm_files::StormFile& first = files[storm.sources.front().file];
  info.title = TitleOf(name, first);
  info.file_cells = first.cells;
  info.dx_m = first.dx_m;
  info.dy_m = first.dy_m;
  info.fields = FieldsOfAny(files, storm.notes);
  info.latitude_deg = first.latitude_deg;
  info.longitude_deg = first.longitude_deg;
  // A series of analyses has a run for each time, so it has no single start.
  if (first.run_start.has_value() && std::ranges::all_of(files, [&](const auto& file) {
        return file.run_start == first.run_start;
      })) {
    info.run_start = FormatValidTime(*first.run_start);
  }
  for (const storm_files::StormFile& file : files) {
    for (const std::string& assumption : file.assumptions) {
      if (std::ranges::find(info.assumptions, assumption) == info.assumptions.end()) {
        info.assumptions.push_back(base::Printable(assumption));
      }
    }
  }
  storm.files = std::move(files);
  CountTimes(storm);
  SetProjections(storm);
  AddNotes(storm.notes, storm.files, info.assumptions);
  return storm;
}

}  // namespace thunderhead::storm_store
