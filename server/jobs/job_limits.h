// How much render jobs may take. What is beyond is refused with RESOURCE_EXHAUSTED and a time after
// which to try again. Results that were fetched make room for others; while those that nobody has
// fetched take all that they may, no further picture is begun.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thunderhead::jobs {

struct JobLimits {
  // Kept at a time. Jobs that have ended and whose results were fetched make room, the oldest
  // first.
  std::size_t max_jobs = 1000;
  std::size_t max_jobs_per_owner = 200;
  // That are to be drawn.
  std::size_t max_pictures = 20'000;
  std::size_t max_pictures_per_owner = 5'000;
  // Of the kept jobs, in whatever state: a picture's record takes up to a kilobyte of memory.
  std::size_t max_kept_pictures = 200'000;
  std::size_t max_kept_pictures_per_owner = 50'000;
  // Of results, in all and of one owner's that nobody has fetched. Pictures in hand may exceed it.
  std::uint64_t max_result_bytes = std::uint64_t{10} << 30;
  std::uint64_t max_result_bytes_per_owner = std::uint64_t{5} << 30;
  // How long a job that has ended is kept, with its results; and one that is paused, as nobody
  // fetches them.
  std::chrono::seconds keep = std::chrono::hours(24);
  // Begun at a time. Two are read, drawn or encoded by the render loop, one may wait for it.
  std::size_t max_in_hand = 3;
};

}  // namespace thunderhead::jobs
