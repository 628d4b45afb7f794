// Metaballs for a scene's storm: Man's approximator (clouds/rbf_fit.h) on the extinction of the
// fields that the scene shows. Fits are kept, as each takes a second or more. Knows no GL; safe
// from any thread.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "renderers/medium.h"
#include "renderers/metaball/ball_cloud.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

// Fits at most `count` balls, none of which takes away, to the extinction of `medium`. No balls for
// what is empty; fewer where there are fewer cells.
absl::StatusOr<BallCloud> FitBalls(const Medium& medium, const volume::HydrometeorFields& fields,
                                   int count);

class BallFits {
 public:
  // Keeps the `most` fits used last.
  explicit BallFits(std::size_t max_fits = 64) : max_fits_(max_fits) {}

  // The balls of `scene`, kept or fitted now: then it takes seconds.
  absl::StatusOr<std::shared_ptr<const BallCloud>> Get(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields);

  // True if Get has nothing to fit.
  bool Has(const scene::Scene& scene,
           const std::shared_ptr<const volume::HydrometeorFields>& fields);

 private:
  // Inputs of the fit.
  struct Key {
    std::weak_ptr<const volume::HydrometeorFields> fields;
    std::vector<volume::ExtinctionTerm> terms;
    int count = 0;
  };
  struct Kept {
    Key key;
    std::shared_ptr<const BallCloud> balls;
  };

  static bool Same(const Key& a, const Key& b);
  std::shared_ptr<const BallCloud> Find(const Key& key);

  const std::size_t max_fits_;
  std::mutex fitting_;    // one fit at a time: each uses every core
  std::mutex mutex_;      // of `kept_`
  std::list<Kept> kept_;  // the most recently used first
};

}  // namespace thunderhead::renderers
