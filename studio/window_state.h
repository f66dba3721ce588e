// State that the panels and the image of the window share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "studio/layers.h"
#include "studio/layout.h"
#include "studio/options.h"
#include "studio/project.h"
#include "studio/render_thread.h"
#include "studio/view_state.h"
#include "studio/widgets.h"
#include "workspace/frame.h"
#include "workspace/scene_settings.h"
#include "world/world.h"

namespace panwright::studio {

// Pixels of a texture, sRGB.
struct Canvas {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4*H*W
  bool smooth = false;             // interpolated on the screen: fewer pixels than it has
};

// Settings of the displayed image, beside those of the layout.
struct ImageSettings {
  bool edges = false;              // of triangles
  std::string comparison = "off";  // one of kComparisons
  double split = 0.5;              // left end of the reference, in parts of the width
  double difference_range = 0.1;   // at the ends of the colours, of the RMS radiance
  bool interreflections = true;    // of the reference image
};

// Largest sRGB codes of the pixels of an image, or the numbers of a detector.
struct Histogram {
  std::vector<float> bins;  // log(1 + pixels), of 0 to `most`
  std::uint32_t most = 255;
  std::uint64_t saturated = 0;  // pixels
};

// Parts by "TARGET/path".
struct PartSelection {
  std::set<std::string> hidden;
  std::string selected;  // empty: none
};

// Display of a scenario.
struct Playback {
  double rate = 10;               // frames per second
  bool tracks = true;             // drawn, from outside
  std::vector<Message> messages;  // of the displayed frame
};

struct WindowState {
  explicit WindowState(const Options& options);

  Options options;
  Layout layout;
  Project project;
  RenderThread renderer;
  Widgets widgets;
  Project::State models;               // as of this frame
  workspace::BoundingSpheres spheres;  // of `models`
  ViewState view;
  Vec2 image_size{0};                          // pixels of the area for it
  std::shared_ptr<const RenderResult> result;  // displayed; null: none yet
  ImageSettings image;
  Pixels color_scale;  // of the displayed layer, without pixels
  Histogram histogram;
  PartSelection parts;
  Playback playback;
  workspace::SceneReader scene;
  std::optional<Vec3> scene_sun;  // taken over last

  // A copy of the world with the poses and joints of the view. Expects: a world.
  world::World posed() const;
  // Returns a maker of frames of a world, kept for the next call: it has maps and catalogues.
  workspace::FrameMaker& maker_of(const std::shared_ptr<const world::World>& world);
  // Takes over the Sun of the scene of a model, where it has changed.
  void take_scene();
  // Takes over the lens of the camera file, and drops changes of a detector that is none any more.
  void take_camera();
  // Optics and detector of the image as their file has them; null: there are none.
  const sensor::Imager* imager() const;
  // Width and height of the image: those of its camera, or `image_size`.
  Vec2 pixels() const;
  // Fits all targets into the image; frame_all() the tracks of a scenario too.
  void frame_targets();
  void frame_all();
  // `file`, relative to the script where there is one.
  std::filesystem::path output_path(const std::string& file) const;
  workspace::Settings settings() const;

 private:
  std::shared_ptr<const world::World> made_;  // of maker_
  std::optional<workspace::FrameMaker> maker_;
};

}  // namespace panwright::studio
