#include "delivery/link_estimate.h"

#include <algorithm>

namespace thunderhead::delivery {
namespace {

// Number of samples needed before a step is left, and before a step on trial is judged.
constexpr int kFewestSamples = 4;
// After a step to smaller pictures, the step is kept only if a picture arrives in at most kWorthIt
// times the time that a larger picture took before. After a step to larger pictures, a picture may
// take up to kBearable times as long as a smaller picture did.
constexpr double kWorthIt = 0.8;
constexpr double kBearable = 1.25;

double Milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

void LinkEstimate::SetLeast(int step, Time now) {
  least_ = std::min(step, steps_ - 1);
  if (step_ >= least_) return;
  trial_.reset();
  ChangeTo(least_, now);
}

void LinkEstimate::Acknowledged(Time now, Time sent_at) {
  // If this frame was already in flight when the previous frame arrived, the sample is the time
  // between the two arrivals. Otherwise it is the time since this frame was sent.
  const bool waited = last_acknowledged_.has_value() && sent_at < *last_acknowledged_;
  const double sample_ms = Milliseconds(waited ? now - *last_acknowledged_ : now - sent_at);
  last_acknowledged_ = now;
  if (sent_at < changed_at_) return;  // the frame was sent with another step
  constexpr double kWeight = 0.3;
  frame_ms_ = samples_ == 0 ? sample_ms : (1.0 - kWeight) * frame_ms_ + kWeight * sample_ms;
  if (++samples_ >= kFewestSamples) Judge(now);
}

void LinkEstimate::Judge(Time now) {
  const double longest_ms = Milliseconds(kLongest);
  if (trial_.has_value()) {
    const Trial trial = *trial_;
    trial_.reset();
    const bool grew = step_ < trial.step_before;
    if (grew && frame_ms_ > longest_ms && frame_ms_ > kBearable * trial.frame_ms_before) {
      wait_to_grow_ = std::min<std::chrono::seconds>(2 * wait_to_grow_, kLongestWait);
      ChangeTo(trial.step_before, now);
    } else if (!grew && frame_ms_ > kWorthIt * trial.frame_ms_before) {
      shrink_again_at_ = now + kLongestWait;
      ChangeTo(trial.step_before, now);
    } else if (grew) {
      wait_to_grow_ = kShortestWait;
    }
    return;
  }
  const bool may_shrink = !shrink_again_at_.has_value() || now >= *shrink_again_at_;
  if (frame_ms_ > longest_ms && step_ < steps_ - 1 && may_shrink) {
    Try(step_ + 1, now);
  } else if (step_ > least_ && now >= changed_at_ + wait_to_grow_) {
    Try(step_ - 1, now);
  }
}

void LinkEstimate::Try(int step, Time now) {
  trial_ = Trial{step_, frame_ms_};
  ChangeTo(step, now);
}

void LinkEstimate::ChangeTo(int step, Time now) {
  step_ = step;
  samples_ = 0;
  changed_at_ = now;
}

int TierForWindow(const PictureWidth& picture, int window_px) {
  int tier = 0;
  while (window_px > 0 && tier < kTiers - 1 && (picture.full_px >> (tier + 1)) >= window_px) ++tier;
  while (tier > 0 && 2 * (picture.px >> tier) < std::min(window_px, picture.full_px >> tier))
    --tier;
  return tier;
}

}  // namespace thunderhead::delivery
