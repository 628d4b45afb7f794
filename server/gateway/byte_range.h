// A part of a file, as a request asks for it and as a response's body (RFC 9110, 14). Knows no
// socket.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/file.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/optional/optional.hpp>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace thunderhead::gateway {

struct ByteRange {
  enum class Asked { kAll, kPart, kNothingThere };
  Asked asked = Asked::kAll;
  std::uint64_t first = 0;
  std::uint64_t bytes = 0;
};

// The part of a file of this size that a Range header asks for. A header that is empty, has several
// parts or cannot be read asks for all of it, as a server may answer.
ByteRange RangeOf(std::string_view header, std::uint64_t file_bytes);

// Beast's body of a part of a file, whose place it is at.
struct FileRangeBody {
  struct value_type {
    boost::beast::file file;
    std::uint64_t bytes = 0;
  };

  static std::uint64_t size(const value_type& body) { return body.bytes; }

  class writer {
   public:
    using const_buffers_type = boost::asio::const_buffer;

    template <bool is_request, typename Fields>
    writer(boost::beast::http::header<is_request, Fields>& /*header*/, value_type& body)
        : body_(body), left_(body.bytes), buffer_(kBufferBytes) {}

    void init(boost::system::error_code& error) { error = {}; }

    boost::optional<std::pair<const_buffers_type, bool>> get(boost::system::error_code& error);

   private:
    static constexpr std::size_t kBufferBytes = 64 << 10;

    value_type& body_;
    std::uint64_t left_;
    std::vector<char> buffer_;
  };
};

}  // namespace thunderhead::gateway
