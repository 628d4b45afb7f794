#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "app/address.h"
#include "app/client_access.h"
#include "app/commands.h"
#include "app/hidden_flags.h"
#include "app/interruption.h"
#include "app/picture_size.h"
#include "base/status.h"
#include "load/bounds.h"
#include "load/load.h"
#include "runs/progress_bar.h"

namespace thunderhead::app {
namespace {

struct LoadFlags {
  std::string server;
  std::string size = "640x360";
  std::string images_size = "640x360";
  std::optional<double> kbit_per_s;
  std::optional<int> throttled;
  load::LoadOptions load;
  load::Bounds bounds;
  bool json = false;
  ClientAccessFlags access;
};

enum class Protocol { kGrpc, kHttp, kHttps };

struct LoadTarget {
  Address address;
  Protocol protocol = Protocol::kGrpc;
};

absl::StatusOr<LoadTarget> ParseTarget(const std::string& server) {
  LoadTarget target;
  if (absl::StartsWith(server, "http://")) target.protocol = Protocol::kHttp;
  if (absl::StartsWith(server, "https://")) target.protocol = Protocol::kHttps;
  std::string place = server.substr(target.protocol == Protocol::kGrpc ? 0 : server.find("//") + 2);
  if (target.protocol != Protocol::kGrpc) place = std::string(absl::StripSuffix(place, "/"));
  THUNDERHEAD_ASSIGN_OR_RETURN(target.address, ParseAddress("SERVER", place));
  return target;
}

absl::StatusOr<std::unique_ptr<load::Transport>> TransportTo(const LoadTarget& target,
                                                             const load::Access& access) {
  const auto& [host, port] = target.address;
  switch (target.protocol) {
    case Protocol::kHttp:
      return load::MakeWebSocketTransport(host, port, access.token);
    case Protocol::kHttps:
      return load::MakeSecureWebSocketTransport(host, port, access);
    case Protocol::kGrpc:
      break;
  }
  return load::MakeGrpcTransport(ToString(target.address), access);
}

absl::StatusOr<load::LoadOptions> LoadOptionsOf(const LoadFlags& flags) {
  load::LoadOptions options = flags.load;
  THUNDERHEAD_ASSIGN_OR_RETURN(const PictureSize size, ParsePictureSize(flags.size));
  options.width_px = size.width_px;
  options.height_px = size.height_px;
  THUNDERHEAD_ASSIGN_OR_RETURN(const PictureSize image,
                               ParsePictureSize(flags.images_size, "--images-size"));
  options.images.width_px = image.width_px;
  options.images.height_px = image.height_px;
  if (flags.throttled.has_value() && !flags.kbit_per_s.has_value()) {
    return absl::InvalidArgumentError(
        "--throttled needs --kbit, the rate at which those viewers read");
  }
  if (flags.kbit_per_s.has_value()) load::Throttle(*flags.kbit_per_s, flags.throttled, options);
  if (options.looking > options.viewers) {
    return absl::InvalidArgumentError(
        absl::StrCat("--looking is ", options.looking, ", more than the ", options.viewers,
                     " viewers of --viewers; lower it, or raise --viewers"));
  }
  return options;
}

std::string NoteOf(const load::Progress& progress) {
  std::string note = absl::StrFormat("%d viewers have frames, %.1f frames/s", progress.joined,
                                     progress.frames_per_s);
  if (progress.errors > 0) absl::StrAppendFormat(&note, ", %d errors", progress.errors);
  return note;
}

absl::Status Load(const LoadFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const LoadTarget target, ParseTarget(flags.server));
  THUNDERHEAD_ASSIGN_OR_RETURN(const load::LoadOptions options, LoadOptionsOf(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(const load::Access access, ReadClientAccess(flags.access));
  // The signals must be blocked before the transport starts its threads. The threads then inherit
  // the blocked signals, and only the thread of `interruption` receives them.
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<load::Transport> transport,
                               TransportTo(target, access));
  const auto process = load::ServerProcess::Find(target.address.host, target.address.port);
  std::optional<runs::ProgressBar> bar(std::in_place, "load");
  const absl::StatusOr<load::Report> report =
      load::Run(options, *transport, process, interruption.Token(), [&bar](const auto& progress) {
        bar->Set(progress.share);
        bar->Note(NoteOf(progress));
      });
  bar.reset();
  THUNDERHEAD_RETURN_IF_ERROR(report.status());
  std::cout << (flags.json ? load::ToJson(*report) : load::ToText(*report));
  std::vector<std::string> wrong = load::NotKept(flags.bounds, *report);
  if (report->ErrorCount() > 0) {
    wrong.push_back(absl::StrCat("errors during the load: ", report->ErrorCount()));
  }
  return wrong.empty() ? absl::OkStatus() : absl::AbortedError(absl::StrJoin(wrong, "; "));
}

// Adds the flags of single images, whose names begin with `name`.
std::vector<CLI::Option*> AddImageFlags(const std::string& name, CLI::App& load, LoadFlags& flags) {
  load::ImageBurstOptions& images = flags.load.images;
  return {
      load.add_option(name, images.count,
                      "Additional single images, all requested when measuring begins")
          ->check(CLI::Range(0, 10000))
          ->capture_default_str(),
      load.add_option(name + "-size", flags.images_size, "Size of the single images, WIDTHxHEIGHT")
          ->capture_default_str(),
      load.add_option(name + "-slices", images.slices,
                      "Slices of the single images; 0 for the default")
          ->check(CLI::Range(0, 4096))
          ->capture_default_str()};
}

void AddBounds(CLI::App& load, load::Bounds& bounds) {
  const auto add = [&load](const char* name, std::optional<double>& bound, const char* text) {
    load.add_option(name, bound, text)->check(CLI::Range(0.0, 1e9));
  };
  add("--min-fps", bounds.min_fps, "Fail if a viewer gets fewer frames/s");
  add("--max-p95", bounds.max_p95_ms,
      "Fail if the 95th percentile of the latency is larger, in milliseconds");
  add("--max-p99", bounds.max_p99_ms,
      "Fail if the 99th percentile of the latency is larger, in milliseconds");
  add("--max-spread", bounds.max_spread_ms,
      "Fail if the 99th percentile of the time between the first and the last viewer to show a "
      "picture is larger, in milliseconds");
  add("--max-growth", bounds.max_growth_mb,
      "Fail if the server's memory grows by more than this, in MB");
}

}  // namespace

Command AddLoad(CLI::App& app) {
  auto flags = std::make_shared<LoadFlags>();
  load::LoadOptions& options = flags->load;
  CLI::App* load = app.add_subcommand(
      "load", "Measure a server under many viewers of one session whose camera turns");
  load->add_option("SERVER", flags->server,
                   "HOST:PORT of the server's gRPC port, or http://HOST:PORT or https://HOST:PORT "
                   "to connect by WebSocket")
      ->required();
  load->add_option("--viewers", options.viewers, "Viewers who read every frame that they receive")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  load->add_option("--seconds", options.seconds, "Seconds to measure, once all have joined")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  load->add_option("--size", flags->size, "Size of the pictures, WIDTHxHEIGHT")
      ->capture_default_str();
  load->add_option("--codec", options.codec, "Encoding of the frames to request: jpeg or vp9")
      ->transform(CLI::CheckedTransformer(std::map<std::string, load::LoadCodec>{
          {"jpeg", load::LoadCodec::kJpeg}, {"vp9", load::LoadCodec::kVp9}}));
  load->add_option("--steer", options.steer_hz,
                   "Updates of the camera a second by the presenter; 0 for none")
      ->check(CLI::Range(0.0, 240.0))
      ->capture_default_str();
  load->add_option(
          "--looking", options.looking,
          "How many of --viewers look around: each turns its own view, --steer times a second")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  load->add_option(
          "--kbit", flags->kbit_per_s,
          "Maximum kbit/s that each viewer reads; with --throttled only those viewers are limited")
      ->check(CLI::Range(1.0, 1e7));
  load->add_option("--throttled", flags->throttled,
                   "Additional viewers who read at most --kbit; the others are then not limited")
      ->check(CLI::Range(1, 10000));
  load->add_option("--stalled", options.stalled, "Additional viewers who join and never read")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  load->add_option("--passing", options.passing,
                   "Additional viewers who leave after two seconds and join again")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  AddClientAccessFlags(*load, flags->access);
  load->get_option("--tls-roots")
      ->description(
          "PEM file of the certificate authorities that may sign the server's certificate; without "
          "it the connection to HOST:PORT is not encrypted, and https:// uses this machine's "
          "authorities");
  AddImageFlags("--images", *load, *flags);
  // The flags --images were called --stills before. The earlier names are still accepted.
  for (CLI::Option* earlier : AddImageFlags("--stills", *load, *flags)) HideFromHelp(*earlier);
  AddBounds(*load, flags->bounds);
  load->add_flag("--json", flags->json, "Print JSON");
  return {load, [flags] { return Load(*flags); }};
}

}  // namespace thunderhead::app
