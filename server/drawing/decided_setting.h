// The setting that a session's scene is drawn with: decided at once for the accuracy or speed that
// it asks for, and again at rest with the measured costs and discretisation error. A plain value.
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
  // `offers` must outlive it.
  explicit DecidedSetting(const accuracy::Offers& offers) : offers_(offers) {}

  // The newest scene with its setting decided. The error is returned once; afterwards, none.
  absl::StatusOr<std::optional<session::NewestScene>> Decide(const session::NewestScene& asked);

  // True until Checked, for a setting that can be drawn with half the slices as well.
  bool NeedsCheck() const;
  void Checked(double discretisation_error) {
    checked_ = true;
    discretisation_error_ = discretisation_error;
  }
  const std::optional<double>& discretisation_error() const { return discretisation_error_; }

  // Decides again. True if another setting is better now, which happens at most a few times.
  bool DecideAgain(const session::NewestScene& asked);

  // The whole picture was measured, its light traced to the end if it is traced. True if it surely
  // has more error than the scene asks for and another setting is decided on; what was measured
  // counts for later scenes as well that ask for the same of the same storm.
  bool Measured(const accuracy::MeasuredError& error, const session::NewestScene& asked);

  // True if the setting is final for this revision.
  bool settled() const { return settled_; }

 private:
  bool ContinuesWith(const scene::Scene& asked) const;
  // True if another setting is better now, which the scene has then.
  bool DecideAnew(const session::NewestScene& asked);

  const accuracy::Offers& offers_;
  std::optional<std::uint64_t> revision_;
  std::shared_ptr<const scene::Scene> scene_;  // null if that failed
  accuracy::MeasuredErrors measured_;
  int decided_again_ = 0;
  int refuted_ = 0;
  bool checked_ = false;
  std::optional<double> discretisation_error_;
  bool settled_ = false;
};

}  // namespace thunderhead::drawing
