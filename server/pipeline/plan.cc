#include "pipeline/plan.h"

#include <cstdlib>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status.h"

namespace thunderhead::pipeline {
namespace {

// An upper limit for the number of shares, far above any reasonable number of processes.
constexpr int kMaxShards = 1'000'000;

absl::string_view PlanText(std::string_view text) { return {text.data(), text.size()}; }

absl::StatusOr<Shard> ShardOf(std::string_view what, absl::string_view index,
                              absl::string_view count) {
  Shard shard;
  if (absl::SimpleAtoi(index, &shard.index) && absl::SimpleAtoi(count, &shard.count) &&
      shard.count >= 1 && shard.count <= kMaxShards && shard.index >= 0 &&
      shard.index < shard.count) {
    return shard;
  }
  return absl::InvalidArgumentError(
      absl::StrCat(PlanText(what), " is '", index, "/", count,
                   "'; it must be I/N, such as 0/4, with I from 0 to N - 1"));
}

}  // namespace

absl::StatusOr<std::vector<int>> ParseTimes(std::string_view text, int count) {
  std::set<int> times;
  for (const absl::string_view part : absl::StrSplit(PlanText(text), ',')) {
    const std::pair<absl::string_view, absl::string_view> ends =
        absl::StrSplit(part, absl::MaxSplits('-', 1));
    int first = 0;
    int last = count - 1;
    if (part == "last") {
      first = last;
    } else if (part != "all") {
      const bool range = part.find('-') != absl::string_view::npos;
      if (!absl::SimpleAtoi(ends.first, &first) ||
          !absl::SimpleAtoi(range ? ends.second : ends.first, &last) || first > last || first < 0 ||
          last >= count) {
        return absl::InvalidArgumentError(absl::StrCat(
            "--times is '", PlanText(text), "', of which '", part,
            "' is not all, last, an index or a range such as 2-5 within 0 to ", count - 1));
      }
    }
    for (int time = first; time <= last; ++time) times.insert(time);
  }
  return std::vector<int>(times.begin(), times.end());
}

absl::StatusOr<Shard> ParseShard(std::string_view text) {
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(PlanText(text), absl::MaxSplits('/', 1));
  return ShardOf("--shard", parts.first, parts.second);
}

absl::StatusOr<Shard> ShardOfEnvironment() {
  const auto variable = [](const char* name) { return std::getenv(name); };
  if (const char* task = variable("SLURM_ARRAY_TASK_ID"); task != nullptr) {
    const char* count = variable("SLURM_ARRAY_TASK_COUNT");
    const char* first = variable("SLURM_ARRAY_TASK_MIN");
    int index = 0;
    int minimum = 0;
    if (count == nullptr || !absl::SimpleAtoi(task, &index) ||
        (first != nullptr && !absl::SimpleAtoi(first, &minimum))) {
      return absl::InvalidArgumentError(
          "SLURM_ARRAY_TASK_ID is set without a usable SLURM_ARRAY_TASK_COUNT; give --shard");
    }
    return ShardOf("the share of SLURM_ARRAY_TASK_ID", absl::StrCat(index - minimum), count);
  }
  if (const char* index = variable("JOB_COMPLETION_INDEX"); index != nullptr) {
    // Kubernetes tells a pod only its own index. The number of pods must be passed by the Job's
    // manifest.
    const char* count = variable("JOB_COMPLETIONS");
    if (count == nullptr) {
      return absl::InvalidArgumentError(
          "JOB_COMPLETION_INDEX is set without JOB_COMPLETIONS, the job's number of completions; "
          "set it in the job, or give --shard");
    }
    return ShardOf("the share of JOB_COMPLETION_INDEX", index, count);
  }
  return Shard{};
}

std::string ManifestName(const Shard& shard) {
  if (shard.count == 1) return "manifest.jsonl";
  return absl::StrCat("manifest.", shard.index, "-of-", shard.count, ".jsonl");
}

bool IsManifestOfShare(std::string_view file) {
  constexpr std::string_view kBegin = "manifest.";
  constexpr std::string_view kEnd = ".jsonl";
  std::string_view name = file;
  if (name.size() <= kBegin.size() + kEnd.size() || !name.starts_with(kBegin) ||
      !name.ends_with(kEnd)) {
    return false;
  }
  name.remove_prefix(kBegin.size());
  name.remove_suffix(kEnd.size());
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(PlanText(name), absl::MaxSplits("-of-", 1));
  const auto shard = ShardOf("", parts.first, parts.second);
  return shard.ok() && ManifestName(*shard) == file;
}

bool MadeAlike(const ManifestEntry& entry, std::string_view scene_sha256, std::string_view version,
               const InputFile& input, const std::function<std::string()>& input_sha256) {
  if (entry.scene_sha256 != scene_sha256 || entry.version != version) return false;
  const InputFile& then = entry.input;
  if (!input.sha256.empty()) return then.sha256 == input.sha256;
  if (then.path == input.path && then.bytes == input.bytes &&
      then.modified_ns == input.modified_ns) {
    return true;
  }
  return then.bytes == input.bytes && then.sha256 == input_sha256();
}

}  // namespace thunderhead::pipeline
