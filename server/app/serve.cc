#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "app/address.h"
#include "app/catalogue_flags.h"
#include "app/clouds_folder.h"
#include "app/commands.h"
#include "app/local_service.h"
#include "app/operation.h"
#include "app/state_folder.h"
#include "base/status.h"
#include "gateway/gateway.h"
#include "session/gl_frame_source.h"
#include "spdlog/spdlog.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::app {
namespace {

struct Flags {
  std::vector<std::string> data;
  std::string http = "127.0.0.1:8080";
  std::string grpc = "127.0.0.1:50051";
  std::string device = "auto";
  std::string page;
  std::string clouds;
  std::string state;
  std::vector<std::string> allowed_origins;
  double memory_budget_gib = 2.0;
  CatalogueFlags catalogue;
  OperationFlags operation;
};

// The installed page, or the one in the build tree; empty if there is neither.
std::string DefaultPageFolder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"../share/thunderhead/page", "../../../client-web/dist"}) {
    if (std::filesystem::exists(program / place / "index.html", error)) return program / place;
  }
  return "";
}

// Draws two small pictures, with the sun before and behind the eye, so that storm and shaders are
// ready for the first viewer.
void WarmUp(const std::shared_ptr<grpc::Channel>& channel) {
  const auto stub = v1::ThunderheadService::NewStub(channel);
  for (const float azimuth_deg : {255.0F, 75.0F}) {
    v1::RenderImageRequest request;
    request.mutable_scene()->mutable_output()->set_width_px(64);
    request.mutable_scene()->mutable_output()->set_height_px(36);
    request.mutable_scene()->mutable_camera()->mutable_orbit()->set_azimuth_deg(azimuth_deg);
    v1::RenderImageResponse response;
    grpc::ClientContext context;
    const grpc::Status status = stub->RenderImage(&context, request, &response);
    if (!status.ok()) spdlog::warn("cannot draw the first storm: {}", status.error_message());
  }
}

absl::Status Serve(const Flags& flags) {
  // Blocked before any thread starts, so that only sigwait below takes them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<Operation> operation,
                               Operation::Start(flags.operation));
  THUNDERHEAD_ASSIGN_OR_RETURN(Address http, ParseAddress("--http", flags.http));
  THUNDERHEAD_ASSIGN_OR_RETURN(Address grpc, ParseAddress("--grpc", flags.grpc));
  volume::StormStoreOptions store_options;
  store_options.byte_budget = static_cast<std::size_t>(flags.memory_budget_gib * (1 << 30));
  store_options.live = LiveCatalogueOf(flags.catalogue);
  THUNDERHEAD_ASSIGN_OR_RETURN(const CloudsFolder clouds, CloudsFolder::Open(flags.clouds));
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<volume::StormStore> store,
                               volume::StormStore::Open(flags.data, store_options));
  for (const std::string& file : clouds.Files()) {
    if (const auto added = store->Add(file); !added.ok()) {
      spdlog::warn("skipping {}: {}", file, std::string(added.status().message()));
    }
  }
  service::ServerOptions server_options;
  THUNDERHEAD_ASSIGN_OR_RETURN(server_options.session_store, OpenSessionStore(flags.state));
  server_options.clouds_folder = clouds.Path();
  server_options.address = ToString(grpc);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<service::Server> server,
                               service::Server::Start(server_options, store, [&flags] {
                                 return session::MakeGlFrameSource(flags.device);
                               }));
  gateway::GatewayOptions gateway_options;
  gateway_options.address = http.host;
  gateway_options.port = http.port;
  gateway_options.page_directory = flags.page.empty() ? DefaultPageFolder() : flags.page;
  gateway_options.allowed_origins = flags.allowed_origins;
  if (gateway_options.page_directory.empty()) {
    spdlog::warn("serving no page: none is installed with the program; name one with --page");
  }
  const std::shared_ptr<grpc::Channel> channel = server->LocalChannel();
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<gateway::Gateway> gateway,
                               gateway::Gateway::Start(gateway_options, channel));
  http.port = gateway->Port();
  grpc.port = static_cast<std::uint16_t>(server->Port());
  std::cout << "Thunderhead is ready at http://" << ToString(http) << "/ (gRPC " << ToString(grpc)
            << ")" << std::endl;
  std::thread warm_up([channel] { WarmUp(channel); });
  operation->SetServer(server.get());
  operation->WaitAndDrain(signals, *server);
  operation->SetServer(nullptr);
  // First, because its calls to the service must end before the service does.
  gateway.reset();
  server->Shutdown();
  warm_up.join();
  return absl::OkStatus();
}

}  // namespace

Command AddServe(CLI::App& app) {
  auto flags = std::make_shared<Flags>();
  CLI::App* serve = app.add_subcommand("serve", "Serve storms to browsers and gRPC clients");
  serve
      ->add_option("--data", flags->data,
                   "Storm files, or folders of them; the page opens the first")
      ->required();
  serve->add_option("--http", flags->http, "HOST:PORT to serve the page on")->capture_default_str();
  serve->add_option("--grpc", flags->grpc, "HOST:PORT to serve gRPC on")->capture_default_str();
  serve->add_option("--device", flags->device, "auto, software or a GPU's number")
      ->capture_default_str();
  serve->add_option("--page", flags->page, "Folder with the built page");
  serve->add_option(
      "--clouds", flags->clouds,
      "Folder in which generated clouds are kept; without it they are deleted when the "
      "server stops");
  serve->add_option("--state", flags->state,
                    "Folder in which sessions outlive the server, or 'none'; by default "
                    "$STATE_DIRECTORY, else thunderhead in $XDG_STATE_HOME or ~/.local/state");
  serve->add_option("--allow-origin", flags->allowed_origins,
                    "Origins of other sites whose pages may call the server");
  serve->add_option("--memory-budget", flags->memory_budget_gib, "GiB of storms kept in memory")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  AddOperationFlags(*serve, flags->operation);
  AddCatalogueFlags(*serve, flags->catalogue);
  return {serve, [flags] { return Serve(*flags); }};
}

}  // namespace thunderhead::app
