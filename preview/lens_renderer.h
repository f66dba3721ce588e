// LensRenderer: world → pixels of a camera whose lens has distortion.
#pragma once

#include <memory>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "image/image.h"
#include "preview/renderer.h"
#include "world/camera.h"
#include "world/evaluation.h"
#include "world/world.h"

namespace panwright::preview {

// Renderer of images with distortion. A Renderer draws pinhole views with texels finer than pixels.
// Each texel is spread over the pixels under its image, by exact areas: light times area is kept.
// Wide fields are divided into several views. Small targets have views of their own with many
// texels a pixel, as imposters have. Accuracy: docs/accuracy/lenses.md.
class LensRenderer {
 public:
  // Returns the cause why a camera cannot be drawn, or null: a moving pupil has no pinhole views.
  static const char* refused(const world::Camera& camera);

  // Renders one view, without ground truth layers, whatever the options say; their memory counts.
  //
  // Expects: as Renderer::render(), with a camera with distortion that is not refused(); no view of
  // the renderer under way.
  // Reports, fails: as Renderer::render(); E5003 when a pixel's view is too wide. Cost: about the
  // squared texels a pixel (1.5, more for a small pixel_error) times that of a pinhole of the
  // field.
  Result<image::Image> render(Renderer& renderer, const world::World& world,
                              const world::Camera& camera, const RenderOptions& options,
                              DiagnosticLog& log, const Job& job = {});

  // Of the last image: in its pixels. Errors include those of resampling.
  const SamplingReport& sampling() const { return report_; }

 private:
  struct Frame;
  struct Sums {
    double radiance = 0;  // of all channels
    double squares = 0;   // mean of the channels
    double blur = 0;      // squared errors of resampling
  };
  static Sums sums_of(const Frame& frame);
  bool draw_rest(Frame& frame);
  bool draw_to_error(Frame& frame);
  bool draw_texels(Frame& frame, std::size_t index);
  void add_small(Frame& frame);
  void estimate(const Frame& frame);

  world::Evaluation evaluation_;
  SamplingReport report_;
};

}  // namespace panwright::preview
