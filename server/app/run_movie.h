// The movie of a run's pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "app/picture_run.h"
#include "pipeline/product_name.h"

namespace thunderhead::app {

// Where a run's movies go.
struct MovieOptions {
  std::optional<pipeline::ProductName> name;  // nothing: no movie
};

// INVALID_ARGUMENT if --movie is not a name of a movie, or products of that format are no pictures
// for one.
absl::StatusOr<MovieOptions> MovieOptionsOf(const PipelineFlags& flags,
                                            const ProductFormat& format);

// Makes each storm's movies of those of its pictures that are made, where they changed since.
absl::Status MakeMovies(const MovieOptions& options, const std::vector<PlannedPicture>& pictures,
                        PictureRun& run, RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
