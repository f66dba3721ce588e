// Views: a camera, the Sun and poses of targets, from the text of a command line or a
// views file. Syntax: docs/conventions.md 2–7.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "workspace/drawer.h"
#include "workspace/joints.h"
#include "workspace/quantities.h"
#include "workspace/targets.h"
#include "world/world.h"

namespace panwright::workspace {

// ---- views

struct TargetPose {
  std::string target;  // its name
  world::Pose pose;    // world_from_model
};

struct TargetJoint {
  std::string target;  // its name
  std::uint32_t joint = 0;
  geometry::JointValues values{};
};

// One image to render.
struct View {
  std::string label;  // what diagnostics call it, as "view 3 ('far')"; empty: nothing
  world::Camera camera;
  std::optional<world::Sun> sun;    // none: the world's
  std::vector<TargetPose> poses;    // of targets that differ from the world; later ones replace
                                    // earlier ones
  std::vector<TargetJoint> joints;  // that differ from the world, aims worked out
  std::string output;               // .png, .exr, .npy or .npz
  double ev = 0;                    // stops, of a PNG
  bool auto_ev = false;             // found from the image: workspace/exposure.h
  std::vector<std::string> more_outputs;  // further files of the same image
  std::optional<DrawOptions> draw;        // none: those of the run
};

// Sets the state of a view in a world that is shown: poses, joints and the Sun of the view, all
// else as in the world it is of. What stays the same keeps its stamps, and with them all that was
// derived from it.
//
// Expects: `shown` was copied from `world`; targets and joints of the world.
void show(const View& view, const world::World& world, world::World& shown);

// ---- as text

struct PoseText {
  std::string target;  // its name; empty: the only one
  std::string value;   // "x y z w i j k"
};

// "NAME=x y z w i j k", or "x y z w i j k".
PoseText pose_text(std::string_view text);

// One view as typed; what is absent is found by ViewMaker and draw_options().
struct ViewText {
  std::optional<std::string> camera;          // "x y z" metres
  std::optional<std::string> look_at;         // "x y z"
  std::optional<std::string> up;              // "x y z"
  std::optional<std::string> quat;            // "w x y z", world_from_camera
  std::vector<PoseText> poses;                // world_from_model; later ones replace earlier ones
  std::vector<JointText> joints;              // later ones replace earlier ones
  std::optional<std::string> camera_frame;    // "TARGET/FRAME", or "FRAME" that one target has
  std::optional<std::string> sun;             // "x y z", towards the Sun
  std::optional<std::string> sun_distance;    // AU
  std::optional<std::string> sun_irradiance;  // "E" or "Er,Eg,Eb"
  std::optional<std::string> fov;             // angle; bare: degrees
  std::optional<std::string> ifov;            // angle; bare: degrees
  std::optional<std::string> intrinsics;      // "fx,fy,cx,cy" pixels
  std::optional<std::string> ortho;           // metres
  std::optional<std::string> size;            // "WxH"
  std::optional<std::string> ev;              // stops, or "auto"
  std::optional<std::string> output;
  std::vector<std::string> more_outputs;

  // what replaces the models of the run
  std::vector<std::string> targets;  // "FILE" or "NAME=FILE"; empty: those of the run
  std::vector<std::pair<std::string, std::string>> defines;  // parameters: name and value

  // engine; flags are "true" or "false"
  std::optional<std::string> limb_darkening;    // 0 to 1
  std::optional<std::string> engine;            // "gl" or "reference"
  std::optional<std::string> samples;           // "auto" or N
  std::optional<std::string> pixel_error;       // share
  std::optional<std::string> adaptive;          // flag
  std::optional<std::string> flat;              // flag
  std::optional<std::string> specular_filter;   // "auto" or "off"
  std::optional<std::string> no_shadows;        // flag
  std::optional<std::string> shadows;           // "auto", "off", "hard" or "soft"
  std::optional<std::string> sun_points;
  std::optional<std::string> shadow_side;       // texels
  std::optional<std::string> levels;            // "auto", "off" or metres
  std::optional<std::string> imposters;         // "auto", "off", "always" or pixels
  std::optional<std::string> flux_error;        // share
  std::optional<std::string> psf;               // pixels
  std::optional<std::string> until_error;       // share
  std::optional<std::string> max_samples;       // of a pixel
  std::optional<std::string> bounces;           // number
  std::optional<std::string> seed;              // number
  std::optional<std::string> filter;            // "box" or "gaussian:SIGMA"
  std::optional<std::string> no_sun_disc;       // flag
  std::optional<std::string> max_image_memory;  // bytes, as "2GB"

  std::string name;   // as its author calls it
  std::string label;  // what diagnostics call it, as "view 3 ('far')"; empty: options of a command
  std::string file;   // of views that it comes from; empty: none
};

// Reads a views file (docs/views.md): a JSON list of objects whose members are those of
// schemas/views.toml, with '-' or '_' between words. What a view leaves out is taken from
// `defaults`, as by with_defaults().
//
//   returns  one view or more, each with an output
// Fails: E0101…E0104, E0203.
Result<std::vector<ViewText>> read_views(const std::filesystem::path& path,
                                         const ViewText& defaults, DiagnosticLog& log);

// The same of a text in memory; `name` stands for it in diagnostics.
Result<std::vector<ViewText>> parse_views(std::string_view text, const std::string& name,
                                          const ViewText& defaults, DiagnosticLog& log);

// One view, an object, as a line of a stream of them.
//
//   index  its number in the stream
//   view   what could be read of it; name and label in any case
// False: E0203.
bool parse_view(std::string_view text, std::size_t index, const ViewText& defaults, ViewText& view,
                DiagnosticLog& log);

// Reports what is wrong with the values of a view, as far as that can be told without its targets:
// E0201 (of a views file: E0203), E0202.
void check_values(const ViewText& text, DiagnosticLog& log);

// Most bytes of one line of a stream of views.
constexpr std::size_t kMaxViewLine = std::size_t{1} << 20;

// A view with what it leaves out. Of alternative members, of poses of one target and of values of
// one parameter, the view's replace the default's.
ViewText with_defaults(ViewText view, const ViewText& defaults);

// How a view is to be drawn. Fails: E0201 (of a views file: E0203); E0201 too for an option of the
// other engine.
Result<DrawOptions> draw_options(const ViewText& text, preview::ContextKind context,
                                 DiagnosticLog& log);

// Makes views of one world from texts. Without a lens, the visible targets fill the image; without
// a camera, it stands in front of them; without a direction, it looks at the origin where a
// position is given, else at their centre; without a Sun, it shines from behind the
// camera's left shoulder.
class ViewMaker {
 public:
  // Expects: world outlives the maker.
  explicit ViewMaker(const world::World& world) : world_(world) {}

  // Reports: N5004, W5015. Fails: E0201 (of a views file: E0203), E0202, E5005, E5011, E5013,
  // E5014.
  Result<View> view(const ViewText& text, DiagnosticLog& log);

 private:
  Result<View> made(const ViewText& text, DiagnosticLog& log);
  const world::World& world_;
  BoundingSpheres spheres_;
};

}  // namespace panwright::workspace
