// Layers of shadow maps, and what is drawn into one. Private to preview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/job.h"
#include "preview/frame/target_states.h"
#include "preview/gl/gl_objects.h"
#include "preview/model/caster_meshes.h"

namespace panwright::preview {

// Depths, and their changes along x and y (shaders/shadow.frag), of maps of one size.
struct MapLayers {
  int width = 0;  // of the textures, texels, which may be larger than a map
  int height = 0;
  GlTexture depths;
  GlTexture slopes;
  GlFramebuffer framebuffer;
  GlBuffer view;  // ViewBlock of drawing them

  // Replaces all. False: the context has no memory.
  //
  //   most  texels of a side, of the context
  bool make(const GladGLContext& gl, std::size_t columns, std::size_t rows, std::uint32_t most,
            int layers);
  // Binds and clears one, for drawing.
  void begin(const GladGLContext& gl, int layer) const;
};

// Items to be drawn into parts of a layer, in their order.
class CasterDraws {
 public:
  void clear();
  // clamped: parts nearer to the light than the map are drawn onto its border
  // mesh: instead of the item's, which has its state; null: that itself
  void add(const GladGLContext& gl, std::uint32_t target, std::uint32_t item, std::uint32_t part,
           bool clamped, const DrawItem& from, const Mat4& clip_from_mesh,
           const CasterMesh* mesh = nullptr);
  bool empty() const { return draws_.empty(); }

  // Draws all. False: the job is cancelled.
  //
  //   begin_part  sets the viewport
  //   all_sides   of closed meshes also the inside
  bool draw(Device::Impl& device, const TargetStates& states,
            const std::function<void(std::uint32_t part)>& begin_part, bool all_sides,
            const Job& job);

 private:
  struct Draw {
    std::uint32_t target = 0;  // of the world
    std::uint32_t item = 0;
    std::uint32_t part = 0;
    bool clamped = false;
    const CasterMesh* mesh = nullptr;
  };
  std::vector<Draw> draws_;
  std::vector<std::byte> blocks_;
  std::size_t stride_ = 0;  // bytes, of blocks_
  std::optional<StreamBuffer> stream_;
};

}  // namespace panwright::preview
