#include "pipeline/manifest.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/file_descriptor.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "nlohmann/json.hpp"

namespace thunderhead::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Maximum size of a manifest that is read. A manifest of this size has more than a million
// products.
constexpr off_t kMaxBytes = off_t{1} << 30;

template <typename Value>
Json OrNull(const std::optional<Value>& value) {
  return value.has_value() ? Json(*value) : Json(nullptr);
}

template <typename Value>
std::optional<Value> Optional(const Json& json, const char* name) {
  const Json& value = json.at(name);
  if (value.is_null()) return std::nullopt;
  return value.get<Value>();
}

// Returns the entries in a manifest's text. A last line without a line break was not written
// completely and is left out. `whole_bytes` receives the size of the text before it.
absl::StatusOr<std::vector<ManifestEntry>> ParseLines(const std::string& path,
                                                      std::string_view text,
                                                      std::size_t& whole_bytes) {
  std::vector<ManifestEntry> entries;
  whole_bytes = 0;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos;
       end = text.find('\n', whole_bytes)) {
    auto entry = FromLine(text.substr(whole_bytes, end - whole_bytes));
    if (!entry.ok()) {
      return absl::DataLossError(absl::StrCat(
          path, ": line ", entries.size() + 1, " is not an entry of a manifest (",
          entry.status().message(), "); delete the line, and its product is drawn again"));
    }
    entries.push_back(*std::move(entry));
    whole_bytes = end + 1;
  }
  return entries;
}

// Returns what is at `path` if it is not a regular file, or if it is a file with several hard
// links. Otherwise returns an empty text.
std::string WhatIsAt(const std::string& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) return "";
  if (S_ISLNK(found.st_mode)) return "a symbolic link";
  if (S_ISDIR(found.st_mode)) return "a folder";
  if (!S_ISREG(found.st_mode)) return "a FIFO, a socket or a device";
  return found.st_nlink > 1 ? "a file with a second name (a hard link)" : "";
}

absl::Status NotUsable(const std::string& path) {
  const int code = errno;
  if (const std::string found = WhatIsAt(path); !found.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, ": this is ", found,
                     ", and a manifest must be a file of its own, because another user may have "
                     "planted it; remove it, or name another manifest with --manifest"));
  }
  return base::WriteProblem(
      absl::StrCat(path, ": the manifest cannot be written (", std::strerror(code), ")"), code);
}

// Opens a regular file with a single hard link, and nothing else. Another user of the folder could
// otherwise plant a link to a file or device, or a FIFO. On failure, returns a descriptor that is
// not open, and sets errno.
base::FileDescriptor OpenOwn(const std::string& path, int flags) {
  base::FileDescriptor file(
      open(path.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666));
  struct stat found {};
  if (!file.IsOpen() || fstat(file.Get(), &found) != 0) return base::FileDescriptor();
  if (S_ISREG(found.st_mode) && found.st_nlink <= 1) return file;
  errno = ELOOP;
  return base::FileDescriptor();
}

// Reads the whole text of an open manifest.
absl::StatusOr<std::string> TextAt(int file, const std::string& path) {
  struct stat about {};
  if (fstat(file, &about) != 0) return NotUsable(path);
  if (about.st_size > kMaxBytes) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, ": the manifest has ", about.st_size, " bytes, and at most ", kMaxBytes,
                     " are read; move it away, or name another manifest with --manifest"));
  }
  std::string text(static_cast<std::size_t>(about.st_size), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count =
        pread(file, text.data() + done, text.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return NotUsable(path);
    if (count == 0) break;  // another process has shortened the file
    done += static_cast<std::size_t>(count);
  }
  text.resize(done);
  return text;
}

// Returns true if `file` is still the file at `path`. Another process may have replaced it.
bool IsAt(int file, const std::string& path) {
  struct stat open_file {};
  struct stat named {};
  return fstat(file, &open_file) == 0 && lstat(path.c_str(), &named) == 0 &&
         open_file.st_ino == named.st_ino && open_file.st_dev == named.st_dev;
}

// Opens and locks a file. Returns -1 with errno set on failure.
int OpenLocked(const std::string& path) {
  while (true) {
    base::FileDescriptor file = OpenOwn(path, O_RDWR | O_CREAT | O_APPEND);
    if (!file.IsOpen()) return -1;
    if (flock(file.Get(), LOCK_EX | LOCK_NB) != 0) {
      const int why = errno;
      file = base::FileDescriptor();
      errno = why;
      return -1;
    }
    if (IsAt(file.Get(), path)) return file.Release();
  }
}

std::string TextOf(const std::vector<ManifestEntry>& entries) {
  std::string text;
  for (const ManifestEntry& entry : entries) absl::StrAppend(&text, ToLine(entry), "\n");
  return text;
}

// Returns the entries of another manifest; none if it no longer exists or may not be read.
absl::StatusOr<std::vector<ManifestEntry>> Read(const std::string& path) {
  const base::FileDescriptor file = OpenOwn(path, O_RDONLY);
  if (!file.IsOpen() && (errno == ENOENT || errno == EACCES)) return std::vector<ManifestEntry>();
  if (!file.IsOpen()) return NotUsable(path);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string text, TextAt(file.Get(), path));
  std::size_t whole_bytes = 0;
  return ParseLines(path, text, whole_bytes);
}

// Sorts manifests from oldest to newest. Their modification times come from the same clock, because
// they are in one folder.
std::vector<std::string> ByDate(const std::vector<std::string>& manifests) {
  std::vector<std::pair<fs::file_time_type, std::string>> dated;
  for (const std::string& path : manifests) {
    std::error_code error;
    dated.emplace_back(fs::last_write_time(path, error), path);
  }
  std::ranges::sort(dated);
  std::vector<std::string> sorted;
  sorted.reserve(dated.size());
  for (auto& [date, path] : dated) sorted.push_back(std::move(path));
  return sorted;
}

// Locks another manifest. A process that makes another share of the pictures may hold the lock
// briefly, to remove a line. Returns -1 if a process holds the lock for longer, or if the manifest
// no longer exists.
int LockOther(const std::string& path) {
  constexpr int kTries = 50;
  std::error_code error;
  for (int i = 0; i < kTries && fs::exists(path, error); ++i) {
    const int file = OpenLocked(path);
    if (file >= 0) return file;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return -1;
}

}  // namespace

std::string ToLine(const ManifestEntry& entry) {
  Json json;
  json["file"] = entry.file;
  json["bytes"] = entry.bytes;
  json["sha256"] = entry.sha256;
  json["storm"] = entry.storm;
  json["valid"] = entry.valid;
  json["run"] = OrNull(entry.run);
  json["lead_s"] = OrNull(entry.lead_s);
  json["view"] = entry.view;
  json["scene_sha256"] = entry.scene_sha256;
  json["version"] = entry.version;
  json["device"] = entry.device;
  json["milliseconds"] = entry.milliseconds;
  json["estimated_error"] = OrNull(entry.estimated_error);
  json["error_low"] = OrNull(entry.error_low);
  json["error_high"] = OrNull(entry.error_high);
  json["input"] = {{"file", entry.input.path},
                   {"bytes", entry.input.bytes},
                   {"modified_ns", entry.input.modified_ns},
                   {"sha256", entry.input.sha256}};
  // File names may be in any encoding. Bytes that are not valid UTF-8 are replaced, because JSON
  // cannot hold them.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

absl::StatusOr<ManifestEntry> FromLine(std::string_view line) {
  try {
    const Json json = Json::parse(line);
    ManifestEntry entry;
    json.at("file").get_to(entry.file);
    json.at("bytes").get_to(entry.bytes);
    json.at("sha256").get_to(entry.sha256);
    json.at("storm").get_to(entry.storm);
    json.at("valid").get_to(entry.valid);
    entry.run = Optional<std::string>(json, "run");
    entry.lead_s = Optional<double>(json, "lead_s");
    json.at("view").get_to(entry.view);
    json.at("scene_sha256").get_to(entry.scene_sha256);
    json.at("version").get_to(entry.version);
    json.at("device").get_to(entry.device);
    json.at("milliseconds").get_to(entry.milliseconds);
    entry.estimated_error = Optional<double>(json, "estimated_error");
    if (json.contains("error_low")) {  // manifests written before version 0.2 have none
      entry.error_low = Optional<double>(json, "error_low");
      entry.error_high = Optional<double>(json, "error_high");
    }
    const Json& input = json.at("input");
    input.at("file").get_to(entry.input.path);
    input.at("bytes").get_to(entry.input.bytes);
    input.at("modified_ns").get_to(entry.input.modified_ns);
    input.at("sha256").get_to(entry.input.sha256);
    return entry;
  } catch (const Json::exception& error) {
    return absl::InvalidArgumentError(error.what());
  }
}

absl::StatusOr<Manifest> Manifest::Open(const std::string& path, const OtherManifests& others) {
  Manifest manifest(path, OpenLocked(path));
  if (manifest.file_ < 0) {
    if (errno != EWOULDBLOCK) return NotUsable(path);
    return absl::UnavailableError(
        absl::StrCat(path,
                     ": another thunderhead is writing this manifest; wait for it, or name another "
                     "manifest or product folder"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string text, TextAt(manifest.file_, path));
  std::size_t whole_bytes = 0;
  THUNDERHEAD_ASSIGN_OR_RETURN(manifest.entries_, ParseLines(path, text, whole_bytes));
  if (whole_bytes < text.size() &&
      ftruncate(manifest.file_, static_cast<off_t>(whole_bytes)) != 0) {
    return NotUsable(path);
  }
  unlink(base::PartialPath(path).c_str());
  for (const std::string& other : ByDate(others.count)) {
    THUNDERHEAD_RETURN_IF_ERROR(manifest.ReadOther(other));
  }
  THUNDERHEAD_RETURN_IF_ERROR(manifest.TakeOver(others.take_over));
  return manifest;
}

absl::Status Manifest::ReadOther(const std::string& manifest) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<ManifestEntry> entries, Read(manifest));
  for (ManifestEntry& entry : entries) {
    std::string file = entry.file;
    others_[std::move(file)].push_back({manifest, std::move(entry)});
  }
  return absl::OkStatus();
}

// Lines are made durable in this manifest before they are deleted from the other one. If the
// process is killed in between, both manifests have them, and the next run moves them again.
absl::Status Manifest::TakeOver(const std::vector<std::string>& manifests) {
  std::vector<std::pair<std::string, int>> taken;  // locked
  absl::Status read;
  std::map<std::string, ManifestEntry> fresh;
  for (const std::string& path : ByDate(manifests)) {
    const int file = OpenLocked(path);
    if (file < 0) {
      read.Update(ReadOther(path));
      continue;
    }
    taken.emplace_back(path, file);
    auto entries = Read(path);
    read.Update(entries.status());
    if (!entries.ok()) continue;
    for (ManifestEntry& entry : *entries) {
      std::string name = entry.file;
      fresh.insert_or_assign(std::move(name), std::move(entry));
    }
  }
  std::set<std::string> own;
  for (const ManifestEntry& entry : entries_) own.insert(entry.file);
  const std::size_t before = entries_.size();
  for (auto& [name, entry] : fresh) {
    if (!own.contains(name)) entries_.push_back(std::move(entry));
  }
  absl::Status moved = read;
  if (moved.ok() && entries_.size() > before) moved = Rewrite();
  for (const auto& [path, file] : taken) {
    if (moved.ok()) unlink(path.c_str());
    close(file);
  }
  return moved;
}

// Runs before the new line is written. If the process is killed in between, the product has no line
// and is made again. A wrong line never exists.
absl::Status Manifest::RemoveFromOthers(const std::string& name) {
  const auto others = others_.find(name);
  if (others == others_.end()) return absl::OkStatus();
  for (const Other& other : others->second) {
    if (held_.contains(other.manifest)) continue;
    const int file = LockOther(other.manifest);
    if (file < 0) {
      held_.insert(other.manifest);
      continue;
    }
    auto entries = Read(other.manifest);
    absl::Status removed = entries.status();
    if (removed.ok() && std::erase_if(*entries, [&name](const ManifestEntry& entry) {
                          return entry.file == name;
                        }) > 0) {
      removed = base::WriteWholeFile(other.manifest, TextOf(*entries));
    }
    close(file);
    THUNDERHEAD_RETURN_IF_ERROR(removed);
  }
  others_.erase(others);
  return absl::OkStatus();
}

Manifest::Manifest(Manifest&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      entries_(std::move(other.entries_)),
      others_(std::move(other.others_)),
      held_(std::move(other.held_)) {}

Manifest::~Manifest() {
  if (file_ >= 0) close(file_);
}

std::string Manifest::NameOf(const std::string& path) const {
  const fs::path folder = fs::path(path_).parent_path();
  return fs::absolute(path).lexically_normal().lexically_relative(
      fs::absolute(folder.empty() ? "." : folder).lexically_normal());
}

const ManifestEntry* Manifest::Find(const std::string& path) const {
  const std::string name = NameOf(path);
  const auto own = std::ranges::find(entries_, name, &ManifestEntry::file);
  if (own != entries_.end()) return &*own;
  const auto other = others_.find(name);
  return other == others_.end() ? nullptr : &other->second.back().entry;
}

std::vector<ManifestEntry> Manifest::Entries() const {
  std::vector<ManifestEntry> all = entries_;
  for (const auto& [name, entries] : others_) {
    const auto own = std::ranges::find(entries_, name, &ManifestEntry::file);
    if (own == entries_.end()) all.push_back(entries.back().entry);
  }
  return all;
}

std::string Manifest::PathOf(const ManifestEntry& entry) const {
  return (fs::path(path_).parent_path() / entry.file).string();
}

absl::Status Manifest::Record(const std::string& path, ManifestEntry entry) {
  entry.file = NameOf(path);
  THUNDERHEAD_RETURN_IF_ERROR(RemoveFromOthers(entry.file));
  const auto old = std::ranges::find(entries_, entry.file, &ManifestEntry::file);
  if (old != entries_.end()) {
    entries_.erase(old);
    entries_.push_back(std::move(entry));
    return Rewrite();
  }
  entries_.push_back(std::move(entry));
  return Append(entries_.back());
}

absl::Status Manifest::Append(const ManifestEntry& entry) const {
  const std::string line = ToLine(entry) + "\n";
  struct stat before {};
  if (fstat(file_, &before) != 0) return NotUsable(path_);
  const ssize_t written = write(file_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size()) && fsync(file_) == 0) return absl::OkStatus();
  if (written >= 0 && written < static_cast<ssize_t>(line.size())) errno = ENOSPC;
  absl::Status status = NotUsable(path_);
  // If the truncation fails, the partial line remains, and the next run drops it.
  if (ftruncate(file_, before.st_size) != 0) return status;
  return status;
}

absl::Status Manifest::Rewrite() {
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(path_, TextOf(entries_)));
  const int file = OpenLocked(path_);
  if (file < 0) return NotUsable(path_);
  close(std::exchange(file_, file));
  return absl::OkStatus();
}

}  // namespace thunderhead::pipeline
