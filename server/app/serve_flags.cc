#include "app/serve_flags.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "access/secret_file.h"
#include "app/audit_log.h"
#include "app/hidden_flags.h"
#include "base/machine_memory.h"
#include "base/named_file.h"
#include "base/status.h"

namespace thunderhead::app {
namespace {

constexpr char kWho[] = "Access";

// Flags that --help omits. --print-config lists them.
constexpr std::array kRarelyChanged = {
    "--drain-seconds",
    "--grpc-memory",
    "--jobs-quota-each",
    "--max-calls-each",
    "--max-connections",
    "--max-connections-each",
    "--max-handshakes-each",
    "--max-images",
    "--max-images-each",
    "--max-job-pictures",
    "--max-job-pictures-each",
    "--max-jobs",
    "--max-jobs-each",
    "--max-kept-pictures",
    "--max-kept-pictures-each",
    "--max-message",
    "--max-picture",
    "--max-predicted-render-time",
    "--max-render-time",
    "--max-requests",
    "--max-samples",
    "--max-sessions-each",
    "--max-streams",
    "--max-streams-each",
    "--max-streams-per-connection",
    "--max-unsent",
    "--max-waiting",
    "--max-waiting-each",
    "--max-wrong-tokens",
    "--read-deadline",
    "--rescan-seconds",
    "--roster-timeouts",
    "--sandbox-memory",
    "--sandbox-seconds",
    "--settle-seconds",
    "--stuck-seconds",
};
constexpr char kHowMuch[] =
    "Limits; a request beyond them is refused, with the time after which to try again";

constexpr std::size_t kMinBudget = std::size_t{64} << 20U;
// Default budgets for a system that does not report its memory.
constexpr std::size_t kSomeMemory = std::size_t{4} << 30U;
constexpr std::size_t kGpuMemory = std::size_t{4} << 30U;
// The share of the memory budget that is kept for GL objects if the CPU draws. Storm fields use the
// same budget and would otherwise leave no memory for these objects.
constexpr double kKeptForDrawing = 0.4;

bool IsLoopback(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

void AddAccessFlags(CLI::App& serve, ServeFlags& flags) {
  serve
      .add_option(
          "--auth", flags.auth,
          "none; or tokens FILE, with a line for each token: name, role, SHA-256 of the token; or "
          "jwt FILE, with the key of JWTs: a public key in PEM for RS256, or a secret for HS256")
      ->expected(1, 2)
      ->group(kWho);
  serve.add_option("--jwt-issuer", flags.jwt_issuer, "Issuer (iss) that JWTs must have")
      ->group(kWho);
  serve.add_option("--jwt-audience", flags.jwt_audience, "Audience (aud) that JWTs must have")
      ->group(kWho);
  serve
      .add_option("--tls-cert", flags.tls.certificate,
                  "Certificate chain in PEM, for both ports; read again when it changes")
      ->group(kWho);
  serve
      .add_option("--tls-key", flags.tls.key,
                  "Private key of --tls-cert in PEM; read again when it changes")
      ->group(kWho);
  serve
      .add_flag("--insecure", flags.insecure,
                "Serve other machines without --auth or TLS: behind a proxy that has both, or in a "
                "network where everyone may see and do everything")
      ->group(kWho);
  serve
      .add_option("--allow-host", flags.allowed_hosts,
                  "Host names under which browsers may open the page, in addition to localhost, IP "
                  "addresses and this machine's own name")
      ->group(kWho);
  serve
      .add_option("--allow-origin", flags.allowed_origins,
                  "Origins of other sites whose pages may call the server")
      ->group(kWho);
  serve
      .add_option("--trusted-proxy", flags.trusted_proxies,
                  "Addresses or networks (10.1.0.0/16) of proxies before both ports whose "
                  "X-Forwarded-For header is believed; the header of others is ignored")
      ->group(kWho);
  serve
      .add_option("--audit-log", flags.audit_log,
                  "File to which refusals and privileged acts are appended, one per line; without "
                  "it they go to standard error")
      ->group(kWho);
}

template <typename Number>
void AddLimit(CLI::App& serve, const std::string& name, Number& value, double least, double most,
              const std::string& help) {
  serve.add_option(name, value, help)
      ->check(CLI::Range(least, most))
      ->capture_default_str()
      ->group(kHowMuch);
}

void AddLimitFlags(CLI::App& serve, ServeFlags& flags) {
  AddLimit(serve, "--max-sessions", flags.sessions.max_sessions, 1, 1e5,
           "Maximum number of sessions");
  AddLimit(serve, "--max-sessions-each", flags.sessions.max_sessions_per_owner, 1, 1e5,
           "Maximum number of sessions opened by one identity, which is a token's name, or without "
           "--auth an address");
  AddLimit(serve, "--max-viewers", flags.limits.max_viewers_per_session, 1, 1e5,
           "Maximum number of viewers of a session");
  AddLimit(serve, "--max-connections", flags.gateway.max_connections, 1, 1e5,
           "Maximum number of connections of each port");
  AddLimit(serve, "--max-connections-each", flags.gateway.max_connections_per_address, 1, 1e5,
           "Maximum number of connections of each port from one address");
  AddLimit(serve, "--max-handshakes-each", flags.gateway.max_handshakes_per_address, 0, 1e5,
           "TLS connections per second that one address may start on each port, and twice as many "
           "at once; 0 for no limit");
  AddLimit(serve, "--max-calls-each", flags.limits.max_calls_per_address, 0, 1e6,
           "Calls per second that one address may begin on gRPC's port, and twice as many at once; "
           "beyond them its connections are closed; 0 for no limit");
  AddLimit(
      serve, "--max-streams", flags.quotas.max_streams, 1, 1e6,
      "Maximum number of calls that stay open, and of responses that clients have not read yet");
  AddLimit(serve, "--max-streams-each", flags.quotas.max_streams_per_identity, 1, 1e6,
           "Maximum number of calls of one identity that stay open");
  AddLimit(serve, "--max-streams-per-connection", flags.limits.max_streams_per_connection, 1, 1e6,
           "Maximum number of calls on one gRPC connection; further calls wait in the client");
  AddLimit(serve, "--max-requests", flags.quotas.requests_per_second, 0, 1e6,
           "Requests per second of one identity, and within one call of Interact; 0 for no limit");
  AddLimit(serve, "--max-message", flags.max_message_kib, 1, 1 << 20,
           "Maximum KiB of a request message");
  AddLimit(serve, "--max-picture", flags.max_megapixels, 0.001, 33.6,
           "Maximum megapixels of a picture");
  AddLimit(serve, "--max-samples", flags.max_megasamples, 0.001, 137439,
           "Maximum megasamples of a picture: its pixels times its slices");
  AddLimit(serve, "--max-render-time", flags.max_render_s, 0.001, 1e6,
           "Maximum seconds for a single image once it is begun");
  AddLimit(serve, "--max-predicted-render-time", flags.render_loop.image_limits.max_predicted_s,
           0.001, 1e6,
           "Maximum predicted seconds of drawing for a single image; costlier ones are refused");
  // The names --max-stills and --max-stills-each are earlier names, which are still accepted.
  AddLimit(serve, "--max-images,--max-stills", flags.render_loop.max_waiting_images, 0, 1e6,
           "Maximum number of single images that wait to be drawn");
  AddLimit(serve, "--max-images-each,--max-stills-each", flags.render_loop.max_waiting_images_each,
           0, 1e6, "Maximum number of single images of one identity that wait to be drawn");
  AddLimit(serve, "--max-waiting", flags.executor.max_waiting, 1, 1e6,
           "Maximum number of other requests that wait for a storm to be read, described, mapped "
           "or probed");
  AddLimit(serve, "--max-waiting-each", flags.executor.max_waiting_each, 1, 1e6,
           "Maximum number of such requests of one identity");
  AddLimit(serve, "--max-wrong-tokens", flags.quotas.wrong_tokens_per_second, 0, 1e6,
           "Wrong tokens per second from one address; 0 for no limit");
  AddLimit(serve, "--max-unsent", flags.max_unsent_mib, 128, 1 << 20,
           "Maximum MiB of responses that wait for clients of the HTTP port to read them");
  AddLimit(serve, "--grpc-memory", flags.grpc_memory_mib, 16, 1 << 20,
           "Maximum MiB of gRPC's buffers for all connections together");
}

// Adds a flag for a size in bytes, or with a unit such as 8GiB.
void AddMemoryFlag(CLI::App& serve, const std::string& name, std::uint64_t& bytes,
                   const std::string& help) {
  serve.add_option(name, bytes, help)
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(std::uint64_t{kMinBudget}, std::uint64_t{1} << 50U))
      ->group(kHowMuch);
}

void AddMemoryFlags(CLI::App& serve, ServeFlags& flags) {
  AddMemoryFlag(serve, "--memory-budget", flags.memory_bytes,
                "Memory for storms, pictures and path tracing, and for drawing without a GPU, such "
                "as 8GiB; by default half of the machine's or cgroup's memory");
  AddMemoryFlag(serve, "--gpu-memory-budget", flags.gpu_memory_bytes,
                "The GPU's memory for drawing; by default 4GiB");
  AddLimit(serve, "--read-deadline", flags.read_deadline_s, 0.1, 86400,
           "Seconds without data after which the storage of a storm that is read counts as "
           "hanging, or its file as damaged");
}

absl::Status CheckReachOfMetrics(const std::string& metrics) {
  if (metrics.empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(const Address address, ParseAddress("--metrics", metrics));
  if (IsLoopback(address.host)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--metrics ", ToString(address),
                   " can be reached from other machines, and this port neither asks for a token "
                   "nor encrypts; listen on 127.0.0.1, or accept this with --insecure"));
}

}  // namespace

void AddServeFlags(CLI::App& serve, ServeFlags& flags) {
  serve
      .add_option("--config", flags.config,
                  "File with settings: any of these flags, and the limits that --print-config "
                  "lists, one per line, such as `max-sessions = 200`")
      ->configurable(false);
  serve
      .add_flag("--print-config", flags.print_config,
                "Print a file for --config with every setting, its unit and its default, and exit")
      ->configurable(false);
  serve.add_option("--data", flags.data,
                   "Storm files, or folders of them; the page opens the first storm");
  serve.add_option("--http", flags.http, "HOST:PORT to serve the page on")->capture_default_str();
  serve.add_option("--grpc", flags.grpc, "HOST:PORT to serve gRPC on")->capture_default_str();
  serve.add_option("--device", flags.device, "auto, software or a GPU's number")
      ->capture_default_str();
  serve.add_option("--page", flags.page, "Folder with the built page");
  serve.add_option("--clouds", flags.clouds,
                   "Folder in which generated clouds are kept; without it the clouds are deleted "
                   "when the server stops");
  serve.add_option(
      "--state", flags.state,
      "Folder in which sessions and render jobs are saved across restarts, or 'none'; by default "
      "$STATE_DIRECTORY, otherwise the folder thunderhead in $XDG_STATE_HOME or ~/.local/state");
  serve.add_option("--roster-timeouts", flags.roster_timeouts,
                   "File with the times after which people of a session count as away, for tests");
  AddMemoryFlags(serve, flags);
  AddCatalogueFlags(serve, flags.catalogue);
  AddReaderFlags(serve, flags.reader);
  AddOperationFlags(serve, flags.operation);
  AddAccessFlags(serve, flags);
  AddLimitFlags(serve, flags);
  AddJobsFlags(serve, flags.jobs);
  serve.get_option("--help")->configurable(false);
  for (const char* const name : kRarelyChanged) HideFromHelp(*serve.get_option(name));
}

Budgets BudgetsOf(const ServeFlags& flags) {
  const std::size_t machine = base::MachineMemoryBytes();
  std::size_t bytes = flags.memory_bytes;
  if (bytes == 0) bytes = std::max(machine == 0 ? kSomeMemory : machine / 2, kMinBudget);
  const std::size_t gpu_bytes = flags.gpu_memory_bytes == 0 ? kGpuMemory : flags.gpu_memory_bytes;
  return {base::MemoryBudget::Make({.bytes = bytes,
                                    .kept_for_drawing = static_cast<std::size_t>(
                                        kKeptForDrawing * static_cast<double>(bytes))}),
          base::MemoryBudget::Make(
              {.name = "GPU memory", .flag = "--gpu-memory-budget", .bytes = gpu_bytes})};
}

namespace {

absl::StatusOr<base::TrustedProxies> ProxiesOf(const ServeFlags& flags) {
  auto proxies = base::TrustedProxies::Parse(flags.trusted_proxies);
  if (!proxies.ok()) return base::Annotate(proxies.status(), "--trusted-proxy");
  return proxies;
}

}  // namespace

absl::StatusOr<std::shared_ptr<access::AccessControl>> MakeAccessControl(const ServeFlags& flags) {
  const std::string& mode = flags.auth.front();
  const bool has_file = flags.auth.size() == 2;
  std::unique_ptr<access::Authenticator> authenticator;
  if (mode == "none" && !has_file) {
    authenticator = access::TrustEverybody();
  } else if (mode == "tokens" && has_file) {
    THUNDERHEAD_ASSIGN_OR_RETURN(authenticator, access::TrustTokens(flags.auth[1]));
  } else if (mode == "jwt" && has_file) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        authenticator, access::TrustJwt(flags.auth[1], {flags.jwt_issuer, flags.jwt_audience}));
  } else {
    return absl::InvalidArgumentError(absl::StrCat("--auth is '", mode,
                                                   has_file ? absl::StrCat(" ", flags.auth[1]) : "",
                                                   "'; it must be none, tokens FILE or jwt FILE"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<access::Audit> audit,
                               OpenAudit(flags.audit_log, flags.operation.log_format));
  THUNDERHEAD_ASSIGN_OR_RETURN(base::TrustedProxies proxies, ProxiesOf(flags));
  return std::make_shared<access::AccessControl>(std::move(authenticator), std::move(audit),
                                                 flags.quotas, std::move(proxies));
}

absl::Status CompleteFlags(ServeFlags& flags) {
  if (flags.tls.certificate.empty() != flags.tls.key.empty()) {
    return absl::InvalidArgumentError("--tls-cert and --tls-key belong together: give both");
  }
  if (!flags.tls.key.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(base::CheckRegularFile(flags.tls.certificate));
    THUNDERHEAD_RETURN_IF_ERROR(access::ReadSecretFile(flags.tls.key).status());
  }
  flags.limits.max_render_time = std::chrono::milliseconds(std::lround(1e3 * flags.max_render_s));
  // The flag's largest value means the API's own limit, which is not a round number of megapixels.
  flags.limits.max_pixels =
      std::min(flags.limits.max_pixels, static_cast<std::uint64_t>(1e6 * flags.max_megapixels));
  flags.limits.max_samples = static_cast<std::uint64_t>(1e6 * flags.max_megasamples);
  flags.limits.max_request_bytes = static_cast<std::size_t>(flags.max_message_kib) << 10;
  flags.limits.grpc_memory_bytes = static_cast<std::size_t>(flags.grpc_memory_mib) << 20;
  flags.limits.max_connections = flags.gateway.max_connections;
  flags.limits.max_connections_per_address = flags.gateway.max_connections_per_address;
  flags.limits.max_handshakes_per_address = flags.gateway.max_handshakes_per_address;
  flags.gateway.max_unsent_bytes = static_cast<std::size_t>(flags.max_unsent_mib) << 20;
  flags.gateway.max_message_bytes = flags.limits.max_request_bytes;
  flags.gateway.allowed_hosts = flags.allowed_hosts;
  flags.gateway.allowed_origins = flags.allowed_origins;
  THUNDERHEAD_ASSIGN_OR_RETURN(flags.gateway.trusted_proxies, ProxiesOf(flags));
  return absl::OkStatus();
}

absl::Status CheckReach(const ServeFlags& flags, const Address& http, const Address& grpc) {
  if (flags.insecure) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckReachOfMetrics(flags.operation.metrics));
  const bool has_auth = flags.auth.front() != "none";
  const bool has_tls = !flags.tls.certificate.empty();
  if (has_auth && has_tls) return absl::OkStatus();
  for (const auto& [flag, address] : {std::pair{"--http", http}, std::pair{"--grpc", grpc}}) {
    if (IsLoopback(address.host)) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        flag, " ", ToString(address), " can be reached from other machines, and ",
        has_auth ? "" : "no token is needed (--auth none)", has_auth || has_tls ? "" : " and ",
        has_tls ? "" : "the connection is not encrypted (no --tls-cert and --tls-key)",
        "; give the missing flags, listen on 127.0.0.1, or accept this with --insecure"));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::app
