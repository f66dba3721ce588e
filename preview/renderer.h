// Pan → pixels.
#pragma once

#include <cstdint>
#include <memory>

#include "base/diagnostic.h"
#include "base/result.h"
#include "pan/model.h"
#include "preview/context.h"
#include "preview/image.h"
#include "preview/view.h"

namespace panwright::preview {

struct RenderOptions {
  unsigned samples = 1;            // N: every pixel is the mean of N×N point samples; 1 to 64
  bool flat = false;               // shade by the triangles' own normals
  unsigned shadow_side = 2048;     // texels a side of the map of what the Sun sees, 16 to 16384 (or
                                   // what the context takes); 0: nothing casts shadows
  bool truth = false;              // also depth, range, normal (without bumps) and ids, at the
                                   // pixels' centres
  std::uint32_t tile_side = 2048;  // samples that are drawn at once, a side; ≥ samples
  std::uint64_t max_bytes = 12ull << 30;  // of the image in memory
};

// Draws one model into images of linear radiance, many views one after the other. Vertices,
// textures and shaders are kept on the context between views.
//
// What a pixel is (docs/conventions.md): the mean over its square of the radiance towards the
// camera, one directional Sun; a point is lit where its shading normal faces the Sun and nothing
// of the model stands in between. The edges of shadows are hard and right to a texel of the shadow
// map, which spans the model as the Sun sees it; a point of a smooth mesh is moved out past the
// mesh's error before it is asked, so that facets cast no shadows on the shape they stand for.
// The back faces of closed meshes are not drawn; open meshes have two equal sides, and so have
// those with holes (a cutout map), through which one sees what is behind. A decal lies on the side
// that is seen: its z must point out of that side. Bumps are an instance's own: mirrored and
// stretched with it. Whatever decides
// where something is, is formed in double and camera-relative and rounded to float once, so the
// distance of the camera costs no precision. Same model, view and options on the same context kind:
// the same bits.
class Renderer {
 public:
  // Puts a model onto a context.
  //
  // Expects: model.checked(); context and model outlive the renderer.
  // Fails: E5003 when a texture or the whole is too large for the context; E5007.
  static Result<Renderer> create(Context& context, const pan::Model& model, DiagnosticLog& log);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  // Renders one view.
  //
  // Expects: options as documented; a camera of 1 pixel or more, finite and with unit rotations; a
  // Sun direction that is not 0.
  // Reports: W5006 when every pixel stays empty. Fails: E5003.
  // Cost: about one draw of what lies in view per tile of tile_side² samples.
  Result<Image> render(const View& view, const RenderOptions& options, DiagnosticLog& log);

  std::uint64_t triangles() const;  // instances counted

  // Draws what render() would draw for one sample a pixel, with the shortest shader there is, into
  // the same kind of framebuffer, and waits. Returns seconds: what the context needs at least.
  //
  // Expects: an image that the context can hold in one framebuffer.
  double seconds_of_bare_draw(const View& view);

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Puts the camera of a view into a named frame of the model, at the view's pose of the model.
//
// Expects: model.checked(). Fails: E5005.
bool place_in_frame(View& view, const pan::Model& model, std::string_view name, DiagnosticLog& log);

}  // namespace panwright::preview
