// Type-erased completion handlers and buffers for reads and writes of a stream. With these, the
// code of Asio, Beast and OpenSSL for a read or a write is compiled once per stream type, and not
// once per caller.
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

// The type-erased completion handler of a read or write.
class BytesHandler {
 public:
  // Asio requires these names for the executor that calls the handler.
  using executor_type = boost::asio::any_io_executor;
  executor_type get_executor() const { return executor_; }

  // `handler` is called on `executor`, unless it has an associated executor.
  template <typename Handler>
  BytesHandler(Handler handler, const executor_type& executor)
      : executor_(boost::asio::get_associated_executor(handler, executor)),
        call_(std::make_unique<CallOf<Handler>>(std::move(handler))) {}

  void operator()(boost::system::error_code error, size_t bytes) {
    // The handler may destroy the object that holds this BytesHandler.
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

// The first 16 buffers of a buffer sequence of any type. More are not needed, because a read or
// write may be partial.
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
