#include "gateway/static_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::gateway {
namespace {

namespace fs = std::filesystem;

std::string ContentType(const fs::path& path) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 18> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".webmanifest", "application/manifest+json"},
      {".wasm", "application/wasm"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".jpeg", "image/jpeg"},
      {".webp", "image/webp"},
      {".avif", "image/avif"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".woff", "font/woff"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  const std::string extension = absl::AsciiStrToLower(path.extension().string());
  const auto* const type = std::find_if(
      kTypes.begin(), kTypes.end(), [&](const auto& entry) { return entry.first == extension; });
  return std::string(type == kTypes.end() ? "application/octet-stream" : type->second);
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> PercentDecode(std::string_view text) {
  std::string decoded;
  decoded.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = HexDigit(text[i + 1]);
    const int low = HexDigit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

// Returns the path relative to the directory, such as "assets/index.js" for "/assets/index.js".
// Returns nothing for a path that could lead out of the directory or to a hidden file.
std::optional<fs::path> RelativePath(std::string_view url_path) {
  const std::optional<std::string> decoded = PercentDecode(url_path);
  if (!decoded.has_value() || !decoded->starts_with('/')) return std::nullopt;
  if (decoded->find('\0') != std::string::npos || decoded->find('\\') != std::string::npos) {
    return std::nullopt;
  }
  if (*decoded == "/") return fs::path("index.html");
  const std::vector<std::string> segments = absl::StrSplit(decoded->substr(1), '/');
  fs::path relative;
  for (const std::string& segment : segments) {
    if (segment.empty() || segment.front() == '.') return std::nullopt;
    relative /= segment;
  }
  return relative;
}

bool IsInside(const fs::path& path, const fs::path& root) {
  const auto [end_of_root, rest] =
      std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return end_of_root == root.end() && rest != path.end();
}

std::optional<struct stat> RegularFile(const fs::path& path) {
  struct stat information = {};
  if (::stat(path.c_str(), &information) != 0 || !S_ISREG(information.st_mode)) return std::nullopt;
  return information;
}

std::string EntityTag(const struct stat& information, std::string_view suffix) {
  return absl::StrCat("\"", absl::Hex(information.st_size), "-",
                      absl::Hex(information.st_mtim.tv_sec), "-",
                      absl::Hex(information.st_mtim.tv_nsec), std::string(suffix), "\"");
}

bool IsOlder(const struct stat& a, const struct stat& b) {
  return std::tie(a.st_mtim.tv_sec, a.st_mtim.tv_nsec) <
         std::tie(b.st_mtim.tv_sec, b.st_mtim.tv_nsec);
}

// Returns the weight in parameters such as "q=0.5"; 0 if they are malformed.
double WeightOf(absl::string_view parameters) {
  for (absl::string_view parameter : absl::StrSplit(parameters, ';')) {
    parameter = absl::StripAsciiWhitespace(parameter);
    if (!absl::ConsumePrefix(&parameter, "q=") && !absl::ConsumePrefix(&parameter, "Q=")) continue;
    double weight = 0.0;
    return absl::SimpleAtod(parameter, &weight) && weight >= 0.0 ? weight : 0.0;
  }
  return 1.0;
}

}  // namespace

absl::StatusOr<StaticFiles> StaticFiles::Open(const std::string& directory) {
  if (directory.empty()) return StaticFiles(fs::path());
  std::error_code error;
  fs::path root = fs::canonical(directory, error);
  if (error) {
    return absl::NotFoundError(absl::StrCat("the page's directory ", directory, ": ",
                                            error.message(), "; build the page with ./dev build"));
  }
  StaticFiles files(std::move(root));
  if (!files.Find("/").has_value()) {
    return absl::NotFoundError(
        absl::StrCat("the page's directory ", directory,
                     " has no readable index.html; build the page with ./dev build"));
  }
  return files;
}

std::optional<StaticFile> StaticFiles::Find(std::string_view url_path,
                                            std::string_view accept_encoding) const {
  if (root_.empty()) return std::nullopt;
  const std::optional<fs::path> relative = RelativePath(url_path);
  if (!relative.has_value()) return std::nullopt;
  std::error_code error;
  fs::path path = fs::canonical(root_ / *relative, error);
  // Symbolic links may lead to files in the page's directory, but not out of it.
  if (error || !IsInside(path, root_)) return std::nullopt;
  const std::optional<struct stat> plain = RegularFile(path);
  if (!plain.has_value()) return std::nullopt;

  StaticFile file;
  file.content_type = ContentType(path);
  file.entity_tag = EntityTag(*plain, "");
  // The names of files in assets contain a hash of their content, so browsers never need to
  // revalidate them. They must revalidate other files.
  const bool is_hashed = *relative->begin() == "assets";
  file.cache_control = is_hashed ? "public, max-age=31536000, immutable" : "no-cache";
  // A gzip file that is older than its original was made from other content, so it is ignored.
  const fs::path compressed = fs::canonical(fs::path(path) += ".gz", error);
  const std::optional<struct stat> gzip =
      !error && IsInside(compressed, root_) ? RegularFile(compressed) : std::nullopt;
  file.varies = gzip.has_value() && !IsOlder(*gzip, *plain);
  if (file.varies && PrefersGzip(accept_encoding)) {
    file.content_encoding = "gzip";
    file.entity_tag = EntityTag(*gzip, "-gzip");
    path = compressed;
  }
  file.path = std::move(path);
  return file;
}

bool PrefersGzip(std::string_view accept_encoding) {
  std::optional<double> gzip;
  std::optional<double> any;
  double plain = 0.0;  // 0 means that the original is used only if nothing else is accepted
  for (const absl::string_view choice :
       absl::StrSplit(absl::string_view(accept_encoding.data(), accept_encoding.size()), ',')) {
    const std::pair<absl::string_view, absl::string_view> parts =
        absl::StrSplit(choice, absl::MaxSplits(';', 1));
    const absl::string_view coding = absl::StripAsciiWhitespace(parts.first);
    const double weight = WeightOf(parts.second);
    if (absl::EqualsIgnoreCase(coding, "gzip") || absl::EqualsIgnoreCase(coding, "x-gzip")) {
      gzip = weight;
    } else if (absl::EqualsIgnoreCase(coding, "identity")) {
      plain = weight;
    } else if (coding == "*") {
      any = weight;
    }
  }
  const double weight = gzip.value_or(any.value_or(0.0));
  return weight > 0.0 && weight >= plain;
}

bool MatchesEntityTag(std::string_view candidates, std::string_view entity_tag) {
  for (absl::string_view candidate :
       absl::StrSplit(absl::string_view(candidates.data(), candidates.size()), ',')) {
    candidate = absl::StripAsciiWhitespace(candidate);
    absl::ConsumePrefix(&candidate, "W/");
    if (candidate == "*" || std::string_view(candidate.data(), candidate.size()) == entity_tag) {
      return true;
    }
  }
  return false;
}

}  // namespace thunderhead::gateway
