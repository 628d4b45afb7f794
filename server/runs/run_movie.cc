#include "runs/run_movie.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/own_file.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/whole_file.h"
#include "frame/image_codec.h"
#include "frame/png_text.h"
#include "nlohmann/json.hpp"
#include "pipeline/movie.h"
#include "pipeline/sha256.h"
#include "service/messages/picture_texts.h"

namespace thunderhead::runs {
namespace {

// This rate is slow enough to follow a storm and fast enough to show its motion.
constexpr int kFramesPerSecond = 8;

nlohmann::ordered_json JsonOf(const std::string& text) {
  return nlohmann::ordered_json::parse(text, nullptr, false);
}

// Returns the description for a movie's metadata, as JSON. It has the program's version, the storm,
// the start of the model run, the view's name, the times, the largest estimated error of the
// pictures, and the scene. It also has the View message of the first picture, if that picture is a
// PNG with this message in its texts.
std::string DescriptionOf(const pipeline::ManifestEntry& entry, const View& view,
                          const std::vector<const PlannedPicture*>& pictures) {
  nlohmann::ordered_json json;
  json["program"] = absl::StrCat("Thunderhead ", entry.version);
  json["storm"] = entry.storm;
  if (entry.run.has_value()) json["run"] = *entry.run;
  json["view"] = view.name;
  for (const PlannedPicture* picture : pictures) {
    json["valid"].push_back(
        absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", picture->key.valid, absl::UTCTimeZone()));
  }
  if (entry.estimated_error.has_value()) json["estimated_error"] = *entry.estimated_error;
  std::string scene;
  (void)google::protobuf::util::MessageToJsonString(view.scene, &scene);
  json["scene"] = JsonOf(scene);
  const auto first = base::ReadOwnFile(pictures.front()->path);
  if (first.ok() && frame::IsPng(*first)) {
    const auto texts = frame::TextsOf(*first);
    if (texts.ok() && texts->contains(service::kViewText)) {
      json["pose"] = JsonOf(texts->at(service::kViewText));
    }
  }
  // Invalid characters are replaced, because storms are named after files, whose names may have any
  // encoding.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

absl::Status MakeMovie(const std::string& path, const View& view,
                       std::vector<const PlannedPicture*> pictures, PictureRun& run,
                       RunProgress& progress, const std::stop_token& stop) {
  const base::Stopwatch stopwatch;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  if (!folder.empty()) THUNDERHEAD_RETURN_IF_ERROR(base::MakeFolders(folder));
  std::ranges::sort(pictures, {}, [](const PlannedPicture* picture) { return picture->key.valid; });
  pipeline::InputFile input;  // its hash is made of the hashes of the movie's pictures
  std::vector<absl::Time> valid;
  std::string hashes;
  pipeline::ManifestEntry entry;
  std::optional<double> largest_error;
  for (const PlannedPicture* picture : pictures) {
    const pipeline::ManifestEntry* made = run.Records().Find(picture->path);
    if (made == nullptr) {
      return absl::InternalError(absl::StrCat(picture->path, " is not in the manifest"));
    }
    valid.push_back(picture->key.valid);
    absl::StrAppend(&hashes, made->sha256, "\n");
    input.bytes += made->bytes;
    entry = *made;
    if (made->estimated_error.has_value()) {
      largest_error = std::max(largest_error.value_or(0.0), *made->estimated_error);
    }
  }
  entry.estimated_error = largest_error;
  // The interval is removed because it belongs to one picture, while the largest error may belong
  // to another.
  entry.error_low.reset();
  entry.error_high.reset();
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
      entry.storm, absl::StrCat("made by Thunderhead ", entry.version, " of scene ", view.sha256),
      DescriptionOf(entry, view, pictures)};
  THUNDERHEAD_RETURN_IF_ERROR(pipeline::WriteMovie(
      path, pipeline::FramesOfPictures(valid), kFramesPerSecond, text,
      [&](std::size_t i) -> absl::StatusOr<frame::RgbImage> {
        if (stop.stop_requested()) return absl::CancelledError("interrupted");
        THUNDERHEAD_ASSIGN_OR_RETURN(const std::string bytes, base::ReadOwnFile(pictures[i]->path));
        return run.Options().format.kind == ProductKind::kPng ? frame::DecodePng(bytes)
                                                              : frame::DecodeJpeg(bytes);
      }));
  entry.milliseconds = stopwatch.ElapsedMs();
  entry.input = std::move(input);
  THUNDERHEAD_ASSIGN_OR_RETURN(const pipeline::InputFile written, StampOf(path));
  entry.bytes = written.bytes;
  THUNDERHEAD_ASSIGN_OR_RETURN(entry.sha256, pipeline::Sha256OfFile(path));
  THUNDERHEAD_RETURN_IF_ERROR(run.Record(path, std::move(entry)));
  progress.Drawn(path, stopwatch.ElapsedMs());
  return absl::OkStatus();
}

// Returns the error for two movies of one name, and what distinguishes them.
absl::Status SameName(const std::string& path, const pipeline::ProductKey& one,
                      const pipeline::ProductKey& other) {
  const bool of_one_storm = one.storm == other.storm;
  return absl::InvalidArgumentError(absl::StrCat(
      "--movie would give the movies of ",
      of_one_storm ? absl::StrCat("two runs of storm ", one.storm)
                   : absl::StrCat("storms ", one.storm, " and ", other.storm),
      " the same name '", path, "'; add ", of_one_storm ? "{run:%Y%m%d%H}" : "{storm}"));
}

}  // namespace

absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop) {
  if (!options.name.has_value()) return absl::OkStatus();
  std::map<std::string, std::vector<const PlannedPicture*>> movies;
  for (const PlannedPicture& picture : pictures) {
    if (!picture.outcome.ok()) continue;
    if (picture.view > 0 && !options.name->Has("view")) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string path, options.name->For(picture.key));
    THUNDERHEAD_RETURN_IF_ERROR(CheckIsNoManifest("a movie", path, run.Options().manifest));
    std::vector<const PlannedPicture*>& movie = movies[path];
    if (!movie.empty() && (movie.front()->key.storm != picture.key.storm ||
                           movie.front()->key.run != picture.key.run)) {
      return SameName(path, movie.front()->key, picture.key);
    }
    movie.push_back(&picture);
  }
  for (const auto& [path, of] : movies) {
    const View& view = run.Options().views[of.front()->view];
    THUNDERHEAD_RETURN_IF_ERROR(MakeMovie(path, view, of, run, progress, stop));
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::runs
