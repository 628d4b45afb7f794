// Draws the pictures of render jobs in the same way as RenderImage, but with lower priority.
#pragma once

#include "jobs/picture_source.h"
#include "service/engine/engine.h"
#include "service/jobs/job_files.h"

namespace thunderhead::service {

// Returns the function that begins a picture of a job. The function takes an order made by OrderOf.
// It describes the drawn picture by a serialized FetchRenderResultResponse. `engine` must outlive
// the function and its pictures.
jobs::BeginPicture JobPictures(Engine& engine, const JobFiles& files);

}  // namespace thunderhead::service
