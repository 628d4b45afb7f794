// One call of any kind over a WebSocket, in the format of websocket_protocol.h. The next message is
// read from the server only after the client has accepted the previous one. The next message is
// read from the client only when the server's flow control allows it. Both directions run
// concurrently. The exchange is independent of message types.
//
// Three coroutines use one connection. Only Run() sends messages and close frames, only
// ForwardRequests() receives, and Watch() pings the client and disconnects one that no longer
// responds.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "gateway/awaitable.h"
#include "gateway/change_signal.h"
#include "gateway/client_link.h"
#include "gateway/peer_liveness.h"
#include "gateway/site.h"
#include "gateway/upstream_call.h"
#include "gateway/websocket_reader.h"
#include "grpcpp/support/byte_buffer.h"

namespace thunderhead::gateway {

class WebSocketExchange : public std::enable_shared_from_this<WebSocketExchange> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  // `site` must outlive the exchange.
  WebSocketExchange(Site& site, std::shared_ptr<ClientLink> link);

  // Answers the upgrade `request` and makes the call. Closes the link at the end.
  boost::asio::awaitable<void> Run(const Request& request, const UpstreamRequest& upstream);

 private:
  using CloseReason = boost::beast::websocket::close_reason;
  using Socket = boost::beast::websocket::stream<ClientStream&, /*deflateSupported=*/false>;

  boost::asio::awaitable<bool> Accept(const Request& request);
  void SpawnTasks();
  template <typename Task>
  void Spawn(Task task);

  // Forwards responses until the trailers are sent, or until the client or the gateway ends the
  // call early.
  boost::asio::awaitable<void> ForwardResponses();
  boost::asio::awaitable<bool> WriteMessage(const grpc::ByteBuffer& message);
  boost::asio::awaitable<bool> WriteTrailers(const Metadata& trailers);
  boost::asio::awaitable<bool> Write(const std::vector<boost::asio::const_buffer>& buffers);
  boost::asio::awaitable<void> Close();

  boost::asio::awaitable<void> ForwardRequests();
  // Forwards the rest of the message whose start was read. Returns an error if the connection has
  // ended.
  boost::asio::awaitable<boost::system::error_code> ForwardMessage();

  boost::asio::awaitable<void> Watch();
  void Judge(PeerLiveness& liveness);
  void Ping();

  // Ends the call and closes the WebSocket with `reason`, unless it is already being closed.
  void EndWith(const CloseReason& reason);
  void GoAway();
  // Ends the call. Only the closing handshake remains; Watch() limits its duration.
  void BeginClosing();
  // Ends the call and the connection at once.
  void Abandon();

  Site& site_;
  const std::shared_ptr<ClientLink> link_;
  Socket socket_;
  WebSocketReader<Socket> reader_;
  boost::asio::steady_timer watch_timer_;
  std::shared_ptr<UpstreamCall> call_;
  std::string client_;

  PeerLiveness::Clock::time_point accepted_at_{};
  // True once the client has sent its first message or has ended the WebSocket.
  bool has_begun_ = false;
  bool is_writing_ = false;
  // The time by which the client must have received the message being written.
  PeerLiveness::Clock::time_point write_end_{};
  bool is_pinging_ = false;
  bool is_held_back_ = false;
  bool is_closing_ = false;
  bool is_cut_off_ = false;  // true once the FrameCounter has refused the client's frames
  std::optional<CloseReason> close_reason_;
  std::optional<std::chrono::steady_clock::time_point> leave_by_;

  ChangeSignal changed_;
  bool reader_ended_ = false;
  int tasks_ = 0;
  bool tasks_ended_ = true;
};

}  // namespace thunderhead::gateway
