// An HTTP/1.1 client that sends exactly the given bytes, and parses gRPC-Web without a library.
// Every wait ends after testing::kHangLimit.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace thunderhead::gateway::test {

using Response = boost::beast::http::response<boost::beast::http::string_body>;
using Headers = std::vector<std::pair<std::string, std::string>>;

class RawClient {
 public:
  // Connects. `receive_buffer_bytes` above 0 limits the bytes that the kernel buffers for the
  // client.
  explicit RawClient(uint16_t port, int receive_buffer_bytes = 0);

  void Send(const std::string& bytes);
  // Sends the bytes to a server that may close before it has read them all. Returns false if it
  // did.
  bool SendUntilClosed(const std::string& bytes);
  // Reads the next response; a response to a HEAD request has no body.
  Response Read(bool to_head = false);
  // Sends a request with a Host header and reads its response.
  Response Ask(const std::string& method, const std::string& target, const Headers& headers = {},
               const std::string& body = "");

  // Reads the headers of a response whose body is read as it arrives.
  Response ReadHeaders();
  // Reads until the body has `bytes` bytes, or has ended. Returns the body so far.
  const std::string& ReadBody(size_t bytes);

  // Returns true if the server ends the connection within the wait and sends nothing before.
  bool IsClosed();
  // Returns true if the server ends the connection within the wait, whatever it sends before.
  bool IsEnded();
  // Returns all bytes that the server sends before the connection ends.
  std::string ReadToEnd();
  // Returns true if bytes or the end of the connection can be read.
  bool HasInput();
  // Sends the bytes that the kernel accepts at once. Another thread may wait for the server
  // meanwhile.
  void SendNow(const std::string& bytes);
  void ShutdownSending();
  void Close();

 private:
  using Parser = boost::beast::http::response_parser<boost::beast::http::string_body>;
  template <typename Start>
  boost::system::error_code Await(Start start);
  boost::system::error_code Write(const std::string& bytes);
  // Appends all bytes that arrive. Returns the error that ended the reading.
  boost::system::error_code ReadInto(std::string* all);

  boost::asio::io_context io_;
  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_;
  std::unique_ptr<Parser> parser_;
};

// Returns the "POST" request of a gRPC-Web call with its Host header and content type.
std::string CallRequest(const std::string& method, const std::string& body,
                        const Headers& headers = {});

// Returns `message` in a frame.
std::string Frame(const std::string& message, uint8_t flags = 0);

// The parsed body of a response.
struct CallResult {
  std::vector<std::string> messages;
  std::multimap<std::string, std::string> trailers;  // from the headers if there is no body
  bool trailers_only = false;

  std::string Trailer(const std::string& name) const;
};
CallResult ParseResult(const Response& response);

// Makes one whole call on a separate connection.
CallResult Call(uint16_t port, const std::string& method, const std::string& message,
                const Headers& headers = {});

}  // namespace thunderhead::gateway::test
