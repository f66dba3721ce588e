// The window: panels around the image, and what mouse and keys do there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "preview/context.h"
#include "studio/artist.h"
#include "studio/edits.h"
#include "studio/eye.h"
#include "studio/layout.h"
#include "studio/measure.h"
#include "studio/project.h"
#include "studio/samples.h"
#include "studio/script.h"
#include "studio/video.h"
#include "studio/widgets.h"

namespace panwright::studio {

struct Options {
  std::vector<std::string> files;  // FILE or NAME=FILE
  workspace::OpenOptions open;
  preview::ContextKind context = preview::ContextKind::automatic;  // of what draws images
  Layout layout;                                                   // of the window to begin with
  std::filesystem::path layout_file;  // where it is remembered; empty: nowhere
  std::string layout_problem;         // said in the window
  double scale = 0;  // of text and widgets; 0: that of the screen
  std::vector<Step> script;  // empty: a hand uses the window
  std::filesystem::path folder;  // of the script's files
  bool with_script = false;
};

// What happened in the window.
struct Report {
  Series spent{1 << 20};  // ms of each frame's work on the window's thread
  double busy = 0;        // ms, the most that one of them took of a processor
  double first_image =
      0;             // seconds from the start to the first image on the screen; 0: there was none
  Series saved{64};  // seconds from a file's time of modification to the image of it on the screen
  SavedToImage last_saved;
  Series resident{64};  // bytes, after each frame of a script
  Artist::Status drawing;
  std::uint64_t readings = 0;  // of the models
  std::string command;         // that makes the last image
};

// Opens the window and returns when it is closed, or the script is at its end.
//
//   report   may be null
//   returns  whether all went well: the script, if there is one, could be followed
// Fails: E5001 without a display, or OpenGL 3.3 in windows; E0203 where the script goes wrong.
bool run(const Options& options, DiagnosticLog& log, Report* report = nullptr);

// Whatever stands on the screen, apart from how it gets there.
class Desk {
 public:
  Desk(const Options& options);

  struct Textures {
    std::uintptr_t image = 0, sample = 0;  // 0: there is none
  };
  // One frame's panels and input. size: pixels of the window
  void frame(const Vec2& size, double scale, const Textures& textures);
  // The pixels to show, where they are others since the last call; null: the same.
  struct Canvas {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    bool smooth = false;  // fewer pixels than the screen has: they are interpolated
  };
  const Canvas* new_canvas();
  const Canvas* new_sample_canvas();  // of the material's samples
  // Of a file that was saved, once for each, when the canvas is that of the models as they are
  // since then; `shown` is that moment.
  std::optional<SavedToImage> saved_to_image();

  Widgets& widgets() { return widgets_; }
  // What scripts expect: words by name.
  std::optional<std::string> state(const std::string& name) const;
  bool settled() const;  // the image is exact, and of the models as they are
  bool saving() const { return saving_.valid(); }
  bool filming() const { return video_.status().busy; }
  bool sampling() const { return samples_.busy(); }
  std::string command() const;  // as the Save tab shows it
  Layout layout() const;        // as it is now
  bool idle() const;     // nothing happens unless a hand does something
  const Artist& artist() const { return artist_; }
  const Project& project() const { return project_; }
  const Place& image_place() const { return image_place_; }
  void drop(const std::vector<std::string>& files);  // dropped onto the window

 private:
  std::string status_words() const;
  void bar(const Vec2& at, const Vec2& size);
  void panel(const Vec2& at, const Vec2& size);
  void camera_tab();
  void sun_tab();
  void image_tab();
  void levels_legend();
  void budget_table();
  void comparison();
  bool take_image();
  void paint_canvas();
  std::string canvas_words() const;
  void parts_tab();
  void joints_tab();
  void materials_tab();
  void material_list();
  void material_curves();
  void foil_seed(const MaterialFile& file, const pxn::EditableMaterial& foil);
  void foil_curves(const std::string& name);
  void material_library();
  void ask_for_sample();
  void material_numbers(const MaterialFile& file, const pxn::EditableMaterial& material);
  void unsaved_changes();
  void save_tab();
  void border(const Vec2& at, const Vec2& size, double scale);
  void messages(const Vec2& at, const Vec2& size);
  void image_view(const Vec2& at, const Vec2& size, std::uintptr_t texture);
  void readings(const Vec2& mouse, const Vec2& at, std::uintptr_t texture);
  void labels(const Vec2& at);
  void hand_on_image(const Vec2& at, const Vec2& size);
  void keys();
  void node_row(std::size_t target, std::uint32_t node);
  void joint_row(std::size_t target, std::size_t joint, const geometry::JointValues& now);
  void video_controls();
  void save(const std::string& file);
  void order();
  void take_models();
  world::World posed() const;  // Expects: a world
  void frame_all();
  void poses();
  void open_in_editor(const Message& message);
  std::vector<Message> all_messages() const;

  Options options_;
  Layout layout_;  // its layer, mark_white and labels are below
  bool first_frame_ = true;
  Project project_;
  Artist artist_;
  Widgets widgets_;
  Project::State models_;
  workspace::BoundingSpheres spheres_;
  Eye eye_;
  bool framed_ = false;  // the eye has looked at the first model
  std::shared_ptr<const DrawnImage> shown_;
  // what of it is shown
  std::string layer_ = "light";
  bool mark_white_ = false;
  bool show_edges_ = false;
  std::string compare_ = "off";
  double split_ = 0.5;          // of the image's width, from where the reference is shown
  double difference_ = 0.1;     // at the ends of its colours, of the RMS radiance
  bool bounces_ = true;         // light between surfaces, of the reference
  Canvas canvas_;
  std::int64_t measured_ = 0;   // Project::State::saved of the last one
  Pixels scale_;                // of the canvas, without pixels
  std::string shown_as_;        // what the canvas was painted with
  Place image_place_;
  Vec2 image_size_{0};
  // parts
  std::string search_;
  bool show_costs_ = false;       // in place of the tree
  bool prune_ = false;            // hidden geometry of CAD files is left out, as `compile` does
  std::set<std::string> hidden_;  // "TARGET/path"
  std::string selected_;          // the same
  bool show_labels_ = false;
  // joints that play: their "TARGET/JOINT"
  std::string playing_;
  double play_start_ = 0;
  // materials
  Edits edits_;
  std::string material_;  // the one that is edited: "FILE/NAME", or of models alone "model/NAME"
  std::string edited_;    // what came of saving
  std::string preset_;    // of the library, that is looked at
  std::string preset_search_;
  pxn::Provenance provenance_;   // of the preset
  bool in_library_ = false;
  Samples samples_;
  std::string sampled_;          // what was asked for last
  SheetSlopes slopes_;           // of the foil that is looked at
  std::string sloped_;           // what they are of
  std::optional<Sample> held_;   // to compare with
  Canvas sample_canvas_;
  bool sample_is_new_ = false;
  std::uintptr_t sample_texture_ = 0;
  // saving
  std::string output_ = "image.png";
  std::future<std::string> saving_;
  std::string saved_;  // what came of it
  VideoPlan video_plan_;
  Video video_;
  std::vector<float> histogram_;
  std::uint64_t saturated_ = 0;  // pixels
  bool dragging_ = false;        // over the image
  bool bordering_ = false;       // the panel's border
  double last_change_ = 0;
};

}  // namespace panwright::studio
