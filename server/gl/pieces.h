// Cuts drawing into pieces of about 30 ms. Contexts that share a device can then draw in turn, and
// cancelled drawing ends soon. The result does not depend on where the work is cut. Each context
// has its own Pieces, and so its own GL state, which stays bound between two pieces. Use it on the
// context's thread. This code does not use physics.
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

// The guessed cost of an item (a pixel, a row, a cell) of one kind of work, used until one has been
// measured. Costs are measured by name.
struct PieceCost {
  std::string_view name;
  double guess_ns = 1.0;
};

class Pieces {
 public:
  // Draws everything in one piece.
  Pieces() = default;
  // Takes `turn` for each piece. It must outlive this object.
  explicit Pieces(base::DeviceTurn* turn) : turn_(turn) {}
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

  // Draws with `draw`. The turn is taken before the call and given back after it.
  template <typename Draw>
  auto During(const Draw& draw) -> decltype(draw()) {
    if (absl::Status taken = Take(); !taken.ok()) return taken;
    const Held held(*this);  // gives the turn back even if an allocation throws
    return draw();
  }

  // Marks a place where drawing may be interrupted. Lets other contexts draw if this piece has
  // lasted long enough.
  absl::Status Between();

  // Runs `work` without the turn. `work` uses little of the device but much time of this thread.
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

  // Runs the items from 0 to before `count`, some in each piece.
  absl::Status Steps(const PieceCost& cost, int count,
                     const std::function<void(int begin, int end)>& run);
  // Draws `whole` in tiles. `draw` is called with the scissor test set to one tile.
  absl::Status Tiles(const PieceCost& cost, const PixelRect& whole,
                     const std::function<void()>& draw);

  // Returns true for the first call with a program, which must be compiled off turn before its
  // first piece.
  bool IsNew(unsigned int program);

  // Returns why long work without the turn must end, or OK while it may continue. It is safe to
  // call from any thread.
  absl::Status Wanted() const { return turn_ == nullptr ? absl::OkStatus() : turn_->Wanted(); }

  // Returns the total time for which drawing has waited for turns.
  double WaitedMs() const { return waited_ms_; }

 private:
  // Measured costs of an item, in units of the guess.
  struct Pace {
    double worst = 0.0;
    double last = 0.0;
    double unmeasured;  // possible cost of an unmeasured item
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
