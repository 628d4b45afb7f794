// Draws the pictures of render jobs as RenderImage draws its own, but behind those.
#pragma once

#include "jobs/picture_source.h"
#include "service/engine.h"
#include "service/job_files.h"

namespace thunderhead::service {

// Orders are those of OrderOf; what is told of a picture is a FetchRenderResultResponse. `engine`
// must outlive it and its pictures.
jobs::BeginPicture JobPictures(Engine& engine, const JobFiles& files);

}  // namespace thunderhead::service
