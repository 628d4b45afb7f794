// The loop that draws: one thread makes the frame source, owns it, and draws with it in turn the
// newest scene of every session that has a viewer ready for a frame, and the pictures that were
// asked for one by one. Reads, encoding and the reference run on other threads beside it. Knows no
// GL (that is the frame source's) and no messages.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "accuracy/cost_model.h"
#include "accuracy/offers.h"
#include "base/stopwatch.h"
#include "base/wake_signal.h"
#include "session/fields_reader.h"
#include "session/frame_encoder.h"
#include "session/frame_planner.h"
#include "session/frame_source.h"
#include "session/sessions.h"
#include "session/truth_source.h"
#include "session/truth_tracer.h"

namespace thunderhead::session {

struct RenderLoopOptions {
  PlannerTargets targets;
  std::size_t max_waiting_images = 16;
  int encoder_threads = 1;
  // Of sessions that show the reference; each takes some hundred bytes a pixel and the medium.
  std::size_t max_traced_sessions = 8;
  std::function<accuracy::OfferTables()> offer_tables = accuracy::BuiltInOfferTables;
  TruthSourceFactory make_truth_source = [] { return MakeReferenceTruthSource(); };
};

// How far the light of a picture has been traced.
struct ImageProgress {
  double share = 0.0;  // of the paths that it waits for, 0 to 1
  std::int64_t traced_paths = 0;
  std::optional<double> estimated_error;  // that it would have now
};

// One picture at full quality, outside any session.
struct ImageJob {
  scene::Scene scene;
  std::shared_ptr<const volume::HydrometeorFields> fields;
  std::shared_ptr<const std::atomic<bool>> cancelled;  // true drops the job while it waits
  // Called once, on the loop's thread or the one that asked; must not block.
  std::function<void(absl::StatusOr<DisplayFrame>)> done;
  // If given, called on the loop's thread after each step of tracing light for the picture, and not
  // after `done`; must not block.
  std::function<void(const ImageProgress&)> on_progress = nullptr;
};

// When tracing is tried again for what found too much of it going on.
inline constexpr Clock::duration kTracingLater = std::chrono::milliseconds(500);

class RenderLoop {
 public:
  // Returns once the frame source is made, or could not be. `sessions` calls `wake.Notify()` when
  // there is work; all three references must outlive the loop.
  static absl::StatusOr<std::unique_ptr<RenderLoop>> Start(const RenderLoopOptions& options,
                                                           volume::StormStore& store,
                                                           Sessions& sessions,
                                                           base::WakeSignal& wake,
                                                           const FrameSourceFactory& make_source);
  ~RenderLoop();
  RenderLoop(const RenderLoop&) = delete;
  RenderLoop& operator=(const RenderLoop&) = delete;

  const DeviceInfo& Device() const { return device_; }
  // In the order in which to offer them.
  const std::vector<TechniqueInfo>& Techniques() const { return techniques_; }

  // What drawing `scene` would hold the loop up with; blocks. From any thread.
  absl::Status Prepare(const scene::Scene& scene,
                       const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  void RenderImage(ImageJob job);

  // Nothing is drawn any more after the frame being drawn. Returns at once.
  void RequestStop();
  // Waits for the frame being drawn, refuses the pictures that wait and ends every thread.
  void Stop();

 private:
  // A session's picture by the reference.
  struct Traced {
    NewestScene shown;
    std::shared_ptr<const TruthPicture> picture;  // none yet
  };
  // The scene of a revision with the setting that reaches what it asks for.
  struct Decided {
    std::uint64_t revision = 0;
    std::shared_ptr<const scene::Scene> scene;   // null if that failed
    int decided_again = 0;                       // at rest, by what its frames have cost
    bool checked = false;                        // drawn with half the slices as well
    std::optional<double> discretisation_error;  // found so
    bool settled = false;                        // nothing more is to be learnt of it
  };
  // How far the light of a revision has been traced.
  struct TracedLight {
    std::uint64_t revision = 0;
    std::optional<accuracy::LightProgress> begun_at;  // what was there before
    std::int64_t shown = 0;                           // paths of the newest picture
    base::Stopwatch since_shown;
    bool ended = false;
  };
  // What the loop knows of a session.
  struct Track {
    FramePlanner planner;
    std::optional<FieldsKey> fields_key;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::optional<NewestScene> reading_for;  // the scene whose fields are being read
    std::optional<NewestScene> arrived_for;  // the scene whose fields have just been read
    std::uint64_t unreadable_revision = 0;
    std::optional<FieldsKey> drawn_key;
    double read_ms = 0.0;  // to be reported with the next frame
    double prepare_ms = 0.0;
    std::optional<Decided> decided;
    std::optional<Traced> traced;
    std::uint64_t untraceable_revision = 0;
    TracedLight traced_light;
  };
  // What came of looking at a session or the pictures that wait.
  struct Outcome {
    bool drew = false;
    std::optional<Clock::time_point> look_again_at;
  };

  RenderLoop(const RenderLoopOptions& options, volume::StormStore& store, Sessions& sessions,
             base::WakeSignal& wake);

  void Run(const FrameSourceFactory& make_source, std::promise<absl::Status> started);
  std::optional<Clock::time_point> DrawOne();
  void LetGo(const std::string& session_id, Track& track);
  void DropEndedTracks(const std::vector<std::shared_ptr<Session>>& sessions);
  Outcome TrySession(const std::shared_ptr<Session>& session);
  void TakeRead(Session& session, Track& track);
  bool IsPrepared(const scene::Scene& scene,
                  const std::shared_ptr<const volume::HydrometeorFields>& fields) const;
  void AskFor(const Session& session, const NewestScene& newest);
  // What a series that goes on, a step at a time, will need next, done before it is asked for.
  void PrepareNext(const Session& session, Track& track, const scene::Scene& shown);
  std::optional<NewestScene> DrawableScene(const Session& session, Track& track,
                                           const NewestScene& newest);
  // `shown` with what it asks for decided; null if that failed, which its viewers are told once.
  std::optional<NewestScene> Decide(Session& session, Track& track, const NewestScene& shown);
  // At rest: decides again by what frames have cost, then finds out what few slices do.
  Outcome Check(const std::shared_ptr<Session>& session, Track& track, const NewestScene& asked);
  // At rest: traces a while for a scene with traced light, and draws it when that shows.
  Outcome TraceLight(const std::shared_ptr<Session>& session, Track& track,
                     const NewestScene& shown);
  void DrawChecked(const std::shared_ptr<Session>& session, Track& track, std::uint64_t revision);
  void DrawFor(const std::shared_ptr<Session>& session, Track& track, const NewestScene& shown,
               const FramePlan& plan);
  void Send(Track& track, DrawnFrame frame);
  // Ends the tracing of what the scene no longer shows.
  void EndTrace(const std::string& session_id, Track& track, const scene::Scene& newest);
  Outcome ShowTraced(const std::shared_ptr<Session>& session, Track& track,
                     const NewestScene& shown);
  // True if there is something that its viewers have not seen.
  absl::StatusOr<bool> Trace(const std::string& session_id, Track& track, const NewestScene& shown);
  void Fail(Session& session, Track& track, std::uint64_t revision, const absl::Status& why);
  absl::StatusOr<DisplayFrame> DrawImage(const ImageJob& job);
  absl::StatusOr<bool> TraceForImage(const ImageJob& job);
  Outcome TryImage();
  std::optional<ImageJob> NextImage();
  absl::StatusOr<DisplayFrame> Draw(const scene::Scene& scene,
                                    const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                    const FrameQuality& quality, double& total_ms);
  void RefuseImages();

  const RenderLoopOptions options_;
  volume::StormStore& store_;
  Sessions& sessions_;
  base::WakeSignal& wake_;
  DeviceInfo device_;
  std::vector<TechniqueInfo> techniques_;
  std::atomic<bool> stopping_{false};

  std::mutex images_mutex_;
  std::deque<ImageJob> images_;
  bool refuses_images_ = false;

  // Used by the loop's thread only.
  std::shared_ptr<Preparation> preparation_;  // set before Start returns
  std::unique_ptr<FrameSource> source_;
  std::map<std::string, Track> tracks_;  // by session id
  std::string last_served_;  // the session looked at last; the pictures' turn is the empty string
  std::optional<LastDrawn> last_drawn_;
  bool warm_ = false;
  accuracy::CostModels machine_costs_;
  accuracy::Offers offers_;
  // The settings whose shaders are compiled, by technique, mode, transport and correction: the time
  // of a first frame is not representative, as it includes compilation.
  std::set<std::tuple<std::string, std::string_view, std::string_view, bool>> compiled_;

  std::unique_ptr<FieldsReader> reader_;
  std::unique_ptr<FrameEncoder> encoder_;
  std::unique_ptr<TruthTracer> tracer_;
  std::thread thread_;
};

}  // namespace thunderhead::session
