// The gRPC server: the service, standard health and reflection, on a port or in process, with the
// render loop. Its storms and frame source are injected, so that tests run it without files or GL.
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

// PEM files, read again when they change; both empty: no TLS.
struct TlsFiles {
  std::string certificate;  // the chain, the server's own certificate first
  std::string key;
  unsigned look_every_s = 5;
};

struct ServerOptions {
  std::string address;  // HOST:PORT, port 0 for a free one; empty: no port
  TlsFiles tls;         // of that port
  // The time of sessions, their people and the limits; must outlive the server. A door has its own.
  const base::TimeSource* time = &base::SteadyTime();
  // Decides who may call; null: everybody may do everything, and nothing is written down.
  std::shared_ptr<access::Door> door;
  Limits limits;
  std::string clouds_folder;  // for generated clouds; empty: none can be generated
  session::SessionsOptions sessions;
  std::shared_ptr<session::SessionStore> session_store;  // null: sessions end with the server
  drawing::RenderLoopOptions render_loop;
  jobs::JobsOptions jobs;
  JobFiles job_files;
  // Of blocking work: reading fields, making clouds. The storm store reads one after another, so a
  // few threads are enough.
  base::Executor::Limits executor;
  // For running calls to end by themselves before a server that shuts down cancels them.
  std::chrono::seconds shutdown_grace{2};
};

// The load of a server now.
struct ServerLoad {
  int sessions = 0;
  int viewers = 0;  // of sessions and own views
  int storms = 0;
  double cached_bytes = 0.0;     // of storms' fields
  int pictures = 0;              // single ones, begun and not yet delivered
  int waiting_pictures = 0;      // of them, for a lane
  double reading_stuck_s = 0.0;  // since a storage that hangs gave something; 0: none hangs
  bool recovering = false;       // the device was lost
  double stalled_s = 0.0;        // since a lane that works drew a piece; 0 while none works
  double turn_s = 0.0;           // since the render loop's turn began; 0 while it waits for work
  bool draining = false;
  jobs::JobsLoad jobs;
};

class Server {
 public:
  // Returns when the frame source is ready and the port is open.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerOptions& options, std::shared_ptr<storm_store::StormStore> store,
      const drawing::FrameSourceFactory& make_source);
  virtual ~Server() = default;

  // The listening port, 0 if none.
  virtual int Port() const = 0;
  // The device that the server draws on.
  virtual const drawing::DeviceInfo& Device() const = 0;
  // A channel to this server from its own process, through a local socket.
  virtual std::shared_ptr<grpc::Channel> LocalChannel() = 0;
  virtual ServerLoad Load() const = 0;
  // The file of a render job's picture by its path at the HTTP port, "/results/KEY/INDEX"; nothing
  // if there is none.
  virtual std::optional<jobs::ResultPlace> FindResult(std::string_view path) const = 0;
  // Somebody has got the whole of that file.
  virtual void ResultFetched(std::string_view path) = 0;
  // Tells everybody in a session when to come back, to the next server, refuses new sessions,
  // viewers and pictures, and tells health checks. Sessions, for those who stay, and pictures that
  // were begun go on. Returns at once.
  virtual void BeginDrain() = 0;

  // Replaces ServerOptions::sessions.roster_timeouts, also for waits that have begun.
  virtual void SetRosterTimeouts(const session::RosterTimeouts& timeouts) = 0;

  // Sets the status that gRPC's health service gives: serving from the start, and never again once
  // the server drains.
  virtual void SetServing(bool serving) = 0;
  // Ends every stream with UNAVAILABLE, refuses queued work, and waits for running work. The
  // destructor does it too.
  virtual void Shutdown() = 0;
};

}  // namespace thunderhead::service
