// Makes the missing pictures of a plan, each exactly once. For each picture, it reads the storm,
// draws, writes the product, and then records the product in the manifest.
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
#include "grpcpp/channel.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"
#include "runs/run_options.h"
#include "runs/run_progress.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"

namespace thunderhead::runs {

// One picture of a plan.
struct PlannedPicture {
  std::size_t storm = 0;  // index of the storm in the plan
  int time_index = 0;
  std::size_t view = 0;
  pipeline::ProductKey key;
  std::string path;
  std::string input;  // the storm file from which the picture is made
  // For a picture that a server draws: the storm's id on the server, and the server's input file
  // without its hash.
  std::string server_storm = {};
  std::optional<pipeline::InputFile> server_input = {};
  // OK once the picture is made. Before, UNAVAILABLE or the error of an attempt.
  absl::Status outcome;
};

// Returns a plan with a picture for each time in `times` of the storm number `storm`, in each view.
// Products name the storm `name`. If `assume_run` is true and the files do not give the start of
// the run, it is the run's first time. Errors are those of making the products' names.
absl::StatusOr<std::vector<PlannedPicture>> PlanOf(
    const PictureRunOptions& options, const std::vector<storm_store::CataloguedStorm>& storms,
    std::size_t storm, const std::string& name, const std::vector<int>& times, bool assume_run);

// Returns INVALID_ARGUMENT if two pictures would have the same name, or if one would replace a
// storm file of the plan or the manifest.
absl::Status CheckNames(const PictureRunOptions& options,
                        const std::vector<PlannedPicture>& pictures);

// Returns the size and the modification time of a file, without its hash. Returns NOT_FOUND if the
// file does not exist.
absl::StatusOr<pipeline::InputFile> StampOf(const std::string& path);

// Returns the manifest entry that describes the contents of a product.
pipeline::ManifestEntry EntryOf(const pipeline::ProductKey& key, const View& view);

// Returns true if two stamps (path, size and modification time) show that the file was not written
// in between.
bool SameStamp(const pipeline::InputFile& a, const pipeline::InputFile& b);

class PictureRun {
 public:
  // Creates the folder of the products and opens the manifest, which it locks.
  static absl::StatusOr<std::unique_ptr<PictureRun>> Open(PictureRunOptions options);

  // Makes those of `pictures` that are missing, and sets their outcome. A picture whose input is
  // bad or changes does not affect the others. Any other error ends the run and is returned; it is
  // CANCELLED if `stop` was requested. Recorded products stay recorded.
  absl::Status Make(const std::vector<storm_store::CataloguedStorm>& storms,
                    std::vector<PlannedPicture>& pictures, RunProgress& progress,
                    const std::stop_token& stop);

  const PictureRunOptions& Options() const { return options_; }
  // Returns the manifest. Must not be called while pictures are being made.
  const pipeline::Manifest& Records() const { return manifest_; }

  // Adds the manifest entry of the product at `path`, with its size and hash, and writes the
  // product's done marker. Safe to call from any thread.
  absl::Status Record(const std::string& path, pipeline::ManifestEntry entry);
  // Makes the product from the picture drawn for `planned`, and writes and records it. Its world
  // file, if any, is written first. Safe to call from any thread.
  absl::Status Publish(const PlannedPicture& planned, v1::RenderImageResponse picture,
                       const pipeline::ManifestEntry& entry);
  // Returns true if the picture need not be made again: it and its world file (if any) are
  // complete, and would now be made in the same way (pipeline::MadeAlike).
  absl::StatusOr<bool> IsMade(const PlannedPicture& picture, const pipeline::InputFile& input,
                              const std::function<std::string()>& input_sha256);
  // Returns true if the product at `path` need not be made again: it is complete, and would now be
  // made in the same way (pipeline::MadeAlike).
  absl::StatusOr<bool> IsMade(const std::string& path, const std::string& scene_sha256,
                              const pipeline::InputFile& input,
                              const std::function<std::string()>& input_sha256);

 private:
  PictureRun(PictureRunOptions options, pipeline::Manifest manifest)
      : options_(std::move(options)), manifest_(std::move(manifest)) {}

  absl::StatusOr<bool> IsMade(const PlannedPicture& picture, const std::stop_token& stop);
  absl::Status MakeOne(const PlannedPicture& picture, storm_store::StormStore& store,
                       const std::shared_ptr<grpc::Channel>& channel, const std::string& device,
                       const std::string& storm_id, const std::stop_token& stop,
                       double& milliseconds, PictureTimes& times);
  absl::Status PublishFile(const std::string& path, const std::string& bytes,
                           pipeline::ManifestEntry entry);
  // Returns the hash of the file. If the file cannot be read, or if `stop` is requested meanwhile,
  // returns an empty text, which equals no recorded hash.
  std::string HashOf(const pipeline::InputFile& input, const std::stop_token& stop);
  // Returns false if the file has changed since its first picture was begun. The fields that the
  // storm store keeps for the following views then belong to the old file.
  bool IsAsBegun(const pipeline::InputFile& input);
  absl::Status MarkDone(const std::string& path, const std::string& sha256) const;

  const PictureRunOptions options_;
  std::mutex mutex_;  // guards all members below
  pipeline::Manifest manifest_;
  std::map<std::string, pipeline::InputFile> hashed_;  // by path
  // Sizes and modification times of files, as the pictures in progress first found them.
  std::map<std::string, pipeline::InputFile> begun_;
};

// Returns INVALID_ARGUMENT if `path`, the file of `what`, is also that of the manifest.
absl::Status CheckIsNoManifest(const std::string& what, const std::string& path,
                               const std::string& manifest);

}  // namespace thunderhead::runs
