// Selects the pictures that a run makes: which times, which share of a batch job, and which
// products are already finished.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pipeline/manifest.h"
#include "pipeline/product_name.h"

namespace thunderhead::pipeline {

// One of `count` shares into which the pictures are divided: the share number `index`, counted from
// 0.
struct Shard {
  int index = 0;
  int count = 1;
};

// Parses a list of time indices such as "0,3,6-9", "all" or "last"; there are `count` times.
// Returns the indices in order and without duplicates. INVALID_ARGUMENT names --times.
absl::StatusOr<std::vector<int>> ParseTimes(std::string_view text, int count);

// Parses "I/N", with I from 0 to N - 1. INVALID_ARGUMENT names --shard.
absl::StatusOr<Shard> ParseShard(std::string_view text);

// Returns the share that a batch system assigns to this process by environment variables. For Slurm
// it is the array task: SLURM_ARRAY_TASK_ID of SLURM_ARRAY_TASK_COUNT, counted from
// SLURM_ARRAY_TASK_MIN. For Kubernetes it is JOB_COMPLETION_INDEX of JOB_COMPLETIONS. Without a
// batch system, the share is all pictures.
absl::StatusOr<Shard> ShardOfEnvironment();

// Returns the file name of a share's manifest: "manifest.jsonl" if there is one share, otherwise
// for example "manifest.2-of-4.jsonl".
std::string ManifestName(const Shard& shard);

// Returns true for the file name of a manifest of one of several shares.
bool IsManifestOfShare(std::string_view file);

// Returns true if the entry's product need not be made again, because it has the same scene,
// program version and input. Inputs are compared by hash if `input` has a hash, else by path, size
// and modification time. If path or time differ but the size is the same, the hash that
// `input_sha256` computes decides.
bool MadeAlike(const ManifestEntry& entry, std::string_view scene_sha256, std::string_view version,
               const InputFile& input, const std::function<std::string()>& input_sha256);

}  // namespace thunderhead::pipeline
