#include "renderers/renderer_pool.h"

#include <algorithm>
#include <utility>

namespace thunderhead::renderers {

RendererPool::RendererPool(std::shared_ptr<const TechniqueRegistry> registry,
                           std::shared_ptr<gl::ProgramCache> programs, std::size_t max_renderers,
                           std::size_t max_bytes)
    : max_renderers_(max_renderers),
      max_bytes_(max_bytes),
      registry_(std::move(registry)),
      programs_(std::move(programs)) {}

absl::StatusOr<LinearFrame> RendererPool::Draw(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const DrawQuality& quality) {
  auto frame = Choose(scene, fields).Draw(scene, fields, quality);
  Shrink();
  return frame;
}

SceneRenderer& RendererPool::Choose(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  const auto first_stage = [&](const Kept& kept) {
    return kept.renderer->FirstStage(scene, fields);
  };
  auto best = std::max_element(
      renderers_.begin(), renderers_.end(),
      [&](const auto& a, const auto& b) { return first_stage(a) < first_stage(b); });
  // If the scene needs a new extinction, no renderer has results that can be reused.
  if (best == renderers_.end() || first_stage(*best) <= scene::Stage::kExtinction) {
    if (renderers_.size() < max_renderers_) {
      renderers_.emplace_back().renderer = std::make_unique<SceneRenderer>(programs_, registry_);
    }
    best = renderers_.end() - 1;
  }
  std::rotate(renderers_.begin(), best, best + 1);
  renderers_.front().since_used.Restart();
  return *renderers_.front().renderer;
}

bool RendererPool::DropOldest() {
  if (renderers_.size() < 2) return false;
  renderers_.pop_back();
  return true;
}

void RendererPool::DropUnusedFor(double seconds) {
  std::erase_if(renderers_, [seconds](const Kept& kept) {
    return kept.since_used.ElapsedMs() >= 1e3 * seconds;
  });
}

void RendererPool::Shrink() {
  std::size_t bytes = 0;
  for (const Kept& kept : renderers_) bytes += kept.renderer->Bytes();
  while (renderers_.size() > 1 && bytes > max_bytes_) {
    bytes -= renderers_.back().renderer->Bytes();
    renderers_.pop_back();
  }
}

}  // namespace thunderhead::renderers
