#include "runs/run_movie.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::runs {
namespace {

// Returns the error of making the movies, named `movie`, of pictures with these keys. The manifest
// is manifest.webm in the folder.
std::string ErrorOf(const testing::TemporaryFolder& folder, const std::string& movie,
                    const std::vector<pipeline::ProductKey>& keys) {
  PictureRunOptions options{.product = *pipeline::ProductName::Parse("--product", "{storm}.png")};
  options.manifest = folder.File("manifest.webm");
  auto run = PictureRun::Open(std::move(options));
  EXPECT_TRUE(run.ok()) << run.status();
  std::vector<PlannedPicture> pictures;
  for (const pipeline::ProductKey& key : keys) pictures.emplace_back().key = key;
  RunProgress progress(ProgressStyle::kNone, "test");
  const MovieOptions named{.name = *pipeline::ProductName::Parse("--movie", movie)};
  return std::string(MakeMovies(named, pictures, **run, progress, {}).message());
}

TEST(MakeMovies, SaysWhatDistinguishesMoviesOfOneName) {
  const testing::TemporaryFolder folder;
  const absl::Time run = absl::UnixEpoch();
  EXPECT_EQ(ErrorOf(folder, "movie.webm", {{.storm = "A", .run = run}, {.storm = "B", .run = run}}),
            "--movie would give the movies of storms A and B the same name 'movie.webm'; add "
            "{storm}");
  EXPECT_EQ(ErrorOf(folder, "{storm}.webm",
                    {{.storm = "A", .run = run}, {.storm = "A", .run = run + absl::Hours(6)}}),
            "--movie would give the movies of two runs of storm A the same name 'A.webm'; add "
            "{run:%Y%m%d%H}");
}

TEST(MakeMovies, ReplaceNoManifest) {
  const testing::TemporaryFolder folder;
  const std::string movie = folder.File("./manifest.webm");
  EXPECT_EQ(
      ErrorOf(folder, movie, {{.storm = "A"}}),
      "a movie and the manifest would both be '" + movie + "'; give another name by --manifest");
}

TEST(CheckNames, AProductReplacesNeitherAStormNorTheManifest) {
  const testing::TemporaryFolder folder;
  const std::string storm = folder.File("storm.nc");
  std::ofstream(storm) << "a storm";
  const std::string link = folder.File("link");
  std::filesystem::create_directory_symlink(folder.Path(), link);
  PictureRunOptions options{.product = *pipeline::ProductName::Parse("--product", "{storm}.nc")};
  options.manifest = folder.File("manifest.nc");
  const auto complaint = [&](const std::string& path) {
    std::vector<PlannedPicture> pictures(1);
    pictures[0].path = path;
    pictures[0].input = storm;
    return std::string(CheckNames(options, pictures).message());
  };
  EXPECT_EQ(complaint(folder.File("product.nc")), "");
  for (const std::string& path : {storm, link + "/storm.nc"}) {
    EXPECT_EQ(complaint(path),
              "--product would replace the storm file '" + path + "'; give another name");
  }
  const std::string manifest = folder.File("./manifest.nc");
  EXPECT_EQ(complaint(manifest), "a product and the manifest would both be '" + manifest +
                                     "'; give another name by --manifest");
}

}  // namespace
}  // namespace thunderhead::runs
