#include "session/render_loop.h"

#include <optional>
#include <string>
#include <utility>

#include "base/status.h"
#include "session/image_drawer.h"
#include "session/measured_source.h"
#include "session/session_drawer.h"
#include "session/turns.h"

namespace thunderhead::session {

absl::StatusOr<std::unique_ptr<RenderLoop>> RenderLoop::Start(
    const RenderLoopOptions& options, volume::StormStore& store, Sessions& sessions,
    base::WakeSignal& wake, const FrameSourceFactory& make_source) {
  std::unique_ptr<RenderLoop> loop(new RenderLoop(options, store, sessions, wake));
  std::promise<absl::Status> started;
  std::future<absl::Status> status = started.get_future();
  loop->thread_ =
      std::thread([raw = loop.get(), make_source, promise = std::move(started)]() mutable {
        raw->Run(make_source, std::move(promise));
      });
  THUNDERHEAD_RETURN_IF_ERROR(status.get());
  return loop;
}

RenderLoop::RenderLoop(const RenderLoopOptions& options, volume::StormStore& store,
                       Sessions& sessions, base::WakeSignal& wake)
    : options_(options),
      store_(store),
      sessions_(sessions),
      wake_(wake),
      images_(options.max_waiting_images),
      reader_(std::make_unique<FieldsReader>(store, [&wake] { wake.Notify(); })),
      encoder_(std::make_unique<FrameEncoder>(options.encoder_threads, options.serialize_frame,
                                              [&wake] { wake.Notify(); })),
      tracer_(std::make_unique<TruthTracer>(options.make_truth_source, options.max_traced_sessions,
                                            [&wake] { wake.Notify(); })) {}

RenderLoop::~RenderLoop() { Stop(); }

double RenderLoop::TurnSeconds() const {
  const Clock::rep began = turn_began_;
  if (began == 0) return 0.0;
  const Clock::duration took = Clock::now().time_since_epoch() - Clock::duration(began);
  return std::chrono::duration<double>(took).count();
}

void RenderLoop::RequestStop() {
  stopping_ = true;
  wake_.Notify();
}

void RenderLoop::Stop() {
  RequestStop();
  if (thread_.joinable()) thread_.join();
  reader_.reset();
  tracer_.reset();
  encoder_.reset();
}

void RenderLoop::RenderImage(ImageJob job) {
  if (images_.Add(std::move(job))) wake_.Notify();
}

void RenderLoop::Run(const FrameSourceFactory& make_source, std::promise<absl::Status> started) {
  auto source = make_source();
  if (source.ok()) {
    device_ = (*source)->Device();
    techniques_ = (*source)->Techniques();
    preparation_ = (*source)->PreparationOfScenes();
  }
  started.set_value(source.status());
  if (source.ok()) DrawWith(*std::move(source));
  images_.RefuseAll();
}

void RenderLoop::DrawWith(std::unique_ptr<FrameSource> source) {
  MeasuredSource measured(std::move(source), options_.offer_tables());
  SessionDrawer drawer(options_.targets, {store_, *reader_, preparation_}, measured, *encoder_,
                       *tracer_);
  ImageDrawer image_drawer(images_, measured, preparation_, [this] { wake_.Notify(); });
  Turns turns;
  while (!stopping_) {
    turn_began_ = Clock::now().time_since_epoch().count();
    const std::vector<std::shared_ptr<Session>> sessions = sessions_.AllDrawn();
    drawer.ReleaseUnwatched(sessions);
    // The empty id stands for the single pictures; it sorts before the sessions'.
    std::vector<Contender> contenders{{""}};
    for (const auto& session : sessions) {
      contenders.push_back({session->id(), session->IsOwnView()});
    }
    const auto look_again_at = turns.Next(contenders, [&](std::size_t i, TurnKind kind) {
      return i == 0 ? image_drawer.TakeTurn() : drawer.TakeTurn(sessions[i - 1], kind);
    });
    turn_began_ = 0;
    if (!look_again_at.has_value() || *look_again_at > Clock::now()) wake_.Wait(look_again_at);
  }
}

}  // namespace thunderhead::session
