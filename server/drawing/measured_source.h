// A frame source with the cost model and the error estimator. It reports each frame's cost to the
// cost model once, and adds an estimate of the error to the frame. Used by the render loop's thread
// only.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "accuracy/estimator.h"
#include "accuracy/machine_costs.h"
#include "accuracy/offers.h"
#include "base/time_source.h"
#include "drawing/frame_planner.h"
#include "drawing/frame_source.h"

namespace thunderhead::drawing {

class MeasuredSource {
 public:
  using Fields = std::shared_ptr<const volume::HydrometeorFields>;

  MeasuredSource(std::unique_ptr<FrameSource> source, accuracy::OfferTables tables,
                 const base::TimeSource& time = base::SteadyTime());
  MeasuredSource(const MeasuredSource&) = delete;
  MeasuredSource& operator=(const MeasuredSource&) = delete;

  // Draws a frame of `view`, which is a session's id, or empty for pictures outside any session.
  // `evidence` holds what is known about the frame's error. The number of paths that corrected the
  // light is added to it.
  absl::StatusOr<DisplayFrame> Draw(const std::string& view, const scene::Scene& scene,
                                    const Fields& fields, const FrameQuality& quality,
                                    const accuracy::Evidence& evidence = {});
  absl::StatusOr<CheckedFrame> DrawChecked(const std::string& view, const scene::Scene& scene,
                                           const Fields& fields);
  // The following functions forward to the FrameSource.
  absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                    const scene::Scene& scene);
  absl::StatusOr<frame::FineImage> Fine();
  void FreeUnused(double unused_s) { source_->FreeUnused(unused_s); }

  // Replaces the source after the device was lost. While the source is null, nothing can be drawn.
  void Replace(std::unique_ptr<FrameSource> source);

  // Reports a frame that the source of the named worker drew to the cost model.
  void Learn(std::string_view worker, const std::string& view, const scene::Scene& scene,
             const FrameQuality& quality, const accuracy::Evidence& evidence, DisplayFrame* frame);

  // Forgets the costs of a view that is no longer drawn.
  void Forget(const std::string& view) { costs_.Forget(view); }

  const std::optional<LastDrawn>& Last() const { return last_drawn_; }
  const accuracy::MachineCosts& Costs() const { return costs_; }
  const accuracy::Offers& Offers() const { return offers_; }
  const accuracy::Estimator& Estimator() const { return estimator_; }

 private:
  void Report(const std::string& view, accuracy::MeasuredFrame measured,
              accuracy::Evidence evidence, DisplayFrame* frame);

  std::unique_ptr<FrameSource> source_;
  const accuracy::OfferTables tables_;
  const base::TimeSource& time_;
  accuracy::MachineCosts costs_{tables_};
  const accuracy::Offers offers_{tables_, costs_};
  const accuracy::Estimator estimator_{tables_, costs_};
  std::optional<LastDrawn> last_drawn_;  // absent after a failed drawing
};

}  // namespace thunderhead::drawing
