// Cuts drawing into pieces of about 15 ms. Contexts that share a device can then draw in turn, and
// cancelled drawing ends soon. The result does not depend on where the work is cut. Each context
// has its own Pieces and its own GL state, which stays bound between two pieces. Use a Pieces
// object on its context's thread. This code does not use physics.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "base/device_turn.h"
#include "base/stopwatch.h"
#include "gl/pixel_rect.h"

namespace thunderhead::gl {

// The assumed cost of an item (a pixel, a row, a cell) of one kind of work. It is used until the
// cost of an item has been measured. Measurements are stored by name.
struct PieceCost {
  std::string_view name;
  double guess_ns = 1.0;
};

class Pieces {
 public:
  // Draws everything in one piece.
  Pieces() = default;
  // Takes `turn`, the right to draw on the shared device, for each piece. `turn` must outlive this
  // object.
  explicit Pieces(base::DeviceTurn* turn) : turn_(turn) {}
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

  // Draws with `draw`. The turn is taken before the call and given back after it. Returns the error
  // of taking the turn, or the result of `draw`.
  template <typename Draw>
  auto During(const Draw& draw) -> decltype(draw()) {
    if (absl::Status taken = Take(); !taken.ok()) return taken;
    const Held held(*this);  // gives the turn back even if an allocation throws
    return draw();
  }

  // Marks a place where drawing may be interrupted. If the current piece has lasted long enough,
  // gives the turn back so that other contexts can draw, and takes it again. Returns the error of
  // DeviceTurn::Take, with which the drawing must end. Steps and Tiles return the same error.
  absl::Status Between();

  // Gives the turn back while `work` runs. `work` uses little of the device but much time of this
  // thread. Returns the error of taking the turn again.
  template <typename Work>
  absl::Status OffTurn(const Work& work) {
    if (turn_ == nullptr) {
      work();
      return absl::OkStatus();
    }
    const bool held = holds_;
    GiveBack();
    work();
    return held ? Take() : absl::OkStatus();
  }

  // Runs the items 0 to `count` - 1, as many in each piece as the time allows.
  absl::Status Steps(const PieceCost& cost, int count,
                     const std::function<void(int begin, int end)>& run);
  // Draws `whole` in tiles. `draw` is called with the scissor test set to one tile.
  absl::Status Tiles(const PieceCost& cost, const PixelRect& whole,
                     const std::function<void()>& draw);

  // Returns true for the first call with a program while the turn is held. A new program must be
  // compiled without the turn (OffTurn) before its first piece.
  bool IsNew(unsigned int program);

  // Returns an error that says why long work without the turn must end, or OK if it may continue.
  // It is safe to call from any thread.
  absl::Status Wanted() const { return turn_ == nullptr ? absl::OkStatus() : turn_->Wanted(); }

  // Returns the total time in milliseconds for which drawing has waited for the turn.
  double WaitedMs() const { return waited_ms_; }

 private:
  // Measured costs of an item, as multiples of PieceCost::guess_ns.
  struct Pace {
    double worst = 0.0;
    double last = 0.0;
    double unmeasured;  // lower limit of the cost while few pieces have been measured
  };

  struct Held {
    explicit Held(Pieces& in) : pieces(in) {}
    ~Held() { pieces.GiveBack(); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

    Pieces& pieces;
  };

  absl::Status Take();
  void GiveBack();
  Pace& PaceOf(const PieceCost& cost);
  double ItemsNow(const PieceCost& cost);
  void Learn(const PieceCost& cost, double items, double took_ms);

  base::DeviceTurn* turn_ = nullptr;
  bool holds_ = false;
  base::Stopwatch since_taken_;
  double waited_ms_ = 0.0;
  std::map<std::string, Pace, std::less<>> paces_;
  std::set<unsigned int> seen_;
};

}  // namespace thunderhead::gl
