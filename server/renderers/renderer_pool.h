// A pool of scene renderers for viewers of different scenes. Each renderer keeps the results of all
// stages for the scene that it drew last, so alternating viewers do not discard each other's
// results. The class owns GL objects, so use it on the context's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "base/stopwatch.h"
#include "renderers/scene_renderer.h"

namespace thunderhead::renderers {

class RendererPool {
 public:
  // Keeps at most `max_renderers` renderers. Drops the least recently used renderers while all
  // together use more than `max_bytes` of device memory.
  explicit RendererPool(std::size_t max_renderers = 4,
                        std::size_t max_bytes = std::size_t{1} << 30U)
      : RendererPool(std::make_shared<TechniqueRegistry>(TechniqueRegistry::BuiltIn()),
                     std::make_shared<gl::ProgramCache>(), max_renderers, max_bytes) {}
  // The renderers draw with the techniques of `registry` and get their linked shader programs from
  // `programs`.
  RendererPool(std::shared_ptr<const TechniqueRegistry> registry,
               std::shared_ptr<gl::ProgramCache> programs, std::size_t max_renderers = 4,
               std::size_t max_bytes = std::size_t{1} << 30U);

  // Draws with the renderer that can reuse the most results for the scene. The frame is valid until
  // the next Draw.
  absl::StatusOr<LinearFrame> Draw(const scene::Scene& scene,
                                   const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                   const DrawQuality& quality);

  // Draws rays of the last frame, like SceneRenderer::DrawChosen.
  absl::StatusOr<ChosenFrame> DrawChosen(const std::vector<glm::vec2>& places) {
    return renderers_.front().renderer->DrawChosen(places);
  }

  // Drops the least recently used renderer, but never the renderer that drew last or is drawing.
  // Returns false if there is no renderer to drop.
  bool DropOldest();
  // Drops renderers that have not drawn for `seconds`. This may invalidate the last frame.
  void DropUnusedFor(double seconds);

 private:
  SceneRenderer& Choose(const scene::Scene& scene,
                        const std::shared_ptr<const volume::HydrometeorFields>& fields);
  void Shrink();

  std::size_t max_renderers_;
  std::size_t max_bytes_;
  std::shared_ptr<const TechniqueRegistry> registry_;
  std::shared_ptr<gl::ProgramCache> programs_;
  struct Kept {
    std::unique_ptr<SceneRenderer> renderer;
    base::Stopwatch since_used;
  };
  std::vector<Kept> renderers_;  // the most recently used first
};

}  // namespace thunderhead::renderers
