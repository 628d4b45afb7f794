#include "gl/whole_target.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "base/status.h"
#include "base/stopwatch.h"
#include "gl/chosen_targets.h"
#include "gl/device.h"
#include "glm/common.hpp"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::gl {
namespace {

constexpr int kTrials = 3;
constexpr int kTrialSide_px = 512;
// Speed ratio above which compute shaders are used. Apart from rounding, both ways draw the same
// picture, so a small gain is not worth the change.
constexpr double kClearlyFaster = 1.5;

// Returns the shortest of several times that the device needs to draw a target with an arithmetic
// test shader.
double TrialMs(const WholeTarget& whole_target, bool computes) {
  const auto program =
      Program::LinkWholeTarget(ProgramSource::WholeTarget("common/arithmetic.frag"), computes);
  if (!program.ok()) return std::numeric_limits<double>::infinity();
  const Texture2D texture(GL_RGBA16F, glm::ivec2(kTrialSide_px));
  const Framebuffer target(texture);
  Pieces whole;
  double least_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1 + kTrials; ++i) {
    glFinish();
    const base::Stopwatch stopwatch;
    if (!whole_target.Draw(whole, {"trial"}, *program, target).ok()) break;
    glFinish();
    if (i > 0) least_ms = std::min(least_ms, stopwatch.ElapsedMs());
  }
  return least_ms;
}

bool FindsComputingFaster(const std::string& renderer) {
  if (DrawsInSoftware()) return false;
  const WholeTarget whole_target;
  const double raster_ms = TrialMs(whole_target, false);
  const double compute_ms = TrialMs(whole_target, true);
  const bool computes = compute_ms * kClearlyFaster < raster_ms;
  spdlog::info(
      "{} draws a test picture in {:.2f} ms with fragment shaders and in {:.2f} ms with compute "
      "shaders: pictures are {}",
      renderer, raster_ms, compute_ms, computes ? "computed" : "rasterized");
  return computes;
}

}  // namespace

bool ComputesWholeTargets() {
  static const std::optional<bool> chosen =
      ComputesByChoice(std::getenv("THUNDERHEAD_WHOLE_TARGETS"));
  if (chosen.has_value()) return *chosen;
  static std::mutex mutex;
  static std::map<std::string, bool> computes;
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string renderer = name == nullptr ? "" : name;
  const std::lock_guard lock(mutex);
  const auto found = computes.find(renderer);
  if (found != computes.end()) return found->second;
  return computes.emplace(renderer, FindsComputingFaster(renderer)).first->second;
}

absl::Status WholeTarget::Draw(Pieces& pieces, const PieceCost& pixel, const Program& program,
                               const Framebuffer& target, const PixelRect& rect) const {
  program.Use();
  target.Bind();
  no_attributes_.Bind();
  const auto draw = [&] {
    if (program.Computes()) {
      Compute(program, target);
    } else {
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
  };
  if (pieces.IsNew(program.Get())) {
    // Drivers compile a program for the current GL state when it first draws. With an empty scissor
    // rectangle, this draw call compiles the program and draws nothing.
    THUNDERHEAD_RETURN_IF_ERROR(pieces.OffTurn([&] {
      glEnable(GL_SCISSOR_TEST);
      glScissor(0, 0, 0, 0);
      draw();
      glFinish();
      glDisable(GL_SCISSOR_TEST);
    }));
  }
  return pieces.Tiles(pixel, rect, draw);
}

void WholeTarget::Compute(const Program& program, const Framebuffer& target) {
  glm::ivec2 first(0);
  glm::ivec2 end = target.Size();
  if (glIsEnabled(GL_SCISSOR_TEST) == GL_TRUE) {
    std::array<GLint, 4> box{};
    glGetIntegerv(GL_SCISSOR_BOX, box.data());
    first = glm::clamp(glm::ivec2(box[0], box[1]), glm::ivec2(0), end);
    end = glm::clamp(first + glm::ivec2(box[2], box[3]), first, end);
  }
  if (first.x == end.x || first.y == end.y) return;
  GLint limited_to = 0;
  if (glIsEnabled(GL_DEPTH_TEST) == GL_TRUE) {
    GLint function = 0;
    glGetIntegerv(GL_DEPTH_FUNC, &function);
    limited_to = function == GL_LESS ? 1 : -1;
    glBindTextureUnit(shaders::kTargetLimitUnit, target.Depth());
  }
  program.Set(uniform::target_size, target.Size());
  program.Set(uniform::first_pixel, first);
  program.Set(uniform::end_pixel, end);
  program.Set(uniform::limited_to, limited_to);
  target.BindImages(shaders::kTargetImages);
  const glm::ivec2 groups =
      (end - first + shaders::kTargetGroupSide - 1) / shaders::kTargetGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y), 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace thunderhead::gl
