// Samples where they change the pixel: one for most, N×N for the others. Private to preview.
// docs/sampling.md says what decides, and how well.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/passes.h"
#include "preview/frame/samples.h"
#include "preview/image.h"
#include "preview/renderer.h"

namespace panwright::preview {

class Sampling {
 public:
  // seen, color: what the passes draw into, shared with whoever draws every sample.
  Sampling(Device::Impl& device, Passes& passes, RenderTarget& seen, RenderTarget& color);

  // Draws the means of N×N samples of `color` into the first layer of a target that is large
  // enough, and how far they are apart into the second one; the target is bound for reading then.
  // Fails: E5001.
  bool resolve(const RenderTarget& means, std::uint32_t width, std::uint32_t height,
               unsigned samples, bool spread, DiagnosticLog& log);

  // Draws the radiance of an image that begins as background.
  //
  //   formats  of the layers that the scene needs
  // Expects: something in view, shadows up to date, a current context.
  // Fails: E0001, E5001, E5003.
  bool render(const FrameScene& scene, const RenderOptions& options,
              std::span<const GLenum> formats, Image& image, const Job& job, DiagnosticLog& log);

  // Of the last render().
  const SamplingReport& report() const { return report_; }

 private:
  struct Frame;  // what one call of render() shares

  bool prepare(const Frame& frame);
  bool one_sample_each(const Frame& frame, unsigned samples, std::vector<Pixel>& marked);
  bool classify(const Frame& frame, const TileScene& tile, unsigned samples,
                std::vector<Pixel>& marked);
  bool refine(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
              std::span<float> error);
  bool refine_tile(const Frame& frame, const TileScene& tile, unsigned samples,
                   std::span<const Pixel> pixels, std::span<const std::uint32_t> which,
                   std::span<float> error);
  void clear_runs(const Tile& tile, unsigned samples, GLsizei runs, bool first);
  bool until_error(const Frame& frame, std::vector<Pixel> marked);
  bool measure(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
               std::vector<float>& error);

  Device::Impl& device_;
  Passes& passes_;
  const GladGLContext& gl_;
  RenderTarget& seen_;
  RenderTarget& color_;
  RenderTarget coverage_;
  RenderTarget mask_;
  RenderTarget mean_;
  GlBuffer runs_;    // of pixels to be drawn: x | y << 16, count
  GlBuffer pixels_;  // of blocks: x | y << 16
  GlTexture runs_texture_;
  GlTexture pixels_texture_;
  std::vector<float> floats_;        // read back
  std::vector<std::uint8_t> marks_;  // the same
  SamplingReport report_;
};

}  // namespace panwright::preview
