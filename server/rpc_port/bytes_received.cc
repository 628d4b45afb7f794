#include "rpc_port/bytes_received.h"

// glibc's <netinet/tcp.h> lacks this field of the kernel's, and the two headers exclude each other.
#include <linux/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <netinet/in.h>

namespace thunderhead::rpc_port {

std::uint64_t BytesReceived(int socket) {
  tcp_info info{};
  socklen_t bytes = sizeof(info);
  if (getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &bytes) != 0) return 0;
  return info.tcpi_bytes_received;
}

std::uint64_t BytesUnread(int socket) {
  int bytes = 0;
  return ioctl(socket, FIONREAD, &bytes) == 0 ? static_cast<std::uint64_t>(bytes) : 0;
}

}  // namespace thunderhead::rpc_port
