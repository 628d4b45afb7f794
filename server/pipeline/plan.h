// Which pictures a run makes: times, shares of several processes, and what is done already.
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

// The times that a text such as "0,3,6-9", "all" or "last" names, in order, each once; of `count`
// times. INVALID_ARGUMENT names --times.
absl::StatusOr<std::vector<int>> ParseTimes(std::string_view text, int count);

// "I/N", I from 0 to N - 1; INVALID_ARGUMENT names --shard.
absl::StatusOr<Shard> ParseShard(std::string_view text);

// The share that a batch system tells this process to take, from its environment: Slurm's array
// task (SLURM_ARRAY_TASK_ID of SLURM_ARRAY_TASK_COUNT, counted from SLURM_ARRAY_TASK_MIN), or
// `JOB_COMPLETION_INDEX` of Kubernetes with JOB_COMPLETIONS; everything without one.
absl::StatusOr<Shard> ShardOfEnvironment();

// The manifest of a share: "manifest.jsonl", for one of several "manifest.2-of-4.jsonl".
std::string ManifestName(const Shard& shard);

// True for the name of the manifest of one of several shares.
bool IsManifestOfShare(std::string_view file);

// True if the entry's product is as it would be made now: of the same scene, by the same version,
// of the same input: by its hash where `input` has it, else by path, size and time, and only if
// those differ by the hash that `input_sha256` finds.
bool MadeAlike(const ManifestEntry& entry, std::string_view scene_sha256, std::string_view version,
               const InputFile& input, const std::function<std::string()>& input_sha256);

}  // namespace thunderhead::pipeline
