// The wire format of calls by WebSocket, subprotocol grpc-websocket.v1: the kinds of messages, and
// what a client may send when. Pure functions that know no socket, no call and no message type.
//
// Every WebSocket message is binary: a byte with its kind, then its payload. The client sends
// request messages and at most one half-close; the server sends response messages and last the
// trailers, then closes with 1000 whatever the call's status. A client that breaks these rules is
// closed with 1003 (text), 1008 (any other rule) or 1009 (message too large).
#pragma once

#include <boost/beast/websocket/rfc6455.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thunderhead::gateway {

inline constexpr char kWebSocketSubprotocol[] = "grpc-websocket.v1";

inline constexpr uint8_t kMessageKind = 0x00;    // both ways; the payload is one message
inline constexpr uint8_t kHalfCloseKind = 0x01;  // from the client; no payload
inline constexpr uint8_t kTrailersKind = 0x80;   // from the server; as in a gRPC-Web trailer frame

// True if a Sec-WebSocket-Protocol header offers the subprotocol.
bool OffersSubprotocol(std::string_view offered);

// The token that a Sec-WebSocket-Protocol header offers besides, as "bearer." and the token in
// base64url without padding: the one header that browsers let a page choose. None if it offers
// none, or not in printable ASCII.
inline constexpr char kTokenPrefix[] = "bearer.";
std::optional<std::string> OfferedToken(std::string_view offered);

// The beginning of a WebSocket message from a client.
struct MessageStart {
  bool is_text = false;
  std::optional<uint8_t> kind;  // none: the message is empty
  bool has_payload = false;
  bool after_half_close = false;
};

// Why the connection must be closed, if the client breaks a rule.
std::optional<boost::beast::websocket::close_reason> FindViolation(const MessageStart& start);

// The frame with which the server closes for `reason` (RFC 6455, 5.5.1).
std::string CloseFrame(const boost::beast::websocket::close_reason& reason);

}  // namespace thunderhead::gateway
