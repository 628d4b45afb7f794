#include "storm_store/folder_walk.h"

#include <sys/stat.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/slow_calls.h"
#include "base/status.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepestFolder = 8;

// Number of entries that are read from a folder before another folder gets its turn. A folder with
// more entries stays open until its next turn, so few folders are open at once.
constexpr std::size_t kStep = 4000;

// Returns PERMISSION_DENIED for a symbolic link that the rules do not allow to be followed.
absl::Status CheckLink(const LinkRules& rules, const fs::path& link) {
  std::error_code error;
  const fs::path folder = fs::canonical(link.parent_path(), error);
  if (error || IsWithinAny(folder, rules.untrusted)) {
    return absl::PermissionDeniedError(
        absl::StrCat(link.string(),
                     ": is a symbolic link, which is not followed in an untrusted "
                     "folder; put the file itself there"));
  }
  const fs::path target = fs::canonical(link, error);
  if (error) {
    return absl::PermissionDeniedError(
        absl::StrCat(link.string(), ": is a symbolic link that leads nowhere"));
  }
  if (IsWithinAny(target, rules.targets)) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat(link.string(), ": is a symbolic link to ", target.string(),
                   ", outside the data folders; allow it with --allow-links-to ",
                   (fs::is_directory(target, error) ? target : target.parent_path()).string()));
}

// A folder of the walk. The folder whose subtree has had the fewest entries so far is listed next.
struct Node {
  fs::path path;
  Node* parent = nullptr;
  std::size_t index = 0;  // index in the parent's `below`
  int depth = 0;
  std::size_t own_entries = 0;  // number of entries read from the folder itself
  std::size_t entries = 0;      // number of entries read from it and its subfolders
  bool is_listed = false;       // true once listed to its end, or if it cannot be listed
  bool has_begun = false;
  fs::directory_iterator next;
  std::vector<std::string> files;
  std::vector<std::unique_ptr<Node>> below;
  // The subfolders with folders that are not listed yet, by their entries and index.
  std::set<std::pair<std::size_t, std::size_t>> waiting;

  bool IsWaiting() const { return !is_listed || !waiting.empty(); }
};

const fs::path& PathOf(const std::unique_ptr<Node>& node) { return node->path; }

class Walk {
 public:
  Walk(const std::string& path, const FolderWalk& options)
      : options_(options), end_(options.time->Now() + options.longest) {
    root_.path = path;
    (void)IsNew(root_.path);
  }

  absl::StatusOr<std::vector<ListedFolder>> Run();

 private:
  // A link to a folder, and the folder that it is in.
  struct Link {
    fs::path path;
    Node* in = nullptr;
  };

  // Returns whether the folder was not met before.
  bool IsNew(const fs::path& path);
  void ListAll();
  Node& Next();
  absl::Status ListSome(Node& node);
  void Sort(const fs::directory_entry& entry, Node& node);
  void Add(const fs::path& path, Node& parent);
  void FollowLinks();
  void ReportRest() const;
  void AddKnown(std::vector<ListedFolder>& listed);
  static const Node* FirstWaiting(const Node& node);
  static void Flatten(Node& node, std::vector<ListedFolder>& listed);
  static std::size_t CountWaiting(const Node& node);
  const Node* FindUnlisted(const fs::path& folder) const;

  const FolderWalk& options_;
  const base::TimeSource::Clock::time_point end_;
  Node root_;
  std::vector<Link> links_;
  std::set<std::pair<dev_t, ino_t>> visited_;  // folders, by device and inode
  std::size_t entries_ = 0;
  bool has_stopped_ = false;  // true if the walk stopped at a limit
};

bool Walk::IsNew(const fs::path& path) {
  struct stat identity {};
  return ::stat(path.c_str(), &identity) != 0 ||
         visited_.emplace(identity.st_dev, identity.st_ino).second;
}

void Walk::Add(const fs::path& path, Node& parent) {
  if (parent.depth == kDeepestFolder || !IsNew(path)) return;
  auto node = std::make_unique<Node>();
  node->path = path;
  node->parent = &parent;
  node->index = parent.below.size();
  node->depth = parent.depth + 1;
  parent.waiting.emplace(0, node->index);
  parent.below.push_back(std::move(node));
}

// Adds an entry of a folder to the node's files or subfolders, or to the links.
void Walk::Sort(const fs::directory_entry& entry, Node& node) {
  const fs::path& path = entry.path();
  if (path.filename().string().starts_with('.')) return;
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && !fs::is_regular_file(path, ignored)) return;
  const bool is_link = entry.is_symlink(ignored);
  if (is_link) {
    if (const absl::Status allowed = CheckLink(options_.links, path); !allowed.ok()) {
      return options_.on_left_out(path.string(), allowed);
    }
  }
  if (!is_folder) {
    node.files.push_back(path.string());
  } else if (is_link) {
    links_.push_back({path, &node});
  } else {
    Add(path, node);
  }
}

// Returns the folder that is listed next. A folder must be waiting.
Node& Walk::Next() {
  Node* node = &root_;
  while (true) {
    const bool is_next = !node->is_listed && (node->waiting.empty() ||
                                              node->own_entries <= node->waiting.begin()->first);
    if (is_next) return *node;
    node = node->below[node->waiting.begin()->second].get();
  }
}

absl::Status Walk::ListSome(Node& node) {
  const base::SlowCall call(node.path.string());
  std::error_code error;
  if (!std::exchange(node.has_begun, true)) {
    if (options_.on_folder) options_.on_folder(node.path.string());
    node.next = fs::directory_iterator(node.path, error);
  }
  for (std::size_t i = 0; i < kStep && !error; ++i) {
    if (node.next == fs::directory_iterator()) {
      node.is_listed = true;
      return absl::OkStatus();
    }
    if (entries_ == options_.most_entries || options_.time->Now() > end_) {
      has_stopped_ = true;
      return absl::OkStatus();
    }
    ++entries_;
    ++node.own_entries;
    Sort(*node.next, node);
    node.next.increment(error);
  }
  if (!error) return absl::OkStatus();
  node.is_listed = true;
  return CannotBeListed(node.path.string(), error);
}

void Walk::ListAll() {
  while (root_.IsWaiting() && !has_stopped_ && !options_.stop.stop_requested()) {
    Node& node = Next();
    const std::size_t before = node.own_entries;
    const absl::Status status = ListSome(node);
    if (!status.ok()) options_.on_left_out(node.path.string(), status);
    const std::size_t read = node.own_entries - before;
    node.entries += read;
    for (Node* each = &node; each->parent != nullptr; each = each->parent) {
      auto& waiting = each->parent->waiting;
      // `entries` has grown already, but `waiting` still has the node under its earlier number.
      waiting.erase({each->entries - read, each->index});
      if (each->IsWaiting()) waiting.emplace(each->entries, each->index);
      each->parent->entries += read;
    }
  }
}

// Adds the folders to which links lead. They come last, so that a folder is found at its own path,
// however fast other folders are listed.
void Walk::FollowLinks() {
  std::vector<Link> links = std::exchange(links_, {});
  std::ranges::sort(links, {}, &Link::path);
  for (const Link& link : links) {
    Add(link.path, *link.in);
    // The folders above may have been listed to their end. They wait again, because they now have a
    // folder that is not listed yet.
    for (Node* each = link.in; each->parent != nullptr; each = each->parent) {
      if (each->IsWaiting()) each->parent->waiting.emplace(each->entries, each->index);
    }
  }
}

const Node* Walk::FirstWaiting(const Node& node) {
  if (!node.is_listed) return &node;
  for (const auto& below : node.below) {
    if (const Node* const found = FirstWaiting(*below); found != nullptr) return found;
  }
  return nullptr;
}

std::size_t Walk::CountWaiting(const Node& node) {
  std::size_t count = node.is_listed ? 0 : 1;
  for (const auto& below : node.below) count += CountWaiting(*below);
  return count;
}

// Reports the folders that were not listed to their end.
void Walk::ReportRest() const {
  const std::size_t count = CountWaiting(root_);
  const Node* const first = FirstWaiting(root_);
  if (first == nullptr) return;
  options_.on_left_out(
      root_.path.string(),
      absl::ResourceExhaustedError(absl::StrCat(
          root_.path.string(), ": the search stopped after ", entries_, " files and folders; ",
          count, count == 1 ? " folder was" : " folders were", " not searched to the end, such as ",
          first->path.string(), "; remove files there, or give --data folders farther down")));
}

void Walk::Flatten(Node& node, std::vector<ListedFolder>& listed) {
  std::ranges::sort(node.files);
  std::ranges::sort(node.below, {}, PathOf);
  listed.push_back({node.path.string(), std::move(node.files)});
  for (const auto& below : node.below) Flatten(*below, listed);
}

// Finds `folder` among the folders that the walk has met, or else the nearest folder above
// `folder`. Returns the found folder if it was not listed to its end. Otherwise returns null,
// because the walk has then met all files of `folder` that it could list.
const Node* Walk::FindUnlisted(const fs::path& folder) const {
  const fs::path relative = folder.lexically_relative(root_.path);
  const Node* node = &root_;
  for (const fs::path& name : relative) {
    if (name == "." || name.empty()) continue;
    const fs::path wanted = node->path / name;
    const auto below = std::ranges::lower_bound(node->below, wanted, {}, PathOf);
    if (below == node->below.end() || (*below)->path != wanted) break;
    node = below->get();
  }
  return node->is_listed ? nullptr : node;
}

// Adds the known files that the walk has not met because it stopped.
void Walk::AddKnown(std::vector<ListedFolder>& listed) {
  if (!options_.known_below) return;
  std::map<std::string, std::vector<std::string>> by_folder;
  for (std::string& path : options_.known_below(root_.path.string())) {
    by_folder[fs::path(path).parent_path().string()].push_back(std::move(path));
  }
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < listed.size(); ++i) places.emplace(listed[i].path, i);
  for (auto& [folder, files] : by_folder) {
    if (FindUnlisted(folder) == nullptr) continue;
    const auto [place, is_new] = places.emplace(folder, listed.size());
    if (is_new) listed.push_back({folder, {}});
    std::vector<std::string>& all = listed[place->second].files;
    std::ranges::move(files, std::back_inserter(all));
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
}

absl::StatusOr<std::vector<ListedFolder>> Walk::Run() {
  absl::Status status = ListSome(root_);
  THUNDERHEAD_RETURN_IF_ERROR(status);
  root_.entries = root_.own_entries;
  ListAll();
  while (!links_.empty() && !has_stopped_ && !options_.stop.stop_requested()) {
    FollowLinks();
    ListAll();
  }
  if (has_stopped_) ReportRest();
  std::vector<ListedFolder> listed;
  // Flatten moves the files out of the nodes. AddKnown needs only the rest of the nodes.
  Flatten(root_, listed);
  if (has_stopped_) AddKnown(listed);
  return listed;
}

// Appends the canonical form of each path that exists, or of the file whose storm the path names.
void AppendCanonical(const std::vector<std::string>& paths, std::vector<fs::path>* canonical) {
  for (const std::string& path : paths) {
    std::error_code error;
    fs::path found = fs::canonical(FileOfStorm(path), error);
    if (!error) canonical->push_back(std::move(found));
  }
}

}  // namespace

fs::path FileOfStorm(const fs::path& path) {
  std::error_code error;
  fs::path file = path;
  while (file.has_relative_path() && !fs::exists(file, error)) file = file.parent_path();
  return fs::is_regular_file(file, error) ? file : path;
}

LinkRules LinkRulesOf(const std::vector<std::string>& paths, const LinkPolicy& links) {
  LinkRules rules;
  AppendCanonical(paths, &rules.targets);
  AppendCanonical(links.allowed, &rules.targets);
  AppendCanonical(links.untrusted, &rules.untrusted);
  return rules;
}

bool IsWithin(const fs::path& path, const fs::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

bool IsWithinAny(const fs::path& path, const std::vector<fs::path>& folders) {
  return std::ranges::any_of(folders, [&](const fs::path& each) { return IsWithin(path, each); });
}

absl::Status CannotBeListed(const std::string& folder, const std::error_code& error) {
  return absl::PermissionDeniedError(
      absl::StrCat(folder, ": the folder cannot be listed (", error.message(), ")"));
}

absl::StatusOr<std::vector<ListedFolder>> ListFolders(const std::string& path,
                                                      const FolderWalk& walk) {
  return Walk(path, walk).Run();
}

}  // namespace thunderhead::storm_store
