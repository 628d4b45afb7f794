// Limits of render jobs. Requests beyond them are refused with RESOURCE_EXHAUSTED and a time to
// retry after. Fetched results are evicted for new ones. While unfetched results use up the quota,
// no further picture is begun.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thunderhead::jobs {

struct JobLimits {
  // Kept jobs. Ended jobs with fetched results are forgotten first, the oldest before others.
  std::size_t max_jobs = 1000;
  std::size_t max_jobs_per_owner = 200;
  // Pictures that are still to be drawn.
  std::size_t max_pictures = 20'000;
  std::size_t max_pictures_per_owner = 5'000;
  // Pictures of kept jobs, in any state. The record of a picture takes up to a kilobyte of memory.
  std::size_t max_kept_pictures = 200'000;
  std::size_t max_kept_pictures_per_owner = 50'000;
  // Bytes of all results, and of one owner's unfetched results. Pictures that are being drawn may
  // exceed the limit.
  std::uint64_t max_result_bytes = std::uint64_t{10} << 30;
  std::uint64_t max_result_bytes_per_owner = std::uint64_t{5} << 30;
  // How long an ended job is kept with its results, and how long a job that is paused by unfetched
  // results.
  std::chrono::seconds keep = std::chrono::hours(24);
  // Pictures begun at a time. The render loop reads, draws or encodes two; one may wait for it.
  std::size_t max_in_hand = 3;
};

}  // namespace thunderhead::jobs
