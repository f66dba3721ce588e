// Adaptive sampling: one sample for most pixels, N×N for the others. Private to preview. Criteria
// and accuracy: docs/accuracy/sampling.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "preview/frame/outline.h"
#include "preview/frame/passes.h"
#include "preview/frame/pixel_errors.h"
#include "preview/frame/samples.h"
#include "preview/frame/thin_parts.h"
#include "preview/renderer.h"

namespace panwright::preview {

class Sampling {
 public:
  // seen, color: targets of the passes, shared with full sampling.
  Sampling(Device::Impl& device, Passes& passes, RenderTarget& seen, RenderTarget& color);

  // Draws the means of N×N samples of `color` into the first layer of a large enough target, and
  // their spread into the second one; leaves the target bound for reading.
  // Fails: E5001.
  bool resolve(const RenderTarget& means, std::uint32_t width, std::uint32_t height,
               unsigned samples, bool spread, DiagnosticLog& log);

  // Sums over the pixels of `color`, and of their errors, as estimated from N×N samples.
  struct Sums {
    double radiance = 0, squares = 0;      // as ImageSums
    double errors = 0, error_squares = 0;  // of the mean of the channels
    void state(SamplingReport& report) const;
  };

  // Adds width×height pixels to the sums. N: even. Expects: resolve() of them. Fails: E5001, E5003.
  bool add_errors(std::uint32_t width, std::uint32_t height, unsigned samples, Sums& sums,
                  DiagnosticLog& log);

  // Draws the radiance of an image that begins as background.
  //
  //   formats  of the layers needed by the scene
  // Expects: something in view, shadows up to date, a current context.
  // Fails: E0001, E5001, E5003.
  bool render(const FrameScene& scene, const RenderOptions& options,
              std::span<const GLenum> formats, image::Image& image, const Job& job,
              DiagnosticLog& log);

  // Of the last render().
  const SamplingReport& report() const { return report_; }

 private:
  struct Frame;  // shared state of one render() call

  // Reads the means of N×N samples, and behind them their spreads, into floats_.
  //
  //   area  pixels that later calls may need
  bool read_means(std::uint32_t width, std::uint32_t height, std::size_t area, unsigned samples,
                  DiagnosticLog& log);
  bool one_sample_each(const Frame& frame, image::Image& image, std::vector<float>& patternless,
                       bool relief = false);
  bool look_at_relief(const Frame& frame);
  bool look_at_corners(const Frame& frame);
  void look_for_thin_parts(const Frame& frame);
  float unseen(std::size_t pixel) const { return unseen_.empty() ? 0 : unseen_[pixel]; }
  void take_patternless(const Frame& frame, const Tile& tile, image::Image& image,
                        std::vector<float>& patternless) const;
  bool refine(const Frame& frame, unsigned samples, std::span<const Pixel> pixels,
              std::span<float> error);
  bool refine_tile(const Frame& frame, const TileScene& tile, unsigned samples,
                   std::span<const Pixel> pixels, std::span<const std::uint32_t> which,
                   std::span<float> error);
  void upload(const GlBuffer& buffer, std::span<const std::uint32_t> numbers,
              std::size_t least) const;
  void clear_runs(const Tile& tile, unsigned samples, GLsizei runs, bool first);
  bool some_in_full(const Frame& frame, unsigned samples);
  bool until_error(const Frame& frame);
  bool want_more(const Frame& frame, std::span<const unsigned> sides, double budget,
                 std::vector<std::vector<Pixel>>& wanted);
  void estimate(const ImageSums& sums);
  void raise_around_surprises(const Frame& frame);
  template <class Use>
  void for_small_targets(const Frame& frame, const Use& use);
  void want_small_targets(const Frame& frame, std::span<const unsigned> sides,
                          std::vector<std::vector<Pixel>>& wanted);
  bool measure(const Frame& frame, std::span<const unsigned> sides,
               std::span<const std::vector<Pixel>> wanted);

  Device::Impl& device_;
  Passes& passes_;
  const GladGLContext& gl_;
  RenderTarget& seen_;
  RenderTarget& color_;
  RenderTarget mean_;
  GlBuffer runs_;    // of pixels to be drawn: x | y << 16, count
  GlBuffer pixels_;  // of blocks: x | y << 16
  GlTexture runs_texture_;
  GlTexture pixels_texture_;
  std::vector<float> floats_;  // read back
  ErrorPredictor predictor_;
  // of the pixels in the frame's conservative bounds, kept for the next one
  std::vector<float> patternless_;
  std::vector<float> corner_patternless_;
  std::vector<float> corner_errors_;  // errors seen by the corners of pixels
  image::Image corners_;
  ThinParts thin_;
  std::vector<std::uint8_t> empty_;  // as in ThinParts
  std::vector<float> unseen_;        // radiance that thin parts may have there; or empty
  std::vector<float> predicted_;
  std::vector<float> errors_;
  std::vector<float> spreads_;  // of the measured pixels
  std::vector<float> before_;   // their radiance
  struct Surprise {
    Pixel pixel;
    float change = 0;  // radiance, rms over the channels
  };
  std::vector<Surprise> surprises_;    // of one frame
  std::vector<std::uint32_t> inside_;  // those within a tile's conservative bounds
  std::vector<std::uint32_t> order_;   // of the refined pixels
  PixelSet asked_;                     // of a tile
  std::vector<std::uint8_t> levels_;   // into the sides of until_error()
  Outline outline_;
  image::Image small_;  // of look_at_relief()
  double relief_ = 0;   // of this frame: what it may add (taken_relief)
  double work_ = 0;     // of this frame: RenderOptions::work
  SamplingReport report_;
};

}  // namespace panwright::preview
