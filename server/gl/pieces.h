// Cuts drawing into pieces of some 30 ms, so that contexts that share a device can draw in turn,
// and drawing that nobody wants any more ends soon. What is drawn does not depend on where it is
// cut. Each context has its own: state that stays bound between two pieces is its own, too. Use it
// on the context's thread. Knows no physics.
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

// The guessed cost of an item (a pixel, a row, a cell) of one kind of work, until one has been
// measured. Costs are learnt by name.
struct PieceCost {
  std::string_view name;
  double guess_ns = 1.0;
};

class Pieces {
 public:
  // Everything in one piece.
  Pieces() = default;
  // In pieces for which `turn` is taken; it must outlive this.
  explicit Pieces(base::DeviceTurn* turn) : turn_(turn) {}
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

  // Draws by `draw`, which begins and ends without the turn and has it in between.
  template <typename Draw>
  auto During(const Draw& draw) -> decltype(draw()) {
    if (absl::Status taken = Take(); !taken.ok()) return taken;
    const Held held(*this);  // allocations may fail
    return draw();
  }

  // Marks a place between two pieces: lets others draw if this piece has lasted long enough.
  absl::Status Between();

  // Runs `work`, which uses little of the device but much of this thread, without the turn.
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
  // Draws `whole` in tiles; `draw` is called with the scissor test set to one.
  absl::Status Tiles(const PieceCost& cost, const PixelRect& whole,
                     const std::function<void()>& draw);

  // True the first time for a program, which must be compiled off turn before its first piece.
  bool IsNew(unsigned int program);

  // Why work without the turn, which takes long, must end; OK while it may go on. Safe from any
  // thread.
  absl::Status Wanted() const { return turn_ == nullptr ? absl::OkStatus() : turn_->Wanted(); }

  // How long drawing has waited for turns in all.
  double WaitedMs() const { return waited_ms_; }

 private:
  // Measured costs of an item, in units of the guess.
  struct Pace {
    double worst = 0.0;
    double last = 0.0;
    double unmeasured;  // what it may cost where nothing was measured
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
