// The files of the built page: finds the file for a request's path, with its HTTP headers. Never
// leaves the page's directory. Knows no socket.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"

namespace thunderhead::gateway {

struct StaticFile {
  std::filesystem::path path;
  std::string content_type;
  std::string entity_tag;  // with its quotes
  std::string cache_control;
};

class StaticFiles {
 public:
  // An empty `directory` means a server without a page; any other must contain index.html.
  static absl::StatusOr<StaticFiles> Open(const std::string& directory);

  // The file for a percent-encoded URL path, without its query; "/" is index.html.
  std::optional<StaticFile> Find(std::string_view url_path) const;

 private:
  explicit StaticFiles(std::filesystem::path root) : root_(std::move(root)) {}

  std::filesystem::path root_;  // canonical, or empty
};

// True if the If-None-Match header `candidates` names `entity_tag`.
bool MatchesEntityTag(std::string_view candidates, std::string_view entity_tag);

}  // namespace thunderhead::gateway
