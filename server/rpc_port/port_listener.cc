#include "rpc_port/port_listener.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cstring>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/allowance.h"
#include "base/client_network.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::rpc_port {
namespace {

// The connections are checked this many times within the timeout of an unused connection.
constexpr int kLooks = 10;

struct HostAndPort {
  std::string host;
  std::string port;
};

// Splits "HOST:PORT". The host is returned without the brackets of an IPv6 address.
HostAndPort Split(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  HostAndPort parts{address.substr(0, colon), address.substr(colon + 1)};
  if (parts.host.starts_with('[') && parts.host.ends_with(']')) {
    parts.host = parts.host.substr(1, parts.host.size() - 2);
  }
  return parts;
}

void Set(int socket, int level, int option, int value) {
  setsockopt(socket, level, option, &value, sizeof(value));
}

int PortOf(int socket) {
  sockaddr_storage own{};
  socklen_t bytes = sizeof(own);
  getsockname(socket, reinterpret_cast<sockaddr*>(&own), &bytes);
  return ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6*>(&own)->sin6_port
                                         : reinterpret_cast<const sockaddr_in*>(&own)->sin_port);
}

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses Resolve(const std::string& host, const std::string& port) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) found = nullptr;
  return {found, &freeaddrinfo};
}

base::FileDescriptor ListenOn(const addrinfo& at, std::chrono::milliseconds unanswered) {
  base::FileDescriptor socket(
      ::socket(at.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.IsOpen()) return {};
  Set(socket.Get(), SOL_SOCKET, SO_REUSEADDR, 1);
  // A socket on [::] accepts IPv4 too. Each accepted connection inherits the options set here.
  if (at.ai_family == AF_INET6) Set(socket.Get(), IPPROTO_IPV6, IPV6_V6ONLY, 0);
  Set(socket.Get(), IPPROTO_TCP, TCP_NODELAY, 1);
  // gRPC's keepalive does not end a connection in the middle of a message, so the socket gets a
  // timeout too.
  Set(socket.Get(), IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(unanswered.count()));
  if (bind(socket.Get(), at.ai_addr, at.ai_addrlen) != 0) return {};
  if (listen(socket.Get(), SOMAXCONN) != 0) return {};
  return socket;
}

}  // namespace

absl::StatusOr<std::unique_ptr<PortListener>> PortListener::Open(
    const std::string& address, std::chrono::milliseconds unanswered) {
  const HostAndPort parts = Split(address);
  std::vector<base::FileDescriptor> sockets;
  int port = 0;
  const auto listen = [&](const std::string& host) {
    const Addresses found = Resolve(host, parts.port);
    for (const addrinfo* at = found.get(); at != nullptr; at = at->ai_next) {
      base::FileDescriptor socket = ListenOn(*at, unanswered);
      if (!socket.IsOpen()) continue;
      // With port 0, each address would get a different port, so the first one's port is used for
      // all.
      const int its_port = PortOf(socket.Get());
      if (sockets.empty()) port = its_port;
      if (its_port == port) sockets.push_back(std::move(socket));
    }
  };
  const bool all = parts.host == "0.0.0.0" || parts.host == "::";
  listen(all ? "::" : parts.host);
  // On a machine without IPv6, 0.0.0.0 must be used instead of [::].
  if (all && sockets.empty()) listen("0.0.0.0");
  if (!sockets.empty()) {
    return std::unique_ptr<PortListener>(new PortListener(std::move(sockets), port));
  }
  return absl::UnavailableError(absl::StrCat("cannot listen for gRPC on ", address,
                                             ": it is not an address of this machine, or the port "
                                             "is in use; choose another address or port"));
}

absl::Status PortListener::Start(Acceptor acceptor, OpenSockets open, const Options& options,
                                 Refused report) {
  // The objects are held by shared pointers, because std::function must be copyable.
  const auto sockets = std::make_shared<OpenSockets>(std::move(open));
  const auto handshakes = std::make_shared<base::Allowances>(options.handshakes_per_address);
  const auto refused = std::make_shared<const Refused>(std::move(report));
  auto take = [acceptor = std::shared_ptr(std::move(acceptor)), sockets, handshakes,
               calls = options.calls, proxies = options.proxies, &time = *options.time,
               refused](base::FileDescriptor connection) {
    const auto peer = OpenSockets::PeerOf(connection.Get());
    if (!peer.has_value()) return;  // the peer has already disconnected
    if (calls->IsBlocked(*peer)) return (*refused)(*peer, base::TooManyCalls());
    if (!proxies.Holds(*peer) && handshakes->Take(base::NetworkOf(*peer), time.Now()).has_value()) {
      return (*refused)(*peer, base::TooManyHandshakes());
    }
    if (!sockets->Take(connection.Get(), *peer, time.Now()))
      return (*refused)(*peer, base::TooManyConnections());
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters handed;
    handed.fd = connection.Release();
    acceptor->HandleNewConnection(&handed);
  };
  auto tend = [sockets, calls = options.calls, unused = options.unused, &time = *options.time,
               refused] {
    std::vector<std::string> blocked = calls->TakeNewlyBlocked();
    if (blocked.empty() && calls->HasBacklog()) {
      if (auto most = sockets->WhoSendsMost(); most.has_value()) {
        calls->Block(*most);
        blocked.push_back(*std::move(most));
      }
    }
    for (const std::string& peer : blocked) {
      sockets->AbortNetworkOf(peer);
      (*refused)(peer, base::TooManyCalls());
    }
    sockets->CloseUnused(unused, time.Now());
  };
  THUNDERHEAD_ASSIGN_OR_RETURN(
      loop_, AcceptLoop::Start(std::move(sockets_), std::move(take),
                               AcceptLoop::Chore{.pause = options.unused / kLooks,
                                                 .run = std::move(tend),
                                                 .time = options.time,
                                                 .signal = options.calls->Signal()}));
  return absl::OkStatus();
}

}  // namespace thunderhead::rpc_port
