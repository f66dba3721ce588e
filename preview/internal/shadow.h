// What the Sun sees of a model: which points lie in shadow. Private to preview.
#pragma once

#include <span>

#include "base/diagnostic.h"
#include "preview/context.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/gl_objects.h"
#include "preview/internal/gpu_model.h"
#include "preview/internal/programs.h"
#include "preview/internal/sun_frame.h"

namespace panwright::preview {

// The rows of a block that place an item before the Sun. flat: shaded by its triangles' normals.
void place_before_sun(const SunFrame& frame, const pan::layout::Mesh& mesh, const DrawItem& item,
                      bool flat, DrawBlock& block);

// The depths of what the Sun sees, and their slopes. A surface casts a shadow on a point where each
// of the two lies on the far side of the other's plane (shaders/shadow.glsl), so surfaces shadow
// neither themselves nor their neighbours at edges, and no bias pushes shadows away from contacts.
class ShadowMap {
 public:
  // Draws the map, unless it is there already for the same Sun and side. Expects the state that
  // Renderer::Impl::set_state() leaves.
  //
  //   to_sun  model frame, unit
  //   side    texels, > 4; the context may have less
  // Fails: E5003; E5001 when the driver refuses a shader.
  bool draw(const Context& context, const pan::Model& model, std::span<const DrawItem> list,
            const GpuModel& gpu, Programs& programs, const Vec3& to_sun, unsigned side,
            DiagnosticLog& log);

  // For the geometry and shading steps. Expects: drawn.
  const SunFrame& frame() const { return frame_; }
  void bind(const GladGLContext& gl) const;

 private:
  bool make(const GladGLContext& gl, unsigned side, DiagnosticLog& log);
  void upload(const GladGLContext& gl, std::span<const DrawItem> list);

  SunFrame frame_;
  Vec3 to_sun_{0};  // 0: nothing is drawn
  unsigned side_ = 0;
  std::size_t stride_ = 0;  // bytes, of blocks_
  GlTexture depths_;
  GlTexture slopes_;
  GlFramebuffer framebuffer_;
  GlBuffer blocks_;
  GlBuffer limits_;
};

}  // namespace panwright::preview
