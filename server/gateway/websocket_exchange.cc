#include "gateway/websocket_exchange.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/option.hpp>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "gateway/call_header.h"
#include "gateway/frame_counter.h"
#include "gateway/message_slices.h"
#include "gateway/refusals.h"
#include "gateway/websocket_protocol.h"
#include "grpcpp/support/slice.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kCloseTimeout{5000};
// Timeout for sending the close frame when the gateway shuts down, because the gateway waits for
// its connections.
constexpr milliseconds kLeaveTimeout{1000};
constexpr milliseconds kSlowestWatch{500};
constexpr milliseconds kFastestWatch{5};

std::string TextOf(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return known.what();
  } catch (...) {
    return "an exception of an unknown type";
  }
}

}  // namespace

WebSocketExchange::WebSocketExchange(Site& site, std::shared_ptr<ClientLink> link)
    : site_(site),
      link_(std::move(link)),
      socket_(link_->Stream()),
      reader_(socket_),
      watch_timer_(link_->Stream().get_executor()),
      changed_(link_->Stream().get_executor()) {}

net::awaitable<void> WebSocketExchange::Run(const Request& request,
                                            const UpstreamRequest& upstream) {
  client_ = ClientOf(request, link_->Peer(), site_.options.trusted_proxies);
  const bool accepted = co_await Accept(request);
  if (!accepted) co_return;
  const UpstreamCall::Lease call =
      UpstreamCall::Start(site_.stub, link_->Stream().get_executor(), upstream);
  call_ = call.Share();
  link_->SetFarewell([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->GoAway();
  });
  SpawnTasks();
  co_await ForwardResponses();
  co_await Close();
  Abandon();
  link_->SetFarewell(nullptr);
  co_await changed_.AwaitTrue(tasks_ended_);
  link_->Stream().WatchReads(nullptr);
}

net::awaitable<bool> WebSocketExchange::Accept(const Request& request) {
  // The stream and Watch() limit the times, and the WebSocket's own timeouts are off. These would
  // drop a client that is held back by flow control, or that receives a large message slowly.
  socket_.set_option(websocket::stream_base::timeout{websocket::stream_base::none(),
                                                     websocket::stream_base::none(), false});
  link_->Stream().expires_after(site_.options.idle_timeout);
  socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    response.set(boost::beast::http::field::sec_websocket_protocol, kWebSocketSubprotocol);
  }));
  error_code error;
  co_await socket_.async_accept(request, net::redirect_error(net::use_awaitable, error));
  if (error) co_return false;
  link_->Stream().expires_never();
  reader_.Limit(site_.options.max_message_bytes);
  socket_.binary(true);
  // With fragmentation, each message would be sent in frames of 4 KiB.
  socket_.auto_fragment(false);
  accepted_at_ = site_.Now();
  link_->Stream().WatchReads(
      [this, frames = FrameCounter(accepted_at_)](std::span<const std::byte> bytes) mutable {
        if (frames.Take(bytes, site_.Now())) return true;
        if (is_closing_) return false;
        is_cut_off_ = true;
        if (frames.HasForbiddenCode()) {
          EndWith({websocket::close_code::protocol_error, "close with a code of 1000 to 4999"});
          return false;
        }
        TellOfRefusal(site_.options, client_, "Message", TooManyEmptyFrames());
        EndWith({websocket::close_code::policy_error, "too many frames without content"});
        return false;
      });
  co_return true;
}

void WebSocketExchange::SpawnTasks() {
  Spawn(ForwardRequests());
  Spawn(Watch());
}

template <typename Task>
void WebSocketExchange::Spawn(Task task) {
  ++tasks_;
  tasks_ended_ = false;
  net::co_spawn(link_->Stream().get_executor(), std::move(task),
                [self = shared_from_this()](const std::exception_ptr& error) {
                  if (error) {
                    spdlog::error("closing a WebSocket after an internal error: {}", TextOf(error));
                    self->Abandon();
                  }
                  self->tasks_ended_ = --self->tasks_ == 0;
                  self->changed_.Notify();
                });
}

net::awaitable<void> WebSocketExchange::ForwardResponses() {
  bool written = true;
  while (written) {
    const std::optional<grpc::ByteBuffer> message = co_await call_->ReadMessage();
    if (is_closing_) co_return;
    if (!message.has_value()) break;
    // The service has now admitted the call, so the connection counts as calling. Before, it could
    // be closed to make place for other connections.
    if (link_->Use() != LinkUse::kCalling) link_->Begin(LinkUse::kCalling);
    const std::shared_ptr<const void> place = site_.unsent_answers.Take(*link_, message->Length());
    if (place == nullptr) {
      TellOfRefusal(site_.options, client_, "Answer", AnswersNotTaken());
      const Metadata refusal =
          Trailers(AnswersNotTaken().code(), std::string(AnswersNotTaken().message()), {});
      written = co_await WriteTrailers(refusal);
      if (written) EndWith(websocket::close_code::normal);
      co_return;
    }
    written = co_await WriteMessage(*message);
  }
  if (!written) co_return;
  const grpc::Status status = co_await call_->Finish();
  if (is_closing_) co_return;
  const Metadata trailers = TrailersOf(status, call_->TrailingMetadata());
  written = co_await WriteTrailers(trailers);
  if (written) EndWith(websocket::close_code::normal);
}

net::awaitable<bool> WebSocketExchange::WriteMessage(const grpc::ByteBuffer& message) {
  const MessageSlices slices(message);
  std::vector<net::const_buffer> buffers = {net::buffer(&kMessageKind, 1)};
  slices.AppendTo(buffers);
  const bool written = co_await Write(buffers);
  co_return written;
}

net::awaitable<bool> WebSocketExchange::WriteTrailers(const Metadata& trailers) {
  const std::string text = TrailerBlock(trailers);
  const std::vector<net::const_buffer> buffers = {net::buffer(&kTrailersKind, 1),
                                                  net::buffer(text)};
  const bool written = co_await Write(buffers);
  co_return written;
}

net::awaitable<bool> WebSocketExchange::Write(const std::vector<net::const_buffer>& buffers) {
  is_writing_ = true;
  write_end_ = site_.Now() + site_.options.DeliveryTime(net::buffer_size(buffers));
  error_code error;
  co_await socket_.async_write(buffers, net::redirect_error(net::use_awaitable, error));
  is_writing_ = false;
  co_return !error;
}

net::awaitable<void> WebSocketExchange::Close() {
  BeginClosing();
  if (is_cut_off_) {
    // Beast treats the failed read as the end of the connection and would send no close frame. So
    // the close frame is written here.
    link_->Stream().expires_after(kLeaveTimeout);
    co_await link_->Stream().WriteLast(CloseFrame(*close_reason_));
    co_await changed_.AwaitTrue(reader_ended_);
    co_await link_->Stream().LingeringClose();
  } else if (!close_reason_.has_value() || !socket_.is_open()) {
    // No close frame is written here. Beast's reader answers a client that closes the WebSocket,
    // and closes the WebSocket of a client that breaks the protocol.
    co_await changed_.AwaitTrue(reader_ended_);
  } else if (reader_ended_) {
    error_code ignored;
    co_await socket_.async_close(*close_reason_, net::redirect_error(net::use_awaitable, ignored));
  } else {
    // Beast's closing and a pending reader could wait for each other forever, if the reader finds a
    // broken frame while the close frame is in flight. So Beast's closing is not used. The reader
    // ends by the client's close frame, by a broken frame, or by a message that the call no longer
    // accepts.
    co_await link_->Stream().WriteLast(CloseFrame(*close_reason_));
    co_await changed_.AwaitTrue(reader_ended_);
    if (socket_.is_open()) co_await link_->Stream().LingeringClose();
  }
}

net::awaitable<void> WebSocketExchange::ForwardRequests() {
  error_code error = co_await reader_.ReadStart();
  has_begun_ = true;
  while (!error) {
    if (const auto violation = FindViolation(reader_.Start()); violation.has_value()) {
      EndWith(*violation);
      break;
    }
    is_held_back_ = true;
    co_await call_->AwaitWritten();
    is_held_back_ = false;
    if (reader_.IsHalfClose()) {
      call_->BeginHalfClose();
    } else {
      error = co_await ForwardMessage();
    }
    if (!error) error = co_await reader_.ReadStart();
  }
  if (error == websocket::error::message_too_big) {
    TellOfRefusal(site_.options, client_, "Message", MessageTooLarge());
  }
  if (!is_closing_) Abandon();
  reader_ended_ = true;
  changed_.Notify();
}

net::awaitable<error_code> WebSocketExchange::ForwardMessage() {
  boost::beast::flat_buffer payload;
  const error_code error = co_await reader_.ReadPayload(payload);
  if (error) co_return error;
  const grpc::Slice slice =
      payload.size() == 0 ? grpc::Slice() : grpc::Slice(payload.cdata().data(), payload.size());
  call_->BeginWrite(grpc::ByteBuffer(&slice, 1));
  co_return error;
}

net::awaitable<void> WebSocketExchange::Watch() {
  const GatewayOptions& options = site_.options;
  PeerLiveness liveness(
      {options.websocket_ping_interval, options.write_stall_timeout, kCloseTimeout}, site_.Now());
  const milliseconds period =
      std::clamp(std::min({options.websocket_ping_interval, options.write_stall_timeout,
                           options.header_timeout}) /
                     4,
                 kFastestWatch, kSlowestWatch);
  while (link_->Stream().socket().is_open()) {
    watch_timer_.expires_at(options.time->LookAgainAt(site_.Now() + period));
    error_code woken;
    co_await watch_timer_.async_wait(net::redirect_error(net::use_awaitable, woken));
    if (link_->Stream().socket().is_open()) Judge(liveness);
  }
}

void WebSocketExchange::Judge(PeerLiveness& liveness) {
  const auto now = site_.Now();
  // Beast's reader itself answers a close frame, and closes a connection that breaks the protocol.
  // The reader returns only after the TCP connection has ended too. So the closed socket is noticed
  // here.
  if (!socket_.is_open()) BeginClosing();
  const PeerLiveness::Verdict verdict =
      liveness.Judge({link_->ReceivedBytes(), link_->SentBytes(), link_->DeliveredBytes(),
                      is_writing_, is_pinging_, !is_held_back_, is_closing_},
                     now);
  if (!has_begun_ && now - accepted_at_ > site_.options.header_timeout) {
    EndWith({websocket::close_code::policy_error, "no message came in time"});
  }
  const bool is_too_slow = is_writing_ && now > write_end_;
  const bool must_leave = leave_by_.has_value() && now >= *leave_by_;
  if (verdict == PeerLiveness::Verdict::kDrop || is_too_slow || must_leave ||
      (is_held_back_ && link_->HasHungUp())) {
    Abandon();
  } else if (verdict == PeerLiveness::Verdict::kPing) {
    Ping();
  }
}

void WebSocketExchange::Ping() {
  is_pinging_ = true;
  socket_.async_ping({}, [self = shared_from_this()](error_code) { self->is_pinging_ = false; });
}

void WebSocketExchange::EndWith(const CloseReason& reason) {
  if (is_closing_) return;
  close_reason_ = reason;
  BeginClosing();
}

void WebSocketExchange::BeginClosing() {
  if (is_closing_) return;
  is_closing_ = true;
  call_->Cancel();
}

void WebSocketExchange::GoAway() {
  EndWith({websocket::close_code::going_away, "the server is going away"});
  leave_by_ = site_.Now() + kLeaveTimeout;
}

void WebSocketExchange::Abandon() {
  BeginClosing();
  link_->Close();
  watch_timer_.cancel();
}

}  // namespace thunderhead::gateway
