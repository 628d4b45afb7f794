#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "app/commands.h"
#include "app/interruption.h"
#include "app/job_run.h"
#include "app/local_service.h"
#include "app/picture_run.h"
#include "app/pipeline_flags.h"
#include "app/run_movie.h"
#include "base/status.h"
#include "pipeline/plan.h"
#include "spdlog/spdlog.h"
#include "volume/storm_catalogue.h"

namespace thunderhead::app {
namespace {

struct Flags {
  std::vector<std::string> storms;
  std::string times = "all";
  std::string shard;
  PipelineFlags pipeline;
};

absl::StatusOr<std::vector<PlannedPicture>> PlanAll(
    const PictureRunOptions& options, const std::vector<volume::CataloguedStorm>& storms,
    const std::string& times) {
  std::vector<PlannedPicture> all;
  for (std::size_t storm = 0; storm < storms.size(); ++storm) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<int> chosen,
        pipeline::ParseTimes(times, static_cast<int>(storms[storm].info.times.size())));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<PlannedPicture> pictures,
        PlanOf(options, storms, storm, storms[storm].info.id, chosen, true));
    all.insert(all.end(), pictures.begin(), pictures.end());
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckNames(options, all));
  return all;
}

// Views of one time stay together, so that each process reads a time once.
std::vector<PlannedPicture> ShareOf(const std::vector<PlannedPicture>& all, std::size_t views,
                                    const pipeline::Shard& shard) {
  std::vector<PlannedPicture> share;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto count = static_cast<std::size_t>(shard.count);
    if (i / views % count == static_cast<std::size_t>(shard.index)) share.push_back(all[i]);
  }
  return share;
}

absl::StatusOr<std::vector<PlannedPicture>> PlanAll(const PictureRunOptions& options,
                                                    ServerLink& server,
                                                    const std::vector<std::string>& storms,
                                                    const std::string& times) {
  std::vector<PlannedPicture> all;
  for (std::size_t i = 0; i < storms.size(); ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const v1::StormDescription storm,
                                 DescribeStorm(server, storms[i]));
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<int> chosen,
                                 pipeline::ParseTimes(times, storm.times_size()));
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<PlannedPicture> pictures,
                                 PlanOfServer(options, server, storm, i, chosen, true));
    all.insert(all.end(), pictures.begin(), pictures.end());
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckNames(options, all));
  return all;
}

// What is left undone: what may come by another try goes before what never will.
absl::Status Summary(const std::vector<PlannedPicture>& pictures) {
  absl::Status worst;
  int missing = 0;
  for (const PlannedPicture& picture : pictures) {
    if (picture.outcome.ok()) continue;
    ++missing;
    if (worst.ok() || !absl::IsDataLoss(picture.outcome)) worst = picture.outcome;
  }
  if (missing == 0) return worst;
  return absl::Status(worst.code(), absl::StrCat(missing, " of ", pictures.size(),
                                                 " pictures could not be made; the reasons are "
                                                 "above"));
}

absl::Status Sequence(const Flags& flags) {
  spdlog::set_level(spdlog::level::warn);
  const Interruption interruption;
  const std::stop_token stop = interruption.Token();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const pipeline::Shard shard,
      flags.shard.empty() ? pipeline::ShardOfEnvironment() : pipeline::ParseShard(flags.shard));
  THUNDERHEAD_ASSIGN_OR_RETURN(PictureRunOptions options, RunOptionsOf(flags.pipeline, shard));
  THUNDERHEAD_ASSIGN_OR_RETURN(const MovieOptions movie,
                               MovieOptionsOf(flags.pipeline, options.format));
  if (movie.name.has_value() && shard.count > 1) {
    return absl::InvalidArgumentError(
        "--movie needs all pictures, but this process makes a share: run sequence once more "
        "without --shard when all shares are done, with --movie; it draws nothing anew");
  }
  std::unique_ptr<ServerLink> server;
  std::vector<volume::CataloguedStorm> storms;
  std::vector<PlannedPicture> all;
  if (flags.pipeline.server.address.empty()) {
    auto found = volume::FindStorms(flags.storms, volume::StormFormats::BuiltIn());
    if (!found.ok()) return AsFileProblem(found.status());
    storms = *std::move(found);
    THUNDERHEAD_ASSIGN_OR_RETURN(all, PlanAll(options, storms, flags.times));
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(server, ServerLink::Open(flags.pipeline.server));
    THUNDERHEAD_ASSIGN_OR_RETURN(all, PlanAll(options, *server, flags.storms, flags.times));
  }
  std::vector<PlannedPicture> pictures = ShareOf(all, options.views.size(), shard);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<PictureRun> run,
                               PictureRun::Open(std::move(options)));
  RunProgress progress(flags.pipeline.progress, "drawing");
  const absl::Status made = server == nullptr ? run->Make(storms, pictures, progress, stop)
                                              : MakeByJobs(*server, *run, pictures, progress, stop);
  if (absl::IsCancelled(made)) {
    return absl::CancelledError(absl::StrCat(
        "interrupted: ", progress.DrawnCount() + progress.KeptCount(), " of ", pictures.size(),
        " pictures are made and in ", run->Records().Path(), "; the same command goes on"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(made);
  THUNDERHEAD_RETURN_IF_ERROR(Summary(pictures));
  return MakeMovies(movie, pictures, *run, progress, stop);
}

}  // namespace

Command AddSequence(CLI::App& app) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "sequence", "Render every time of storms in every view; goes on where it was stopped");
  command
      ->add_option("STORM", flags->storms,
                   "Storm files or folders; with --server storms' ids there")
      ->required();
  command
      ->add_option("--times", flags->times,
                   "Indices of each storm's times, such as 0,3,6-9; or all, or last")
      ->capture_default_str();
  command->add_option("--shard", flags->shard,
                      "I/N: make share I, from 0, of N; by default what Slurm's array or a "
                      "Kubernetes job says, else all");
  AddPipelineOptions(*command, flags->pipeline);
  return {command, [flags] { return Sequence(*flags); }};
}

}  // namespace thunderhead::app
