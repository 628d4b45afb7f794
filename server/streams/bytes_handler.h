// Whoever waits for the bytes of a stream, and the bytes themselves, as one type each: what Asio,
// Beast and OpenSSL do for a read or write is compiled once for a stream, not once for each of its
// callers.
#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/system/error_code.hpp>
#include <cstddef>
#include <memory>
#include <utility>

namespace thunderhead::streams {

// The completion handler of a read or write, of whatever type it was.
class BytesHandler {
 public:
  // Asio's names for where it is to be called.
  using executor_type = boost::asio::any_io_executor;
  executor_type get_executor() const { return executor_; }

  // Called on `executor` unless `handler` has one of its own.
  template <typename Handler>
  BytesHandler(Handler handler, const executor_type& executor)
      : executor_(boost::asio::get_associated_executor(handler, executor)),
        call_(std::make_unique<CallOf<Handler>>(std::move(handler))) {}

  void operator()(boost::system::error_code error, size_t bytes) {
    // The handler may end what it is kept in.
    const std::unique_ptr<Call> call = std::move(call_);
    call->Run(error, bytes);
  }

 private:
  struct Call {
    virtual ~Call() = default;
    virtual void Run(boost::system::error_code error, size_t bytes) = 0;
  };
  template <typename Handler>
  struct CallOf : Call {
    explicit CallOf(Handler&& from) : handler(std::move(from)) {}
    void Run(boost::system::error_code error, size_t bytes) override {
      std::move(handler)(error, bytes);
    }
    Handler handler;
  };

  executor_type executor_;
  std::unique_ptr<Call> call_;
};

// The first buffers of a sequence of any type; a read or write of some bytes needs no more.
template <typename Buffer>
class FewBuffers {
 public:
  using value_type = Buffer;
  using const_iterator = const Buffer*;

  template <typename Buffers>
  FewBuffers(const Buffers& buffers) {  // NOLINT(google-explicit-constructor): as Asio's own
    const auto end = boost::asio::buffer_sequence_end(buffers);
    for (auto it = boost::asio::buffer_sequence_begin(buffers); it != end; ++it) {
      if (count_ == buffers_.size()) break;
      buffers_[count_++] = Buffer(*it);
    }
  }

  const_iterator begin() const { return buffers_.data(); }
  const_iterator end() const { return buffers_.data() + count_; }

 private:
  std::array<Buffer, 16> buffers_;
  size_t count_ = 0;
};

}  // namespace thunderhead::streams
