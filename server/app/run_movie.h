// Makes movies from a run's pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "app/picture_run.h"
#include "pipeline/product_name.h"

namespace thunderhead::app {

// The names of a run's movies.
struct MovieOptions {
  std::optional<pipeline::ProductName> name;  // absent if no movie is made
};

// Returns the movie options. INVALID_ARGUMENT if --movie is not a valid name of a movie, or if
// movies cannot be made from products of `format`.
absl::StatusOr<MovieOptions> MovieOptionsOf(const PipelineFlags& flags,
                                            const ProductFormat& format);

// Makes each storm's movies from its finished pictures, unless an existing movie shows the same
// pictures.
absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
