// Views: a camera, the Sun and poses of targets, from the text of a command line or a
// views file. Syntax: docs/conventions.md 2–7.
#pragma once

#include <cstdint>
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

// Image to render.
struct View {
  std::string label;  // name in diagnostics, as "view 3 ('far')"; empty: none
  world::Camera camera;
  std::optional<world::Sun> sun;    // none: the world's
  std::optional<Vec3> white;        // none: the world's
  std::vector<TargetPose> poses;    // different from the world; later ones replace earlier ones
  std::vector<TargetJoint> joints;  // different from the world, aims resolved
  std::string output;               // .png, .exr, .npy or .npz
  double ev = 0;                    // stops, of a PNG
  bool auto_ev = false;             // from the image: workspace/exposure.h
  bool field_of_view = false;       // the lens was given as one, or fitted
  std::vector<std::string> more_outputs;  // further files of the same image
  std::optional<DrawOptions> draw;        // none: those of the run
};

// Sets the state of a view in a shown world: its poses, joints and Sun, all else as in `world`.
// Unchanged parts keep their stamps, and all state derived from them.
//
// Expects: `shown` was copied from `world`; targets and joints of the world.
void show(const View& view, const world::World& world, world::World& shown);

// ---- as text

struct PoseText {
  std::string target;  // its name; empty: the only one
  std::string value;   // "x y z qw qx qy qz"
};

// Parses "NAME=x y z qw qx qy qz", or "x y z qw qx qy qz".
PoseText pose_text(std::string_view text);

// View as typed; absent members are resolved by ViewMaker and draw_options().
struct ViewText {
  std::optional<std::string> camera;          // "x y z" metres
  std::optional<std::string> look_at;         // "x y z"
  std::optional<std::string> up;              // "x y z"
  std::optional<std::string> quat;            // "w x y z", world_from_camera
  std::vector<PoseText> poses;                // world_from_model; later ones replace earlier ones
  std::vector<JointText> joints;              // later ones replace earlier ones
  std::optional<std::string> camera_frame;    // "TARGET/FRAME", or "FRAME" of only one target
  std::optional<std::string> sun;             // "x y z", towards the Sun
  std::optional<std::string> sun_distance;    // AU
  std::optional<std::string> sun_irradiance;  // "E" or "Er Eg Eb"
  std::optional<std::string> white;           // the same, of emission 1
  std::optional<std::string> fov;             // angle; bare: degrees
  std::optional<std::string> ifov;            // angle; bare: degrees
  std::optional<std::string> intrinsics;      // "fx fy cx cy" pixels
  std::optional<std::string> ortho;           // metres
  std::optional<std::string> size;            // "WxH"
  std::optional<std::string> ev;              // stops, or "auto"
  std::optional<std::string> tone;            // "linear" or "photo"
  std::optional<std::string> output;
  std::vector<std::string> more_outputs;
  std::optional<std::string> layers;    // names of layers of .exr and .npz
  std::optional<std::string> compress;  // flag

  // replacements for the models of the run
  std::vector<std::string> targets;  // "FILE" or "NAME=FILE"; empty: those of the run
  std::vector<std::pair<std::string, std::string>> defines;  // parameters: name and value

  // engine; flags are "true" or "false"
  std::optional<std::string> limb_darkening;   // 0 to 1
  std::optional<std::string> engine;           // "gl" or "reference"
  std::optional<std::string> quality;          // "draft", "standard" or "exact"
  std::optional<std::string> samples;          // "auto" or N
  std::optional<std::string> pixel_error;      // share
  std::optional<std::string> adaptive;         // flag
  std::optional<std::string> flat;             // flag
  std::optional<std::string> specular_filter;  // "auto" or "off"
  std::optional<std::string> shadows;          // "auto", "off", "hard" or "soft"
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
  std::optional<std::string> no_sun_disc;       // flag
  std::optional<std::string> max_image_memory;  // bytes, as "2GB"

  bool field_of_view = false;  // intrinsics stand for one, of an image of `size`

  std::string name;   // given by its author
  std::string label;  // name in diagnostics, as "view 3 ('far')"; empty: options of a command
  std::string file;   // views file of origin; empty: none
};

// Reads a views file (docs/views.md): a JSON list of objects whose members are those of
// schemas/views.toml, with '-' or '_' between words. Missing members are taken from `defaults`, as
// by with_defaults().
//
//   returns  one view or more, each with an output
// Fails: E0101…E0104, E0203.
Result<std::vector<ViewText>> read_views(const std::filesystem::path& path,
                                         const ViewText& defaults, DiagnosticLog& log);

// The same for a text in memory; `name` is its name in diagnostics.
Result<std::vector<ViewText>> parse_views(std::string_view text, const std::string& name,
                                          const ViewText& defaults, DiagnosticLog& log);

// Parses one view, an object, as a line of a stream.
//
//   index  its number in the stream
//   view   its readable part; name and label in any case
// False: E0203.
bool parse_view(std::string_view text, std::size_t index, const ViewText& defaults, ViewText& view,
                DiagnosticLog& log);

// Parses the size of an image, as "640x480" or "512": width and height, each 1 to 16384.
std::optional<std::pair<std::uint32_t, std::uint32_t>> image_size(std::string_view size);

// Reports invalid values of a view, as far as possible without its targets: E0201 (of a views file:
// E0203), E0202.
void check_values(const ViewText& text, DiagnosticLog& log);

// Limit of bytes in one line of a stream of views.
constexpr std::size_t kMaxViewLine = std::size_t{1} << 20;

// Returns a view completed by defaults. Of alternative members, of poses of one target and of
// values of one parameter, the view's replace the default's.
ViewText with_defaults(ViewText view, const ViewText& defaults);

// Returns the options of drawing a view. Fails: E0201 (of a views file: E0203); E0201 too for an
// option of the other engine.
Result<DrawOptions> draw_options(const ViewText& text, preview::ContextKind context,
                                 DiagnosticLog& log);

// Maker of views of one world from texts. Without a lens, the visible targets fill the image,
// by their outline if the camera is not given either, else by their sphere.
// Without a position, the camera is in front of them; without a direction, it looks at the origin
// if a position is given, else at their centre; without a Sun, it shines from behind the camera's
// left shoulder.
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
