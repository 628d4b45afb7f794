#include "physics/field_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "physics/counter_random.h"

namespace thunderhead::physics {
namespace {

constexpr int kPatternSide = glsl::kFieldMapCells;
constexpr std::uint64_t kFieldSeed = 1862;
constexpr std::uint64_t kGrainSeed = 1803;
// Maximum of reflectance / mean reflectance, including the grain.
constexpr float kBrightest = 2.35F;

// The crop of a field. Brightness ranges from -1 (dark) to 1 (bright), dryness from -1 (green) to 1
// (dry).
struct Crop {
  float brightness = 0.0F;
  float dryness = 0.0F;
};

constexpr std::array kFieldCrops = {
    Crop{0.5F, 0.8F},     // stubble of wheat
    Crop{-0.05F, -0.1F},  // pasture
    Crop{-0.6F, -0.8F},   // maize
    Crop{-0.35F, -0.6F},  // soya
    Crop{-0.5F, 0.6F},    // bare soil
    Crop{0.2F, 0.3F},     // hay
};

std::size_t At(int x, int y) {
  return static_cast<std::size_t>((y + kPatternSide) % kPatternSide) * kPatternSide +
         static_cast<std::size_t>((x + kPatternSide) % kPatternSide);
}

Crop RandomCrop(CounterRandom* random) {
  Crop crop = kFieldCrops[static_cast<std::size_t>(random->Next() * kFieldCrops.size())];
  crop.brightness += static_cast<float>(0.3 * (random->Next() - 0.5));
  crop.dryness += static_cast<float>(0.3 * (random->Next() - 0.5));
  return crop;
}

// The map of fields. A section (a square mile) has four quarters, and a quarter has four cells. A
// field is a section, a quarter, half of a quarter or a cell.
class FieldMap {
 public:
  FieldMap() : crops_(At(kPatternSide - 1, kPatternSide - 1) + 1), pivots_(crops_.size(), 0.0F) {
    for (int y = 0; y < kPatternSide; y += 4) {
      for (int x = 0; x < kPatternSide; x += 4) PlantSection(x, y);
    }
    Centre(&Crop::brightness);
    Centre(&Crop::dryness);
  }

  const Crop& CropAt(std::size_t cell) const { return crops_[cell]; }
  float PivotAt(std::size_t cell) const { return pivots_[cell]; }

 private:
  void PlantSection(int x, int y) {
    CounterRandom random(kFieldSeed, At(x, y));
    const Crop whole = RandomCrop(&random);
    const bool undivided = random.Next() < 0.12;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int west = x + 2 * (quarter % 2);
      const int south = y + 2 * (quarter / 2);
      if (undivided) {
        Plant(west, south, {whole, whole, whole, whole});
      } else {
        PlantQuarter(west, south, &random);
      }
    }
  }

  void PlantQuarter(int west, int south, CounterRandom* random) {
    std::array<Crop, 4> crops;
    for (Crop& crop : crops) crop = RandomCrop(random);
    const double layout = random->Next();
    if (layout < 0.15) {  // stubble covers the corners that the centre pivot leaves dry
      Plant(west, south, {kFieldCrops[0], kFieldCrops[0], kFieldCrops[0], kFieldCrops[0]}, 1.0F);
    } else if (layout < 0.55) {
      Plant(west, south, {crops[0], crops[0], crops[0], crops[0]});
    } else if (layout < 0.7) {
      Plant(west, south, {crops[0], crops[1], crops[0], crops[1]});
    } else if (layout < 0.85) {
      Plant(west, south, {crops[0], crops[0], crops[1], crops[1]});
    } else {
      Plant(west, south, crops);
    }
  }

  void Plant(int west, int south, const std::array<Crop, 4>& crops, float pivot = 0.0F) {
    for (int i = 0; i < 4; ++i) {
      const std::size_t cell = At(west + i % 2, south + i / 2);
      crops_[cell] = crops[static_cast<std::size_t>(i)];
      pivots_[cell] = pivot;
    }
  }

  void Centre(float Crop::*part) {
    double sum = 0.0;
    for (const Crop& crop : crops_) sum += crop.*part;
    const auto mean = static_cast<float>(sum / static_cast<double>(crops_.size()));
    for (Crop& crop : crops_) crop.*part = std::clamp(crop.*part - mean, -1.0F, 1.0F);
  }

  std::vector<Crop> crops_;
  std::vector<float> pivots_;
};

// Returns the grain: value noise whose octaves each repeat over the map. Its mean is 0 and its
// range is -1 to 1.
std::vector<float> GrainMap() {
  std::vector<float> grain(At(kPatternSide - 1, kPatternSide - 1) + 1, 0.0F);
  const int coarsest = static_cast<int>(glsl::kCoarsestGrain_m / glsl::kGrainCell_m);
  for (int wavelength = coarsest; wavelength >= 1; wavelength /= 2) {
    const int nodes = kPatternSide / wavelength;
    const auto node = [&](int x, int y) {
      const int index = (y % nodes) * nodes + x % nodes;
      CounterRandom random(kGrainSeed + static_cast<std::uint64_t>(wavelength),
                           static_cast<std::uint64_t>(index));
      return static_cast<float>(2.0 * random.Next() - 1.0);
    };
    std::vector<float> nodes_of_row(static_cast<std::size_t>(nodes) * nodes);
    for (int i = 0; i < nodes * nodes; ++i) {
      nodes_of_row[static_cast<std::size_t>(i)] = node(i % nodes, i / nodes);
    }
    const auto value = [&](int x, int y) {
      return nodes_of_row[static_cast<std::size_t>((y % nodes) * nodes + x % nodes)];
    };
    constexpr float kAmplitude = 0.3F;  // amplitude of each octave
    for (int y = 0; y < kPatternSide; ++y) {
      for (int x = 0; x < kPatternSide; ++x) {
        const auto smooth = [&](int at) {
          const float t = static_cast<float>(at % wavelength) / static_cast<float>(wavelength);
          return t * t * (3.0F - 2.0F * t);
        };
        const int i = x / wavelength;
        const int j = y / wavelength;
        const float low = glm::mix(value(i, j), value(i + 1, j), smooth(x));
        const float high = glm::mix(value(i, j + 1), value(i + 1, j + 1), smooth(x));
        grain[At(x, y)] += kAmplitude * glm::mix(low, high, smooth(y));
      }
    }
  }
  double sum = 0.0;
  for (const float value : grain) sum += value;
  const auto mean = static_cast<float>(sum / static_cast<double>(grain.size()));
  for (float& value : grain) value = std::clamp(value - mean, -1.0F, 1.0F);
  return grain;
}

std::uint8_t ByteOfSigned(float value) {
  return static_cast<std::uint8_t>(std::lround(128.0F + 127.0F * value));
}

}  // namespace

const FieldPattern& FieldPattern::Plains() {
  static const FieldPattern pattern;
  return pattern;
}

FieldPattern::FieldPattern() {
  const FieldMap fields;
  const std::vector<float> grain = GrainMap();
  std::vector<glm::vec4> finest;
  for (std::size_t cell = 0; cell < grain.size(); ++cell) {
    const Crop& crop = fields.CropAt(cell);
    const auto pivot = static_cast<std::uint8_t>(255.0F * fields.PivotAt(cell));
    texels_.emplace_back(ByteOfSigned(crop.brightness), ByteOfSigned(crop.dryness), pivot,
                         ByteOfSigned(grain[cell]));
    finest.push_back(glm::vec4(texels_.back()) / 255.0F);
  }
  levels_.push_back(std::move(finest));
  for (int side = kPatternSide / 2; side >= 1; side /= 2) {
    const std::vector<glm::vec4>& below = levels_.back();
    std::vector<glm::vec4> level;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const auto at = [&](int i, int j) {
          return below[static_cast<std::size_t>((2 * y + j) * 2 * side + 2 * x + i)];
        };
        level.push_back(0.25F * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)));
      }
    }
    levels_.push_back(std::move(level));
  }
}

glm::vec4 FieldPattern::Linear(const glm::vec2& cell, int level) const {
  const int side = kPatternSide >> level;
  const glm::vec2 place = cell / static_cast<float>(1 << level) - 0.5F;
  const glm::vec2 corner = glm::floor(place);
  const glm::vec2 share = place - corner;
  const auto at = [&](int x, int y) {
    const auto wrapped = [side](float from, int plus) {
      const int index = (static_cast<int>(from) + plus) % side;
      return index < 0 ? index + side : index;
    };
    return levels_[static_cast<std::size_t>(level)]
                  [static_cast<std::size_t>(wrapped(corner.y, y) * side + wrapped(corner.x, x))];
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), share.x), glm::mix(at(0, 1), at(1, 1), share.x),
                  share.y);
}

glm::vec4 FieldPattern::Sample(const glm::vec2& cell, float level) const {
  const float most = static_cast<float>(levels_.size()) - 1.0F;
  const float held = std::clamp(level, 0.0F, most);
  const int below = static_cast<int>(held);
  if (held == static_cast<float>(below)) return Linear(cell, below);
  return glm::mix(Linear(cell, below), Linear(cell, below + 1), held - static_cast<float>(below));
}

glm::vec3 FieldPattern::Reflectance(const glm::vec2& place_m, const glm::vec2& footprint_m,
                                    float contrast) const {
  const glm::vec2 footprint = footprint_m / glsl::kFieldCell_m;
  const glm::vec4 field =
      Sample(glsl::sharp_cell(place_m / glsl::kFieldCell_m, footprint), glsl::mip_level(footprint));
  return glsl::field_reflectance(glm::vec3(field), glsl::pivot(place_m, footprint_m),
                                 glsl::roads(place_m, footprint_m), contrast) *
         Grain(place_m, footprint_m, contrast);
}

float FieldPattern::Grain(const glm::vec2& place_m, const glm::vec2& footprint_m,
                          float contrast) const {
  if (std::max(footprint_m.x, footprint_m.y) > glsl::kCoarsestGrain_m) return 1.0F;
  const float level = glsl::mip_level(footprint_m / glsl::kGrainCell_m);
  return glsl::grain_factor(Sample(glsl::grain_cell(place_m), level).w, contrast);
}

float FieldContrast(const glm::vec3& mean_reflectance) {
  const float most = std::max({mean_reflectance.x, mean_reflectance.y, mean_reflectance.z, 1e-6F});
  return std::clamp((1.0F / most - 1.0F) / (kBrightest - 1.0F), 0.0F, 1.0F);
}

}  // namespace thunderhead::physics
