// Sends the responses of one HTTP/1.1 connection. Adds the headers that HttpPolicy requires, and
// applies the time limit for the client to receive a response.
#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/site.h"

namespace thunderhead::gateway {

class HttpAnswers {
 public:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Header = boost::beast::http::response<boost::beast::http::empty_body>;
  template <typename T>
  using Awaitable = boost::asio::awaitable<T>;

  HttpAnswers(ClientLink& link, Site& site) : link_(link), site_(site) {}

  // Sets whether a part of the request may still be unread. If so, the next response is the
  // connection's last.
  void SetUnreadInput(bool unread) { unread_input_ = unread; }
  bool HasUnreadInput() const { return unread_input_; }

  // Sends a response. Both functions return true if the connection may be used again.
  Awaitable<bool> SendText(const Request& request, boost::beast::http::status status,
                           const std::string& text, std::string_view allowed_methods = {});
  Awaitable<bool> Send(const Request& request, Header& header);
  // Completes the header of a response whose body the caller sends. Returns true if the connection
  // may be used again afterwards.
  bool Complete(const Request& request, Header& header);
  // Returns the time by which the client must have received `bytes` bytes.
  ClientLink::Clock::time_point EndOfSending(std::uint64_t bytes) const;

  // Returns the client's address, with its port if it is known.
  std::string OwnerOf(const Request& request) const;
  void Tell(const Request& request, const char* act, const absl::Status& refusal) const;

 private:
  template <typename Body>
  Awaitable<bool> SendAny(const Request& request, boost::beast::http::response<Body>& response);
  template <typename Body>
  bool CompleteAny(const Request& request, boost::beast::http::response<Body>& response);

  ClientLink& link_;
  Site& site_;
  bool unread_input_ = false;
};

}  // namespace thunderhead::gateway
