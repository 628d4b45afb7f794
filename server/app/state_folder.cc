#include "app/state_folder.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/own_file.h"
#include "base/slow_calls.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "spdlog/spdlog.h"
#include "store/private_files.h"
#include "store/sqlite_job_store.h"
#include "store/sqlite_session_store.h"
#include "store/state_file.h"
#include "store/timed_stores.h"

namespace thunderhead::app {
namespace {

namespace fs = std::filesystem;

constexpr char kNone[] = "none";
constexpr char kFile[] = "sessions.db";
constexpr char kStormIds[] = "storm_ids";
// Timeout after which the folder's storage counts as hanging. Less would be too short, because a
// disk may be busy with other data for some seconds.
constexpr std::chrono::seconds kPatience{10};

std::string Variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Returns the default folder; empty if the environment does not determine one.
std::string DefaultFolder() {
  // systemd separates several folders by colons; the first one is used.
  const std::string given = Variable("STATE_DIRECTORY");
  if (!given.empty()) return given.substr(0, given.find(':'));
  // A relative path in XDG_STATE_HOME must be ignored (XDG Base Directory Specification).
  const std::string state = Variable("XDG_STATE_HOME");
  if (fs::path(state).is_absolute()) return state + "/thunderhead";
  const std::string home = Variable("HOME");
  return home.empty() ? "" : home + "/.local/state/thunderhead";
}

constexpr char kInstead[] =
    "cannot keep sessions (another folder: --state FOLDER; none: --state none)";

// Checks that only this user can change the folder's contents, and that the files that are not
// checked when they are opened are regular files.
absl::Status Check(const std::string& folder) {
  THUNDERHEAD_RETURN_IF_ERROR(store::CheckFolder(folder));
  const std::string ids = folder + "/" + kStormIds;
  for (const std::string& file : {ids, base::PartialPath(ids)}) {
    THUNDERHEAD_RETURN_IF_ERROR(store::CheckFile(file));
  }
  return absl::OkStatus();
}

// Creates the folder for this user only, if it does not exist.
std::error_code Create(const std::string& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return {};
  fs::create_directories(folder, error);
  if (!error) fs::permissions(folder, fs::perms::owner_all, error);
  return error;
}

}  // namespace

absl::StatusOr<State> OpenState(const std::string& folder) {
  if (folder == kNone) return State();
  const bool is_default = folder.empty();
  const std::string path = is_default ? DefaultFolder() : folder;
  const base::SlowCall slow(path);
  const std::error_code error =
      path.empty() ? std::make_error_code(std::errc::no_such_file_or_directory) : Create(path);
  if (error && is_default) {
    spdlog::warn(
        "sessions and render jobs end with the server, because the state folder '{}' cannot be "
        "used ({}); name another with --state",
        path, error.message());
    return State();
  }
  if (error) {
    return absl::InvalidArgumentError(absl::StrCat("--state is '", path,
                                                   "', which is not a folder and cannot be "
                                                   "created: ",
                                                   error.message()));
  }
  if (const absl::Status checked = Check(path); !checked.ok()) {
    return base::Annotate(checked, kInstead);
  }
  auto file = store::StateFile::Open(path + "/" + kFile);
  if (!file.ok()) return base::Annotate(file.status(), kInstead);
  THUNDERHEAD_ASSIGN_OR_RETURN(auto sessions, store::SqliteSessionStore::In(*file));
  THUNDERHEAD_ASSIGN_OR_RETURN(auto jobs, store::SqliteJobStore::In(*file));
  State state;
  state.calls = std::make_shared<base::TimedCalls>(kPatience);
  state.sessions = store::WithPatience(std::shared_ptr<session::SessionStore>(std::move(sessions)),
                                       state.calls, path);
  state.jobs =
      store::WithPatience(std::shared_ptr<jobs::JobStore>(std::move(jobs)), state.calls, path);
  state.folder = path;
  return state;
}

void KeepStormIds(const State& state, storm_store::LiveCatalogueOptions& catalogue) {
  if (state.folder.empty()) return;
  const std::string path = state.folder + "/" + kStormIds;
  auto ids = state.calls->Ask(state.folder, [path] { return base::ReadOwnFile(path); });
  if (ids.ok()) {
    catalogue.ids = *std::move(ids);
  } else if (!absl::IsNotFound(ids.status())) {
    spdlog::warn("the ids of storms are given anew: {}", std::string(ids.status().message()));
  }
  catalogue.keep_ids = [path, folder = state.folder, calls = state.calls](const std::string& text) {
    const absl::Status kept =
        calls->Ask(folder, [path, text] { return base::WriteWholeFile(path, text); });
    if (kept.ok()) return;
    spdlog::warn("the ids of new storms are not kept for a restart: {}",
                 std::string(kept.message()));
  };
}

}  // namespace thunderhead::app
