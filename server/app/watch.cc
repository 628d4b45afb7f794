#include "runs/watch.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/pipeline_flags.h"
#include "base/status.h"
#include "base/utc_time.h"
#include "pipeline/readiness.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct WatchFlags {
  std::string folder;
  std::string files = "*";
  std::string ready = "open";
  std::vector<std::string> until;
  PipelineFlags pipeline;
};

absl::StatusOr<runs::WatchEnd> ParseUntil(const std::vector<std::string>& until) {
  runs::WatchEnd end;
  bool good = true;
  bool unit_may_follow = false;
  for (const std::string& word : until) {
    int files = 0;
    const bool unit = word == "files" || word == "file";
    if (unit) {
      good = good && unit_may_follow;
    } else if (!end.files.has_value() && absl::SimpleAtoi(word, &files) && files > 0) {
      end.files = files;
    } else {
      const std::optional<absl::Time> at = base::ParseUtcTime(word);
      good = good && end.at == absl::InfiniteFuture() && at.has_value();
      if (at.has_value()) end.at = *at;
    }
    unit_may_follow = !unit && files > 0;
  }
  if (good) return end;
  return absl::InvalidArgumentError(
      absl::StrCat("--until is '", absl::StrJoin(until, " "),
                   "'; it must be a number of files, such as 12, or a time, such as "
                   "2030-05-20T06:00:00Z, or both"));
}

absl::StatusOr<runs::WatchOptions> WatchOptionsOf(const WatchFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const runs::WatchEnd end, ParseUntil(flags.until));
  THUNDERHEAD_ASSIGN_OR_RETURN(pipeline::ReadinessPolicy ready,
                               pipeline::ReadinessPolicy::Parse(flags.ready));
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::PictureRunOptions pictures, RunOptionsOf(flags.pipeline, {}));
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::MovieOptions movie,
                               MovieOptionsOf(flags.pipeline, pictures.format));
  if (pictures.product.Has("time")) {
    return absl::InvalidArgumentError(
        "--product has {time}, the index of a time in the whole run, which is not known while "
        "files still arrive: use {valid:%Y%m%d_%H%M} or {lead_min:04d}");
  }
  return runs::WatchOptions{flags.folder,        flags.files,      std::move(ready),       end,
                            std::move(pictures), std::move(movie), flags.pipeline.progress};
}

absl::Status Watch(const WatchFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::WatchOptions options, WatchOptionsOf(flags));
  if (flags.pipeline.server.address.empty()) {
    return runs::RunWatch(std::move(options), interruption.Token());
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<runs::ServerLink> server,
                               OpenServer(flags.pipeline.server));
  server->StopOn(interruption.Token());
  return runs::RunWatchAtServer(std::move(options), *server, interruption.Token());
}

}  // namespace

Command AddWatch(CLI::App& app) {
  auto flags = std::make_shared<WatchFlags>();
  CLI::App* command = app.add_subcommand(
      "watch", "Render the files of a folder as a model writes them, each once it is complete");
  command
      ->add_option("FOLDER", flags->folder,
                   "Folder in which the files appear; with --server a storm's id there, and the "
                   "server decides when its times are complete")
      ->required();
  command->add_option("--files", flags->files, "Pattern of their names, such as 'wrfout_d01_*'")
      ->capture_default_str();
  command
      ->add_option("--ready", flags->ready,
                   "When a file is complete: open (unchanged for 2 s), age:SECONDS[,minsize:BYTES] "
                   "(unchanged for SECONDS), next[,age:SECONDS] (a file with a later name exists) "
                   "or marker:GLOB (a marker file exists); it must also be readable")
      ->capture_default_str();
  command
      ->add_option("--until", flags->until,
                   "End after this many files (12 or '12 files'), including damaged ones, or at a "
                   "time (2030-05-20T06:00:00Z), or at the earlier of both; by default never")
      ->expected(1, 3);
  AddPipelineOptions(*command, flags->pipeline);
  return {command, [flags] { return Watch(*flags); }};
}

}  // namespace thunderhead::app
