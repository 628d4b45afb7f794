#include "runs/sequence.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "pipeline/plan.h"
#include "runs/exit_codes.h"
#include "runs/job_run.h"
#include "runs/local_service.h"
#include "runs/picture_run.h"
#include "runs/tell_user.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_format.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::runs {
namespace {

// The storms and files that were found.
struct Found {
  std::vector<storm_store::CataloguedStorm> storms;
  // The position of each storm file among all files in the order of their names, including
  // unreadable files.
  std::map<std::string, std::size_t> places;
  // The errors of files that do not exist or cannot be read, by path.
  std::map<std::string, absl::Status> problems;
};

// Ranks outcomes for the exit code. Errors that a retry may fix take precedence over permanent
// errors.
int RankOf(const absl::Status& status) {
  switch (ExitCodeOf(status)) {
    case ExitCode::kDone:
      return 0;
    case ExitCode::kBadInput:
      return 1;
    case ExitCode::kTryAgain:
      return 3;
    default:
      return 2;
  }
}

const absl::Status& Worse(const absl::Status& a, const absl::Status& b) {
  return RankOf(b) > RankOf(a) ? b : a;
}

absl::Status WorstOf(const std::map<std::string, absl::Status>& problems) {
  absl::Status worst;
  for (const auto& [path, problem] : problems) worst = Worse(worst, problem);
  return worst;
}

// Searches each path for storms. A file that cannot be read does not affect the others.
absl::StatusOr<Found> Find(const std::vector<std::string>& paths, const std::stop_token& stop) {
  Found found;
  const storm_files::StormFormats formats = sandbox::ConfinedFormats({.limits = {.stop = stop}});
  // Keeps the place of a file and, if the file cannot be read, the reason. The reasons are reported
  // when all files have been searched.
  const auto note = [&](const std::string& path, absl::StatusOr<storm_files::StormFile>& file) {
    // A folder may also contain files that are not storms.
    const bool other = absl::IsInvalidArgument(file.status());
    if (other && std::ranges::find(paths, path) == paths.end()) return;
    found.places.emplace(path, found.places.size());
    if (file.ok()) return;
    found.problems.emplace(path, AsFileProblem(path, file.status()));
    file = absl::CancelledError("told at the end");
  };
  const storm_store::StormSearch search{.describe =
                                            [&](const std::vector<std::string>& files) {
                                              auto described = storm_store::DescribeInBatches(
                                                  files, formats,
                                                  [&stop] { return !stop.stop_requested(); });
                                              for (std::size_t i = 0; i < files.size(); ++i)
                                                note(files[i], described[i]);
                                              return described;
                                            },
                                        .describe_together =
                                            [&](const std::vector<std::string>& files) {
                                              auto described = formats.DescribeTogether(files);
                                              note(files.front(), described);
                                              return described;
                                            },
                                        .may_find_nothing = true,
                                        .on_unlisted = {},
                                        .on_folder = {},
                                        .examples = formats.Examples(),
                                        .links = storm_store::EveryLink(),
                                        .stop = stop};
  auto storms = storm_store::FindStorms(paths, search);
  if (absl::IsCancelled(storms.status())) {
    return absl::CancelledError(
        "interrupted while the storms were searched: nothing is drawn; run the same command again");
  }
  if (!storms.ok()) return AsFileProblem(storms.status());
  found.storms = *std::move(storms);
  for (const std::string& path : paths) {
    const std::string below = absl::EndsWith(path, "/") ? path : path + "/";
    const bool any = std::ranges::any_of(found.places, [&](const auto& place) {
      return place.first == path || absl::StartsWith(place.first, below);
    });
    if (any) continue;
    found.problems.emplace(path, absl::NotFoundError(absl::StrCat(
                                     path, ": there is no storm; put the model's output files (",
                                     search.examples, ") there, or check the path")));
  }
  if (found.storms.empty()) return WorstOf(found.problems);
  return found;
}

// Returns an error if some files cannot be read, but the request needs the times of all files. It
// needs them if it selects times by index, if a name contains {time}, or if the first time is taken
// as the start of the run.
absl::Status CheckCounts(const Found& found, const std::string& times,
                         const PictureRunOptions& options, const MovieOptions& movie) {
  if (found.problems.empty()) return absl::OkStatus();
  const auto has = [&](const char* field) {
    return options.product.Has(field) || (movie.name.has_value() && movie.name->Has(field));
  };
  const bool assumes_run =
      std::ranges::any_of(found.storms,
                          [](const auto& storm) { return !storm.info.run_start.has_value(); }) &&
      (has("run") || has("lead") || has("lead_min"));
  if (times == "all" && !has("time") && !assumes_run) return absl::OkStatus();
  const absl::Status worst = WorstOf(found.problems);
  return absl::Status(worst.code(),
                      absl::StrCat(worst.message(), ". Nothing is drawn, because ",
                                   times != "all" ? "--times"
                                   : has("time")  ? "{time}"
                                                 : "the start of the run, which is the first time,",
                                   " is known only when all files can be read"));
}

absl::StatusOr<std::vector<PlannedPicture>> PlanSequence(
    const PictureRunOptions& options, const std::vector<storm_store::CataloguedStorm>& storms,
    const std::string& times, bool assume_run) {
  std::vector<PlannedPicture> all;
  for (std::size_t storm = 0; storm < storms.size(); ++storm) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<int> chosen,
        pipeline::ParseTimes(times, static_cast<int>(storms[storm].info.times.size())));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<PlannedPicture> pictures,
        PlanOf(options, storms, storm, storms[storm].info.id, chosen, assume_run));
    all.insert(all.end(), pictures.begin(), pictures.end());
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckNames(options, all));
  return all;
}

// Returns the number of a time, which determines the share that it belongs to. If all times are
// requested, the number is the sum of the time's index in its file and the file's index among all
// files, readable or not. A file that becomes complete between the searches of two shares therefore
// does not change the numbers of other times.
std::size_t NumberOf(const PlannedPicture& picture, std::size_t index, const Found& found,
                     const std::string& times) {
  const auto place = found.places.find(picture.input);
  if (times != "all" || place == found.places.end()) return index;
  const auto& sources = found.storms[picture.storm].sources;
  return place->second + sources[static_cast<std::size_t>(picture.time_index)].record;
}

// Returns the pictures of one share. All views of a time are in the same share, so that only one
// process reads the time.
std::vector<PlannedPicture> ShareOf(const std::vector<PlannedPicture>& all, std::size_t views,
                                    const pipeline::Shard& shard, const Found& found,
                                    const std::string& times) {
  std::vector<PlannedPicture> share;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto count = static_cast<std::size_t>(shard.count);
    if (NumberOf(all[i], i / views, found, times) % count ==
        static_cast<std::size_t>(shard.index)) {
      share.push_back(all[i]);
    }
  }
  return share;
}

absl::StatusOr<std::vector<PlannedPicture>> PlanSequence(const PictureRunOptions& options,
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

// Returns the worst error of all pictures that were not made and of all files that could not be
// read.
absl::Status Summary(const std::vector<PlannedPicture>& pictures, const Found& found) {
  absl::Status worst = WorstOf(found.problems);
  int missing = 0;
  for (const PlannedPicture& picture : pictures) {
    if (picture.outcome.ok()) continue;
    ++missing;
    worst = Worse(worst, absl::IsDataLoss(picture.outcome)
                             ? AsFileProblem(picture.input, picture.outcome)
                             : picture.outcome);
  }
  if (worst.ok()) return worst;
  std::string what = "the reasons are above";
  if (missing > 0) {
    what = absl::StrCat(missing, " of ", pictures.size(), " pictures could not be made; ", what);
  }
  if (!found.problems.empty()) {
    what = absl::StrCat(found.problems.size(), " of the storms' files could not be read; ", what);
  }
  return absl::Status(worst.code(), what);
}

}  // namespace

absl::Status RunSequence(SequenceOptions options, ServerLink* server, const std::stop_token& stop) {
  Found found;
  std::vector<PlannedPicture> all;
  if (server == nullptr) {
    THUNDERHEAD_ASSIGN_OR_RETURN(found, Find(options.storms, stop));
    THUNDERHEAD_RETURN_IF_ERROR(CheckCounts(found, options.times, options.pictures, options.movie));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        all, PlanSequence(options.pictures, found.storms, options.times, found.problems.empty()));
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        all, PlanSequence(options.pictures, *server, options.storms, options.times));
  }
  std::vector<PlannedPicture> pictures =
      ShareOf(all, options.pictures.views.size(), options.shard, found, options.times);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<PictureRun> run,
                               PictureRun::Open(std::move(options.pictures)));
  RunProgress progress(options.progress, "drawing");
  for (const auto& [path, problem] : found.problems) progress.Failed(path, problem);
  const absl::Status made = server == nullptr ? run->Make(found.storms, pictures, progress, stop)
                                              : MakeByJobs(*server, *run, pictures, progress, stop);
  if (absl::IsCancelled(made)) {
    return absl::CancelledError(
        absl::StrCat("interrupted: ", progress.DrawnCount() + progress.KeptCount(), " of ",
                     pictures.size(), " pictures are made and listed in ", run->Records().Path(),
                     "; run the same command again to continue"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(made);
  // The movies are made from the pictures that exist, because the missing ones may never arrive.
  const absl::Status missing = Summary(pictures, found);
  const absl::Status movies = MakeMovies(options.movie, pictures, *run, progress, stop);
  if (missing.ok() || movies.ok()) return missing.ok() ? movies : missing;
  const bool movies_first = RankOf(movies) > RankOf(missing);
  TellUser(std::string((movies_first ? missing : movies).message()));
  return movies_first ? movies : missing;
}

}  // namespace thunderhead::runs
