// The files of the built page. Find returns the file for a request's path with its HTTP headers; it
// may block as long as the storage does. It never leaves the page's directory and is independent of
// sockets. Files are not compressed here: the page's build writes a gzip file next to a file
// ("index.js.gz" next to "index.js"). Such a file is available in both encodings.
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
  std::string entity_tag;  // with its quotes; differs for each encoding
  std::string cache_control;
  std::string content_encoding;  // "gzip", or empty for the original
  // True if the file's encoding depends on the request's Accept-Encoding.
  bool varies = false;
};

class StaticFiles {
 public:
  // Opens the page's directory. An empty `directory` means a server without a page. Any other
  // directory must contain index.html.
  static absl::StatusOr<StaticFiles> Open(const std::string& directory);
  // Returns true if there is no page.
  bool IsEmpty() const { return root_.empty(); }

  // Returns the file for a percent-encoded URL path without its query; "/" is index.html. The file
  // has the encoding that the Accept-Encoding header `accept_encoding` prefers.
  std::optional<StaticFile> Find(std::string_view url_path,
                                 std::string_view accept_encoding = {}) const;

 private:
  explicit StaticFiles(std::filesystem::path root) : root_(std::move(root)) {}

  std::filesystem::path root_;  // canonical, or empty without a page
};

// Returns true if the Accept-Encoding header `accept_encoding` accepts gzip and does not prefer the
// uncompressed file.
bool PrefersGzip(std::string_view accept_encoding);

// Returns true if the If-None-Match header `candidates` contains `entity_tag`.
bool MatchesEntityTag(std::string_view candidates, std::string_view entity_tag);

}  // namespace thunderhead::gateway
