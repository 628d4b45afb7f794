// The gRPC server: the service, standard health checks and reflection, on a port or in process,
// with the render loop. Its storms and frame source are injected, so that tests can run it without
// files or GL.
#pragma once

#include <grpcpp/channel.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "access/door.h"
#include "base/executor.h"
#include "base/time_source.h"
#include "drawing/frame_source.h"
#include "drawing/render_loop.h"
#include "jobs/jobs.h"
#include "service/job_files.h"
#include "service/limits.h"
#include "session/session_store.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

// PEM files, which are read again when they change. If both are empty, TLS is off.
struct TlsFiles {
  std::string certificate;  // the chain, the server's own certificate first
  std::string key;
  unsigned look_every_s = 5;
};

struct ServerOptions {
  std::string address;  // HOST:PORT, port 0 for a free one; empty means no port
  TlsFiles tls;         // for that port
  // The time source of sessions, their people and the limits. It must outlive the server. A door
  // has a separate time source.
  const base::TimeSource* time = &base::SteadyTime();
  // Decides who may call. If null, all calls are allowed and no audit log is written.
  std::shared_ptr<access::Door> door;
  Limits limits;
  std::string clouds_folder;  // for generated clouds; if empty, none can be generated
  session::SessionsOptions sessions;
  std::shared_ptr<session::SessionStore> session_store;  // null if sessions end with the server
  drawing::RenderLoopOptions render_loop;
  jobs::JobsOptions jobs;
  JobFiles job_files;
  // Threads for blocking work, such as reading fields and generating clouds. The storm store reads
  // one time after another, so a few threads are enough.
  base::Executor::Limits executor;
  // Time for running calls to end on their own before a server that shuts down cancels them.
  std::chrono::seconds shutdown_grace{2};
};

// The current load of a server.
struct ServerLoad {
  int sessions = 0;
  int viewers = 0;  // viewers of sessions and own views
  int storms = 0;
  double cached_bytes = 0.0;     // size of the storms' fields in memory
  int pictures = 0;              // single pictures, started and not yet delivered
  int waiting_pictures = 0;      // those of them that wait for a lane
  double reading_stuck_s = 0.0;  // time since a hanging storage last responded; 0 if none hangs
  bool recovering = false;       // true after the device was lost
  double stalled_s = 0.0;        // time since a busy lane last drew a piece; 0 while all are idle
  // Time since the render loop's turn began; 0 while it waits for work.
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

  // Returns the listening port, or 0 if there is none.
  virtual int Port() const = 0;
  // Returns the device that the server draws on.
  virtual const drawing::DeviceInfo& Device() const = 0;
  // Returns a channel to this server from its own process, through a local socket.
  virtual std::shared_ptr<grpc::Channel> LocalChannel() = 0;
  virtual ServerLoad Load() const = 0;
  // Returns the file of a render job's picture by its path on the HTTP port, "/results/KEY/INDEX";
  // nothing if there is none.
  virtual std::optional<jobs::ResultPlace> FindResult(std::string_view path) const = 0;
  // Reports that a client has received that file completely.
  virtual void ResultFetched(std::string_view path) = 0;
  // Starts the draining of the server and returns at once. It tells all people in sessions when to
  // reconnect, to the next server. It refuses new sessions, viewers and pictures, and updates the
  // health checks. Sessions continue for people who stay, and so do pictures that were started.
  virtual void BeginDrain() = 0;

  // Replaces ServerOptions::sessions.roster_timeouts, also for timeouts that are already running.
  virtual void SetRosterTimeouts(const session::RosterTimeouts& timeouts) = 0;

  // Sets the status that gRPC's health service reports. It is serving from the start, and never
  // again once the server drains.
  virtual void SetServing(bool serving) = 0;
  // Ends every stream with UNAVAILABLE, refuses queued work and waits for running work. The
  // destructor calls it too.
  virtual void Shutdown() = 0;
};

}  // namespace thunderhead::service
