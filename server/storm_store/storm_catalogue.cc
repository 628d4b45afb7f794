#include "storm_store/storm_catalogue.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/utf8.h"
#include "spdlog/spdlog.h"
#include "storm_store/assembled_storm.h"
#include "storm_store/described_files.h"
#include "storm_store/folder_walk.h"
#include "storm_store/runs_of_files.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;

// A storm that was found below the path with this index.
struct NamedStorm : NamedFiles {
  std::size_t path = 0;
};

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
  for (NamedFiles& run : GroupRuns(folder.path, std::move(files))) {
    storms.push_back({std::move(run)});
  }
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
      alone.ok()
          ? advice
          : absl::StrCat(alone.message(), ". If the file is one of several files of a time, ",
                         "give the folder with all of them"));
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
    storms.push_back({{NameOfFile(at) + (files.size() > 1 ? name : ""), {}}});
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
  std::vector<ListedFolder> folders;  // if the path is a file: its folder, with only this file
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
        named.push_back({{storm.name, storm.files}});
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
