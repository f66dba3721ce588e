// Passes of one tile of an image: geometry, decals, shading. Private to preview.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "preview/frame/frame_scene.h"
#include "preview/frame/samples.h"
#include "preview/frame/target_states.h"
#include "preview/frame/visible_set.h"
#include "preview/gl/gl_objects.h"
#include "preview/model/device_impl.h"
#include "preview/model/mesh_runs.h"

namespace panwright::preview {

// Kind of a pass over the triangles.
enum class Pass { geometry, flat_geometry, ids, bare };

// Target on one tile.
struct TileTarget {
  std::uint32_t visible = 0;         // into VisibleSet::targets
  std::vector<std::uint32_t> drawn;  // into its items, ascending
  // Materials shaded by one program: of one BRDF model.
  struct ShadingClass {
    std::uint32_t brdf_model = 0;
    std::uint32_t material = 0;  // the only one, if so
    bool one_material = false;
    bool cells = false;  // solar cells are among them
  };
  std::vector<ShadingClass> classes;  // ascending by BRDF model
  std::size_t first_block = 0;        // in the buffer of blocks
  Tile part;                          // of the tile, conservative bounds of the target
};

// Targets on one tile. Found tile by tile in the same memory.
struct TileScene {
  Tile tile;                        // conservative bounds of its contents
  std::vector<TileTarget> targets;  // those on it, as in VisibleSet

  void find(const FrameScene& scene, const Tile& whole);

 private:
  std::vector<TileTarget::ShadingClass> by_family_;
};

TileScene tile_scene(const FrameScene& scene, const Tile& tile);
// Returns the number of triangles of what is on a tile.
double triangles_on(const FrameScene& scene, const TileScene& tile);

// Blocks of N×N samples, each of one pixel, shaded consecutively, in rows.
struct Blocks {
  GLuint pixels = 0;  // buffer texture, one R32UI a block: x | y << 16
  std::uint32_t a_row = 0;
  std::uint32_t rows = 0;
};

// Output of shading beside the radiance: the coverage, and with it more (shading.frag).
enum class Told : std::uint8_t {
  coverage,  // of imposters as `relief`
  cells,     // inputs of error prediction (Sampling)
  relief,    // light that relief finer than the shadow maps' texels may add
};

class Passes {
 public:
  explicit Passes(Device::Impl& device);

  // Builds every program of a pass before its first draw. Fails: E5001.
  bool prepare(const FrameScene& scene, Pass pass, DiagnosticLog& log);

  // Uploads the blocks of a tile and of all items on it.
  void upload(const FrameScene& scene, const TileScene& tile, unsigned samples, bool flat,
              Told told = Told::coverage);

  // Draws the items, with the decals over them in a geometry pass. Groups of targets are drawn from
  // the farthest to the nearest, each over a cleared depth buffer. False: the job is cancelled.
  //
  //   clear  replaces clearing: all at first, then the depth alone, before each group
  //   asked  pixels of the tile; others may miss some surfaces. null: all
  bool draw(const FrameScene& scene, const TileScene& tile, unsigned samples, Pass pass,
            const RenderTarget& target, const Job& job,
            const std::function<void(bool first)>& clear = {}, const PixelSet* asked = nullptr);

  // Shades the visible surfaces, light by light, target by target, the materials of one BRDF model
  // after the other.
  void shade(const FrameScene& scene, const TileScene& tile, unsigned samples,
             const RenderTarget& g_buffer, const RenderTarget& color, const Blocks& blocks = {});

  // A vertex array without vertices.
  GLuint screen() const { return screen_.id(); }

 private:
  GLuint program(const FrameScene& scene, const ModelResources::Impl& model, Variant variant,
                 Pass pass, bool instanced);
  bool draw_items(const FrameScene& scene, const Tile& tile, const PixelSet* asked,
                  const TileTarget& target, Pass pass, const Job& job);
  bool draw_asked(const FrameScene& scene, const Tile& tile, const PixelSet& asked,
                  const TargetState& state, const PlacedBox& box, std::size_t mesh_index,
                  const Job& job);
  void bind_blocks(std::size_t first, std::size_t instances) const;
  void settle_samplers();
  void scissor(const Tile& tile, const Tile& part, unsigned samples) const;
  void shade_target(const FrameScene& scene, const TileTarget& target, unsigned samples,
                    std::uint32_t a_row, GLuint first_class, bool added);
  void draw_decals(const FrameScene& scene, const TileTarget& target, const GlTexture& seen);

  Device::Impl& device_;
  const GladGLContext& gl_;
  GlVertexArray screen_;  // no vertices
  GlBuffer no_pixels_;
  GlTexture no_pixels_texture_;  // in the place of Blocks::pixels: see Passes()
  StreamBuffer stream_;          // a view block, then draw blocks
  std::size_t view_stride_ = 0;  // bytes
  std::size_t draw_stride_ = 0;  // bytes
  std::size_t first_draw_ = 0;   // bytes in stream_, of the last upload
  bool predicting_ = false;      // of the last upload
  std::vector<std::byte> blocks_;
  std::vector<std::uint32_t> places_;  // of draw_decals()
  std::vector<GLuint> first_classes_;  // of shade()
  MeshRunCache runs_;
};

}  // namespace panwright::preview
