// Makes the missing pictures of a plan, each once. It reads, draws, publishes the product, and then
// records it in the manifest.
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
  std::size_t storm = 0;  // index among the plan's storms
  int time_index = 0;
  std::size_t view = 0;
  pipeline::ProductKey key;
  std::string path;
  std::string input;  // the file from which it is made
  // For a picture by a server: the storm's id on the server, and the server's file, without a hash.
  std::string server_storm = {};
  std::optional<pipeline::InputFile> server_input = {};
  absl::Status outcome;  // OK once it is made, UNAVAILABLE before
};

// Returns a plan with every time in `times` of a storm in every view. The storm has the name
// `name`. With `assume_run`, the run's first time is its start if the files do not give one. Errors
// are those of the names.
absl::StatusOr<std::vector<PlannedPicture>> PlanOf(
    const PictureRunOptions& options, const std::vector<storm_store::CataloguedStorm>& storms,
    std::size_t storm, const std::string& name, const std::vector<int>& times, bool assume_run);

// Returns INVALID_ARGUMENT if two pictures would have the same name.
absl::Status CheckNames(const PictureRunOptions& options,
                        const std::vector<PlannedPicture>& pictures);

// Returns the size and time of a file, without its hash; UNAVAILABLE if the file does not exist.
absl::StatusOr<pipeline::InputFile> StampOf(const std::string& path);

// Returns the manifest entry that describes the contents of a product.
pipeline::ManifestEntry EntryOf(const pipeline::ProductKey& key, const View& view);

// Returns true for stamps of a file that was not written in between.
bool SameStamp(const pipeline::InputFile& a, const pipeline::InputFile& b);

class PictureRun {
 public:
  // Creates the products' folder and opens the manifest for exclusive use.
  static absl::StatusOr<std::unique_ptr<PictureRun>> Open(PictureRunOptions options);

  // Makes the missing ones of `pictures` and sets their outcome. A picture whose input is bad or
  // changes does not affect the others. Other errors end the run and are returned, with CANCELLED
  // after `stop`. Recorded products stay recorded.
  absl::Status Make(const std::vector<storm_store::CataloguedStorm>& storms,
                    std::vector<PlannedPicture>& pictures, RunProgress& progress,
                    const std::stop_token& stop);

  const PictureRunOptions& Options() const { return options_; }
  // Returns the manifest. It must not be called while pictures are made.
  const pipeline::Manifest& Records() const { return manifest_; }

  // Adds the entry of the product at `path`, with its size and hash, and the product's marker. Safe
  // to call from any thread.
  absl::Status Record(const std::string& path, pipeline::ManifestEntry entry);
  // Makes and writes the product of the picture drawn for `planned`, with its world file first,
  // then records it. Safe to call from any thread.
  absl::Status Publish(const PlannedPicture& planned, v1::RenderImageResponse picture,
                       const pipeline::ManifestEntry& entry);
  // Returns true if the picture, and its world file if it has one, are complete and were made as
  // they would be now.
  absl::StatusOr<bool> IsMade(const PlannedPicture& picture, const pipeline::InputFile& input,
                              const std::function<std::string()>& input_sha256);
  // Returns true if the product at `path` is complete and was made as it would be now; see
  // MadeAlike.
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
  // Returns false if the file has changed since its first picture was begun. The fields that the
  // storm store keeps from view to view are then not of this file.
  bool IsAsBegun(const pipeline::InputFile& input);
  absl::Status MarkDone(const std::string& path, const std::string& sha256) const;

  const PictureRunOptions options_;
  std::mutex mutex_;  // guards all members below
  pipeline::Manifest manifest_;
  std::map<std::string, pipeline::InputFile> hashed_;  // by path
  // The stamps of files as the pictures in progress first found them.
  std::map<std::string, pipeline::InputFile> begun_;
};

}  // namespace thunderhead::app
