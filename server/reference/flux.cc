#include "reference/flux.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "glm/common.hpp"
#include "glm/vector_relational.hpp"
#include "reference/parallel.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

// Photons in one chunk of work.
constexpr std::int64_t kPiece = 256;

// Rounds of chunks grow until a round takes this long. Progress is reported between rounds.
constexpr double kRound_ms = 200.0;

enum Quantity {
  kReflected,
  kDirect,
  kDiffuse,
  kTransmitted,
  kAbsorbed,
  kThroughSides,
  kInGround,
  kQuantities
};

// Numbers of events, either of one photon or in total. They are integers, so the result does not
// depend on the order in which threads add them.
using Counts = std::array<std::int64_t, kQuantities>;

struct Sums {
  Counts counts{};
  Counts squares{};  // sums of the squares of each photon's counts

  void Add(const Counts& photon) {
    for (std::size_t i = 0; i < kQuantities; ++i) {
      counts[i] += photon[i];
      squares[i] += photon[i] * photon[i];
    }
  }
  void Add(const Sums& other) {
    for (std::size_t i = 0; i < kQuantities; ++i) {
      counts[i] += other.counts[i];
      squares[i] += other.squares[i];
    }
  }
};

enum class Face { kTop, kBottom, kSide };

struct Exit {
  double distance_m = kNoBound;
  Face face = Face::kSide;
};

// The path of one photon through the domain.
class Photon {
 public:
  Photon(const FluxProblem& problem, RandomStream* random) : problem_(problem), random_(random) {
    const glm::dvec3& low = problem.domain_low_m;
    const glm::dvec3& high = problem.domain_high_m;
    const double x = random->Uniform();
    const double y = random->Uniform();
    ray_.origin_m = {glm::mix(low.x, high.x, x), glm::mix(low.y, high.y, y), high.z};
    ray_.direction = -problem.towards_sun;
  }

  Counts Trace() {
    while (Advance()) {
    }
    return counts_;
  }

 private:
  bool Advance() {
    const Exit exit = FindExit();
    const std::optional<double> collision_m =
        SampleCollision(*problem_.medium, ray_, exit.distance_m, random_);
    if (collision_m.has_value()) return Scatter(*collision_m);
    return Leave(exit);
  }

  Exit FindExit() const {
    Exit exit;
    const int first_axis = problem_.medium->Periodic() ? 2 : 0;
    for (int axis = first_axis; axis < 3; ++axis) {
      const double direction = ray_.direction[axis];
      if (direction == 0.0) continue;
      const glm::dvec3& face = direction > 0.0 ? problem_.domain_high_m : problem_.domain_low_m;
      const double distance_m = (face[axis] - ray_.origin_m[axis]) / direction;
      if (distance_m >= exit.distance_m) continue;
      const Face end = direction > 0.0 ? Face::kTop : Face::kBottom;
      exit = {std::max(distance_m, 0.0), axis == 2 ? end : Face::kSide};
    }
    return exit;
  }

  bool Scatter(double distance_m) {
    ray_.origin_m = ray_.At(distance_m);
    if (problem_.medium->Periodic()) Wrap();
    direct_ = false;
    const Scattering scattering = problem_.medium->ScatteringAt(ray_.origin_m, random_->Uniform());
    const double albedo = (scattering.weight.x + scattering.weight.y + scattering.weight.z) / 3.0;
    if (random_->Uniform() >= albedo) return End(kAbsorbed);
    // A randomly chosen colour selects the phase function. The mean over many photons is therefore
    // the mean of the three colours' functions.
    const auto color = static_cast<std::size_t>(3.0 * random_->Uniform());
    const double mu = scattering.phase->Sample(random_->Uniform(), color).mu;
    ray_.direction = Deflect(ray_.direction, mu, 2.0 * std::numbers::pi * random_->Uniform());
    return true;
  }

  bool Leave(const Exit& exit) {
    if (exit.face == Face::kTop) return End(kReflected);
    if (exit.face == Face::kSide) return End(kThroughSides);
    ++counts_[kTransmitted];
    ++counts_[direct_ ? kDirect : kDiffuse];
    if (random_->Uniform() >= problem_.ground_albedo) return End(kInGround);
    direct_ = false;
    ray_.origin_m = ray_.At(exit.distance_m);
    ray_.origin_m.z = problem_.domain_low_m.z;
    if (problem_.medium->Periodic()) Wrap();
    ray_.direction = SampleCosine({0.0, 0.0, 1.0}, random_);
    return true;
  }

  bool End(Quantity quantity) {
    ++counts_[quantity];
    return false;
  }

  // Moves the photon back into the periodic domain. This keeps coordinates small and therefore
  // precise.
  void Wrap() {
    for (int axis = 0; axis < 2; ++axis) {
      const double low_m = problem_.domain_low_m[axis];
      const double period_m = problem_.domain_high_m[axis] - low_m;
      double& place_m = ray_.origin_m[axis];
      place_m -= std::floor((place_m - low_m) / period_m) * period_m;
    }
  }

  const FluxProblem& problem_;
  RandomStream* random_;
  Ray ray_;
  bool direct_ = true;
  Counts counts_{};
};

absl::Status Check(const FluxProblem& problem, const FluxOptions& options) {
  THUNDERHEAD_CHECK(problem.medium != nullptr, "no medium");
  if (!(problem.towards_sun.z > 0.0)) {
    return absl::InvalidArgumentError(
        "no sunlight falls on the domain's top: the sun must stand above the horizon; give an "
        "elevation above 0 degrees");
  }
  if (!(problem.ground_albedo >= 0.0 && problem.ground_albedo <= 1.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the ground's albedo is ", problem.ground_albedo, "; give 0 to 1"));
  }
  if (options.photons <= 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("the number of photons is ", options.photons, "; give 1 or more"));
  }
  const glm::dvec3 slack = 1e-9 * (problem.domain_high_m - problem.domain_low_m);
  if (!glm::all(glm::lessThanEqual(problem.domain_low_m, problem.medium->Low_m() + slack)) ||
      !glm::all(glm::lessThanEqual(problem.medium->High_m() - slack, problem.domain_high_m))) {
    return absl::InvalidArgumentError("the medium reaches beyond the domain; enlarge the domain");
  }
  const glm::dvec3 wider = (problem.domain_high_m - problem.domain_low_m) -
                           (problem.medium->High_m() - problem.medium->Low_m());
  if (problem.medium->Periodic() && (wider.x > slack.x || wider.y > slack.y)) {
    return absl::InvalidArgumentError(
        "the domain is wider than the periodic medium's period; make them equal");
  }
  return absl::OkStatus();
}

struct Piece {
  Sums sums;
  std::int64_t photons = 0;  // 0 if the chunk was skipped
};

Piece TracePiece(const FluxProblem& problem, std::uint64_t seed, std::int64_t first,
                 std::int64_t last) {
  Piece piece;
  for (std::int64_t photon = first; photon < last; ++photon) {
    RandomStream random(seed, static_cast<std::uint64_t>(photon), 0);
    piece.sums.Add(Photon(problem, &random).Trace());
    ++piece.photons;
  }
  return piece;
}

// Traces `count` chunks beginning with photon `first`. A chunk is skipped if `must_end` returns
// true for its first photon.
std::vector<Piece> TraceRound(const FluxProblem& problem, const FluxOptions& options,
                              std::int64_t first, int count,
                              const std::function<bool(std::int64_t begin)>& must_end) {
  std::vector<Piece> pieces(static_cast<std::size_t>(count));
  ParallelFor(options.threads, count, [&](int i) {
    const std::int64_t begin = first + i * kPiece;
    if (must_end(begin)) return;
    pieces[static_cast<std::size_t>(i)] =
        TracePiece(problem, options.seed, begin, std::min(begin + kPiece, options.photons));
  });
  return pieces;
}

FluxShare ShareOf(const Sums& sums, Quantity quantity, std::int64_t photons) {
  const auto n = static_cast<double>(photons);
  const double mean = static_cast<double>(sums.counts[quantity]) / n;
  const double variance = static_cast<double>(sums.squares[quantity]) / n - mean * mean;
  return {mean, std::sqrt(std::max(variance, 0.0) / std::max(n - 1.0, 1.0))};
}

FluxResult ResultOf(const Sums& sums, std::int64_t photons) {
  FluxResult result;
  result.photons = photons;
  result.reflectance = ShareOf(sums, kReflected, photons);
  result.transmittance = ShareOf(sums, kTransmitted, photons);
  result.transmittance_direct = ShareOf(sums, kDirect, photons);
  result.transmittance_diffuse = ShareOf(sums, kDiffuse, photons);
  result.absorptance = ShareOf(sums, kAbsorbed, photons);
  result.sides = ShareOf(sums, kThroughSides, photons);
  result.ground_absorptance = ShareOf(sums, kInGround, photons);
  return result;
}

}  // namespace

FluxProblem FluxProblem::Of(std::shared_ptr<const Medium> medium, const glm::dvec3& towards_sun) {
  FluxProblem problem;
  problem.domain_low_m = medium->Low_m();
  problem.domain_high_m = medium->High_m();
  problem.towards_sun = towards_sun;
  problem.medium = std::move(medium);
  return problem;
}

absl::StatusOr<FluxResult> ComputeFlux(const FluxProblem& problem, const FluxOptions& options,
                                       const FluxObserver& observer, const std::stop_token& stop) {
  THUNDERHEAD_RETURN_IF_ERROR(Check(problem, options));
  const base::Stopwatch stopwatch;
  const auto must_end = [&](std::int64_t begin) {
    const bool is_limited = options.seconds > 0.0 && begin > 0;
    return stop.stop_requested() || (is_limited && stopwatch.ElapsedMs() >= 1e3 * options.seconds);
  };
  Sums sums;
  std::int64_t begun = 0;
  std::int64_t done = 0;
  int pieces = 16;
  while (begun < options.photons && !must_end(begun)) {
    const base::Stopwatch round;
    const std::vector<Piece> results = TraceRound(problem, options, begun, pieces, must_end);
    for (const Piece& piece : results) {
      sums.Add(piece.sums);
      done += piece.photons;
    }
    begun = std::min(begun + pieces * kPiece, options.photons);
    if (round.ElapsedMs() < kRound_ms) pieces *= 2;
    if (observer) observer(static_cast<double>(begun) / static_cast<double>(options.photons));
  }
  if (done == 0) return absl::CancelledError("stopped before the first photon");
  return ResultOf(sums, done);
}

}  // namespace thunderhead::reference
