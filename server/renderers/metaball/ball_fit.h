// Fits metaballs to a scene's storm. The fit applies P. Man's method (clouds/rbf_fit.h) to the
// extinction of the fields that the scene shows. Fits are cached, because each takes a second or
// more. This code does not use GL and is safe to use from any thread.
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

// Fits at most `count` balls to the extinction of `medium`. No ball has a negative extinction.
// Returns no balls for an empty medium, and fewer balls if there are fewer cells.
absl::StatusOr<BallCloud> FitBalls(const Medium& medium, const volume::HydrometeorFields& fields,
                                   int count);

class BallFits {
 public:
  // Keeps the `max_fits` most recently used fits.
  explicit BallFits(std::size_t max_fits = 64) : max_fits_(max_fits) {}

  // Returns the balls of `scene`. If they are not in the cache, the function fits them, which takes
  // seconds.
  absl::StatusOr<std::shared_ptr<const BallCloud>> Get(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields);

  // Returns true if the cache holds the balls of `scene`.
  bool Has(const scene::Scene& scene,
           const std::shared_ptr<const volume::HydrometeorFields>& fields);

 private:
  // The inputs that determine a fit.
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
  std::mutex fitting_;    // one fit at a time, because each uses every core
  std::mutex mutex_;      // protects kept_
  std::list<Kept> kept_;  // the most recently used first
};

}  // namespace thunderhead::renderers
