#include "volume/water_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "storm_store/storm_store.h"
#include "volume/detail_control.h"
#include "volume/water_path_memo.h"

namespace thunderhead::volume {
namespace {

// The channel (group of fields that are drawn together) of each field: cloud water; rain, which the
// noise does not change; and all ice.
constexpr std::array<int, 5> kChannelByField = {0, 1, 2, 2, 2};

using Values = glm::dvec3;  // one value for each channel

double FloatOf(std::uint16_t half) {
  const int exponent = half >> 10;
  return exponent == 0 ? std::ldexp(half, -24) : std::ldexp(1024 + (half & 1023), exponent - 25);
}

// Water paths (mass of water per area of a column) by channel, with and without detail. Each is a
// sum over a block of columns.
struct Paths {
  glm::ivec2 count{0};
  std::vector<Values> with;
  std::vector<Values> without;

  Paths InBlocks(int across) const {
    Paths blocks;
    blocks.count = count / across;
    blocks.with.resize(blocks.count.x * blocks.count.y, Values(0.0));
    blocks.without = blocks.with;
    for (int y = 0; y < blocks.count.y * across; ++y) {
      for (int x = 0; x < blocks.count.x * across; ++x) {
        const int block = y / across * blocks.count.x + x / across;
        blocks.with[block] += with[y * count.x + x] / double(across * across);
        blocks.without[block] += without[y * count.x + x] / double(across * across);
      }
    }
    return blocks;
  }

  // Returns the ratio of all columns, by channel.
  Values Ratio() const {
    return std::accumulate(with.begin(), with.end(), Values(0.0)) /
           std::accumulate(without.begin(), without.end(), Values(0.0));
  }

  // Returns the sum of all channels, as the first channel.
  Paths Together() const {
    Paths together{count, {}, {}};
    for (const Values& path : with) together.with.emplace_back(path.x + path.y + path.z, 0, 0);
    for (const Values& path : without)
      together.without.emplace_back(path.x + path.y + path.z, 0, 0);
    return together;
  }

  // Returns the fraction of the water paths that detail changes by less than `most`. Only paths
  // with an optical depth above 1 count.
  double ShareWithin(double most) const {
    int within = 0;
    int thick = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
      if (without[i].x < 1.0) continue;
      within += std::abs(with[i].x / without[i].x - 1.0) < most ? 1 : 0;
      ++thick;
    }
    return double(within) / thick;
  }

  // Returns the root mean square of the differences of paths with an optical depth above 1.
  double Deviation(int channel) const {
    double squares = 0.0;
    int thick = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
      if (without[i][channel] < 1.0) continue;
      squares += std::pow(with[i][channel] / without[i][channel] - 1.0, 2);
      ++thick;
    }
    EXPECT_GT(thick, 10);
    return std::sqrt(squares / thick);
  }
};

// A volume's texels in floating point, interpolated as textures are.
class Texels {
 public:
  // Stores `values` for each of the grid's cells.
  Texels(const RegularGrid& grid, std::vector<Values> values)
      : grid_(grid), values_(std::move(values)) {}

  Values At(const glm::dvec3& place) const {
    const glm::dvec3 last = glm::dvec3(grid_.cells - 1);
    const glm::dvec3 from_middle = glm::clamp(place - 0.5, glm::dvec3(0.0), last);
    const glm::dvec3 low = glm::max(glm::min(glm::floor(from_middle), last - 1.0), 0.0);
    const glm::dvec3 share = from_middle - low;
    Values sum(0.0);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 weights = glm::mix(1.0 - share, share, glm::dvec3(step));
      const glm::ivec3 cell = glm::min(glm::ivec3(low) + step, grid_.cells - 1);
      sum += weights.x * weights.y * weights.z * values_[grid_.Offset(cell.x, cell.y, cell.z)];
    }
    return sum;
  }

 private:
  RegularGrid grid_;
  std::vector<Values> values_;
};

Texels ExtinctionOf(const ExtinctionVolume& volume) {
  const ExtinctionPlane& plane = volume.planes[0];
  std::vector<Values> values(volume.grid.CellCount());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint16_t* texel = plane.texels.data() + i * static_cast<std::size_t>(plane.channels);
    values[i] = Values(FloatOf(texel[0]), FloatOf(texel[1]), FloatOf(texel[2]));
    values[i] *= static_cast<double>(volume.extinction_per_m);
  }
  return {volume.grid, std::move(values)};
}

// A storm's medium before and after its water paths are kept, and its detail.
struct Drawing {
  ExtinctionVolume plain_;
  ExtinctionVolume kept_;
  DetailControl control_;
  DetailControl kept_control_;
  physics::DetailTile tile_;
  PlacedDetail detail_;  // its tile is tile_
};

class WaterPathsTest : public testing::Test, protected Drawing {
 protected:
  // Draws detail in `fields`.
  void Draw(const HydrometeorFields& fields) {
    std::vector<ExtinctionTerm> terms;
    for (std::size_t i = 0; i < fields.fields.size(); ++i) {
      const HydrometeorField& field = fields.fields[i];
      const MassExtinction extinction = MassExtinctionOf(
          field, physics::DefaultOptics(field.hydrometeor), physics::SizeSource::kModel);
      terms.push_back(
          {static_cast<int>(i), extinction.m2_per_kg, kChannelByField[i], extinction.by_cell});
    }
    plain_ = ComputeExtinction(fields, terms, 3);
    control_ = DetailControlOf(fields, terms, plain_);
    tile_ = physics::MakeDetailTile(4, 1);
    const double wavelength_m = 3.0 * plain_.grid.spacing_m.x;
    detail_.layers = {
        {&tile_, wavelength_m * physics::DetailTile::kWaves, {1.0F, 0.0F, 1.0F, 0.0F}}};
    detail_.warp_m = physics::DetailWarp_m(plain_.grid.spacing_m, wavelength_m);
    detail_.fibres = physics::FibresAlong(fields.motion.shear_m_per_s);
    kept_ = plain_;
    kept_control_ = control_;
    KeepWaterPaths(detail_, &kept_control_, &kept_);
  }

  // Returns the paths of every `stride`th column of `volume` along each axis, by
  // shaders/common/medium.glsl. It uses other points than KeepWaterPaths, `along` on each side of a
  // cell.
  Paths PathsOf(const ExtinctionVolume& volume, const DetailControl& with_control, int along = 3,
                int stride = 1) const {
    const RegularGrid& grid = plain_.grid;
    const Texels plain = ExtinctionOf(plain_);
    const Texels drawn = ExtinctionOf(volume);
    const Texels control = Of(with_control);
    const Texels occupied = OccupiedOf(with_control);
    const glm::ivec3 points = glm::ivec3(1, 1, grid.cells.z) * along;
    const double length_m = grid.spacing_m.z / std::pow(along, 3);
    Paths paths{(glm::ivec2(grid.cells) + stride - 1) / stride, {}, {}};
    for (int column = 0; column < paths.count.x * paths.count.y; ++column) {
      const glm::dvec3 corner(stride * (column % paths.count.x), stride * (column / paths.count.x),
                              0);
      Values without(0.0);
      Values with(0.0);
      for (int i = 0; i < points.x * points.y * points.z; ++i) {
        const glm::dvec3 point(i % points.x, i / points.x % points.y, i / points.x / points.y);
        const glm::dvec3 place = corner + (point + 0.5) / double(along);
        const Values at = control.At(place);
        without += plain.At(place);
        const double share = occupied.At(place).x;
        if (share > 0.0) with += Drawn(drawn, at, share, place);
      }
      paths.without.push_back(without * length_m);
      paths.with.push_back(with * length_m);
    }
    return paths;
  }

  Paths PathsKept() const { return PathsOf(kept_, kept_control_); }
  Paths PathsLost() const { return PathsOf(plain_, control_); }

  Texels Of(const DetailControl& control) const {
    std::vector<Values> bytes;
    for (const DetailTexel& texel : control) {
      bytes.emplace_back(texel.profile, texel.amplitude, texel.column);
    }
    return {plain_.grid, std::move(bytes)};
  }

  Texels OccupiedOf(const DetailControl& control) const {
    std::vector<Values> shares;
    for (const DetailTexel& texel : control) shares.emplace_back(texel.occupied / 255.0, 0, 0);
    return {plain_.grid, std::move(shares)};
  }

  Values Drawn(const Texels& extinction, const Values& control_bytes, double occupied,
               const glm::dvec3& place) const {
    const RegularGrid& grid = plain_.grid;
    const glm::vec2 control(control_bytes.x / 255.0, (control_bytes.y - 128.0) / 127.0);
    glm::dvec3 tile = (grid.low_corner_m + place * grid.spacing_m) / detail_.layers[0].tile_m;
    if (control.y < 0.0F) tile = detail_.fibres * tile;
    const glm::dvec4 noise = physics::DetailNoiseAt(tile_, tile);
    const double share = physics::glsl::detail_warp_share(static_cast<float>(occupied), control.y);
    const glm::dvec3 warp = detail_.warp_m / grid.spacing_m;
    const Values value =
        extinction.At(place + share * warp * glm::dvec3(noise.y, noise.z, noise.w));
    const double factor = physics::glsl::detail_factor(control, static_cast<float>(noise.x), 0.0F);
    return value * Values(factor, 1.0, factor) * (control_bytes.z / 128.0);
  }
};

class WaterPathsOfStorm : public WaterPathsTest, public testing::WithParamInterface<std::string> {
 protected:
  // Each storm is read and drawn once for all tests.
  void SetUp() override {
    static std::map<std::string, Drawing> drawn;
    const auto known = drawn.find(GetParam());
    if (known != drawn.end()) {
      Drawing::operator=(known->second);
      detail_.layers[0].tile = &tile_;
      return;
    }
    auto store = storm_store::StormStore::Open(
        {THUNDERHEAD_SOURCE_DIR "/samples/" + GetParam() + ".nc"}, {.read_ahead = 0});
    ASSERT_TRUE(store.ok()) << store.status();
    const auto storm = (*store)->Get((*store)->Storms().front()->id, 1, {});
    ASSERT_TRUE(storm.ok()) << storm.status();
    Draw(**storm);
    drawn[GetParam()] = *this;
  }
};

TEST_P(WaterPathsOfStorm, AreThoseWithoutDetail) {
  const Paths kept = PathsKept();
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(kept.Ratio()[channel], 1.0, 0.01) << channel;
    EXPECT_LT(kept.InBlocks(4).Deviation(channel), 0.04) << channel;
    EXPECT_LT(kept.InBlocks(8).Deviation(channel), 0.02) << channel;
  }
  const Paths all = kept.Together();
  EXPECT_LT(all.InBlocks(4).Deviation(0), 0.02);
  EXPECT_LT(all.InBlocks(8).Deviation(0), 0.01);
  // With fewer points single columns seem to differ by up to some percent.
  const Paths single = PathsOf(kept_, kept_control_, 8, 4).Together();
  EXPECT_GT(single.ShareWithin(0.01), 0.98);
  EXPECT_GT(single.ShareWithin(0.03), 0.995);
  EXPECT_LT(single.Deviation(0), 0.02);
  // For comparison: if the correction is made only for each channel, the total deviates more.
  EXPECT_GT(PathsOf(kept_, control_).Together().Deviation(0), 0.09);
  // Without the correction of the water paths, detail removes much more water.
  const Paths lost = PathsLost();
  EXPECT_LT(lost.Ratio()[0], 0.97);
  EXPECT_GT(lost.InBlocks(8).Deviation(0), 0.1);
}

TEST_P(WaterPathsOfStorm, AreNearlyThoseWithoutDetailWhileFieldsChange) {
  DetailControl control = control_;
  ExtinctionVolume volume = plain_;
  KeepWaterPaths(detail_, &control, &volume, WaterPathEffort::kQuick);
  const Paths single = PathsOf(volume, control, 8, 4).Together();
  EXPECT_GT(single.ShareWithin(0.01), 0.5);
  EXPECT_GT(single.ShareWithin(0.03), 0.8);
  EXPECT_LT(single.Deviation(0), 0.1);
}

TEST_P(WaterPathsOfStorm, FactorsAreBounded) {
  for (std::size_t i = 0; i < plain_.planes[0].texels.size(); ++i) {
    const double before = FloatOf(plain_.planes[0].texels[i]);
    const double after = FloatOf(kept_.planes[0].texels[i]);
    // The tolerance covers half floats, which have 11 significant bits.
    ASSERT_LE(after, before * double{kMaxColumnFactor} * 1.001 + 1e-7);
    ASSERT_GE(after, before / double{kMaxColumnFactor} * 0.999 - 1e-7);
  }
}

// Ice in weak turbulence has fibres along the shear.
TEST_F(WaterPathsTest, AreKeptInFibres) {
  HydrometeorFields fields;
  fields.grid.cells = glm::ivec3(24, 24, 8);
  fields.grid.spacing_m = glm::dvec3(500.0, 500.0, 200.0);
  fields.condensate = {glm::ivec3(0), fields.grid.cells};
  fields.motion.source = TurbulenceSource::kEnergy;
  fields.motion.turbulence.assign(fields.grid.CellCount(), 100);
  fields.motion.shear_m_per_s = {20.0, 20.0};
  fields.fields.resize(3);  // the third belongs to a channel with detail
  fields.fields[2].hydrometeor = physics::Hydrometeor::kIce;
  fields.fields[2].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-2F);
  Draw(fields);
  EXPECT_GT(PathsLost().Deviation(2), 0.03);
  // Some deviation remains, because the test evaluates the noise at other points than
  // KeepWaterPaths.
  EXPECT_LT(PathsKept().Deviation(2), 0.02);
}

// Returns turbulent ice, in which detail has billows.
HydrometeorFields TurbulentIce(const glm::ivec3& cells) {
  HydrometeorFields fields;
  fields.grid.cells = cells;
  fields.grid.spacing_m = glm::dvec3(500.0);
  fields.condensate = {glm::ivec3(0), fields.grid.cells};
  fields.motion.source = TurbulenceSource::kEnergy;
  fields.motion.turbulence.assign(fields.grid.CellCount(), 100);
  fields.fields.resize(3);
  fields.fields[2].hydrometeor = physics::Hydrometeor::kIce;
  fields.fields[2].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-2F);
  return fields;
}

// Tests a single column and a single cell.
TEST_F(WaterPathsTest, AreKeptInTheSmallestGrids) {
  for (const int levels : {1, 8}) {
    Draw(TurbulentIce({1, 1, levels}));
    EXPECT_NEAR(PathsOf(kept_, kept_control_, 8).Ratio()[2], 1.0, 0.01) << levels;
  }
}

class WaterPathMemoTest : public WaterPathsTest {
 protected:
  void SetUp() override { Draw(TurbulentIce({6, 6, 4})); }

  // Corrects the volume so that detail keeps its water paths, with results stored in `memo`, and
  // returns the effort. The result must be the same as without `memo`.
  WaterPathEffort KeptBy(WaterPathMemo* memo, WaterPathEffort effort) {
    DetailControl control = control_;
    ExtinctionVolume volume = plain_;
    const WaterPathEffort kept = memo->Keep(detail_, &control, &volume, effort);
    DetailControl alone_control = control_;
    ExtinctionVolume alone = plain_;
    KeepWaterPaths(detail_, &alone_control, &alone, kept);
    EXPECT_EQ(volume.planes[0].texels, alone.planes[0].texels);
    EXPECT_EQ(
        std::memcmp(control.data(), alone_control.data(), control.size() * sizeof(DetailTexel)), 0);
    return kept;
  }

  static constexpr std::size_t kEnough = 1U << 20U;
};

TEST_F(WaterPathMemoTest, WhatIsRememberedIsTheSame) {
  WaterPathMemo memo(kEnough);
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kFull), WaterPathEffort::kFull);
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kFull), WaterPathEffort::kFull);
}

TEST_F(WaterPathMemoTest, OnlyFullEffortIsRemembered) {
  WaterPathMemo memo(kEnough);
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kQuick);
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kFull), WaterPathEffort::kFull);
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kFull);
}

TEST_F(WaterPathMemoTest, OtherContentsAreOthers) {
  WaterPathMemo memo(kEnough);
  KeptBy(&memo, WaterPathEffort::kFull);
  detail_.layers[0].tile_m *= 1.5;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kQuick);
  detail_.layers[0].tile_m /= 1.5;
  control_[7].profile ^= 1U;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kQuick);
  control_[7].profile ^= 1U;
  plain_.planes[0].texels[20] ^= 1U;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kQuick);
  plain_.planes[0].texels[20] ^= 1U;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kFull);
}

TEST_F(WaterPathMemoTest, ForgetsWhatWasNotAskedForLongest) {
  WaterPathMemo memo(4096);  // 36 columns have some 800 bytes
  const double tile_m = detail_.layers[0].tile_m;
  KeptBy(&memo, WaterPathEffort::kFull);
  detail_.layers[0].tile_m = 1.5 * tile_m;
  KeptBy(&memo, WaterPathEffort::kFull);
  detail_.layers[0].tile_m = tile_m;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kFull);
  for (int i = 2; i < 10; ++i) {
    detail_.layers[0].tile_m = i * tile_m;
    KeptBy(&memo, WaterPathEffort::kFull);
  }
  detail_.layers[0].tile_m = tile_m;
  EXPECT_EQ(KeptBy(&memo, WaterPathEffort::kQuick), WaterPathEffort::kQuick);
}

INSTANTIATE_TEST_SUITE_P(Storms, WaterPathsOfStorm,
                         testing::Values(std::string("supercell"), std::string("supercell-500m")),
                         [](const auto& storm) {
                           return storm.param == "supercell" ? "Supercell" : "Supercell500m";
                         });

}  // namespace
}  // namespace thunderhead::volume
