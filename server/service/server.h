// The gRPC server: the service, standard health and reflection, on a port or in process, with the
// loop that draws. Takes its storms and its frame source from outside, so that tests run it without
// files or GL.
#pragma once

#include <grpcpp/channel.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/frame_source.h"
#include "session/render_loop.h"
#include "session/sessions.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

struct ServerOptions {
  std::string address;        // HOST:PORT, port 0 for a free one; empty listens nowhere
  std::string clouds_folder;  // of generated clouds; empty makes none
  session::SessionsOptions sessions;
  session::RenderLoopOptions render_loop;
};

class Server {
 public:
  // Returns when the frame source is made and the port is open.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerOptions& options, std::shared_ptr<volume::StormStore> store,
      const session::FrameSourceFactory& make_source);
  virtual ~Server() = default;

  // The port that is listened on, 0 if none.
  virtual int Port() const = 0;
  // What the server draws on.
  virtual const session::DeviceInfo& Device() const = 0;
  // A channel to this server from its own process, by a local socket.
  virtual std::shared_ptr<grpc::Channel> LocalChannel() = 0;
  // Ends every stream with UNAVAILABLE, drops what waits, and waits for what runs. The destructor
  // does it too.
  virtual void Shutdown() = 0;
};

}  // namespace thunderhead::service
