// The wire format of calls over a WebSocket with the subprotocol grpc-websocket.v1: the kinds of
// messages, and when a client may send each kind. The functions are pure, and independent of
// sockets, calls and message types.
//
// Every WebSocket message is binary: a byte with its kind, followed by its payload. The client
// sends request messages and at most one half-close. The server sends response messages, and the
// trailers last. It then closes with 1000, whatever the call's status. A client that breaks these
// rules is closed with 1003 (text), 1008 (any other rule) or 1009 (message too large).
#pragma once

#include <boost/beast/websocket/rfc6455.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thunderhead::gateway {

inline constexpr char kWebSocketSubprotocol[] = "grpc-websocket.v1";

inline constexpr uint8_t kMessageKind = 0x00;    // in both directions; the payload is one message
inline constexpr uint8_t kHalfCloseKind = 0x01;  // from the client; no payload
inline constexpr uint8_t kTrailersKind = 0x80;   // from the server; as in a gRPC-Web trailer frame

// Returns true if a Sec-WebSocket-Protocol header offers the subprotocol.
bool OffersSubprotocol(std::string_view offered);

// Returns the token in a Sec-WebSocket-Protocol header. It is offered there as a subprotocol:
// "bearer." and the token in base64url without padding, because browsers let a page set no other
// header. Returns nothing if there is no token, or if the token is not printable ASCII.
inline constexpr char kTokenPrefix[] = "bearer.";
std::optional<std::string> OfferedToken(std::string_view offered);

// The start of a WebSocket message from a client.
struct MessageStart {
  bool is_text = false;
  std::optional<uint8_t> kind;  // absent if the message is empty
  bool has_payload = false;
  bool after_half_close = false;
};

// Returns the reason to close the connection if the message breaks a rule; nothing if it is
// allowed.
std::optional<boost::beast::websocket::close_reason> FindViolation(const MessageStart& start);

// Returns the frame with which the server closes the connection because of `reason` (RFC 6455,
// 5.5.1).
std::string CloseFrame(const boost::beast::websocket::close_reason& reason);

}  // namespace thunderhead::gateway
