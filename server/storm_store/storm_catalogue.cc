#include "storm_store/storm_catalogue.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "base/status.h"
#include "base/utf8.h"
#include "spdlog/spdlog.h"
#include "storm_store/described_files.h"
#include "storm_store/folder_walk.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;

// Maximum number of notes about one storm, and of its times whose own map projection is checked. A
// file may have a million times.
constexpr std::size_t kMostNotes = 100;
constexpr std::size_t kMostProjections = 10'000;

struct NamedStorm {
  std::string name;
  std::vector<storm_files::StormFile> files;
  std::size_t path = 0;  // index of the user's path
};

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

// Returns the file's name without a netCDF extension. Other dots stay, because they may be part of
// a date.
std::string NameOfFile(const fs::path& path) {
  const std::string extension = path.extension().string();
  const bool known = extension == ".nc" || extension == ".nc4" || extension == ".cdf";
  return known ? path.stem().string() : path.filename().string();
}

std::string NameOfFolder(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::canonical(path, error);
  return (error ? path : canonical).filename().string();
}

// Returns a key that is equal for files that may be parts of one run.
auto RunKey(const storm_files::StormFile& file) {
  // The distances between columns change a little with a moving nest.
  const std::string grid = !file.grid.empty()
                               ? file.grid
                               : absl::StrFormat("%d x %d, %.17g x %.17g", file.cells.x,
                                                 file.cells.y, file.dx_m, file.dy_m);
  return std::make_tuple(file.domain, grid, file.cells.z, file.run, file.member);
}

// Returns whether the files belong to one run. The times of such files overlap at most at their
// ends, for example after a restart. Separate runs on the same grid, such as an ensemble's members,
// share most of their times.
bool ContinueOneAnother(const std::vector<storm_files::StormFile>& files) {
  std::set<absl::Time> distinct;
  std::size_t total = 0;
  for (const storm_files::StormFile& file : files) {
    distinct.insert(file.times.begin(), file.times.end());
    total += file.times.size();
  }
  return distinct.size() * 2 > total;
}

// The search below one path that the user gave.
struct PathSearch {
  const StormSearch& search;
  absl::Status first_failure = absl::OkStatus();
};

// Records why the file or folder `path` is left out of the search.
void LeaveOut(PathSearch& path_search, const std::string& path, const absl::Status& why) {
  path_search.first_failure.Update(why);
  if (path_search.search.on_unlisted) {
    path_search.search.on_unlisted(path, why);
  } else {
    spdlog::warn("left out: {}", std::string(why.message()));
  }
}

absl::Status Stopped() { return absl::CancelledError("the search for storms was interrupted"); }

// Each member of an ensemble is a separate storm.
std::string WithMember(const std::string& name, const storm_files::StormFile& file) {
  return file.member.empty() ? name : absl::StrCat(name, "/", file.member);
}

// Returns the name of a storm that is in one file. `runs` is the number of runs in that file.
std::string NameInFile(const std::string& name, const storm_files::StormFile& file,
                       std::size_t runs) {
  const std::optional<absl::Time> start = file.run_start;
  if (runs < 2 || !start.has_value()) return WithMember(name, file);
  return WithMember(
      absl::StrCat(name, "/", absl::FormatTime("%E4Y-%m-%dT%H:%M", *start, absl::UTCTimeZone())),
      file);
}

// Adds an assumption to files with fewer layers than others of their run on the same columns,
// because they may have been cut short. Such a file becomes a separate storm.
void NoteFewerLayers(std::vector<storm_files::StormFile>& files) {
  const auto key = [](const storm_files::StormFile& file) {
    return std::tuple(file.domain, file.grid, file.cells.x, file.cells.y, file.run, file.member);
  };
  std::map<decltype(key(files[0])), int> most;
  for (const storm_files::StormFile& file : files) {
    int& layers = most[key(file)];
    layers = std::max(layers, file.cells.z);
  }
  for (storm_files::StormFile& file : files) {
    const int layers = most[key(file)];
    if (file.run.empty() || file.cells.z == layers) continue;
    file.assumptions.push_back(absl::StrCat("This file has ", file.cells.z, " layers, and others ",
                                            "of its run have ", layers,
                                            ": it may have been cut short."));
  }
}

// Nested domains of one run are often in one folder, so their names get the domain's number.
void NameDomains(const std::vector<std::size_t>& series, std::vector<NamedStorm>& storms) {
  std::set<std::string> names;
  for (const std::size_t i : series) names.insert(storms[i].name);
  if (names.size() == series.size()) return;
  for (const std::size_t i : series) {
    absl::StrAppend(&storms[i].name, "-d", absl::Dec(storms[i].files[0].domain, absl::kZeroPad2));
  }
}

// Groups a folder's files into runs. Files that do not continue one another become separate storms.
std::vector<NamedStorm> GroupRuns(const fs::path& folder,
                                  std::vector<storm_files::StormFile> files) {
  NoteFewerLayers(files);
  std::map<std::string, std::set<std::string>> runs;  // of each file
  for (const storm_files::StormFile& file : files) runs[file.path].insert(file.run);
  std::vector<NamedStorm> storms;
  std::vector<std::size_t> series;
  for (std::vector<storm_files::StormFile>& run : FilesOfRuns(std::move(files))) {
    if (run.size() > 1 && ContinueOneAnother(run)) {
      series.push_back(storms.size());
      const std::string name = WithMember(NameOfFolder(folder), run.front());
      storms.push_back({name, std::move(run)});
      continue;
    }
    for (storm_files::StormFile& file : run) {
      // If a time is spread over several files, the storm is named after the folder.
      const std::string name = file.parts.empty() ? NameOfFile(file.path) : NameOfFolder(folder);
      storms.push_back({NameInFile(name, file, runs[file.path].size()), {}});
      storms.back().files.push_back(std::move(file));
    }
  }
  NameDomains(series, storms);
  return storms;
}

// The files of one run and member whose times are spread over several files each.
struct PartsOfRun {
  std::vector<std::string> at_all_times;
  std::map<absl::Time, std::vector<std::string>> at;
};

// By StormPart::of and StormFile::member.
using PartsOfRuns = std::map<std::pair<std::string, std::string>, PartsOfRun>;

void Add(const storm_files::StormFile& part, PartsOfRuns& runs) {
  PartsOfRun& run = runs[{part.part.of, part.member}];
  if (part.part.at_all_times) run.at_all_times.push_back(part.path);
  for (const absl::Time time : part.times) run.at[time].push_back(part.path);
}

// Gives each member of an ensemble the files of no member that belong to all times, such as the
// heights of the layers.
void ShareWithMembers(PartsOfRuns& runs) {
  for (auto& [key, run] : runs) {
    const auto shared = runs.find({key.first, ""});
    if (key.second.empty() || shared == runs.end()) continue;
    const std::vector<std::string>& paths = shared->second.at_all_times;
    run.at_all_times.insert(run.at_all_times.end(), paths.begin(), paths.end());
  }
  std::erase_if(runs, [&runs](const auto& entry) {
    const auto& [of, member] = entry.first;
    const auto next = runs.upper_bound(entry.first);
    return member.empty() && entry.second.at.empty() && next != runs.end() &&
           next->first.first == of;
  });
}

// Reports a file that is left out. A file of another kind, such as a read-me, is normal. A storm
// that cannot be read deserves a warning.
void ReportLeftOut(PathSearch& path_search, const absl::Status& why) {
  if (absl::IsCancelled(why)) return;
  path_search.first_failure.Update(why);
  if (path_search.search.on_left_out) return path_search.search.on_left_out(why);
  const bool other = absl::IsInvalidArgument(why);
  spdlog::log(other ? spdlog::level::info : spdlog::level::warn, "left out: {}",
              std::string(why.message()));
}

// Describes each time of the run. A time that lacks a file is left out.
std::vector<storm_files::StormFile> TimesOf(const PartsOfRun& run, const std::string& member,
                                            PathSearch& path_search) {
  std::vector<storm_files::StormFile> files;
  // Some files hold all times of the run. They are described once, for all their times.
  std::set<std::vector<std::string>> described;
  for (const auto& [time, parts] : run.at) {
    // The time's own files come first, because the first path identifies it in messages.
    std::vector<std::string> paths = parts;
    std::ranges::copy_if(run.at_all_times, std::back_inserter(paths),
                         [&parts = parts](const std::string& path) {
                           return std::ranges::find(parts, path) == parts.end();
                         });
    if (!described.insert(paths).second) continue;
    absl::StatusOr<storm_files::StormFile> whole = path_search.search.describe_together(paths);
    if (!whole.ok()) {
      ReportLeftOut(path_search, whole.status());
      continue;
    }
    // The files may also have other members.
    for (storm_files::StormFile& storm : StormsOf(*std::move(whole))) {
      if (storm.member == member) files.push_back(std::move(storm));
    }
  }
  if (run.at.empty() && !run.at_all_times.empty()) {
    ReportLeftOut(path_search,
                  absl::InvalidArgumentError(absl::StrCat(
                      run.at_all_times.front(), ": belongs to all times of a run, and no ",
                      "file of this run with a time is beside it; put them together")));
  }
  return files;
}

// Appends the storms of a folder's files.
void SearchFolder(const ListedFolder& folder, PathSearch& path_search,
                  std::vector<NamedStorm>& storms) {
  std::vector<storm_files::StormFile> files;
  PartsOfRuns runs;
  for (absl::StatusOr<storm_files::StormFile>& described :
       path_search.search.describe(folder.files)) {
    if (!described.ok()) {
      ReportLeftOut(path_search, described.status());
      continue;
    }
    for (storm_files::StormFile& storm : StormsOf(*std::move(described))) {
      if (storm.part.of.empty()) {
        files.push_back(std::move(storm));
      } else {
        Add(storm, runs);
      }
    }
  }
  ShareWithMembers(runs);
  for (const auto& [key, run] : runs) {
    std::ranges::move(TimesOf(run, key.second, path_search), std::back_inserter(files));
  }
  if (files.empty()) return;
  std::ranges::move(GroupRuns(folder.path, std::move(files)), std::back_inserter(storms));
}

// Returns the error for a file that is only a part of a storm. The error says what the file lacks.
absl::Status IsPartOfTime(const std::string& path, const fs::path& at,
                          const storm_files::StormFile& file, const StormSearch& search) {
  if (!file.about.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        path, ": holds only a part of a storm: ", base::Printable(file.about),
        "; add what is missing to the file, or, if it is one of several files of a time, give the ",
        "folder with all of them"));
  }
  const std::string advice =
      absl::StrCat(path, ": is one of several files of a time; give the folder with all of them");
  if (!search.describe_together) return absl::InvalidArgumentError(advice);
  const absl::Status alone = search.describe_together({at.string()}).status();
  return absl::InvalidArgumentError(
      alone.ok() ? advice : absl::StrCat(advice, ". Alone it lacks this: ", alone.message()));
}

// Appends the storms of one file, or the one that the path names.
absl::Status SearchFile(const std::string& path, const StormSearch& search,
                        std::vector<NamedStorm>& storms) {
  const fs::path at = FileOfStorm(path);
  THUNDERHEAD_ASSIGN_OR_RETURN(storm_files::StormFile file, search.describe({at.string()}).front());
  if (!file.part.of.empty()) return IsPartOfTime(path, at, file, search);
  const std::string wanted = fs::path(path).lexically_relative(at).string();
  std::vector<storm_files::StormFile> files = StormsOf(std::move(file));
  std::set<std::string> runs;
  for (const storm_files::StormFile& each : files) runs.insert(each.run);
  std::string names;
  for (storm_files::StormFile& each : files) {
    const std::string name = NameInFile("", each, runs.size());
    absl::StrAppend(&names, names.empty() ? "" : ", ", at.string(), name);
    if (wanted != "." && "/" + wanted != name) continue;
    storms.push_back({NameOfFile(at) + (files.size() > 1 ? name : ""), {}});
    storms.back().files.push_back(std::move(each));
    if (wanted != ".") return absl::OkStatus();
  }
  if (wanted == ".") return absl::OkStatus();
  return absl::NotFoundError(absl::StrCat(path, ": there is no such storm in the file; it has ",
                                          files.size() > 1 ? names : "only one, without a name"));
}

// The folders and files below a path that the user gave.
struct ListedPath {
  bool hangs = false;
  bool is_folder = false;
  bool is_missing = false;
  std::vector<ListedFolder> folders;  // of a file, its folder with the file
};

absl::StatusOr<ListedPath> ListPath(const std::string& path, const LinkRules& links,
                                    PathSearch& path_search) {
  const StormSearch& search = path_search.search;
  ListedPath listed;
  listed.hangs = search.answers && !search.answers(path);
  if (listed.hangs) return listed;
  std::error_code error;
  listed.is_missing = search.may_find_nothing &&
                      fs::status(FileOfStorm(path), error).type() == fs::file_type::not_found;
  if (listed.is_missing) return listed;
  listed.is_folder = fs::is_directory(path, error);
  if (!listed.is_folder) {
    const fs::path file = FileOfStorm(path);
    listed.folders = {{file.parent_path().string(), {file.string()}}};
    return listed;
  }
  const FolderWalk walk{
      .links = links,
      .on_folder = search.on_folder,
      .on_left_out = [&](const std::string& below,
                         const absl::Status& why) { LeaveOut(path_search, below, why); },
      .known_below = search.known_below,
      .most_entries = search.most_entries,
      .stop = search.stop};
  THUNDERHEAD_ASSIGN_OR_RETURN(listed.folders, ListFolders(path, walk));
  return listed;
}

// Appends the storms of a path that does not hang.
absl::Status Search(const std::string& path, const ListedPath& listed, PathSearch& path_search,
                    std::vector<NamedStorm>& storms) {
  const StormSearch& search = path_search.search;
  if (listed.is_missing) return absl::OkStatus();
  if (!listed.is_folder) {
    const absl::Status found = SearchFile(path, search, storms);
    return search.may_find_nothing ? absl::OkStatus() : found;
  }
  const std::size_t before = storms.size();
  for (const ListedFolder& folder : listed.folders) {
    if (search.stop.stop_requested()) return Stopped();
    SearchFolder(folder, path_search, storms);
  }
  if (storms.size() > before || search.may_find_nothing) return absl::OkStatus();
  if (!path_search.first_failure.ok()) {
    return base::Annotate(path_search.first_failure,
                          absl::StrCat(path, " holds no storm; its first file"));
  }
  return absl::NotFoundError(absl::StrCat(path, ": holds no storm; put the model's output files (",
                                          search.examples, ") there"));
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

// The place of a file that was found.
struct FoundPlace {
  std::string key;  // equal for the same storm of the same file
  bool is_linked;   // whether a link below the searched path leads to it
};

// `searched` is the path below which the file was found, and `root` the same without links.
FoundPlace PlaceOf(const storm_files::StormFile& file, const fs::path& searched,
                   const fs::path& root) {
  std::error_code error;
  fs::path canonical = fs::canonical(file.path, error);
  if (error) canonical = file.path;
  const fs::path direct =
      (root / fs::path(file.path).lexically_relative(searched)).lexically_normal();
  FoundPlace place{canonical.string(), direct != canonical && direct != canonical / ""};
  // Two times, or two storms, may share their first file, if it holds both.
  if (!file.parts.empty()) absl::StrAppend(&place.key, " ", absl::FormatTime(file.times.front()));
  absl::StrAppend(&place.key, " ", file.first_record);
  return place;
}

// Drops files that were found before under another path, and links to files that were found
// themselves. If the link stayed instead, its owner could later exchange the storm for another.
void DropRepeated(const std::vector<std::string>& paths, std::vector<NamedStorm>& storms) {
  std::vector<fs::path> roots;
  for (const std::string& path : paths) {
    std::error_code error;
    const fs::path root = fs::weakly_canonical(path, error);
    roots.push_back(error ? fs::path(path) : root);
  }
  std::set<std::string> seen;
  bool any_linked = false;
  const auto drop = [&](bool linked) {
    for (NamedStorm& storm : storms) {
      std::erase_if(storm.files, [&](const storm_files::StormFile& file) {
        const FoundPlace place = PlaceOf(file, paths[storm.path], roots[storm.path]);
        any_linked |= place.is_linked;
        return place.is_linked == linked && !seen.insert(place.key).second;
      });
    }
  };
  drop(false);
  if (any_linked) drop(true);
  std::erase_if(storms, [](const NamedStorm& storm) { return storm.files.empty(); });
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

}  // namespace

absl::Status CheckPlace(const std::vector<std::string>& paths, const LinkPolicy& links,
                        const std::string& path, const std::string& place) {
  const LinkRules rules = LinkRulesOf(paths, links);
  const auto refused = [&] {
    return absl::PermissionDeniedError(
        absl::StrCat(path, ": lies at ", place, ", where no link may lead; put the file itself ",
                     "into the data folder, or see --allow-links-to"));
  };
  if (!IsWithinAny(place, rules.targets)) return refused();
  const auto written = [](const fs::path& each) {
    const fs::path normal = fs::absolute(each).lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();
  };
  // No link is followed in an untrusted folder, so a file found there must really be there.
  for (const std::string& untrusted : links.untrusted) {
    std::error_code error;
    const fs::path folder = fs::canonical(untrusted, error);
    if (error) continue;
    const bool is_below =
        IsWithin(written(path), written(untrusted)) || IsWithin(written(path), folder);
    if (is_below && !IsWithin(place, folder)) return refused();
  }
  return absl::OkStatus();
}

std::vector<std::vector<storm_files::StormFile>> FilesOfRuns(
    std::vector<storm_files::StormFile> files) {
  std::map<decltype(RunKey(files[0])), std::vector<storm_files::StormFile>> by_key;
  for (storm_files::StormFile& file : files) {
    for (storm_files::StormFile& storm : StormsOf(std::move(file))) {
      by_key[RunKey(storm)].push_back(std::move(storm));
    }
  }
  std::vector<std::vector<storm_files::StormFile>> runs;
  runs.reserve(by_key.size());
  for (auto& [key, run] : by_key) runs.push_back(std::move(run));
  return runs;
}

namespace {

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
    storm.info.times[time].elapsed_s = absl::ToDoubleSeconds(valid - first);
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

void LogNotes(const std::vector<CataloguedStorm>& storms, std::set<std::string>* logged) {
  for (const CataloguedStorm& storm : storms) {
    for (const std::string& note : storm.notes) {
      if (logged == nullptr || logged->insert(note).second) spdlog::warn("{}", note);
    }
  }
}

absl::Status CheckFile(const std::string& path, const storm_files::StormFormats& formats) {
  const StormSearch search{.describe =
                               [&](const std::vector<std::string>& files) {
                                 return DescribeInBatches(files, formats, [] { return true; });
                               },
                           .describe_together = {},
                           .on_unlisted = {},
                           .on_folder = {},
                           .examples = {}};
  std::vector<NamedStorm> storms;
  return SearchFile(path, search, storms);
}

absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const storm_files::StormFormats& formats,
                                                        const LinkPolicy& links,
                                                        const std::stop_token& stop) {
  const auto describe = [&](const std::vector<std::string>& files) {
    return DescribeInBatches(files, formats, [&stop] { return !stop.stop_requested(); });
  };
  const auto together = [&](const std::vector<std::string>& files) {
    return formats.DescribeTogether(files);
  };
  auto storms = FindStorms(paths, {.describe = describe,
                                   .describe_together = together,
                                   .on_unlisted = {},
                                   .on_folder = {},
                                   .examples = formats.Examples(),
                                   .links = links,
                                   .stop = stop});
  if (storms.ok()) LogNotes(*storms);
  return storms;
}

absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormSearch& search) {
  std::vector<NamedStorm> named;
  const LinkRules links = LinkRulesOf(paths, search.links);
  std::vector<PathSearch> searches(paths.size(), PathSearch{search});
  std::vector<ListedPath> listed;
  for (std::size_t path = 0; path < paths.size(); ++path) {
    THUNDERHEAD_ASSIGN_OR_RETURN(listed.emplace_back(),
                                 ListPath(paths[path], links, searches[path]));
  }
  if (search.stop.stop_requested()) return Stopped();
  if (search.prepare) {
    std::vector<ListedFolder> folders;
    for (const ListedPath& each : listed) std::ranges::copy(each.folders, back_inserter(folders));
    search.prepare(folders);
  }
  for (std::size_t path = 0; path < paths.size(); ++path) {
    const std::size_t before = named.size();
    if (listed[path].hangs) {
      for (const NamedFiles& storm : (*search.found)[paths[path]]) {
        named.push_back({storm.name, storm.files});
      }
    } else {
      const absl::Status searched = Search(paths[path], listed[path], searches[path], named);
      if (search.stop.stop_requested()) return Stopped();
      THUNDERHEAD_RETURN_IF_ERROR(searched);
    }
    for (std::size_t i = before; i < named.size(); ++i) named[i].path = path;
    if (search.found == nullptr) continue;
    std::vector<NamedFiles>& found = (*search.found)[paths[path]];
    found.clear();
    for (std::size_t i = before; i < named.size(); ++i) {
      found.push_back({named[i].name, named[i].files});
    }
  }
  if (named.empty() && !search.may_find_nothing) {
    return absl::InvalidArgumentError(absl::StrCat(
        "no storm to show; name a file or folder of model output (", search.examples, ")"));
  }
  DropRepeated(paths, named);
  std::vector<CataloguedStorm> storms;
  std::set<std::string> ids;
  std::map<std::string, int> copies;  // the last number that was appended to an id
  for (NamedStorm& storm : named) {
    // The part of the name behind the file's name identifies the storm in the file, as "/mem05".
    const std::string in_file =
        storm.name.substr(std::min(storm.name.find('/'), storm.name.size()));
    storms.push_back(AssembleStorm(storm.name, std::move(storm.files)));
    StormInfo& info = storms.back().info;
    if (info.files.size() == 1) info.path = info.files.front() + in_file;
    storms.back().path = storm.path;
    const std::string& stem = storms.back().stem;
    int& copy = copies.try_emplace(stem, 1).first->second;
    while (!ids.insert(info.id).second) info.id = absl::StrCat(stem, "-", ++copy);
  }
  std::ranges::sort(storms, {}, [](const CataloguedStorm& storm) {
    return std::pair(storm.path, storm.info.id);
  });
  return storms;
}

}  // namespace thunderhead::storm_store
