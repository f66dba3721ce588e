// Views: a camera, the Sun and poses of targets, from the text of a command line or a
// views file. Syntax: docs/conventions.md 2–7.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "workspace/targets.h"
#include "world/world.h"

namespace panwright::workspace {

// ---- views

struct TargetPose {
  std::string target;  // its name
  world::Pose pose;    // world_from_model
};

// One image to render.
struct View {
  world::Camera camera;
  std::optional<world::Sun> sun;  // none: the world's
  std::vector<TargetPose> poses;  // of targets that differ from the world; later ones replace
                                  // earlier ones
  std::string output;             // .png, .exr, .npy or .npz
  double ev = 0;                  // stops, of a PNG
  bool auto_ev = false;           // found from the image: workspace/exposure.h
};

// ---- as text

struct PoseText {
  std::string target;  // its name; empty: the only one
  std::string value;   // "x y z w i j k"
};

// "NAME=x y z w i j k", or "x y z w i j k".
PoseText pose_text(std::string_view text);

// One view as typed; what is absent is found by make_view().
struct ViewText {
  std::optional<std::string> camera;          // "x y z" metres
  std::optional<std::string> look_at;         // "x y z"
  std::optional<std::string> up;              // "x y z"
  std::optional<std::string> quat;            // "w x y z", world_from_camera
  std::vector<PoseText> poses;                // world_from_model; later ones replace earlier ones
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
};

// Reads a views file: a JSON list of objects whose members are those of ViewText, with '-' or '_'
// between words; "pose" is a text, a list of 7 numbers, or an object of these by target. What a
// view leaves out is taken from `defaults`; of alternative members, and of poses of one target, the
// view's replace the default's.
//
//   returns  one view or more, each with an output
// Fails: E0101…E0104, E0203.
Result<std::vector<ViewText>> read_views(const std::filesystem::path& path,
                                         const ViewText& defaults, DiagnosticLog& log);

// Makes views of one world from texts. Without a lens, the visible targets fill the image; without
// a camera, it stands in front of them; without a direction, it looks at the origin where a
// position is given, else at their centre; without a Sun, it shines from behind the
// camera's left shoulder.
class ViewMaker {
 public:
  // Expects: world outlives the maker.
  explicit ViewMaker(const world::World& world) : world_(world) {}

  // Reports: N5004. Fails: E0201, E5005, E5011.
  Result<View> view(const ViewText& text, DiagnosticLog& log);

 private:
  const world::World& world_;
  BoundingSpheres spheres_;
};

// ---- numbers as typed

// Numbers separated by blanks or commas; nothing when the text is something else or the number of
// numbers is not `count`.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);

// An angle in radians: a bare number is degrees; deg, rad, mrad, urad, arcmin and arcsec may follow
// it.
std::optional<double> parse_angle(std::string_view text);

// A share: "0.1%" or "0.001".
std::optional<double> parse_share(std::string_view text);

}  // namespace panwright::workspace
