// The gRPC server with the render loop: the service, standard health checks and reflection. It
// listens on a port, or is reached in process only. Its storms and its frame source are passed in,
// so that tests can run it without files or GL.
#pragma once

#include <grpcpp/channel.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "access/access_control.h"
#include "base/certificate_files.h"
#include "base/executor.h"
#include "base/time_source.h"
#include "drawing/frame_source.h"
#include "drawing/render_loop.h"
#include "jobs/jobs.h"
#include "service/engine/limits.h"
#include "service/jobs/job_files.h"
#include "session/session_store.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

struct ServerOptions {
  std::string address;  // HOST:PORT, with port 0 for a free port; empty means no port
  base::TlsFiles tls;   // TLS of that port
  // The time source of sessions, their people and the limits. It must outlive the server.
  // `access_control` has its own time source.
  const base::TimeSource* time = &base::SteadyTime();
  // Decides who may call. If null, all calls are allowed and no audit log is written.
  std::shared_ptr<access::AccessControl> access_control;
  Limits limits;
  std::string clouds_folder;  // folder for generated clouds; if empty, none can be generated
  session::SessionsOptions sessions;
  std::shared_ptr<session::SessionStore> session_store;  // null if sessions end with the server
  drawing::RenderLoopOptions render_loop;
  jobs::JobsOptions jobs;
  JobFiles job_files;
  // Threads for blocking work, such as reading fields and generating clouds. The storm store
  // normally reads only one time of a storm at once, so a few threads are enough.
  base::Executor::Limits executor;
  // When the server shuts down, the time for calls to end on their own before they are cancelled.
  std::chrono::seconds shutdown_grace{2};
};

// The current load of a server.
struct ServerLoad {
  int sessions = 0;
  std::size_t max_sessions = 0;  // sessions that may be open at once
  int viewers = 0;               // viewers of sessions' views and of their own views
  int storms = 0;
  double cached_bytes = 0.0;  // size of the storms' fields in memory
  int pictures = 0;           // single pictures that were requested and not yet delivered
  int waiting_pictures = 0;   // those of `pictures` that wait for a worker
  // Seconds for which a read of a storm file has made no progress, because its storage hangs; 0 if
  // no read hangs.
  double reading_stuck_s = 0.0;
  bool recovering = false;  // true from the loss of the device until it is open again
  // The longest time in seconds that a worker has now worked without drawing a piece or waiting for
  // a turn on the device; 0 if no worker works.
  double stalled_s = 0.0;
  // Seconds since the render loop's current turn began; 0 while the loop waits for work.
  double turn_s = 0.0;
  bool draining = false;
  jobs::JobsLoad jobs;
};

class Server {
 public:
  // Starts a server and returns when the frame source is ready and the port is open.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerOptions& options, std::shared_ptr<storm_store::StormStore> store,
      const drawing::FrameSourceFactory& make_source);
  virtual ~Server() = default;

  // Returns the port on which the server listens, or 0 if it listens on none.
  virtual int Port() const = 0;
  // Returns the device that the server draws on.
  virtual const drawing::DeviceInfo& Device() const = 0;
  // Returns a channel to this server from its own process, through a local socket.
  virtual std::shared_ptr<grpc::Channel> LocalChannel() = 0;
  virtual ServerLoad Load() const = 0;
  // Returns the result file of a render job's picture by its path on the HTTP port,
  // "/results/KEY/INDEX". Returns nothing if there is no such result.
  virtual std::optional<jobs::ResultPlace> FindResult(std::string_view path) const = 0;
  // Records that a client has received the file at that path completely.
  virtual void ResultFetched(std::string_view path) = 0;
  // Starts draining the server, without waiting. All people in sessions are told when to reconnect,
  // to the next server. New sessions, viewers and pictures are refused, and the health checks
  // report that the server does not serve. Sessions continue for the people who stay, and started
  // pictures are completed.
  virtual void BeginDrain() = 0;

  // Replaces ServerOptions::sessions.roster_timeouts, also for timeouts that are already running.
  virtual void SetRosterTimeouts(const session::RosterTimeouts& timeouts) = 0;

  // Sets the status that gRPC's health service reports. After Start it is "serving". Once the
  // server drains, it stays "not serving".
  virtual void SetServing(bool serving) = 0;
  // Ends every stream with UNAVAILABLE, refuses queued work and waits for running work. The
  // destructor calls this too.
  virtual void Shutdown() = 0;
};

}  // namespace thunderhead::service
