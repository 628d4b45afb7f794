#include "runs/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/utf8.h"

namespace thunderhead::runs {
namespace {

constexpr int kWidth = 32;
constexpr std::chrono::milliseconds kFirstDrawing{1000};
constexpr std::chrono::milliseconds kRedrawing{100};

std::string Bar(double share, int tick) {
  std::string bar(kWidth, '.');
  if (share < 0.0) {
    // If the share is unknown, a mark moves back and forth.
    const int turn = tick % (2 * (kWidth - 1));
    bar[static_cast<std::size_t>(std::min(turn, 2 * (kWidth - 1) - turn))] = '#';
  } else {
    const auto full = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * kWidth);
    std::fill_n(bar.begin(), full, '#');
  }
  return bar;
}

}  // namespace

ProgressBar::ProgressBar(const std::string& label) : label_(base::Printable(label)) {
  if (isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { Draw(); });
}

ProgressBar::~ProgressBar() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ended_changed_.notify_all();
  thread_.join();
}

void ProgressBar::Draw() {
  std::unique_lock lock(mutex_);
  const auto ended = [this] { return ended_; };
  if (ended_changed_.wait_for(lock, kFirstDrawing, ended)) return;
  for (int tick = 0; !ended_; ++tick) {
    const double share = share_;
    std::fprintf(stderr, "\r%s [%s] ", label_.c_str(), Bar(share, tick).c_str());
    if (share >= 0.0) std::fprintf(stderr, "%3.0f %%", 100.0 * share);
    if (!note_.empty()) std::fprintf(stderr, "  %s\x1b[K", note_.c_str());
    std::fflush(stderr);
    ended_changed_.wait_for(lock, kRedrawing, ended);
  }
  std::fprintf(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace thunderhead::runs
