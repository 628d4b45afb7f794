// Fakes for tests of the render loop, which replace files and OpenGL. The fake store has storms in
// memory. The fake frame source paints values of the scene as colours. Drawing takes a given time,
// on the real clock or on a ManualTime.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "drawing/frame_source.h"
#include "drawing/reference_source.h"
#include "storm_store/storm_store.h"
#include "tests/support/manual_time.h"

namespace thunderhead::testing {

inline constexpr std::chrono::seconds kPatience{600};

// A gate that blocks a fake's thread while it is closed. It starts open.
class Gate {
 public:
  void Close();
  void Open();
  // Lets `count` threads pass the closed gate: the waiting threads first, then the next to arrive.
  void LetPass(int count);
  void LetOnePass() { LetPass(1); }
  // Waits until the gate is open or lets this thread pass. The fakes call this.
  void Pass();
  // Waits until `count` threads wait at the closed gate. Tests call this.
  bool AwaitWaiting(int count);
  // Returns the number of threads that wait at the closed gate.
  int Waiting();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  int waiting_ = 0;
  int may_pass_ = 0;
};

inline constexpr char kThrownByStore[] = "/storms/anvil is not what it seemed";

// A store with two storms. "anvil" has four times with cloud and rain in part of the domain;
// "clear" has one time without condensate.
class FakeStormStore final : public storm_store::StormStore {
 public:
  FakeStormStore();

  std::vector<storm_store::StormInfoPtr> Storms() const override;
  // Adds a storm with the file's name, if the file exists.
  absl::StatusOr<storm_store::StormInfoPtr> Add(const std::string& path) override;
  absl::Status Remove(std::string_view id) override;
  bool IsSearching() const override { return searching; }
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view id, int time_index, const storm_store::ReadProgress& progress) override;
  std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view id,
                                                        int time_index) override;
  std::vector<int> TimesInMemory(std::string_view id) const override;
  std::size_t CachedBytes() const override { return 0; }
  void Listen(storm_store::CatalogueListener listener) override;

  // Applies `change` to a storm, as if its files had changed.
  void Become(const std::string& id, const std::function<void(storm_store::StormInfo&)>& change);

  std::atomic<bool> without_memory{false};  // if true, reads throw std::bad_alloc
  std::atomic<bool> throws{false};          // if true, finding a storm throws kThrownByStore

  // Makes reads of that time fail with `status` from now on.
  void FailAt(int time_index, const absl::Status& status);
  int Reads();
  // Waits until that many reads have ended.
  bool AwaitReads(int count);

  Gate reading;

  std::atomic<bool> searching = false;

 private:
  std::deque<storm_store::StormInfoPtr> storms_;
  std::mutex listening_;
  storm_store::CatalogueListener listener_;
  std::set<std::string> removed_;  // ids of removed storms
  mutable std::mutex mutex_;
  std::map<int, absl::Status> failures_;
  std::condition_variable changed_;
  std::set<std::pair<std::string, int>> cached_;
  int reads_ = 0;
};

// The simulated machine on which fake frame sources draw. The test and the frame source share this
// object, because the render loop's thread owns the frame source.
struct FakeMachine {
  struct Drawn {
    scene::Scene scene;
    accuracy::FrameQuality quality;
    int niceness = 0;  // scheduling priority (nice value) of the thread that drew the frame
  };

  Gate drawing;
  Gate next_piece;  // passed before each piece of a picture that is drawn in several turns
  // If not null, drawing advances this clock instead of sleeping. Set it before anything is drawn.
  ManualTime* time = nullptr;
  std::atomic<double> ms_per_mega_sample{0.0};
  std::atomic<double> fails_above_exposure_ev{1e9};
  std::atomic<int> losses{0};  // number of device losses; each of the next pictures causes one
  std::atomic<double> loses_above_exposure_ev{1e9};
  std::atomic<int> cannot_open{0};  // number of frame sources that will fail to open
  std::atomic<int> opened{0};       // number of frame sources that were opened
  Gate opening;                     // passed when a frame source is opened
  Gate preparing;  // passed when a scene is prepared, once for each pair of number of metaballs and
                   // storm time
  std::atomic<int> cannot_prepare{-1};
  std::atomic<int> pieces{0};   // pieces of pictures drawn in several turns
  std::atomic<int> checked{0};  // frames that were also drawn with half the slices
  std::atomic<std::int64_t> paths_per_step{100'000};
  std::atomic<std::int64_t> traced_paths{0};
  std::atomic<std::int64_t> traced_steps{0};
  std::atomic<int> trace_refusals{0};  // refusals to trace: enough was traced, or tracing must wait
  std::atomic<int> trace_failures{0};
  std::atomic<double> cannot_trace_azimuth_deg{-1.0};
  std::atomic<bool> traces_enough{false};  // what the source reports: enough light has been traced
  std::atomic<double> waits_to_trace_azimuth_deg{-1.0};  // tracing waits at this sun azimuth
  const accuracy::LightClaim light = std::make_shared<int>();
  // The measured error of pictures, reported from the second measuring step on. Each step takes 0.1
  // s of tracing. If it is 0, no error can be measured.
  std::atomic<double> measured_error{0.0};
  // If not 0, pictures with at least this number of slices have half the error.
  std::atomic<int> slices_of_half_error{0};
  std::atomic<int> measured_steps{0};
  Gate tracing;

  std::vector<Drawn> Log();
  void Add(Drawn drawn);
  // Lets pieces pass the closed gate `next_piece` one after another, until a frame is drawn for
  // which `is` returns true. Returns the number of pieces; -1 if no such frame is drawn within
  // kPatience.
  int PiecesUntil(const std::function<bool(const Drawn&)>& is);
  // Returns the scenes whose light was traced, one for each step.
  std::vector<scene::Scene> Traced();
  void AddTraced(const scene::Scene& scene);
  bool IsPrepared(const scene::Scene& scene);
  // Waits until the scene is prepared, for at most kPatience.
  bool AwaitPrepared(const scene::Scene& scene);
  void Prepared(const scene::Scene& scene);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Drawn> log_;
  std::vector<scene::Scene> traced_;
  std::set<std::pair<int, int>> prepared_;  // pairs of number of metaballs and time index
};

// Drawing time of one piece of a picture that is drawn in several turns.
inline constexpr double kFakePiece_ms = 10.0;

drawing::FrameSourceFactory FakeFrameSources(std::shared_ptr<FakeMachine> machine);

// The behaviour of fake references (path tracers that refine a picture), shared with the test. Each
// sample per pixel takes `ms_per_sample`, and the relative error is one over the square root of the
// number of samples. The pictures have uniform radiance.
struct FakeReference {
  struct Begun {
    scene::Scene scene;
    glm::ivec2 size_px{0};
    int samples_before = 0;  // samples of all earlier pictures
  };

  Gate sampling;
  std::atomic<double> ms_per_sample{0.5};
  std::atomic<double> fails_above_exposure_ev{1e9};
  std::atomic<int> samples{0};  // samples of all pictures
  std::atomic<int> sources{0};  // number of fake references that exist now

  std::vector<Begun> Log();
  void Add(Begun begun);

 private:
  std::mutex mutex_;
  std::vector<Begun> log_;
};

drawing::ReferenceSourceFactory FakeReferenceSources(std::shared_ptr<FakeReference> reference);

// The colours in which the fake source paints a scene: red encodes the time, green the sun's
// azimuth.
std::uint8_t RedOf(int time_index);
std::uint8_t GreenOf(double sun_azimuth_deg);

}  // namespace thunderhead::testing
