#include "tests/service/fake_engine.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <thread>

#include "accuracy/cost_model.h"
#include "base/status.h"
#include "gl/device_faults.h"
#include "tests/support/techniques.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

storm_store::StormInfoPtr Storm(const std::string& id, int time_count) {
  storm_store::StormInfo storm;
  storm.id = id;
  storm.title = "A storm called " + id;
  for (int i = 0; i < time_count; ++i) {
    storm.times.push_back({"0001-01-01T00:" + std::to_string(10 + 10 * i) + ":00Z", 600.0 * i});
  }
  storm.file_cells = {20, 10, 5};
  storm.fields = {physics::Hydrometeor::kCloud, physics::Hydrometeor::kRain};
  return std::make_shared<const storm_store::StormInfo>(std::move(storm));
}

std::shared_ptr<const volume::HydrometeorFields> Fields(bool empty) {
  auto fields = std::make_shared<volume::HydrometeorFields>();
  fields->grid = {{20, 10, 5}, {1000.0, 1000.0, 500.0}, {-10000.0, -5000.0, 0.0}};
  volume::HydrometeorField cloud;
  cloud.hydrometeor = physics::Hydrometeor::kCloud;
  cloud.variable = "QCLOUD";
  volume::HydrometeorField rain;
  rain.hydrometeor = physics::Hydrometeor::kRain;
  rain.variable = "QRAIN";
  rain.sizes.origin = volume::SizeOrigin::kNumber;
  rain.sizes.name = "QNRAIN";
  if (!empty) {
    cloud.concentration_kg_per_m3.assign(fields->grid.CellCount(), 0.0F);
    cloud.concentration_kg_per_m3[fields->grid.Offset(4, 4, 2)] = 1e-3F;
    cloud.statistics = {-1e-13F, 2e-3F, 0.25, 7.5, 3, 1};
    fields->condensate = {{4, 4, 2}, {5, 5, 3}};
    fields->motion.source = volume::TurbulenceSource::kEnergy;
    fields->motion.variable = "QKE";
    fields->motion.steering_m_per_s = {12.5, -4.0};
  }
  fields->fields = {cloud, rain};
  return fields;
}

// Returns the number of slices, or the default for techniques without slices.
int SlicesOf(const scene::Scene& scene) {
  return scene::SlicesOf(scene.rendering.technique).value_or(scene::LightVolume().slices);
}

bool Traces(const scene::Scene& scene) {
  return scene::TracedLightOf(scene.rendering.technique) != scene::TracedLight::kOff;
}

// Returns the scene's number of metaballs and its time index.
std::pair<int, int> KeyOf(const scene::Scene& scene) {
  return {std::get<scene::Metaballs>(scene.rendering.technique).count, scene.time_index};
}

// Decrements the counter; returns true if it was above 0.
bool TakeOne(std::atomic<int>& left) {
  int count = left;
  while (count > 0 && !left.compare_exchange_weak(count, count - 1)) {
  }
  return count > 0;
}

class FakePreparation final : public renderers::Preparation {
 public:
  explicit FakePreparation(std::shared_ptr<FakeMachine> machine) : machine_(std::move(machine)) {}

  bool IsNeeded(const scene::Scene& scene) const override {
    return test_support::PlainTechniqueOf(scene.rendering.technique) == test_support::kMetaball;
  }

  bool IsDone(const scene::Scene& scene, const Fields& fields) override {
    THUNDERHEAD_CHECK(fields != nullptr, "prepared without fields");
    return !IsNeeded(scene) || machine_->IsPrepared(scene);
  }

  absl::Status Prepare(const scene::Scene& scene, const Fields& fields) override {
    if (IsDone(scene, fields)) return absl::OkStatus();
    machine_->preparing.Pass();
    if (std::get<scene::Metaballs>(scene.rendering.technique).count == machine_->cannot_prepare) {
      return absl::InternalError("it cannot be fitted");
    }
    machine_->Prepared(scene);
    return absl::OkStatus();
  }

 private:
  const std::shared_ptr<FakeMachine> machine_;
};

class FakeFrameSource final : public drawing::FrameSource {
 public:
  FakeFrameSource(std::shared_ptr<FakeMachine> machine, base::DeviceTurn* turn)
      : machine_(std::move(machine)), turn_(turn) {}

  const drawing::DeviceInfo& Device() const override { return info_; }

  std::vector<scene::TechniqueInfo> Techniques() const override {
    return {{std::string(scene::LightVolume::kName), scene::LightVolume::kCapabilities},
            {std::string(scene::HalfAngle::kName), scene::HalfAngle::kCapabilities},
            {std::string(scene::Metaballs::kName), scene::Metaballs::kCapabilities},
            {std::string(scene::Reference::kName), scene::Reference::kCapabilities},
            {"toy", {}}};
  }

  std::shared_ptr<renderers::Preparation> PreparationOfScenes() const override {
    return std::make_shared<FakePreparation>(machine_);
  }

  absl::StatusOr<drawing::DisplayFrame> Draw(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      const accuracy::FrameQuality& quality) override {
    THUNDERHEAD_CHECK(fields != nullptr, "drawn without fields");
    THUNDERHEAD_CHECK(FakePreparation(machine_).IsDone(scene, fields), "drawn unprepared");
    const double ms = machine_->ms_per_mega_sample * accuracy::MegaSamples(scene, quality);
    double left_ms = ms;
    do {
      if (turn_ != nullptr) THUNDERHEAD_RETURN_IF_ERROR(turn_->Take());
      if (left_ms == ms) {
        // The niceness of the calling thread.
        const int niceness = ::getpriority(PRIO_PROCESS, 0);
        machine_->Add({scene, quality, niceness});
        machine_->drawing.Pass();
      }
      if (turn_ != nullptr) machine_->next_piece.Pass();
      const double piece_ms = turn_ != nullptr ? std::min(left_ms, kFakePiece_ms) : left_ms;
      Spend(piece_ms);
      left_ms -= piece_ms;
      if (turn_ != nullptr) {
        ++machine_->pieces;
        turn_->GiveBack();
      }
    } while (left_ms > 0.0);
    if (scene.display.exposure_ev > machine_->loses_above_exposure_ev ||
        TakeOne(machine_->losses)) {
      return gl::DeviceLost();
    }
    if (scene.display.exposure_ev > machine_->fails_above_exposure_ev) {
      return absl::InternalError("the fake machine does not like this exposure");
    }
    return Paint(scene, quality, ms);
  }

  absl::StatusOr<drawing::CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    ++machine_->checked;
    THUNDERHEAD_ASSIGN_OR_RETURN(drawing::DisplayFrame frame, Draw(scene, fields, {}));
    return drawing::CheckedFrame{std::move(frame), 1.0 / SlicesOf(scene)};
  }

  absl::StatusOr<accuracy::LightProgress> TraceLight(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      std::int64_t /*wanted_paths*/, accuracy::LightClaim* claim) override {
    THUNDERHEAD_CHECK(fields != nullptr, "traced without fields");
    if (!Traces(scene)) return accuracy::LightProgress{};
    const double waits = machine_->waits_to_trace_azimuth_deg;
    if (machine_->traces_enough || scene.sun.azimuth_deg == waits) {
      ++machine_->trace_refusals;
      return absl::ResourceExhaustedError("it traces enough already");
    }
    if (scene.sun.azimuth_deg == machine_->cannot_trace_azimuth_deg) {
      ++machine_->trace_failures;
      return absl::InternalError("the fake machine cannot trace that");
    }
    if (claim != nullptr) *claim = machine_->light;
    machine_->tracing.Pass();
    machine_->AddTraced(scene);
    return accuracy::LightProgress{machine_->traced_paths += machine_->paths_per_step,
                                   ++machine_->traced_steps};
  }

  absl::StatusOr<accuracy::ErrorProgress> MeasureError(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    THUNDERHEAD_CHECK(fields != nullptr, "measured without fields");
    const int fine = machine_->slices_of_half_error;
    const double error =
        machine_->measured_error * (fine > 0 && SlicesOf(scene) >= fine ? 0.5 : 1.0);
    if (error <= 0.0) return accuracy::ErrorProgress{.ended = true};
    const int steps = ++machine_->measured_steps;
    accuracy::ErrorProgress progress{.traced_s = 0.1 * steps, .ended = steps >= 10};
    if (steps < 2) return progress;
    const double reach = error / (1.0 + steps);
    progress.error = {.relative_rmse = {error, error - reach, error + reach},
                      .relative_bias = {-0.5 * error, -0.5 * error - reach, -0.5 * error + reach},
                      .paths = 1000 * steps};
    return progress;
  }

  absl::StatusOr<drawing::DisplayFrame> Tone(const picture::LinearPicture& picture,
                                             const scene::Scene& scene) override {
    drawing::DisplayFrame frame;
    frame.width_px = picture.size_px.x;
    frame.height_px = picture.size_px.y;
    const double exposure = std::exp2(scene.display.exposure_ev.value_or(0.0));
    for (const glm::vec3& radiance : picture.radiance) {
      const double level = std::min(255.0 * exposure * radiance.x, 255.0);
      frame.rgb.insert(frame.rgb.end(), 3, static_cast<std::uint8_t>(level));
    }
    frame.stages = {{scene::FrameStage::kTone, 0.1}};
    return frame;
  }

 private:
  void Spend(double ms) const {
    const std::chrono::duration<double, std::milli> duration(ms);
    if (machine_->time != nullptr) {
      machine_->time->Advance(std::chrono::duration_cast<ManualTime::Clock::duration>(duration));
    } else {
      std::this_thread::sleep_for(duration);
    }
  }

  drawing::DisplayFrame Paint(const scene::Scene& scene, const accuracy::FrameQuality& quality,
                              double ms) const {
    drawing::DisplayFrame frame;
    frame.width_px = scene.output.width_px;
    frame.height_px = scene.output.height_px;
    for (int i = 0; i < frame.width_px * frame.height_px; ++i) {
      frame.rgb.push_back(RedOf(scene.time_index));
      frame.rgb.push_back(GreenOf(scene.sun.azimuth_deg));
      frame.rgb.push_back(static_cast<std::uint8_t>(255 * (i % frame.width_px) / frame.width_px));
    }
    frame.stages = {{scene::FrameStage::kSlices, ms}};
    frame.modelled.technique = scene::NameOf(scene.rendering.technique);
    frame.modelled.content.fields = {physics::Hydrometeor::kCloud};
    frame.modelled.slices =
        std::max(1, static_cast<int>(std::lround(SlicesOf(scene) * quality.slice_share)));
    frame.modelled.device_bytes = 4096;
    frame.modelled.content.occupied_share = 0.125;
    if (Traces(scene)) frame.modelled.traced_paths = machine_->traced_paths;
    return frame;
  }

  const std::shared_ptr<FakeMachine> machine_;
  base::DeviceTurn* const turn_;  // if null, the picture is drawn in one piece
  const drawing::DeviceInfo info_{"software", "fake renderer", "4.5 fake"};
};

class FakeReferenceSource final : public drawing::ReferenceSource {
 public:
  explicit FakeReferenceSource(std::shared_ptr<FakeReference> reference)
      : reference_(std::move(reference)) {
    ++reference_->sources;
  }
  ~FakeReferenceSource() override { --reference_->sources; }

  absl::Status Begin(const scene::Scene& scene,
                     const std::shared_ptr<const volume::HydrometeorFields>& fields,
                     const glm::ivec2& size_px) override {
    THUNDERHEAD_CHECK(fields != nullptr, "traced without fields");
    reference_->Add({scene, size_px, reference_->samples});
    size_px_ = size_px;
    samples_ = 0;
    if (scene.display.exposure_ev > reference_->fails_above_exposure_ev) {
      return absl::InternalError("the fake reference does not like this exposure");
    }
    return absl::OkStatus();
  }

  delivery::Refinement Refine(int until_samples, double seconds,
                              const std::stop_token& stop) override {
    double left_ms = 1e3 * seconds;
    while (samples_ < until_samples && left_ms > 0.0) {
      if (stop.stop_requested()) break;
      reference_->sampling.Pass();
      const double ms = reference_->ms_per_sample;
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(ms));
      left_ms -= ms;
      ++samples_;
      ++reference_->samples;
    }
    delivery::Refinement refinement;
    refinement.samples_per_pixel = samples_;
    if (samples_ > 1) refinement.relative_error = 1.0 / std::sqrt(samples_);
    return refinement;
  }

  picture::LinearPicture Snapshot() override {
    const auto pixels = static_cast<std::size_t>(size_px_.x) * static_cast<std::size_t>(size_px_.y);
    return {size_px_, std::vector<glm::vec3>(pixels, glm::vec3(0.25F))};
  }

 private:
  const std::shared_ptr<FakeReference> reference_;
  glm::ivec2 size_px_{0};
  int samples_ = 0;
};

}  // namespace

std::vector<FakeReference::Begun> FakeReference::Log() {
  const std::lock_guard lock(mutex_);
  return log_;
}

void FakeReference::Add(Begun begun) {
  const std::lock_guard lock(mutex_);
  log_.push_back(std::move(begun));
}

drawing::ReferenceSourceFactory FakeReferenceSources(std::shared_ptr<FakeReference> reference) {
  return [reference = std::move(reference)] {
    return std::make_unique<FakeReferenceSource>(reference);
  };
}

void Gate::Close() {
  const std::lock_guard lock(mutex_);
  open_ = false;
  may_pass_ = 0;
}

void Gate::Open() {
  {
    const std::lock_guard lock(mutex_);
    open_ = true;
  }
  changed_.notify_all();
}

void Gate::LetPass(int count) {
  {
    const std::lock_guard lock(mutex_);
    may_pass_ += count;
  }
  changed_.notify_all();
}

void Gate::Pass() {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return open_ || may_pass_ > 0; });
  --waiting_;
  if (!open_) --may_pass_;
}

bool Gate::AwaitWaiting(int count) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kPatience, [&] { return waiting_ - may_pass_ >= count; });
}

int Gate::Waiting() {
  const std::lock_guard lock(mutex_);
  return open_ ? 0 : std::max(waiting_ - may_pass_, 0);
}

FakeStormStore::FakeStormStore() : storms_{Storm("anvil", 4), Storm("clear", 1)} {}

void FakeStormStore::Listen(storm_store::CatalogueListener listener) {
  const std::lock_guard lock(listening_);
  listener_ = std::move(listener);
}

void FakeStormStore::Become(const std::string& id,
                            const std::function<void(storm_store::StormInfo&)>& change) {
  const std::lock_guard listening(listening_);
  storm_store::StormChange changed;
  {
    const std::lock_guard lock(mutex_);
    for (storm_store::StormInfoPtr& storm : storms_) {
      if (storm->id != id) continue;
      changed.before = storm;
      storm_store::StormInfo renewed = *storm;
      change(renewed);
      storm = std::make_shared<const storm_store::StormInfo>(std::move(renewed));
      changed.after = storm;
    }
  }
  if (listener_) listener_({changed});
}

std::vector<storm_store::StormInfoPtr> FakeStormStore::Storms() const {
  if (throws) throw std::runtime_error(kThrownByStore);
  const std::lock_guard lock(mutex_);
  std::vector<storm_store::StormInfoPtr> storms;
  for (const storm_store::StormInfoPtr& storm : storms_) {
    if (!removed_.contains(storm->id)) storms.push_back(storm);
  }
  return storms;
}

absl::StatusOr<storm_store::StormInfoPtr> FakeStormStore::Add(const std::string& path) {
  if (!std::filesystem::exists(path)) return absl::NotFoundError(path + " is not there");
  const std::lock_guard lock(mutex_);
  return storms_.emplace_back(Storm(std::filesystem::path(path).stem(), 1));
}

absl::Status FakeStormStore::Remove(std::string_view id) {
  const std::lock_guard lock(mutex_);
  const auto at = std::ranges::find_if(storms_, [&](const auto& storm) { return storm->id == id; });
  const bool there = at != storms_.end() && removed_.insert((*at)->id).second;
  return there ? absl::OkStatus() : absl::NotFoundError("there is no such storm");
}

absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> FakeStormStore::Get(
    std::string_view id, int time_index, const storm_store::ReadProgress& /*progress*/) {
  if (Find(id) == nullptr) return absl::NotFoundError("there is no such storm");
  if (auto cached = Peek(id, time_index); cached != nullptr) return cached;
  reading.Pass();
  if (without_memory) throw std::bad_alloc();
  const std::lock_guard lock(mutex_);
  ++reads_;
  changed_.notify_all();
  if (const auto failure = failures_.find(time_index); failure != failures_.end()) {
    return failure->second;
  }
  cached_.emplace(id, time_index);
  return Fields(id == "clear");
}

std::shared_ptr<const volume::HydrometeorFields> FakeStormStore::Peek(std::string_view id,
                                                                      int time_index) {
  const std::lock_guard lock(mutex_);
  return cached_.count({std::string(id), time_index}) > 0 ? Fields(id == "clear") : nullptr;
}

std::vector<int> FakeStormStore::TimesInMemory(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  std::vector<int> times;
  for (const auto& [storm, time] : cached_) {
    if (storm == id) times.push_back(time);
  }
  return times;
}

void FakeStormStore::FailAt(int time_index, const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  failures_[time_index] = status;
}

int FakeStormStore::Reads() {
  const std::lock_guard lock(mutex_);
  return reads_;
}

bool FakeStormStore::AwaitReads(int count) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kPatience, [&] { return reads_ >= count; });
}

std::vector<FakeMachine::Drawn> FakeMachine::Log() {
  const std::lock_guard lock(mutex_);
  return log_;
}

int FakeMachine::PiecesUntil(const std::function<bool(const Drawn&)>& is) {
  int passed = 0;
  const bool drawn = WaitFor([&] {
    // The order of these two checks matters: a frame that was drawn before a piece began to wait is
    // then already in the log.
    const bool waits = next_piece.Waiting() > 0;
    if (std::ranges::any_of(Log(), is)) return true;
    if (!waits) return false;
    next_piece.LetOnePass();
    ++passed;
    return false;
  });
  return drawn ? passed : -1;
}

std::vector<scene::Scene> FakeMachine::Traced() {
  const std::lock_guard lock(mutex_);
  return traced_;
}

void FakeMachine::AddTraced(const scene::Scene& scene) {
  const std::lock_guard lock(mutex_);
  traced_.push_back(scene);
}

bool FakeMachine::IsPrepared(const scene::Scene& scene) {
  const std::lock_guard lock(mutex_);
  return prepared_.contains(KeyOf(scene));
}

bool FakeMachine::AwaitPrepared(const scene::Scene& scene) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kPatience, [&] { return prepared_.contains(KeyOf(scene)); });
}

void FakeMachine::Prepared(const scene::Scene& scene) {
  {
    const std::lock_guard lock(mutex_);
    prepared_.insert(KeyOf(scene));
  }
  changed_.notify_all();
}

void FakeMachine::Add(Drawn drawn) {
  const std::lock_guard lock(mutex_);
  log_.push_back(std::move(drawn));
}

drawing::FrameSourceFactory FakeFrameSources(std::shared_ptr<FakeMachine> machine) {
  return [machine = std::move(machine)](
             base::DeviceTurn* turn) -> absl::StatusOr<std::unique_ptr<drawing::FrameSource>> {
    machine->opening.Pass();
    if (TakeOne(machine->cannot_open)) return absl::UnavailableError("there is no device");
    ++machine->opened;
    return std::make_unique<FakeFrameSource>(machine, turn);
  };
}

std::uint8_t RedOf(int time_index) { return static_cast<std::uint8_t>(40 + 50 * time_index); }

std::uint8_t GreenOf(double sun_azimuth_deg) {
  return static_cast<std::uint8_t>(std::lround(sun_azimuth_deg / 360.0 * 200.0));
}

}  // namespace thunderhead::testing
