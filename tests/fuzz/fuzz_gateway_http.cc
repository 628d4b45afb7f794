// Fuzzes a browser's request as bytes. The target runs the gateway's HTTP parser, its access rules,
// the page's files, the translation into a gRPC call, and the frame of its message.
#include <algorithm>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "gateway/call_header.h"
#include "gateway/grpc_web_protocol.h"
#include "gateway/http_policy.h"
#include "gateway/static_files.h"
#include "gateway/text_view.h"
#include "gateway/websocket_protocol.h"
#include "gateway/websocket_upgrade.h"
#include "tests/fuzz/must.h"

namespace thunderhead::gateway {
namespace {

namespace http = boost::beast::http;

// A page of two files, removed when the program ends.
class PageFolder {
 public:
  PageFolder()
      : path_((std::filesystem::temp_directory_path() / "thunderhead-fuzz-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) std::abort();
    std::filesystem::create_directory(path_ + "/assets");
    std::ofstream(path_ + "/index.html") << "page";
    std::ofstream(path_ + "/assets/index.js") << "script";
  }
  ~PageFolder() { std::filesystem::remove_all(path_); }
  PageFolder(const PageFolder&) = delete;
  PageFolder& operator=(const PageFolder&) = delete;

  const std::string& Path() const { return path_; }

 private:
  std::string path_;
};

StaticFiles Page() {
  static const PageFolder folder;
  return *StaticFiles::Open(folder.Path());
}

using fuzz::Must;

// Checks the metadata's rules, because gRPC ends the process if metadata breaks them.
void CheckMetadata(const Metadata& metadata) {
  for (const auto& [name, value] : metadata) {
    Must(!name.empty() && std::ranges::none_of(name, [](char c) { return c >= 'A' && c <= 'Z'; }));
    if (name.ends_with("-bin")) continue;
    Must(std::ranges::all_of(value, [](unsigned char c) { return c >= 0x20 && c <= 0x7e; }));
  }
}

void Take(const http::request<http::string_body>& request) {
  static const StaticFiles page = Page();
  static const HttpPolicy policy(false, {"storms.example.org"}, {"https://other.example.org"});
  const std::string_view host = View(request[http::field::host]);
  const std::string_view origin = View(request[http::field::origin]);
  policy.AllowsHost(host);
  policy.IsOwnOrigin(origin, host);
  http::fields response;
  policy.Decorate(origin, response);
  const std::string_view target = View(request.target());
  const std::string_view path = target.substr(0, target.find('?'));
  if (const auto file = page.Find(path); file.has_value()) {
    const std::string found = file->path.string();
    Must(found.ends_with("/index.html") || found.ends_with("/assets/index.js"));
    MatchesEntityTag(View(request[http::field::if_none_match]), file->entity_tag);
  }
  IsMethodPath(path);
  static_cast<void>(FindUpgradeRefusal(request, policy));
  static const auto proxies = *base::TrustedProxies::Parse({"192.0.2.0/24", "2001:db8::/32"});
  for (const char* peer : {"192.0.2.7:1234", "198.51.100.1:1234"}) {
    const auto upstream = TranslateHeader(request, peer, proxies);
    if (upstream.ok()) CheckMetadata(upstream->metadata);
  }
  if (!IsBinaryGrpcWeb(View(request[http::field::content_type]))) return;
  if (const auto message = TakeSingleMessage(request.body()); message.ok()) {
    Must(message->size() + kFrameHeaderBytes == request.body().size());
  }
}

}  // namespace
}  // namespace thunderhead::gateway

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace http = boost::beast::http;
  http::request_parser<http::string_body> parser;
  parser.header_limit(16 << 10);
  parser.body_limit((1 << 20) + 5);
  parser.eager(true);
  boost::system::error_code error;
  boost::asio::const_buffer rest(data, size);
  // The bytes arrive in parts, as from a socket.
  while (rest.size() > 0 && !error && !parser.is_done()) {
    const std::size_t used = parser.put(rest, error);
    rest += used;
    if (used == 0) break;
  }
  if (parser.is_header_done()) thunderhead::gateway::Take(parser.get());
  return 0;
}
