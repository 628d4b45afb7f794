// A client with its own HTTP/2 implementation. It grants the server no flow-control window, so the
// server can send no message contents.
#pragma once

#include <cstddef>
#include <string>

#include "base/file_descriptor.h"

namespace thunderhead::testing {

class UntakingClient {
 public:
  explicit UntakingClient(int port);

  enum class Stream { kEnds, kStaysOpen };
  // Calls `method`, such as "thunderhead.v1.ThunderheadService/ListStorms". `stream` says whether
  // the client ends its side of the call after the message, or leaves it open.
  void Call(const std::string& method, const std::string& message, Stream stream = Stream::kEnds);
  // Makes a call whose message is `gzip`, a text that is already compressed.
  void CallCompressed(const std::string& method, const std::string& gzip);
  // Resets the newest call.
  void Reset();
  // Makes `calls` calls with an empty message and resets each at once. Returns false if the server
  // has closed the connection before.
  bool CallAndReset(const std::string& method, int calls);
  // Sends the headers of a call whose message never follows.
  void Announce(const std::string& method);

  // Returns whether the server has begun to send a response. HTTP/2 headers need no flow-control
  // window, so they arrive although no message can follow. IsAnswered(), IsReset(), Refused() and
  // IsClosed() first read all bytes that have arrived, and answer pings.
  bool IsAnswered();
  // Returns whether the server has reset a call.
  bool IsReset();
  // Returns the number of calls that the server has refused without a message.
  int Refused();
  // Returns whether the server has closed the connection.
  bool IsClosed();

  void Leave() { socket_ = {}; }

 private:
  static std::string Frame(char type, char flags, std::size_t stream, const std::string& payload);
  void Send(const std::string& bytes);
  // Sends an answer, which the server may no longer accept.
  void Answer(const std::string& bytes);
  bool TakeFrame();
  void TakeAll();

  base::FileDescriptor socket_;
  std::size_t stream_ = 1;  // HTTP/2 stream number of the next call
  std::string received_;
  bool answered_ = false;
  bool reset_ = false;
  bool closed_ = false;
  int refused_ = 0;
};

}  // namespace thunderhead::testing
