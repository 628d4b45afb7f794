// Tells how much a TCP connection has received.
#pragma once

#include <cstdint>

namespace thunderhead::rpc_port {

// Returns the number of bytes that the peer of this socket has sent and the kernel has received.
// Returns 0 if the socket is no TCP connection.
std::uint64_t BytesReceived(int socket);
// Returns how many of these bytes the process has not read yet.
std::uint64_t BytesUnread(int socket);

}  // namespace thunderhead::rpc_port
