#include "volume/storm_catalogue.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <new>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/slow_calls.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "volume/run_start.h"

namespace thunderhead::volume {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestFolder =
    8;  // below a path given by the user; also ends loops of symbolic links

struct NamedStorm {
  std::string name;
  std::vector<StormFile> files;
  std::size_t path = 0;  // which of those the user gave
};

// ISO 8601, e.g. "0001-01-01T00:40:00Z".
std::string FormatValidTime(absl::Time time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", time, absl::UTCTimeZone());
}

// An id that is safe in a URL and on a command line: in "wrfout_d01_0001-01-01_00:10:00" colons
// become hyphens.
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

// The file's name without a netCDF extension. Other dots stay: they may be part of a date.
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

// Equal for files that may be parts of one run.
auto RunKey(const StormFile& file) {
  return std::make_tuple(file.domain, file.cells.x, file.cells.y, file.cells.z, file.dx_m,
                         file.dy_m, file.run, file.fields);
}

// True for the files of one run, which overlap at most at their ends, as after a restart. Separate
// runs on the same grid, such as an ensemble's, share most of their times.
bool ContinueOneAnother(const std::vector<StormFile>& files) {
  std::set<absl::Time> distinct;
  std::size_t total = 0;
  for (const StormFile& file : files) {
    distinct.insert(file.times.begin(), file.times.end());
    total += file.times.size();
  }
  return distinct.size() * 2 > total;
}

struct Folder {
  std::vector<fs::path> files;
  std::vector<fs::path> folders;
};

absl::StatusOr<Folder> List(const fs::path& path) {
  const base::SlowCall call(path.string());
  Folder folder;
  std::error_code error;
  fs::directory_iterator entries(path, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& entry = entries->path();
    if (entry.filename().string().starts_with('.')) continue;
    std::error_code ignored;
    if (fs::is_directory(entry, ignored)) folder.folders.push_back(entry);
    if (fs::is_regular_file(entry, ignored)) folder.files.push_back(entry);
  }
  if (error) {
    return absl::PermissionDeniedError(
        absl::StrCat(path.string(), ": the folder cannot be listed (", error.message(), ")"));
  }
  std::ranges::sort(folder.files);
  std::ranges::sort(folder.folders);
  return folder;
}

// Groups a folder's files into runs; files that do not continue one another become storms of their
// own.
std::vector<NamedStorm> GroupRuns(const fs::path& folder, std::vector<StormFile> files) {
  std::vector<NamedStorm> storms;
  std::vector<std::size_t> series;
  for (std::vector<StormFile>& run : FilesOfRuns(std::move(files))) {
    if (run.size() > 1 && ContinueOneAnother(run)) {
      series.push_back(storms.size());
      storms.push_back({NameOfFolder(folder), std::move(run)});
      continue;
    }
    for (StormFile& file : run) {
      const std::string name = NameOfFile(file.path);
      storms.push_back({name, {}});
      storms.back().files.push_back(std::move(file));
    }
  }
  // Nested domains of one run are often in one folder; their names get the domain's number.
  if (series.size() > 1) {
    for (const std::size_t i : series) {
      absl::StrAppend(&storms[i].name, "-d", absl::Dec(storms[i].files[0].domain, absl::kZeroPad2));
    }
  }
  return storms;
}

absl::Status SearchFolder(const fs::path& path, const StormSearch& search, int depth,
                          std::vector<NamedStorm>& storms, absl::Status& first_failure) {
  if (search.on_folder) search.on_folder(path.string());
  THUNDERHEAD_ASSIGN_OR_RETURN(const Folder folder, List(path));
  std::vector<StormFile> files;
  for (const fs::path& file : folder.files) {
    absl::StatusOr<StormFile> metadata = search.describe(file.string());
    if (metadata.ok()) {
      files.push_back(*std::move(metadata));
      continue;
    }
    if (absl::IsCancelled(metadata.status())) continue;
    first_failure.Update(metadata.status());
    // A file of another kind, such as a read-me, is normal; a storm that cannot be read deserves a
    // warning.
    const bool other = absl::IsInvalidArgument(metadata.status());
    spdlog::log(other ? spdlog::level::info : spdlog::level::warn, "left out: {}",
                std::string(metadata.status().message()));
  }
  if (!files.empty()) std::ranges::move(GroupRuns(path, std::move(files)), back_inserter(storms));
  if (depth == kDeepestFolder) return absl::OkStatus();
  for (const fs::path& below : folder.folders) {
    if (absl::Status status = SearchFolder(below, search, depth + 1, storms, first_failure);
        !status.ok()) {
      first_failure.Update(status);
      if (search.on_unlisted) {
        search.on_unlisted(below.string(), status);
      } else {
        spdlog::warn("left out: {}", std::string(status.message()));
      }
    }
  }
  return absl::OkStatus();
}

absl::Status Search(const std::string& path, const StormSearch& search,
                    std::vector<NamedStorm>& storms) {
  std::error_code error;
  if (search.may_find_nothing && fs::status(path, error).type() == fs::file_type::not_found) {
    return absl::OkStatus();
  }
  if (!fs::is_directory(path, error)) {
    absl::StatusOr<StormFile> metadata = search.describe(path);
    if (!metadata.ok() && search.may_find_nothing) return absl::OkStatus();
    THUNDERHEAD_RETURN_IF_ERROR(metadata.status());
    storms.push_back({NameOfFile(path), {}});
    storms.back().files.push_back(*std::move(metadata));
    return absl::OkStatus();
  }
  const std::size_t before = storms.size();
  absl::Status first_failure;
  THUNDERHEAD_RETURN_IF_ERROR(SearchFolder(path, search, 0, storms, first_failure));
  if (storms.size() > before || search.may_find_nothing) return absl::OkStatus();
  if (!first_failure.ok()) {
    return base::Annotate(first_failure, absl::StrCat(path, " holds no storm; its first file"));
  }
  return absl::NotFoundError(absl::StrCat(path, ": holds no storm; put the model's output files (",
                                          search.examples, ") there"));
}

std::string TitleOf(const std::string& name, const StormFile& file) {
  return file.about.empty() ? name : absl::StrCat(name, " (", file.about, ")");
}

// Drops files that were found before under another path or through a link.
void DropRepeated(std::vector<NamedStorm>& storms) {
  std::set<std::string> seen;
  for (NamedStorm& storm : storms) {
    std::erase_if(storm.files, [&seen](const StormFile& file) {
      std::error_code error;
      const fs::path canonical = fs::canonical(file.path, error);
      return !seen.insert(error ? file.path : canonical.string()).second;
    });
  }
  std::erase_if(storms, [](const NamedStorm& storm) { return storm.files.empty(); });
}

}  // namespace

std::vector<std::vector<StormFile>> FilesOfRuns(std::vector<StormFile> files) {
  std::map<decltype(RunKey(files[0])), std::vector<StormFile>> by_key;
  for (StormFile& file : files) by_key[RunKey(file)].push_back(std::move(file));
  std::vector<std::vector<StormFile>> runs;
  runs.reserve(by_key.size());
  for (auto& [key, run] : by_key) runs.push_back(std::move(run));
  return runs;
}

CataloguedStorm AssembleStorm(const std::string& name, std::vector<StormFile> files) {
  THUNDERHEAD_CHECK(!files.empty(), name);
  std::ranges::sort(files, {}, &StormFile::path);
  CataloguedStorm storm;
  std::map<absl::Time, TimeSource> sources;
  for (std::size_t file = 0; file < files.size(); ++file) {
    for (std::size_t record = 0; record < files[file].times.size(); ++record) {
      const absl::Time time = files[file].times[record];
      const auto [at, added] = sources.try_emplace(time, TimeSource{file, record});
      if (added) continue;
      storm.notes.push_back(absl::StrCat(FormatValidTime(time), " is in ",
                                         files[at->second.file].path, " and in ", files[file].path,
                                         "; the latter is used"));
      at->second = {file, record};
    }
  }
  StormInfo& info = storm.info;
  info.id = IdFrom(name);
  for (const auto& [time, source] : sources) {
    const StormFile& file = files[source.file];
    info.times.push_back({.valid_time = FormatValidTime(time),
                          .elapsed_s = absl::ToDoubleSeconds(time - sources.begin()->first),
                          .file = file.path,
                          .version = file.version});
    storm.sources.push_back(source);
  }
  for (const StormFile& file : files) info.files.push_back(file.path);
  const StormFile& first = files[storm.sources.front().file];
  info.title = TitleOf(name, first);
  info.file_cells = first.cells;
  info.dx_m = first.dx_m;
  info.dy_m = first.dy_m;
  info.fields = first.fields;
  info.latitude_deg = first.latitude_deg;
  info.longitude_deg = first.longitude_deg;
  if (const auto start = RunStart(first); start.has_value()) {
    info.run_start = FormatValidTime(*start);
  }
  info.projection = first.projection;
  storm.files = std::move(files);
  return storm;
}

void LogNotes(const std::vector<CataloguedStorm>& storms) {
  for (const CataloguedStorm& storm : storms) {
    for (const std::string& note : storm.notes) spdlog::info("{}", note);
  }
}

absl::StatusOr<StormFile> DescribeFile(const std::string& path, const StormFormats& formats) {
  const base::SlowCall call(path);
  try {
    absl::StatusOr<StormFile> file = formats.Describe(path);
    if (file.ok() && file->device == 0) {
      if (const auto stamp = base::StampOf(path); stamp.has_value()) file->device = stamp->device;
    }
    return file;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(
        absl::StrCat(path, ": its metadata does not fit in memory; the file is probably damaged"));
  }
}

absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormFormats& formats) {
  auto storms = FindStorms(
      paths, {.describe = [&](const std::string& path) { return DescribeFile(path, formats); },
              .on_unlisted = {},
              .on_folder = {},
              .examples = formats.Examples()});
  if (storms.ok()) LogNotes(*storms);
  return storms;
}

absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormSearch& search) {
  std::vector<NamedStorm> named;
  for (std::size_t path = 0; path < paths.size(); ++path) {
    const std::size_t before = named.size();
    if (search.answers && !search.answers(paths[path])) {
      for (const NamedFiles& storm : (*search.found)[paths[path]]) {
        named.push_back({storm.name, storm.files});
      }
    } else {
      THUNDERHEAD_RETURN_IF_ERROR(Search(paths[path], search, named));
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
  DropRepeated(named);
  std::vector<CataloguedStorm> storms;
  std::set<std::string> ids;
  for (NamedStorm& storm : named) {
    storms.push_back(AssembleStorm(storm.name, std::move(storm.files)));
    std::string& id = storms.back().info.id;
    const std::string stem = id;
    for (int copy = 2; !ids.insert(id).second; ++copy) id = absl::StrCat(stem, "-", copy);
  }
  for (std::size_t first = 0, last = 0; first < storms.size(); first = last) {
    while (last < storms.size() && named[last].path == named[first].path) ++last;
    const auto begin = storms.begin();
    std::ranges::sort(begin + static_cast<std::ptrdiff_t>(first),
                      begin + static_cast<std::ptrdiff_t>(last), {},
                      [](const CataloguedStorm& storm) { return storm.info.id; });
  }
  return storms;
}

}  // namespace thunderhead::volume
