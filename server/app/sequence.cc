#include "runs/sequence.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/interruption.h"
#include "app/pipeline_flags.h"
#include "base/status.h"
#include "pipeline/plan.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

struct SequenceFlags {
  std::vector<std::string> storms;
  std::string times = "all";
  std::string shard;
  PipelineFlags pipeline;
};

absl::StatusOr<runs::SequenceOptions> SequenceOptionsOf(const SequenceFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const pipeline::Shard shard,
      flags.shard.empty() ? pipeline::ShardOfEnvironment() : pipeline::ParseShard(flags.shard));
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::PictureRunOptions pictures,
                               RunOptionsOf(flags.pipeline, shard));
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::MovieOptions movie,
                               MovieOptionsOf(flags.pipeline, pictures.format));
  if (movie.name.has_value() && shard.count > 1) {
    return absl::InvalidArgumentError(
        "--movie needs all pictures, but this process makes only a share of them: omit it, and "
        "when all shares are done, run sequence once more with --movie and without --shard, which "
        "draws no picture again");
  }
  return runs::SequenceOptions{flags.storms,        flags.times,      shard,
                               std::move(pictures), std::move(movie), flags.pipeline.progress};
}

absl::Status Sequence(const SequenceFlags& flags) {
  spdlog::set_level(spdlog::level::warn);
  const Interruption interruption;
  THUNDERHEAD_ASSIGN_OR_RETURN(runs::SequenceOptions options, SequenceOptionsOf(flags));
  std::unique_ptr<runs::ServerLink> server;
  if (!flags.pipeline.server.address.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(server, OpenServer(flags.pipeline.server));
    server->StopOn(interruption.Token());
  }
  return runs::RunSequence(std::move(options), server.get(), interruption.Token());
}

}  // namespace

Command AddSequence(CLI::App& app) {
  auto flags = std::make_shared<SequenceFlags>();
  CLI::App* command = app.add_subcommand(
      "sequence", "Render every time of storms in every view; continues where it was stopped");
  command
      ->add_option("STORM", flags->storms,
                   "Storm files or folders; with --server storms' ids there")
      ->required();
  command
      ->add_option("--times", flags->times,
                   "Indices of each storm's times, such as 0,3,6-9; or all, or last")
      ->capture_default_str();
  command->add_option("--shard", flags->shard,
                      "I/N: make only share I (from 0) of N shares; by default the share that a "
                      "Slurm array or a Kubernetes job sets, otherwise all");
  AddPipelineOptions(*command, flags->pipeline);
  return {command, [flags] { return Sequence(*flags); }};
}

}  // namespace thunderhead::app
