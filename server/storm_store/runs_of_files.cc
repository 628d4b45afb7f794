#include "storm_store/runs_of_files.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;

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

// Returns the files in groups that have the same fields.
std::vector<std::vector<storm_files::StormFile>> ByFields(
    std::vector<storm_files::StormFile> files) {
  std::map<std::vector<physics::Hydrometeor>, std::vector<storm_files::StormFile>> groups;
  for (storm_files::StormFile& file : files) groups[file.fields].push_back(std::move(file));
  std::vector<std::vector<storm_files::StormFile>> list;
  list.reserve(groups.size());
  for (auto& [fields, group] : groups) list.push_back(std::move(group));
  return list;
}

// Each member of an ensemble is a separate storm.
std::string WithMember(const std::string& name, const storm_files::StormFile& file) {
  return file.member.empty() ? name : absl::StrCat(name, "/", file.member);
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

// Adds an assumption to files of one run that have most of their times in common.
void NoteSameTimes(std::vector<storm_files::StormFile>& run) {
  if (run.size() < 2) return;
  const std::string more =
      run.size() > 2 ? absl::StrCat(" and ", run.size() - 2, " more files have ") : " has ";
  for (std::size_t i = 0; i < run.size(); ++i) {
    const fs::path other = run[i == 0 ? 1 : 0].path;
    run[i].assumptions.push_back(absl::StrCat(
        other.filename().string(), more, "most or all of the same times on the same ",
        "grid, so each file is a separate storm. If they are copies, remove all but ", "one."));
  }
}

// Nested domains of one run are often in one folder, so their names get the domain's number.
void NameDomains(const std::vector<std::size_t>& series, std::vector<NamedFiles>& storms) {
  std::set<std::string> names;
  for (const std::size_t i : series) names.insert(storms[i].name);
  if (names.size() == series.size()) return;
  for (const std::size_t i : series) {
    absl::StrAppend(&storms[i].name, "-d", absl::Dec(storms[i].files[0].domain, absl::kZeroPad2));
  }
}

}  // namespace

std::string NameOfFile(const fs::path& path) {
  const std::string extension = path.extension().string();
  const bool known = extension == ".nc" || extension == ".nc4" || extension == ".cdf";
  return known ? path.stem().string() : path.filename().string();
}

std::string NameInFile(const std::string& name, const storm_files::StormFile& file,
                       std::size_t runs) {
  const std::optional<absl::Time> start = file.run_start;
  if (runs < 2 || !start.has_value()) return WithMember(name, file);
  return WithMember(
      absl::StrCat(name, "/", absl::FormatTime("%E4Y-%m-%dT%H:%M", *start, absl::UTCTimeZone())),
      file);
}

std::vector<NamedFiles> GroupRuns(const fs::path& folder,
                                  std::vector<storm_files::StormFile> files) {
  NoteFewerLayers(files);
  std::map<std::string, std::set<std::string>> runs;  // of each file
  for (const storm_files::StormFile& file : files) runs[file.path].insert(file.run);
  std::vector<NamedFiles> storms;
  std::vector<std::size_t> series;
  for (std::vector<storm_files::StormFile>& run : FilesOfRuns(std::move(files))) {
    if (run.size() > 1 && ContinueOneAnother(run)) {
      series.push_back(storms.size());
      const std::string name = WithMember(NameOfFolder(folder), run.front());
      storms.push_back({name, std::move(run)});
      continue;
    }
    NoteSameTimes(run);
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
  for (auto& [key, run] : by_key) {
    // Files with the same times but other fields, such as a series for each hydrometeor, are
    // separate runs. A file that only lacks a field is a part of its run.
    if (ContinueOneAnother(run)) {
      runs.push_back(std::move(run));
    } else {
      std::ranges::move(ByFields(std::move(run)), std::back_inserter(runs));
    }
  }
  return runs;
}

}  // namespace thunderhead::storm_store
