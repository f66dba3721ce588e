// Light that other surfaces send the targets of a view. Private to preview.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "base/diagnostic.h"
#include "base/stamp.h"
#include "light/surfels.h"
#include "preview/frame/block_stream.h"
#include "preview/frame/frame_scene.h"
#include "preview/gl/gl_objects.h"
#include "preview/gl/uniforms.h"
#include "preview/renderer.h"

namespace panwright::preview {

// Grids of surfels and their irradiance as buffer textures, uploaded once each. Shading adds them
// in the Sun's pass (shaders/indirect.glsl).
class Indirect {
 public:
  // Begins another image.
  void begin_image(const RenderOptions& options);
  bool any() const { return light_ != nullptr; }

  // Uploads what changed.
  //
  //   samples  model_from_sample of the receivers (light_view.h)
  // Fails: E5003 where a grid is larger than the context takes.
  bool update(const Context& context, const FrameScene& scene, const std::vector<Mat4>& samples,
              DiagnosticLog& log);

  // Expects: any(); update() of the same scene.
  void bind(const GladGLContext& gl, std::size_t receiver) const;

 private:
  struct Grid {
    Stamp stamp = 0;        // of the grid
    Stamp light_stamp = 0;  // of its irradiance
    GlBuffer cells, entries, limits, irradiance;
    GlTexture cells_texture, entries_texture, limits_texture, light_texture;
  };
  Grid& grid_of(const GladGLContext& gl, const light::SurfelLight& light);

  std::shared_ptr<const std::vector<light::SurfelLight>> light_;
  bool mirrors_apart_ = false;
  std::vector<std::unique_ptr<Grid>> grids_;
  std::vector<const Grid*> receivers_;  // null: no light
  const Grid* any_grid_ = nullptr;      // bound where a receiver has none
  BlockStream<IndirectBlock> blocks_;
};

}  // namespace panwright::preview
