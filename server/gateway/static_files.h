// The files of the built page: finds the file for a request's path, with its HTTP headers, which
// may take as long as the storage does. Never leaves the page's directory. Knows no socket.
// Compresses nothing: a file with its gzip file beside it, as the page's build writes them
// ("index.js.gz" beside "index.js"), can be had in either encoding.
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
  std::string entity_tag;  // with its quotes; another one for another encoding
  std::string cache_control;
  std::string content_encoding;  // "gzip", or empty: the file as it is
  bool varies = false;           // with the request's Accept-Encoding
};

class StaticFiles {
 public:
  // An empty `directory` means a server without a page; any other must contain index.html.
  static absl::StatusOr<StaticFiles> Open(const std::string& directory);
  // There is no page.
  bool IsEmpty() const { return root_.empty(); }

  // The file for a percent-encoded URL path, without its query; "/" is index.html. In the encoding
  // that the Accept-Encoding header `accept_encoding` prefers.
  std::optional<StaticFile> Find(std::string_view url_path,
                                 std::string_view accept_encoding = {}) const;

 private:
  explicit StaticFiles(std::filesystem::path root) : root_(std::move(root)) {}

  std::filesystem::path root_;  // canonical, or empty
};

// True if the Accept-Encoding header `accept_encoding` accepts gzip, and does not rank the file as
// it is above it.
bool PrefersGzip(std::string_view accept_encoding);

// True if the If-None-Match header `candidates` names `entity_tag`.
bool MatchesEntityTag(std::string_view candidates, std::string_view entity_tag);

}  // namespace thunderhead::gateway
