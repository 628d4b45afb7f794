#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "app/address.h"
#include "app/catalogue_flags.h"
#include "app/clouds_folder.h"
#include "app/commands.h"
#include "app/config_file.h"
#include "app/operation.h"
#include "app/roster_timeouts_file.h"
#include "app/serve_flags.h"
#include "app/state_folder.h"
#include "app/stop_signals.h"
#include "base/error_details.h"
#include "base/process_limits.h"
#include "base/program_folder.h"
#include "base/status.h"
#include "drawing/gl_frame_source.h"
#include "gateway/gateway.h"
#include "gateway/tls_contexts.h"
#include "runs/exit_codes.h"
#include "sandbox/confined_files.h"
#include "spdlog/spdlog.h"
#include "storm_store/border_data.h"
#include "storm_store/storm_catalogue.h"
#include "telemetry/metrics.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::app {
namespace {

// The longest wait for the audit log to be written when the process ends early: after a second
// signal, or because calls hang.
constexpr std::chrono::seconds kLastLines{1};

// The time for calls to end after the grace period, and for the last saves. The service manager's
// own limit, after which it kills the process, is longer.
constexpr std::chrono::seconds kEndPatience{12};

// Returns the folder of the installed page, or of the one in the build tree; empty if there is
// neither.
std::string DefaultPageFolder() {
  std::error_code error;
  const std::filesystem::path program = base::ProgramFolder();
  for (const char* place : {"../share/thunderhead/page", "../../../client-web/dist"}) {
    if (std::filesystem::exists(program / place / "index.html", error)) return program / place;
  }
  return "";
}

void ShowOwnToken(const access::AccessControl& access_control, grpc::ClientContext& context) {
  context.AddMetadata("authorization", absl::StrCat("Bearer ", access_control.OwnToken()));
}

// Opens a session, waits for its first frame, and closes it.
grpc::Status ShowOnce(v1::ThunderheadService::Stub& stub, const v1::Scene& scene,
                      const access::AccessControl& access_control) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = scene;
  v1::CreateSessionResponse session;
  grpc::ClientContext creating;
  ShowOwnToken(access_control, creating);
  if (grpc::Status status = stub.CreateSession(&creating, request, &session); !status.ok()) {
    return status;
  }
  {
    v1::WatchFramesRequest watch;
    watch.set_session_id(session.session_id());
    grpc::ClientContext watching;
    ShowOwnToken(access_control, watching);
    const auto frames = stub.WatchFrames(&watching, watch);
    v1::WatchFramesResponse event;
    while (frames->Read(&event) && !event.has_frame() && !event.has_problem()) {
    }
    watching.TryCancel();
    frames->Finish();
  }
  v1::CloseSessionRequest close;
  close.set_session_id(session.session_id());
  v1::CloseSessionResponse closed;
  grpc::ClientContext closing;
  ShowOwnToken(access_control, closing);
  return stub.CloseSession(&closing, close, &closed);
}

// Draws two small pictures, one with the sun in front of the eye and one with the sun behind it.
// After that, the storm and the shaders are ready for the first viewer.
void WarmUp(const std::shared_ptr<grpc::Channel>& channel,
            const access::AccessControl& access_control) {
  const auto stub = v1::ThunderheadService::NewStub(channel);
  for (const float azimuth_deg : {255.0F, 75.0F}) {
    v1::Scene scene;
    scene.mutable_output()->set_width_px(64);
    scene.mutable_output()->set_height_px(36);
    scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(azimuth_deg);
    const grpc::Status status = ShowOnce(*stub, scene, access_control);
    if (!status.ok()) spdlog::warn("cannot draw the first storm: {}", status.error_message());
  }
}

// Waits until the folders were searched for the first time, so that clients find the storms, but at
// most 30 s. Returns false if it is told to stop.
bool AwaitStorms(const storm_store::StormStore& store, const std::stop_token& stop) {
  constexpr std::chrono::seconds kWhile{30};
  constexpr std::chrono::milliseconds kPause{20};
  const auto until = std::chrono::steady_clock::now() + kWhile;
  while (store.IsSearching() && std::chrono::steady_clock::now() < until) {
    if (stop.stop_requested()) return false;
    std::this_thread::sleep_for(kPause);
  }
  if (store.IsSearching()) {
    spdlog::warn(
        "still searching the folders for storms; the storms are served when the search has ended");
  }
  return !stop.stop_requested();
}

// Returns UNAVAILABLE if the system's clock is wrong by decades, because a wait until a later time
// would then last for decades, too. Times after 2262 wrap around to times before 1970.
absl::Status CheckClock(std::chrono::system_clock::time_point now) {
  if (now.time_since_epoch().count() >= 0) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat("the system's clock shows a time before 1970 or after 2262 (",
                   absl::FormatTime("%Y-%m-%d %H:%M", absl::FromChrono(now), absl::UTCTimeZone()),
                   " UTC); set it, for example with timedatectl, and start the server again"));
}

// Raises the limit on open files to the maximum that the system allows. Each connection needs a
// file descriptor, and the usual limit of 1024 was made for programs that use select().
void RaiseFileLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::optional<gateway::KeptFile> FindResult(service::Server& server, std::string_view path) {
  std::optional<jobs::ResultPlace> result = server.FindResult(path);
  if (!result.has_value()) return std::nullopt;
  gateway::FileContents contents{.bytes = result->bytes, .sha256 = result->sha256};
  return gateway::KeptFile{
      .path = std::move(result->path),
      .entity_tag = std::move(result->sha256),
      .on_sent = [&server, path = std::string(path)] { server.ResultFetched(path); },
      .contents = std::move(contents)};
}

absl::Status Serve(ServeFlags flags) {
  THUNDERHEAD_RETURN_IF_ERROR(base::CheckProcessLimits(base::ReadProcessLimits()));
  // The signals are blocked before any thread starts, so that only the code below that waits for
  // them receives them.
  const sigset_t signals = StopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  // SIGPIPE is ignored, so that the server continues if the process that reads its log ends.
  std::signal(SIGPIPE, SIG_IGN);

  THUNDERHEAD_RETURN_IF_ERROR(CheckClock(std::chrono::system_clock::now()));
  THUNDERHEAD_ASSIGN_OR_RETURN(Address http, ParseAddress("--http", flags.http));
  THUNDERHEAD_ASSIGN_OR_RETURN(Address grpc, ParseAddress("--grpc", flags.grpc));
  THUNDERHEAD_RETURN_IF_ERROR(CheckReach(flags, http, grpc));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<Operation> operation,
                               Operation::Start(flags.operation, flags.allowed_hosts));
  // Reading the storms' headers and the state may take long on slow storage, or forever on storage
  // that hangs. Signals are therefore handled meanwhile.
  std::jthread starting = EndIfToldWhileStarting(signals);
  THUNDERHEAD_RETURN_IF_ERROR(CompleteFlags(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<access::AccessControl> access_control,
                               MakeAccessControl(flags));
  // The certificate is loaded before any port is opened, and before the storms are searched, so
  // that a wrong file is reported at once.
  if (!flags.tls.certificate.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(flags.gateway.tls, gateway::TlsContexts::Open(flags.tls));
  }
  RaiseFileLimit();
  storm_store::StormStoreOptions store_options;
  base::ShareFreedBlocks();
  const Budgets budgets = BudgetsOf(flags);
  store_options.memory = budgets.memory;
  store_options.byte_budget = budgets.memory->Bytes();
  const std::chrono::milliseconds read_deadline(std::lround(1e3 * flags.read_deadline_s));
  sandbox::ReaderLimits reader_limits = LimitsOf(flags.reader);
  reader_limits.silence = read_deadline;
  reader_limits.silence_flag = "--read-deadline";
  // The read's deadline is later than the reader's, so that a reader that does not respond is ended
  // first. Only then is it known that its storage hangs.
  store_options.read_deadline = read_deadline + std::chrono::seconds(5);
  store_options.live = LiveCatalogueOf(flags.catalogue);
  THUNDERHEAD_ASSIGN_OR_RETURN(const State state, OpenState(flags.state));
  // Ids are kept only if the folders are searched again. Otherwise no new storm can appear and take
  // another storm's id.
  if (store_options.live.has_value()) KeepStormIds(state, *store_options.live);
  THUNDERHEAD_RETURN_IF_ERROR(ProbeReaders(reader_limits));
  store_options.borders = storm_store::BorderData::Find(storm_store::kBorderFolder);
  THUNDERHEAD_ASSIGN_OR_RETURN(const CloudsFolder clouds, CloudsFolder::Open(flags.clouds));
  store_options.links = LinksOf(flags.catalogue);
  std::vector<std::string> folders = flags.data;
  folders.push_back(clouds.Path());
  store_options.formats = sandbox::ConfinedFormats(
      {.limits = reader_limits,
       .check_opened = [folders, links = store_options.links](const std::string& path,
                                                              const std::string& place) {
         return storm_store::CheckPlace(folders, links, path, place);
       }});
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<storm_store::StormStore> store,
                               storm_store::StormStore::Open(flags.data, store_options));
  for (const std::string& file : clouds.Files()) {
    if (const auto added = store->Add(file); !added.ok()) {
      spdlog::warn("skipping {}: {}", file, std::string(added.status().message()));
    }
  }
  service::ServerOptions server_options;
  server_options.session_store = state.sessions;
  server_options.jobs = JobsOptionsOf(flags.jobs, state);
  server_options.clouds_folder = clouds.Path();
  server_options.executor = flags.executor;
  server_options.render_loop = flags.render_loop;
  server_options.render_loop.memory = budgets.memory;
  server_options.render_loop.device_memory = {budgets.memory, budgets.gpu};
  // When the device is given up, a signal ends the wait below, and a supervisor then restarts the
  // server.
  const auto given_up = std::make_shared<absl::Status>();
  server_options.render_loop.on_device_given_up = [given_up](const absl::Status& why) {
    *given_up = why;
    kill(getpid(), SIGTERM);
  };
  server_options.address = ToString(grpc);
  server_options.tls = flags.tls;
  server_options.access_control = access_control;
  server_options.limits = flags.limits;
  server_options.sessions = flags.sessions;
  if (!flags.roster_timeouts.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(server_options.sessions.roster_timeouts,
                                 ReadRosterTimeouts(flags.roster_timeouts));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::unique_ptr<service::Server> server,
      service::Server::Start(server_options, store,
                             drawing::GlFrameSources(flags.device, {.memory = budgets.memory,
                                                                    .gpu_memory = budgets.gpu})));
  gateway::GatewayOptions gateway_options = flags.gateway;
  gateway_options.address = http.host;
  gateway_options.port = http.port;
  gateway_options.page_directory = flags.page.empty() ? DefaultPageFolder() : flags.page;
  if (gateway_options.page_directory.empty()) {
    spdlog::warn(
        "the page is not served, because it is not installed with the program; name its folder "
        "with --page");
  }
  gateway_options.find_kept_file = [&server](std::string_view path) {
    return FindResult(*server, path);
  };
  gateway_options.on_refusal = [&access_control](const gateway::GatewayRefusal& refusal) {
    telemetry::Counted().refusals.Of(base::DetailsOf(refusal.why).reason).Add();
    access_control->ReportBeforeCall(refusal.peer, refusal.act, refusal.why);
  };
  const std::shared_ptr<grpc::Channel> channel = server->LocalChannel();
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<gateway::Gateway> gateway,
                               gateway::Gateway::Start(gateway_options, channel));
  http.port = gateway->Port();
  grpc.port = static_cast<std::uint16_t>(server->Port());
  starting = {};
  std::thread warm_up;
  std::jthread becoming_ready([&](const std::stop_token& stop) {
    if (!AwaitStorms(*store, stop)) return;
    operation->SetServer(server.get(), {budgets.memory, budgets.gpu, state.calls});
    std::cout << "Thunderhead is ready at " << (flags.tls.certificate.empty() ? "http" : "https")
              << "://" << ToString(http) << "/ (gRPC " << ToString(grpc) << ")" << std::endl;
    warm_up = std::thread([channel, access_control] { WarmUp(channel, *access_control); });
  });
  std::jthread roster_timeouts;
  if (!flags.roster_timeouts.empty()) {
    roster_timeouts = FollowRosterTimeouts(flags.roster_timeouts,
                                           [&server](const session::RosterTimeouts& timeouts) {
                                             server->SetRosterTimeouts(timeouts);
                                           });
  }
  const auto last = [access_control] { access_control->FlushAudit(kLastLines); };
  operation->WaitAndDrain(signals, *server, last);
  const std::jthread ends_anyway = EndAnywayAfter(
      kEndPatience, [given_up] { return static_cast<int>(runs::ExitCodeOf(*given_up)); }, last);
  becoming_ready = {};
  operation->SetServer(nullptr);
  roster_timeouts = {};
  // The gateway ends first, because its calls to the service must end before the service does.
  gateway.reset();
  server->Shutdown();
  if (warm_up.joinable()) warm_up.join();
  return *given_up;
}

}  // namespace

Command AddServe(CLI::App& app) {
  auto flags = std::make_shared<ServeFlags>();
  CLI::App* serve = app.add_subcommand("serve", "Serve storms to browsers and gRPC clients");
  AddServeFlags(*serve, *flags);
  return {serve, [flags, serve]() -> absl::Status {
            if (!flags->config.empty()) {
              THUNDERHEAD_RETURN_IF_ERROR(ReadConfigFile(*serve, flags->config));
            }
            if (flags->print_config) {
              std::cout << ConfigFileOf(*serve);
              return absl::OkStatus();
            }
            if (flags->data.empty()) {
              return absl::InvalidArgumentError(
                  "there are no storms to serve; give --data FILE or --data FOLDER, here or in the "
                  "file of --config");
            }
            return Serve(*flags);
          }};
}

}  // namespace thunderhead::app
