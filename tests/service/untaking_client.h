// A client that speaks HTTP/2 by itself, and grants no room for what the server sends.
#pragma once

#include <cstddef>
#include <string>

#include "base/file_descriptor.h"

namespace thunderhead::testing {

class UntakingClient {
 public:
  explicit UntakingClient(int port);

  enum class Stream { kEnds, kStaysOpen };
  // `method` with its service; its own side of the call ends with the message, or stays open.
  void Call(const std::string& method, const std::string& message, Stream stream = Stream::kEnds);
  // A call whose message is `gzip`, compressed already.
  void CallCompressed(const std::string& method, const std::string& gzip);
  // The headers of a call whose message does not come.
  void Announce(const std::string& method);

  // Each takes what has come, and answers pings.
  // Returns whether the server has reset a call.
  bool IsReset();
  // Returns how many calls the server has refused without a message.
  int Refused();
  // Returns whether the server has closed the connection.
  bool IsClosed();

  void Leave() { socket_ = {}; }

 private:
  static std::string Frame(char type, char flags, std::size_t stream, const std::string& payload);
  void Send(const std::string& bytes);
  // The same for an answer, which the server may no longer take.
  void Answer(const std::string& bytes);
  bool TakeFrame();
  void TakeAll();

  base::FileDescriptor socket_;
  std::size_t stream_ = 1;  // the next call's
  std::string received_;
  bool reset_ = false;
  bool closed_ = false;
  int refused_ = 0;
};

}  // namespace thunderhead::testing
