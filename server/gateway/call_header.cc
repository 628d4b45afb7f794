#include "gateway/call_header.h"

#include <boost/beast/http/field.hpp>
#include <chrono>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "base/status.h"
#include "gateway/text_view.h"
#include "gateway/websocket_protocol.h"

namespace thunderhead::gateway {
namespace {

// A longer timeout is ignored, because adding it to the clock could overflow.
constexpr absl::Duration kLongestTimeout = absl::Hours(24 * 365);

}  // namespace

std::string ClientOf(const boost::beast::http::request<boost::beast::http::string_body>& request,
                     const std::string& peer, const base::TrustedProxies& proxies) {
  std::string forwarded_for;
  const auto [first, last] = request.equal_range("x-forwarded-for");
  for (auto line = first; line != last; ++line) {
    absl::StrAppend(&forwarded_for, forwarded_for.empty() ? "" : ",",
                    absl::string_view(line->value().data(), line->value().size()));
  }
  return proxies.ClientOf(peer, forwarded_for);
}

absl::StatusOr<UpstreamRequest> TranslateHeader(
    const boost::beast::http::request<boost::beast::http::string_body>& request,
    const std::string& peer, const base::TrustedProxies& proxies) {
  UpstreamRequest upstream;
  const std::string_view target = View(request.target());
  upstream.method = std::string(target.substr(0, target.find('?')));
  for (const auto& field : request) {
    THUNDERHEAD_RETURN_IF_ERROR(
        AddRequestHeader(View(field.name_string()), View(field.value()), upstream.metadata));
  }
  upstream.metadata.emplace_back("x-forwarded-for", ClientOf(request, peer, proxies));
  const auto [begin, end] = request.equal_range(boost::beast::http::field::sec_websocket_protocol);
  for (auto field = begin; field != end; ++field) {
    // The subprotocol carries the token, because browsers cannot set other headers of a WebSocket.
    const auto token = OfferedToken(View(field->value()));
    if (token.has_value()) upstream.metadata.emplace_back("authorization", "Bearer " + *token);
  }
  if (const auto timeout = request.find("grpc-timeout"); timeout != request.end()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const absl::Duration left, ParseTimeout(View(timeout->value())));
    if (left < kLongestTimeout) {
      upstream.deadline = std::chrono::system_clock::now() +
                          std::chrono::duration_cast<std::chrono::system_clock::duration>(
                              absl::ToChronoNanoseconds(left));
    }
  }
  return upstream;
}

Metadata TrailersOf(const grpc::Status& status, const Metadata& metadata) {
  // The code is cast without a check, because a server may send codes outside the canonical ones.
  return Trailers(static_cast<absl::StatusCode>(status.error_code()), status.error_message(),
                  metadata);
}

}  // namespace thunderhead::gateway
