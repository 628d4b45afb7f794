#include "base/allowance.h"

#include <algorithm>

namespace thunderhead::base {
namespace {

// When this many names have a bucket, Allowances drops full buckets before it adds another.
constexpr std::size_t kMaxCounted = 4096;

}  // namespace

double Allowance::LeftAt(Time now) const {
  const std::chrono::duration<double> rest = now - at_;
  return std::min(kBurst_s * per_second_, left_ + per_second_ * rest.count());
}

std::optional<std::chrono::milliseconds> Allowance::Take(Time now) {
  left_ = LeftAt(now);
  at_ = now;
  if (left_ < 1.0) {
    const std::chrono::duration<double> wait((1.0 - left_) / per_second_);
    return std::chrono::ceil<std::chrono::milliseconds>(wait);
  }
  left_ -= 1.0;
  return std::nullopt;
}

std::optional<std::chrono::milliseconds> Allowances::Take(const std::string& who, Time now) {
  if (per_second_ <= 0.0) return std::nullopt;
  auto own = left_.find(who);
  if (own == left_.end()) {
    if (left_.size() >= kMaxCounted) {
      std::erase_if(left_, [&](const auto& entry) { return entry.second.IsFull(now); });
    }
    own = left_.emplace(who, Allowance(per_second_, now)).first;
  }
  return own->second.Take(now);
}

bool Allowances::HasAny(const std::string& who, Time now) const {
  const auto own = left_.find(who);
  return own == left_.end() || own->second.LeftAt(now) >= 1.0;
}

}  // namespace thunderhead::base
