// Labels of a frame from a world and its camera. No OpenGL.
//
//   labels::Labeller labeller;
//   auto frame = labeller.label(world, camera, {.layers = &image}, log);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "image/image.h"
#include "labels/flow.h"
#include "labels/labels.h"
#include "labels/parts.h"
#include "trace/scene.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::labels {

struct LabelOptions {
  std::vector<ChosenPart> parts;  // beside those that models name
  // Metres: surfaces nearer than this to a keypoint neither hide nor shade it.
  double keypoint_slack = 1e-4;
  bool operator==(const LabelOptions&) const = default;
};

// Rows [first, end) of an image, from the top.
struct ImageRows {
  std::uint32_t first = 0, end = 0;
  bool beyond = true;  // the first and the last row of the image: what lies above and below it too
};

// Knowledge of a frame beside its world and camera.
struct FrameContext {
  // Image of the frame, whose ground truth saves rays; null, or without: rays alone.
  const image::Image* layers = nullptr;
  const Moment* previous = nullptr;  // null: no backward flow
  const Moment* next = nullptr;      // null: no forward flow
  // Rows that show this world, where others show other times: masks, boxes and areas are of these.
  // None: all.
  std::optional<ImageRows> rows;
};

// Returns the keypoints of each target, in the world's order, without masks.
//
//   scene   of the world; its observer at the camera's pose
//   slack   metres, as LabelOptions
std::vector<std::vector<Keypoint>> keypoints_in_view(const world::World& world,
                                                     const trace::Scene& scene,
                                                     const world::Camera& camera, double slack);

// Maker of labels of frames, one after the other. Search trees and placements are kept from frame
// to frame, by the world's stamps.
class Labeller {
 public:
  explicit Labeller(LabelOptions options = {});
  ~Labeller();
  Labeller(Labeller&&) noexcept;
  Labeller& operator=(Labeller&&) noexcept;

  // Returns the labels of a frame; names, number and time are for the caller to set. The same for
  // any number of threads.
  //
  // Surfaces are the finest meshes, holes cut by textures left out. Masks: 8×8 samples a pixel;
  // boxes of the whole: of all vertices, to 0.005 pixels with distortion.
  // Expects: a sound camera and world; in `previous` and `next` the same targets.
  // Fails: E0001, E9005.
  Result<FrameLabels> label(const world::World& world, const world::Camera& camera,
                            const FrameContext& context, DiagnosticLog& log, const Job& job = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::labels
