// Makes the pictures of a plan that are not made yet, each once: reads, draws, publishes the
// product, then records it in the manifest.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "app/pipeline_flags.h"
#include "app/run_progress.h"
#include "grpcpp/channel.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"

namespace thunderhead::app {

// One picture of a plan.
struct PlannedPicture {
  std::size_t storm = 0;  // of the plan's storms
  int time_index = 0;
  std::size_t view = 0;
  pipeline::ProductKey key;
  std::string path;
  std::string input;  // the file that it is made of
  // Of a picture by a server: the storm's id there, and the file as the server has it, without
  // hash.
  std::string server_storm = {};
  std::optional<pipeline::InputFile> server_input = {};
  absl::Status outcome;  // OK once it is made; UNAVAILABLE before
};

// Every time in `times` of a storm in every view, under the storm's name `name`. `assume_run` takes
// the run's first time as its start if the files do not tell. Errors: those of the names.
absl::StatusOr<std::vector<PlannedPicture>> PlanOf(
    const PictureRunOptions& options, const std::vector<storm_store::CataloguedStorm>& storms,
    std::size_t storm, const std::string& name, const std::vector<int>& times, bool assume_run);

// INVALID_ARGUMENT if two pictures would have one name.
absl::Status CheckNames(const PictureRunOptions& options,
                        const std::vector<PlannedPicture>& pictures);

// The size and time of a file, without its hash; UNAVAILABLE if there is none.
absl::StatusOr<pipeline::InputFile> StampOf(const std::string& path);

// The contents of a product, as its entry has them.
pipeline::ManifestEntry EntryOf(const pipeline::ProductKey& key, const View& view);

// Equal for a file that has not been written to in between.
bool SameStamp(const pipeline::InputFile& a, const pipeline::InputFile& b);

class PictureRun {
 public:
  // Creates the products' folder and takes the manifest.
  static absl::StatusOr<std::unique_ptr<PictureRun>> Open(PictureRunOptions options);

  // Makes those of `pictures` that are missing, and sets their outcome. Pictures whose input is bad
  // or changes leave the others alone; other errors end the run and are returned: CANCELLED after
  // `stop`. Products that were recorded stay recorded.
  absl::Status Make(const std::vector<storm_store::CataloguedStorm>& storms,
                    std::vector<PlannedPicture>& pictures, RunProgress& progress,
                    const std::stop_token& stop);

  const PictureRunOptions& Options() const { return options_; }
  // Not while pictures are made.
  const pipeline::Manifest& Records() const { return manifest_; }

  // Adds the entry of the product at `path`, whose size and hash it has, and its marker. Safe from
  // any thread.
  absl::Status Record(const std::string& path, pipeline::ManifestEntry entry);
  // Makes the product of a picture that was drawn for `planned` and writes it, with its world file
  // before it, then records it. Safe from any thread.
  absl::Status Publish(const PlannedPicture& planned, v1::RenderImageResponse picture,
                       const pipeline::ManifestEntry& entry);
  // True if the picture, and its world file if it has one, are whole and made as they would be now.
  absl::StatusOr<bool> IsMade(const PlannedPicture& picture, const pipeline::InputFile& input,
                              const std::function<std::string()>& input_sha256);
  // True if the product at `path` is whole and made as it would be now; see MadeAlike.
  absl::StatusOr<bool> IsMade(const std::string& path, const std::string& scene_sha256,
                              const pipeline::InputFile& input,
                              const std::function<std::string()>& input_sha256);

 private:
  PictureRun(PictureRunOptions options, pipeline::Manifest manifest)
      : options_(std::move(options)), manifest_(std::move(manifest)) {}

  absl::StatusOr<bool> IsMade(const PlannedPicture& picture);
  absl::Status MakeOne(const PlannedPicture& picture, storm_store::StormStore& store,
                       const std::shared_ptr<grpc::Channel>& channel, const std::string& device,
                       const std::string& storm_id, const std::stop_token& stop,
                       double& milliseconds, PictureTimes& times);
  absl::Status PublishFile(const std::string& path, const std::string& bytes,
                           pipeline::ManifestEntry entry);
  std::string HashOf(const pipeline::InputFile& input);
  // False if the file is another than when the first picture of it was begun: its fields, which the
  // storm store keeps from view to view, are then not of this file.
  bool IsAsBegun(const pipeline::InputFile& input);
  absl::Status MarkDone(const std::string& path, const std::string& sha256) const;

  const PictureRunOptions options_;
  std::mutex mutex_;  // of all below
  pipeline::Manifest manifest_;
  std::map<std::string, pipeline::InputFile> hashed_;  // by path
  std::map<std::string, pipeline::InputFile> begun_;   // as pictures under way found them first
};

}  // namespace thunderhead::app
