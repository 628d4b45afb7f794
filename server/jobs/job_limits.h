// Limits for render jobs. A request that exceeds a limit is refused with RESOURCE_EXHAUSTED and a
// retry delay. Fetched results are evicted if new results need their space. While unfetched results
// use up the quota, no further picture is begun.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thunderhead::jobs {

struct JobLimits {
  // Maximum number of kept jobs, in total and for each owner. For a new job, ended jobs whose
  // results were fetched are forgotten, the oldest first.
  std::size_t max_jobs = 1000;
  std::size_t max_jobs_per_owner = 200;
  // Maximum number of pictures that are still to be drawn.
  std::size_t max_pictures = 20'000;
  std::size_t max_pictures_per_owner = 5'000;
  // Maximum number of pictures of kept jobs, in any state. The record of a picture takes up to a
  // kilobyte of memory.
  std::size_t max_kept_pictures = 200'000;
  std::size_t max_kept_pictures_per_owner = 50'000;
  // Maximum bytes of all results, and of one owner's unfetched results. The limit is checked before
  // a picture is begun, so pictures that are being drawn may exceed it.
  std::uint64_t max_result_bytes = std::uint64_t{10} << 30;
  std::uint64_t max_result_bytes_per_owner = std::uint64_t{5} << 30;
  // The time for which an ended job is kept with its results. A job that is paused by its own
  // unfetched results for this time is ended.
  std::chrono::seconds keep = std::chrono::hours(24);
  // Maximum number of pictures that are begun and not finished. The render loop reads, draws or
  // encodes two pictures; the third waits for the render loop.
  std::size_t max_in_hand = 3;
};

}  // namespace thunderhead::jobs
