#include "drawing/error_measuring.h"

namespace thunderhead::drawing {
namespace {

// A frame reports the error again when the error's confidence interval is narrower by this factor,
// or no longer contains the reported error. During a measurement, reports are at least
// kMinBetweenErrors apart.
constexpr double kToldNarrowing = 0.8;
constexpr session::Clock::duration kMinBetweenErrors = std::chrono::seconds(1);

double WidthOf(const accuracy::Estimated& error) { return error.high - error.low; }

bool SaysMore(const accuracy::Estimated& error, const accuracy::Estimated& told) {
  return WidthOf(error) <= kToldNarrowing * WidthOf(told) || told.value < error.low ||
         told.value > error.high;
}

}  // namespace

void ErrorMeasuring::BeginFor(std::uint64_t revision) {
  if (revision_ == revision) return;
  *this = ErrorMeasuring();
  revision_ = revision;
}

bool ErrorMeasuring::Measured(const accuracy::ErrorProgress& progress,
                              session::Clock::time_point now) {
  ended_ = progress.ended;
  if (!progress.error.has_value()) return due_;
  const accuracy::Estimated& measured = progress.error->relative_rmse;
  // Until the measured error is certainly above 0, the estimate from the accuracy table is more
  // informative.
  if (!ended_ && !(measured.low > 0.0)) return due_;
  error_ = progress.error;
  due_ = !told_.has_value() || ((ended_ || now - told_at_ >= kMinBetweenErrors) &&
                                SaysMore(measured, told_->relative_rmse));
  return due_;
}

void ErrorMeasuring::Told(session::Clock::time_point now) {
  told_ = error_;
  told_at_ = now;
  due_ = false;
}

void ErrorMeasuring::GiveUp() {
  error_.reset();
  ended_ = true;
  due_ = false;
}

}  // namespace thunderhead::drawing
