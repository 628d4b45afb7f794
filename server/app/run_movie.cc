#include "app/run_movie.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/whole_file.h"
#include "frame/image_codec.h"
#include "pipeline/movie.h"
#include "pipeline/sha256.h"

namespace thunderhead::app {
namespace {

// So slow that a storm can be followed, so fast that it moves.
constexpr int kFramesPerSecond = 8;

absl::Status MakeMovie(const std::string& path, const View& view,
                       std::vector<const PlannedPicture*> pictures, PictureRun& run,
                       RunProgress& progress, const std::stop_token& stop) {
  const base::Stopwatch stopwatch;
  std::ranges::sort(pictures, {}, [](const PlannedPicture* picture) { return picture->key.valid; });
  pipeline::InputFile input;  // the pictures, by their hashes
  std::vector<absl::Time> valid;
  std::string hashes;
  pipeline::ManifestEntry entry;
  for (const PlannedPicture* picture : pictures) {
    const pipeline::ManifestEntry* made = run.Records().Find(picture->path);
    if (made == nullptr) {
      return absl::InternalError(absl::StrCat(picture->path, " is not in the manifest"));
    }
    valid.push_back(picture->key.valid);
    absl::StrAppend(&hashes, made->sha256, "\n");
    input.bytes += made->bytes;
    entry = *made;
  }
  input.path = run.Options().product.Text();
  input.sha256 = pipeline::Sha256(hashes);
  progress.Plan(1);
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool made,
                               run.IsMade(path, view.sha256, input, [] { return ""; }));
  if (made) {
    progress.Kept(path);
    return absl::OkStatus();
  }
  const pipeline::MovieText text{
      entry.storm, absl::StrCat("made by Thunderhead ", entry.version, " of scene ", view.sha256)};
  THUNDERHEAD_RETURN_IF_ERROR(pipeline::WriteMovie(
      path, pipeline::FramesOfPictures(valid), kFramesPerSecond, text,
      [&](std::size_t i) -> absl::StatusOr<frame::RgbImage> {
        if (stop.stop_requested()) return absl::CancelledError("interrupted");
        THUNDERHEAD_ASSIGN_OR_RETURN(const std::string bytes,
                                     base::ReadWholeFile(pictures[i]->path));
        return run.Options().format == v1::IMAGE_FORMAT_PNG ? frame::DecodePng(bytes)
                                                            : frame::DecodeJpeg(bytes);
      }));
  entry.milliseconds = stopwatch.ElapsedMs();
  entry.estimated_error.reset();
  entry.input = std::move(input);
  THUNDERHEAD_ASSIGN_OR_RETURN(const pipeline::InputFile written, StampOf(path));
  entry.bytes = written.bytes;
  THUNDERHEAD_ASSIGN_OR_RETURN(entry.sha256, pipeline::Sha256OfFile(path));
  THUNDERHEAD_RETURN_IF_ERROR(run.Record(path, std::move(entry)));
  progress.Drawn(path, stopwatch.ElapsedMs());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MovieOptions> MovieOptionsOf(const PipelineFlags& flags) {
  MovieOptions options;
  if (flags.movie.empty()) return options;
  THUNDERHEAD_ASSIGN_OR_RETURN(options.name, pipeline::ProductName::Parse("--movie", flags.movie));
  const bool of_times = options.name->Has("valid") || options.name->Has("lead") ||
                        options.name->Has("lead_min") || options.name->Has("time");
  if (pipeline::IsMovieName(flags.movie) && !of_times) return options;
  return absl::InvalidArgumentError(absl::StrCat(
      "--movie is '", flags.movie,
      "'; it must end in .webm or .mp4, and have no field but {storm}, {run:...} and {view}"));
}

absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop) {
  if (!options.name.has_value()) return absl::OkStatus();
  if (run.Options().format == v1::IMAGE_FORMAT_EXR) {
    return absl::InvalidArgumentError(
        "--movie needs pictures of .png or .jpg, but --product ends in .exr: omit one");
  }
  std::map<std::string, std::vector<const PlannedPicture*>> movies;
  for (const PlannedPicture& picture : pictures) {
    if (!picture.outcome.ok()) continue;
    if (picture.view > 0 && !options.name->Has("view")) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string path, options.name->For(picture.key));
    std::vector<const PlannedPicture*>& movie = movies[path];
    if (!movie.empty() && (movie.front()->key.storm != picture.key.storm ||
                           movie.front()->key.run != picture.key.run)) {
      return absl::InvalidArgumentError(
          absl::StrCat("--movie would name the movies of storms ", movie.front()->key.storm,
                       " and ", picture.key.storm, " '", path, "'; add {storm} or {run:%Y%m%d%H}"));
    }
    movie.push_back(&picture);
  }
  for (const auto& [path, of] : movies) {
    const View& view = run.Options().views[of.front()->view];
    THUNDERHEAD_RETURN_IF_ERROR(MakeMovie(path, view, of, run, progress, stop));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::app
