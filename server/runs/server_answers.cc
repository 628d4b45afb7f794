#include "runs/server_answers.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "base/utf8.h"

namespace thunderhead::runs {
namespace {

constexpr double kMaxLeadS = 1e9;

absl::Status Unusable(const std::string& what) {
  return absl::InternalError(absl::StrCat("the server's description of the storm ", what,
                                          "; run the server and this program in the same version"));
}

}  // namespace

absl::Status CheckDescription(const v1::StormDescription& storm, const std::string& asked) {
  if (!asked.empty() && storm.id() != asked) {
    return Unusable(
        absl::StrCat("'", asked, "' is of another one, '", base::Printable(storm.id()), "'"));
  }
  if (storm.times().empty()) return Unusable(absl::StrCat("'", asked, "' has no times"));
  for (const v1::StormTime& time : storm.times()) {
    // The comparison is false for NaN.
    if (time.has_lead_s() && !(std::abs(time.lead_s()) <= kMaxLeadS)) {
      return Unusable(absl::StrCat("'", asked, "' has a lead time of ", time.lead_s(), " s"));
    }
  }
  return absl::OkStatus();
}

absl::Status FailureOf(const v1::RenderJobProblem& problem, const std::string& product) {
  const auto code = static_cast<absl::StatusCode>(problem.code());
  if (code <= absl::StatusCode::kOk || code > absl::StatusCode::kUnauthenticated) {
    return absl::UnknownError(absl::StrCat(product, " was not made; the server gives the code ",
                                           problem.code(), " and says '", problem.message(),
                                           "'; look at the server's log"));
  }
  const bool bad_file =
      problem.reason() == "STORM_UNREADABLE" &&
      (code == absl::StatusCode::kInvalidArgument || code == absl::StatusCode::kFailedPrecondition);
  return absl::Status(
      bad_file ? absl::StatusCode::kDataLoss : code,
      problem.message().empty() ? absl::StrCat(product, " was not made") : problem.message());
}

double AsCost(double milliseconds) {
  return std::isfinite(milliseconds) && milliseconds >= 0.0 ? milliseconds : 0.0;
}

}  // namespace thunderhead::runs
