// Makes the movies of a run's pictures.
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
  std::optional<pipeline::ProductName> name;  // absent for no movie
};

// Returns the options. Returns INVALID_ARGUMENT if --movie is not a valid name of a movie, or if
// movies cannot be made from products of that format.
absl::StatusOr<MovieOptions> MovieOptionsOf(const PipelineFlags& flags,
                                            const ProductFormat& format);

// Makes each storm's movies from its finished pictures, if the pictures have changed since.
absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
