// The setting (technique settings and image scale) with which a session's scene is drawn. It is
// decided immediately for the requested accuracy or speed. It is decided again when the scene is at
// rest, with the measured costs and discretisation error. A plain value.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "absl/status/status.h"
#include "accuracy/measured_errors.h"
#include "accuracy/offers.h"
#include "scene/scene.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class DecidedSetting {
 public:
  // `offers` must outlive this object.
  explicit DecidedSetting(const accuracy::Offers& offers) : offers_(offers) {}

  // Returns the newest scene with its setting decided. If no setting can be decided for a revision,
  // returns the error the first time and none afterwards.
  absl::StatusOr<std::optional<session::NewestScene>> Decide(const session::NewestScene& asked);

  // Returns true if the setting can also be drawn with half the slices, and Checked has not been
  // called yet.
  bool NeedsCheck() const;
  void Checked(double discretisation_error) {
    checked_ = true;
    discretisation_error_ = discretisation_error;
  }
  const std::optional<double>& discretisation_error() const { return discretisation_error_; }

  // Decides again. Returns true if another setting is now better, which happens a few times per
  // revision at most.
  bool DecideAgain(const session::NewestScene& asked);

  // Takes the measured error of the whole picture. If the light is traced, tracing must be
  // complete. Returns true if the error is certainly larger than the scene allows and another
  // setting was decided. The measurement also counts for later scenes of the same storm with the
  // same requested accuracy.
  bool Measured(const accuracy::MeasuredError& error, const session::NewestScene& asked);

  // Returns true if the setting is final for this revision.
  bool settled() const { return settled_; }

 private:
  bool ContinuesWith(const scene::Scene& asked) const;
  // Decides again. If another setting is now better, puts it into the scene and returns true.
  bool DecideAnew(const session::NewestScene& asked);

  const accuracy::Offers& offers_;
  std::optional<std::uint64_t> revision_;
  std::shared_ptr<const scene::Scene> scene_;  // null if the decision failed
  accuracy::MeasuredErrors measured_;
  int decided_again_ = 0;
  int refuted_ = 0;
  bool checked_ = false;
  std::optional<double> discretisation_error_;
  bool settled_ = false;
};

}  // namespace thunderhead::drawing
