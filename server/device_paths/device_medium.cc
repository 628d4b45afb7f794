#include "device_paths/device_medium.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/guarded.h"
#include "base/status.h"
#include "device_paths/bindings.h"
#include "gl/device_faults.h"
#include "reference/sampled_phase.h"
#include "shaders/uniforms.h"

namespace thunderhead::device_paths {
namespace {

using reference::Optics;

constexpr std::size_t kGroupsOfTexture = 4;
constexpr std::size_t kMaxGroups = 8;

// A group's optics in the layout of GroupOptics in paths/scattering.glsl.
struct GroupTexels {
  float albedo[3];
  float choice_albedo;
  float share;
  float asymmetry;
  std::int32_t table;
  std::int32_t colors;
};

// Returns the values of the exact and the similar optics (reference::Optics) interleaved. If the
// medium has no similar optics, each exact value appears twice.
std::vector<float> Interleaved(const std::vector<float>& exact, const std::vector<float>& similar) {
  std::vector<float> both;
  both.reserve(2 * exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    both.push_back(exact[i]);
    both.push_back(similar.empty() ? exact[i] : similar[i]);
  }
  return both;
}

// The tables of all phase functions one after another. They are preceded by the nodes 1 -
// cos(angle), which all tables have in common.
class Tables {
 public:
  // Adds the tables of a phase function. Returns the index of the table of its first colour, or -1
  // if the function has no table.
  std::int32_t Add(const reference::SampledPhase& phase) {
    if (phase.Tables() == 0) return -1;
    const auto [found, is_new] = firsts_.emplace(&phase, static_cast<std::int32_t>(values_.size()));
    if (!is_new) return found->second;
    if (values_.empty()) {
      const std::vector<double>& x = phase.TableOf(0).x;
      THUNDERHEAD_CHECK(x.size() == shaders::kPhaseIntervals + 1, "tables as shaders read them");
      Append(x);
      found->second = static_cast<std::int32_t>(values_.size());
    }
    for (int color = 0; color < phase.Tables(); ++color) {
      const auto table = phase.TableOf(static_cast<std::size_t>(color));
      Append(table.values);
      Append(table.cumulative);
      Append(table.guide);
    }
    return found->second;
  }

  gl::Buffer Uploaded() {
    if (values_.empty()) values_.push_back(0.0F);
    return {values_.size() * sizeof(float), values_.data(), 0};
  }

 private:
  template <typename T>
  void Append(const std::vector<T>& values) {
    for (const T value : values) values_.push_back(static_cast<float>(value));
  }

  std::vector<float> values_;
  std::map<const reference::SampledPhase*, std::int32_t> firsts_;
};

}  // namespace

absl::StatusOr<DeviceMedium> DeviceMedium::Of(const reference::Medium& medium) {
  if (medium.Periodic() || !medium.Linear()) {
    return absl::UnimplementedError(
        "the device traces media with open sides and linear interpolation");
  }
  if (medium.Groups(Optics::kExact).size() > kMaxGroups) {
    return absl::UnimplementedError("the device traces media of at most 8 groups of fields");
  }
  GLint longest = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &longest);
  const glm::ivec3& cells = medium.Grid().cells;
  if (std::max({cells.x, cells.y, cells.z}) > longest) {
    return absl::UnimplementedError(
        absl::StrCat("the device has textures of at most ", longest, " cells along a side"));
  }
  return DeviceMedium(medium);
}

DeviceMedium::DeviceMedium(const reference::Medium& medium)
    : groups_(std::max(static_cast<int>(medium.Groups(Optics::kExact).size()), 1)),
      brick_low_m_(medium.BrickLow_m()),
      brick_m_(medium.BrickSize_m()),
      box_low_(InBricks(medium.Low_m())),
      box_high_(InBricks(medium.High_m())),
      cells_(medium.Grid().cells),
      bricks_(medium.Bricks()),
      first_cell_(medium.FirstCell()),
      extinctions_(GL_RG32F, cells_, gl::Filter::kNearest),
      majorants_(GL_RG32F, bricks_, gl::Filter::kNearest) {
  const auto upload = [](const std::vector<float>& exact, const std::vector<float>& similar,
                         gl::Texture3D* texture) {
    texture->Upload(GL_RG, GL_FLOAT, Interleaved(exact, similar).data());
  };
  upload(medium.Extinctions_per_m(Optics::kExact), medium.Extinctions_per_m(Optics::kSimilar),
         &extinctions_);
  upload(medium.Majorants_per_m(Optics::kExact), medium.Majorants_per_m(Optics::kSimilar),
         &majorants_);
  UploadGroups(medium);
  UploadOptics(medium);
  if (absl::Status fault = gl::FaultNow(); !fault.ok()) {
    throw base::FailedAllocation(std::move(fault));
  }
}

void DeviceMedium::UploadGroups(const reference::Medium& medium) {
  const std::vector<std::vector<float>>& groups = medium.GroupExtinctions_per_m();
  for (std::size_t first = 0; first < groups.size(); first += kGroupsOfTexture) {
    const std::size_t count = std::min(groups.size() - first, kGroupsOfTexture);
    std::vector<float> texels(kGroupsOfTexture * medium.Grid().CellCount(), 0.0F);
    for (std::size_t g = 0; g < count; ++g) {
      for (std::size_t i = 0; i < groups[first + g].size(); ++i) {
        texels[kGroupsOfTexture * i + g] = groups[first + g][i];
      }
    }
    group_extinctions_.emplace_back(GL_RGBA32F, cells_, gl::Filter::kNearest);
    group_extinctions_.back().Upload(GL_RGBA, GL_FLOAT, texels.data());
  }
}

void DeviceMedium::UploadOptics(const reference::Medium& medium) {
  Tables tables;
  std::vector<GroupTexels> texels;
  const auto texel_of = [&](const reference::GroupOptics& group) -> GroupTexels {
    const glm::vec3 albedo(group.albedo);
    return {{albedo.x, albedo.y, albedo.z},  static_cast<float>(group.choice_albedo),
            static_cast<float>(group.share), static_cast<float>(group.phase->Asymmetry()),
            tables.Add(*group.phase),        group.phase->Tables()};
  };
  const auto& exact = medium.Groups(Optics::kExact);
  const auto& similar = medium.HasSimilar() ? medium.Groups(Optics::kSimilar) : exact;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    texels.push_back(texel_of(exact[i]));
    texels.push_back(texel_of(similar[i]));
  }
  if (texels.empty()) texels.resize(2);
  optics_ = gl::Buffer(texels.size() * sizeof(GroupTexels), texels.data(), 0);
  phases_ = tables.Uploaded();
}

void DeviceMedium::Bind(const gl::Program& program) const {
  program.Set(uniform::cell_count, cells_);
  program.Set(uniform::brick_count, bricks_);
  program.Set(uniform::first_cell, first_cell_);
  program.Set(uniform::box_low, glm::vec3(box_low_));
  program.Set(uniform::box_high, glm::vec3(box_high_));
  program.Set(uniform::bricks_per_m, glm::vec3(1.0 / brick_m_));
  program.Set(uniform::brick_m, glm::vec3(brick_m_));
  program.Set(uniform::low_height_m, static_cast<float>(brick_low_m_.z));
  extinctions_.Bind(shaders::kPathExtinctionUnit);
  majorants_.Bind(shaders::kPathMajorantUnit);
  for (std::size_t i = 0; i < group_extinctions_.size(); ++i) {
    group_extinctions_[i].Bind(static_cast<GLuint>(shaders::kPathGroupsUnit) +
                               static_cast<GLuint>(i));
  }
  optics_.BindStorage(shaders::kPathGroupsBinding);
  phases_.BindStorage(shaders::kPathPhasesBinding);
}

}  // namespace thunderhead::device_paths
