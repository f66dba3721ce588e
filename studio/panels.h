// Tabs of the panel, one class each.
#pragma once

#include <cstdint>
#include <future>
#include <string>
#include <string_view>

#include "geometry/kinematics/joint.h"
#include "studio/edits.h"
#include "studio/material_curves.h"
#include "studio/video.h"
#include "studio/window_state.h"

namespace panwright::studio {

class CameraPanel {
 public:
  explicit CameraPanel(WindowState& state) : state_(state) {}
  void draw();

 private:
  void scenario();
  void frames();
  WindowState& state_;
};

// Sun, exposure or detector, shadows and imposters.
class SunPanel {
 public:
  explicit SunPanel(WindowState& state) : state_(state) {}
  void draw();

 private:
  void exposure();
  void detector(const sensor::Imager& imager);
  void histogram();
  void shadows();
  WindowState& state_;
};

// Planets, stars, the Sun's disc and lamps.
class SkyPanel {
 public:
  explicit SkyPanel(WindowState& state) : state_(state) {}
  void draw();

 private:
  // Settings of the tab, and of the scene of a model where it says nothing.
  workspace::Settings effective();
  void sun_and_stars(const workspace::Settings& now);
  void planet(const std::string& name, const workspace::Settings& now);
  void lamps();
  void lamp_row(const world::Lamp& original, bool every_on, bool every_off);
  WindowState& state_;
};

// Layer of the image, and comparison with the reference renderer.
class ImagePanel {
 public:
  explicit ImagePanel(WindowState& state) : state_(state) {}
  void draw();

 private:
  void levels_legend();
  void comparison();
  void comparison_result();
  WindowState& state_;
};

// Tree of nodes, or table of triangles and errors.
class PartsPanel {
 public:
  explicit PartsPanel(WindowState& state) : state_(state) {}
  void draw();

 private:
  void selection();
  void isolate();
  void tree();
  void node_row(std::size_t target, std::uint32_t node);
  void budget_table();
  void budget_row(const Detail& detail, std::uint64_t drawn);

  WindowState& state_;
  std::string search_;
  bool show_triangles_ = false;  // in place of the tree
  bool prune_ = false;           // hidden geometry of CAD files is removed, as `compile` does
};

// Poses of targets and values of joints.
class JointsPanel {
 public:
  explicit JointsPanel(WindowState& state) : state_(state) {}
  void draw();
  // Moves the joint that plays.
  void advance();
  bool playing() const { return !playing_.empty(); }

 private:
  void controls(const world::World& posed);
  void poses();
  void pose(const world::Instance& target);
  void side_by_side();
  void joint_row(std::size_t target, std::size_t joint, const geometry::JointValues& now);
  void copy_joints() const;

  WindowState& state_;
  std::string playing_;  // "TARGET/JOINT"; empty: none
  double play_start_ = 0;
};

// Materials and foil: editable numbers, curves, library of presets.
class MaterialsPanel {
 public:
  explicit MaterialsPanel(WindowState& state) : state_(state), sample_(state), foil_(state) {}
  void draw();
  // Reads the editable numbers again, after the models were read.
  void models_read() { edits_.update(state_.models.watched); }
  void set_texture(std::uintptr_t texture) { sample_.set_texture(texture); }
  const Canvas* new_canvas() { return sample_.new_canvas(); }
  bool sampling() const { return sample_.busy(); }
  std::string sample_name() const { return sample_.name(); }
  std::size_t edit_count() const { return edits_.size(); }

 private:
  void list();
  void numbers();
  void material_numbers(const MaterialFile& file, const pxn::EditableMaterial& material);
  void number_sliders(const MaterialFile& file, const pxn::EditableMaterial& material,
                      const std::vector<pxn::EditableNumber>& numbers, const char* help);
  void foil_seed(const MaterialFile& file, const pxn::EditableMaterial& foil);
  void unsaved_changes();
  void library();
  std::string material_name() const;  // of the selected one

  WindowState& state_;
  Edits edits_;
  std::string selected_;  // "FILE/NAME", or without a source text "model/NAME"
  std::string save_message_;
  std::string preset_;  // selected in the library
  std::string preset_search_;
  SampleView sample_;
  FoilSlopesView foil_;
};

// Images, the command that makes them, and videos.
class SavePanel {
 public:
  explicit SavePanel(WindowState& state) : state_(state) {}
  void draw();
  // Takes the result of a save that has ended.
  void poll();
  bool saving() const { return saving_.valid(); }
  const std::string& message() const { return message_; }
  bool recording() const { return video_.status().busy; }
  std::string video_message() const { return video_.status().message; }
  // `panwright render …` of the displayed view.
  std::string command() const;

 private:
  void save();
  void video();
  void video_settings();
  void start_video();

  WindowState& state_;
  std::string output_ = "image.png";
  std::future<std::string> saving_;
  std::string message_;
  VideoSettings video_settings_;
  Video video_;
};

class Panels {
 public:
  explicit Panels(WindowState& state);
  // Draws the tab bar and the open tab.
  void draw();

  CameraPanel camera;
  SunPanel sun;
  SkyPanel sky;
  ImagePanel image;
  PartsPanel parts;
  JointsPanel joints;
  MaterialsPanel materials;
  SavePanel save;

 private:
  template <class Panel>
  void tab(const char* name, Panel& panel);

  WindowState& state_;
  bool first_frame_ = true;
};

}  // namespace panwright::studio
