// Makes movies from a run's pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pipeline/product_name.h"
#include "runs/picture_run.h"

namespace thunderhead::runs {

// The names of a run's movies.
struct MovieOptions {
  std::optional<pipeline::ProductName> name;  // absent if no movie is made
};

// Makes each storm's movies from its finished pictures, unless an existing movie shows the same
// pictures. If the movies' name has no {view}, only the first view gets a movie.
absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::runs
