#include "gl/pieces.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "base/status.h"

namespace thunderhead::gl {
namespace {

// Target duration of a piece in milliseconds. If its items cost more than the measured cost, a
// piece may take twice as long.
constexpr double kPiece_ms = 15.0;
// Minimum time in milliseconds that a piece must have left for another pass to start in it.
constexpr double kLeast_ms = 4.0;
// Safety factor on the guessed cost of an item before its cost was measured. Each measured piece
// halves the factor.
constexpr double kCaution = 2.0;
// Safety factor on the measured cost of an item in the last piece.
constexpr double kAbove = 1.25;
// Weight of the highest cost of an item so far. That cost decreases slowly, by half in 35 pieces.
constexpr double kOfWorst = 0.5;
constexpr double kForgetting = 0.98;
// Side of the pixel blocks of which tiles are multiples. GPUs and software renderers draw the
// pixels of a block together.
constexpr int kBlock_px = 8;
// Minimum height of tiles if one row of the picture takes longer than a piece. Such tiles stay
// wide, so that their parts are drawn in parallel.
constexpr int kMinRows = 8;

}  // namespace

absl::Status Pieces::Take() {
  if (turn_ == nullptr) return absl::OkStatus();
  const base::Stopwatch waiting;
  THUNDERHEAD_RETURN_IF_ERROR(turn_->Take());
  waited_ms_ += waiting.ElapsedMs();
  holds_ = true;
  since_taken_.Restart();
  return absl::OkStatus();
}

void Pieces::GiveBack() {
  if (!holds_) return;
  glFinish();
  holds_ = false;
  turn_->GiveBack();
}

absl::Status Pieces::Between() {
  if (!holds_) return absl::OkStatus();
  glFinish();
  if (since_taken_.ElapsedMs() < kPiece_ms - kLeast_ms) return absl::OkStatus();
  GiveBack();
  return Take();
}

Pieces::Pace& Pieces::PaceOf(const PieceCost& cost) {
  return paces_.try_emplace(std::string(cost.name), Pace{.unmeasured = kCaution}).first->second;
}

double Pieces::ItemsNow(const PieceCost& cost) {
  const Pace& pace = PaceOf(cost);
  const double left_ms = std::max(kPiece_ms - since_taken_.ElapsedMs(), kLeast_ms);
  const double factor = std::max({kAbove * pace.last, kOfWorst * pace.worst, pace.unmeasured});
  return left_ms * 1e6 / (cost.guess_ns * factor);
}

void Pieces::Learn(const PieceCost& cost, double items, double took_ms) {
  Pace& pace = PaceOf(cost);
  pace.last = took_ms * 1e6 / (items * cost.guess_ns);
  pace.worst = std::max(pace.last, kForgetting * pace.worst);
  pace.unmeasured *= 0.5;
}

absl::Status Pieces::Steps(const PieceCost& cost, int count,
                           const std::function<void(int begin, int end)>& run) {
  if (!holds_) {
    if (count > 0) run(0, count);
    return absl::OkStatus();
  }
  for (int begin = 0; begin < count;) {
    const int end = begin + static_cast<int>(std::clamp(ItemsNow(cost), 1.0, 1.0 * count - begin));
    const base::Stopwatch stopwatch;
    run(begin, end);
    glFinish();
    Learn(cost, end - begin, stopwatch.ElapsedMs());
    THUNDERHEAD_RETURN_IF_ERROR(Between());
    begin = end;
  }
  return absl::OkStatus();
}

absl::Status Pieces::Tiles(const PieceCost& cost, const PixelRect& whole,
                           const std::function<void()>& draw) {
  if (whole.Empty()) return absl::OkStatus();
  const auto draw_in = [&](const PixelRect& tile) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(tile.low.x, tile.low.y, tile.Size().x, tile.Size().y);
    draw();
    glDisable(GL_SCISSOR_TEST);
  };
  if (!holds_) {
    draw_in(whole);
    return absl::OkStatus();
  }
  const int width = whole.Size().x;
  const auto blocks = [](double pixels) {
    return std::max(static_cast<int>(std::min(pixels / kBlock_px, 1e6)), 1) * kBlock_px;
  };
  for (int y = whole.low.y; y < whole.high.y;) {
    const double pixels = ItemsNow(cost);
    const int rows = std::min(pixels < 1.0 * kMinRows * width ? kMinRows : blocks(pixels / width),
                              whole.high.y - y);
    for (int x = whole.low.x; x < whole.high.x;) {
      const int columns = std::min(blocks(ItemsNow(cost) / rows), whole.high.x - x);
      const base::Stopwatch stopwatch;
      draw_in({{x, y}, {x + columns, y + rows}});
      glFinish();
      Learn(cost, 1.0 * rows * columns, stopwatch.ElapsedMs());
      THUNDERHEAD_RETURN_IF_ERROR(Between());
      x += columns;
    }
    y += rows;
  }
  return absl::OkStatus();
}

bool Pieces::IsNew(unsigned int program) { return holds_ && seen_.insert(program).second; }

}  // namespace thunderhead::gl
