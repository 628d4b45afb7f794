#include "service/server.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/executor.h"
#include "base/status.h"
#include "base/wake_signal.h"
#include "rpc_port/call_budgets.h"
#include "rpc_port/connection_calls.h"
#include "rpc_port/grpc_certificate.h"
#include "rpc_port/health_service.h"
#include "rpc_port/local_listener.h"
#include "rpc_port/open_sockets.h"
#include "rpc_port/port_listener.h"
#include "rpc_port/reflection_service.h"
#include "rpc_port/server_settings.h"
#include "service/engine/catalogue_follower.h"
#include "service/engine/engine.h"
#include "service/interact/interact_messages.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/job_pictures.h"
#include "service/jobs/render_job_service.h"
#include "service/stored_scene.h"
#include "service/thunderhead_service.h"
#include "session/session_keeper.h"
#include "session/upkeep.h"
#include "telemetry/metrics.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::service {
namespace {

// Maximum size of a response: that of the largest uncompressed RGB picture that CheckScene allows,
// with a margin.
constexpr int kMaxResponseBytes = 128 << 20;

std::shared_ptr<access::AccessControl> OpenAccessControl() {
  return std::make_shared<access::AccessControl>(
      access::TrustEverybody(), std::make_shared<access::Audit>([](const std::string&) {}),
      access::QuotaLimits());
}

session::SessionsOptions SessionsOf(const ServerOptions& options) {
  session::SessionsOptions sessions = options.sessions;
  sessions.format = InteractFormat();
  sessions.time = options.time;
  return sessions;
}

Limits LimitsOf(const ServerOptions& options) {
  Limits limits = options.limits;
  limits.time = options.time;
  return limits;
}

class RunningServer final : public Server {
 public:
  RunningServer(const ServerOptions& options, std::shared_ptr<storm_store::StormStore> store)
      : store_(std::move(store)),
        session_store_(options.session_store),
        access_control_(options.access_control != nullptr ? options.access_control
                                                          : OpenAccessControl()),
        limits_(LimitsOf(options)),
        job_files_(options.job_files),
        shutdown_grace_(options.shutdown_grace),
        connection_calls_(std::make_shared<rpc_port::ConnectionCalls>(*options.time)),
        sessions_(SessionsOf(options), {[this] { wake_.Notify(); }, [this] { due_.Notify(); }}),
        executor_(options.executor),
        clouds_(options.clouds_folder, *store_, options.render_loop.memory) {}

  ~RunningServer() override { RunningServer::Shutdown(); }

  absl::Status StartLoop(drawing::RenderLoopOptions options,
                         const drawing::FrameSourceFactory& make_source) {
    options.serialize_frame = SerializedFrame;
    THUNDERHEAD_ASSIGN_OR_RETURN(
        loop_, drawing::RenderLoop::Start(options, *store_, sessions_, wake_, make_source));
    return absl::OkStatus();
  }

  // Restores the sessions from the store.
  absl::Status StartKeeper() {
    if (session_store_ == nullptr) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(
        keeper_, session::SessionKeeper::Start(
                     *session_store_, sessions_, [this](const std::string& serialized) {
                       return DecodeStoredScene(*store_, loop_->Techniques(), serialized);
                     }));
    return absl::OkStatus();
  }

  // Restores the jobs from the store.
  absl::Status StartJobs(const jobs::JobsOptions& options) {
    if (options.folder.empty()) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(jobs_, jobs::Jobs::Open(options));
    return absl::OkStatus();
  }

  absl::Status Listen(const std::string& address, const base::TlsFiles& tls) {
    catalogue_ = std::make_unique<CatalogueFollower>(*store_, sessions_, *loop_);
    engine_ = std::make_unique<Engine>(Engine{*store_, sessions_, *loop_, wake_, executor_, clouds_,
                                              keeper_.get(), *catalogue_, drain_, limits_});
    service_ = MakeThunderheadService(*engine_, *access_control_, *connection_calls_);
    job_service_ = std::make_unique<RenderJobService>(*engine_, *access_control_,
                                                      *connection_calls_, jobs_.get(), job_files_);
    grpc::ServerBuilder builder;
    builder.RegisterService(service_.get());
    builder.RegisterService(job_service_.get());
    builder.RegisterService(&health_);
    builder.RegisterService(&reflection_);
    rpc_port::SetLimits(builder, limits_, kMaxResponseBytes);
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::shared_ptr<rpc_port::CallBudgets> call_budgets,
        rpc_port::CallBudgets::Open(limits_.max_calls_per_address, access_control_->Proxies(),
                                    *limits_.time));
    std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> counters;
    counters.push_back(rpc_port::CountCalls(call_budgets));
    builder.experimental().SetInterceptorCreators(std::move(counters));
    builder.SetContextAllocator(rpc_port::CountReceived(call_budgets));
    builder.RegisterCallbackGenericService(&unknown_methods_);
    rpc_port::PortListener::Acceptor acceptor;
    if (!address.empty()) {
      THUNDERHEAD_ASSIGN_OR_RETURN(
          port_, rpc_port::PortListener::Open(address, rpc_port::kKeepaliveTimeout));
      std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
      if (!tls.certificate.empty()) {
        THUNDERHEAD_ASSIGN_OR_RETURN(certificate_,
                                     rpc_port::GrpcCertificate::Open(tls, *limits_.time));
        credentials = certificate_->Credentials();
      }
      using Builder = grpc::ServerBuilder::experimental_type;
      acceptor = builder.experimental().AddExternalConnectionAcceptor(
          Builder::ExternalConnectionType::FROM_FD, credentials);
    }
    server_ = builder.BuildAndStart();
    if (server_ == nullptr) return absl::InternalError("gRPC's server does not start");
    THUNDERHEAD_ASSIGN_OR_RETURN(local_, rpc_port::LocalListener::Start(*server_));
    if (port_ != nullptr) {
      THUNDERHEAD_RETURN_IF_ERROR(port_->Start(
          std::move(acceptor),
          rpc_port::OpenSockets(limits_.max_connections, limits_.max_connections_per_address,
                                access_control_->Proxies(), connection_calls_),
          {.unused = limits_.unused_connection,
           .handshakes_per_address =
               tls.certificate.empty() ? 0.0 : limits_.max_handshakes_per_address,
           .calls = call_budgets,
           .proxies = access_control_->Proxies(),
           .time = limits_.time},
          [this](const std::string& peer, const absl::Status& why) {
            telemetry::Counted().refusals.Of(base::DetailsOf(why).reason).Add();
            access_control_->ReportBeforeCall(peer, "Connect", why);
          }));
    }
    SetServing(true);
    if (jobs_ != nullptr) jobs_->Start(JobPictures(*engine_, job_files_));
    return absl::OkStatus();
  }

  int Port() const override { return port_ != nullptr ? port_->Port() : 0; }
  const drawing::DeviceInfo& Device() const override { return loop_->Device(); }

  std::shared_ptr<grpc::Channel> LocalChannel() override {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(kMaxResponseBytes);
    return grpc::CreateCustomChannel(local_->address(), grpc::InsecureChannelCredentials(),
                                     arguments);
  }

  ServerLoad Load() const override {
    ServerLoad load{.max_sessions = sessions_.max_sessions()};
    for (const auto& session : sessions_.AllDrawn()) {
      load.viewers += static_cast<int>(session->hub().Viewers());
      if (!session->IsOwnView()) ++load.sessions;
    }
    load.storms = static_cast<int>(store_->Storms().size());
    load.cached_bytes = static_cast<double>(store_->CachedBytes());
    load.pictures = drain_.Pictures();
    load.turn_s = loop_->TurnSeconds();
    load.waiting_pictures = static_cast<int>(loop_->WaitingImages());
    if (const auto hung = store_->Hung(); hung.has_value()) load.reading_stuck_s = hung->seconds;
    load.stalled_s = loop_->StalledSeconds();
    load.recovering = loop_->IsRecovering();
    load.draining = drain_.HasBegun();
    if (jobs_ != nullptr) load.jobs = jobs_->Load();
    return load;
  }

  std::optional<jobs::ResultPlace> FindResult(std::string_view path) const override {
    const std::optional<ResultPath> parts = ParseResultPath(path);
    if (jobs_ == nullptr || !parts.has_value()) return std::nullopt;
    auto place = jobs_->ResultOfKey(parts->key, parts->place);
    return place.ok() ? std::optional(*std::move(place)) : std::nullopt;
  }

  void ResultFetched(std::string_view path) override {
    const std::optional<ResultPath> parts = ParseResultPath(path);
    if (jobs_ != nullptr && parts.has_value()) jobs_->FetchedByKey(parts->key, parts->place);
  }

  void SetServing(bool serving) override { health_.SetServing(serving && !drain_.HasBegun()); }

  void SetRosterTimeouts(const session::RosterTimeouts& timeouts) override {
    sessions_.SetRosterTimeouts(timeouts);
    due_.Notify();
  }

  void BeginDrain() override {
    drain_.Begin();
    SetServing(false);
    if (jobs_ != nullptr) jobs_->Drain();
    sessions_.RefuseNew(base::ShuttingDown());
  }

  void Shutdown() override {
    health_.SetServing(false);
    if (jobs_ != nullptr) jobs_->CancelPictures();
    // The loop is stopped first, so that no picture is started after a client has seen its stream
    // end.
    if (loop_ != nullptr) loop_->RequestStop();
    sessions_.CloseAll(base::ShuttingDown());
    if (loop_ != nullptr) loop_->Stop();
    // The jobs stop after the loop, which has ended their pictures.
    if (jobs_ != nullptr) jobs_->Stop();
    if (job_service_ != nullptr) job_service_->Stop();
    executor_.Stop();
    local_.reset();
    port_.reset();
    if (server_ != nullptr) {
      server_->Shutdown(std::chrono::system_clock::now() + shutdown_grace_);
      server_->Wait();
    }
    // The keeper ends last, because calls wait for its saves.
    keeper_.reset();
  }

 private:
  base::WakeSignal wake_;
  base::WakeSignal due_;
  const std::shared_ptr<storm_store::StormStore> store_;
  const std::shared_ptr<session::SessionStore> session_store_;
  const std::shared_ptr<access::AccessControl> access_control_;
  const Limits limits_;
  const JobFiles job_files_;
  const std::chrono::seconds shutdown_grace_;
  const std::shared_ptr<rpc_port::ConnectionCalls> connection_calls_;
  mutable session::Sessions sessions_;
  rpc_port::Drain drain_;
  session::Upkeep upkeep_{sessions_, *store_, due_};
  base::Executor executor_;
  CloudStore clouds_;
  std::unique_ptr<drawing::RenderLoop> loop_;
  std::unique_ptr<session::SessionKeeper> keeper_;
  std::unique_ptr<CatalogueFollower> catalogue_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<jobs::Jobs> jobs_;  // null if the server keeps no render jobs
  std::unique_ptr<grpc::Service> service_;
  std::unique_ptr<RenderJobService> job_service_;
  // Answers calls of unknown methods with UNIMPLEMENTED, so that they are counted, too.
  grpc::CallbackGenericService unknown_methods_;
  rpc_port::HealthService health_{v1::ThunderheadService::service_full_name()};
  rpc_port::ReflectionService reflection_{
      limits_,
      {v1::ThunderheadService::service_full_name(), v1::RenderJobService::service_full_name(),
       grpc::health::v1::Health::service_full_name()}};
  std::unique_ptr<rpc_port::GrpcCertificate> certificate_;  // null without TLS
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<rpc_port::LocalListener> local_;
  std::unique_ptr<rpc_port::PortListener> port_;  // null without a port
};

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::Start(
    const ServerOptions& options, std::shared_ptr<storm_store::StormStore> store,
    const drawing::FrameSourceFactory& make_source) {
  auto server = std::make_unique<RunningServer>(options, std::move(store));
  THUNDERHEAD_RETURN_IF_ERROR(server->StartLoop(options.render_loop, make_source));
  THUNDERHEAD_RETURN_IF_ERROR(server->StartKeeper());
  THUNDERHEAD_RETURN_IF_ERROR(server->StartJobs(options.jobs));
  THUNDERHEAD_RETURN_IF_ERROR(server->Listen(options.address, options.tls));
  return server;
}

}  // namespace thunderhead::service
