#include "pipeline/readiness.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::pipeline {
namespace {

// The time without a change after which a file is complete: the longest pause between two pieces of
// a slow copy.
constexpr absl::Duration kSettled = absl::Seconds(2);

absl::string_view AbslView(std::string_view text) { return {text.data(), text.size()}; }

absl::Status Wrong(std::string_view text, std::string_view why) {
  return absl::InvalidArgumentError(
      absl::StrCat("--ready is '", AbslView(text), "'; ", AbslView(why),
                   " (open, age:SECONDS[,minsize:BYTES], next[,age:SECONDS] or marker:GLOB)"));
}

// Returns the text in `name` that GLOB's star stands for; empty if the name does not match.
std::string_view StarOf(std::string_view glob, std::string_view name) {
  const std::size_t star = glob.find('*');
  const std::string_view before = glob.substr(0, star);
  const std::string_view after = glob.substr(star + 1);
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) ||
      !name.ends_with(after)) {
    return {};
  }
  return name.substr(before.size(), name.size() - before.size() - after.size());
}

std::optional<std::string> WaitsForAge(const SeenFile& file, absl::Duration age) {
  if (file.unchanged >= age) return std::nullopt;
  return absl::StrCat("it changed less than ", absl::FormatDuration(age), " ago");
}

}  // namespace

absl::StatusOr<ReadinessPolicy> ReadinessPolicy::Parse(std::string_view text) {
  ReadinessPolicy policy;
  const absl::string_view all = AbslView(text);
  if (absl::StartsWith(all, "marker:")) {
    policy.kind_ = Kind::kMarker;
    policy.marker_ = std::string(absl::StripPrefix(all, "marker:"));
    if (std::ranges::count(policy.marker_, '*') == 1 && !absl::StrContains(policy.marker_, '/') &&
        policy.marker_ != "*") {
      return policy;
    }
    return Wrong(text, "a marker is a name with one star, such as marker:wrfoutReady_*");
  }
  for (const absl::string_view part : absl::StrSplit(all, ',')) {
    absl::string_view number = part;
    double value = 0.0;
    const bool first = part.data() == all.data();
    if (first && part == "open") continue;
    if (first && part == "next") {
      policy.kind_ = Kind::kNext;
    } else if (absl::ConsumePrefix(&number, "age:") && policy.kind_ != Kind::kMarker &&
               (first || policy.kind_ == Kind::kNext) && absl::SimpleAtod(number, &value) &&
               value >= 0.0 && value < 1e9) {
      if (first) policy.kind_ = Kind::kAge;
      policy.age_ = absl::Seconds(value);
    } else if (absl::ConsumePrefix(&number, "minsize:") && policy.kind_ == Kind::kAge &&
               absl::SimpleAtoi(number, &policy.min_bytes_)) {
      continue;
    } else {
      return Wrong(text, absl::StrCat("'", part, "' is not a policy"));
    }
  }
  return policy;
}

std::optional<std::string> ReadinessPolicy::WaitsFor(const SeenFile& file,
                                                     const std::vector<SeenFile>& files,
                                                     const std::vector<std::string>& names) const {
  switch (kind_) {
    case Kind::kOpen:
      return WaitsForAge(file, kSettled);
    case Kind::kAge:
      if (file.bytes < min_bytes_) {
        return absl::StrCat("it has ", file.bytes, " of at least ", min_bytes_, " bytes");
      }
      return WaitsForAge(file, *age_);
    case Kind::kNext:
      if (std::ranges::any_of(files,
                              [&](const SeenFile& other) { return other.name > file.name; })) {
        return std::nullopt;
      }
      if (age_.has_value()) return WaitsForAge(file, *age_);
      return "the next file is not there";
    case Kind::kMarker: {
      const std::string_view name = file.name;
      const std::string_view stem = name.substr(0, name.rfind('.'));
      const bool marked = std::ranges::any_of(names, [&](const std::string& marker) {
        const std::string_view end = StarOf(marker_, marker);
        return !end.empty() && marker != file.name && (name.ends_with(end) || stem.ends_with(end));
      });
      if (marked) return std::nullopt;
      return absl::StrCat("no marker file ", marker_, " exists for it");
    }
  }
  return std::nullopt;
}

bool ReadinessPolicy::IsMarker(std::string_view name) const {
  return kind_ == Kind::kMarker && !StarOf(marker_, name).empty();
}

absl::Duration ReadinessPolicy::Patience() const {
  return std::clamp(age_.value_or(kSettled) / 4, absl::Milliseconds(100), absl::Seconds(5));
}

}  // namespace thunderhead::pipeline
