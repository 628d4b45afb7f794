// Selects the pictures that a run makes: times, shares of several processes, and finished products.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"

namespace thunderhead::pipeline {

// A share of the pictures: number `index` of `count`, from 0.
struct Shard {
  int index = 0;
  int count = 1;
};

// Parses times such as "0,3,6-9", "all" or "last", out of `count` times. Returns them in order and
// without duplicates. INVALID_ARGUMENT names --times.
absl::StatusOr<std::vector<int>> ParseTimes(std::string_view text, int count);

// Parses "I/N", with I from 0 to N - 1. INVALID_ARGUMENT names --shard.
absl::StatusOr<Shard> ParseShard(std::string_view text);

// Returns the share that a batch system assigns to this process, from environment variables. For
// Slurm it is the array task (SLURM_ARRAY_TASK_ID of SLURM_ARRAY_TASK_COUNT, counted from
// SLURM_ARRAY_TASK_MIN). For Kubernetes it is `JOB_COMPLETION_INDEX` with JOB_COMPLETIONS. Without
// a batch system it is everything.
absl::StatusOr<Shard> ShardOfEnvironment();

// Returns the name of a share's manifest: "manifest.jsonl", or for one of several
// "manifest.2-of-4.jsonl".
std::string ManifestName(const Shard& shard);

// Returns true for the name of the manifest of one of several shares.
bool IsManifestOfShare(std::string_view file);

// Returns true if the entry's product is what would be made now: the same scene, version and input.
// Inputs are compared by hash if `input` has one, else by path, size and time. If path or time
// differ but the size does not, the hash from `input_sha256` decides.
bool MadeAlike(const ManifestEntry& entry, std::string_view scene_sha256, std::string_view version,
               const InputFile& input, const std::function<std::string()>& input_sha256);

}  // namespace thunderhead::pipeline
