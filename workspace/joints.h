// Joint values as text: of options, views files and files of joints.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "world/world.h"

namespace panwright::workspace {

// Value of a joint. A bare number is degrees, metres or a factor, by the joint's kind; units may
// follow it: deg, rad, mrad, urad, arcmin, arcsec; m, mm, cm, dm, km, um, in, ft; %. Joints of
// several values take as many, separated by blanks or commas.
//
// "@sun", "@camera", "@NAME" (another target's origin) and "@X Y Z" (a direction in world axes) aim
// its pointing direction instead.
struct JointText {
  std::string joint;  // "JOINT" of the only target with it, or "TARGET/JOINT"
  std::string value;
  bool operator==(const JointText&) const = default;
};

// Parses "JOINT=VALUE".
JointText joint_text(std::string_view text);

// Reads a file of joints: one JSON object of values by name, texts or numbers or lists of numbers.
//
// Fails: E0101, E0102, E0104, E0203.
Result<std::vector<JointText>> read_joints(const std::filesystem::path& path, DiagnosticLog& log);

// Place of a joint.
struct JointPlace {
  std::size_t target = 0;
  std::uint32_t joint = 0;
};
// Fails: E5013 with near names.
Result<JointPlace> find_joint(std::string_view name, const world::World& world, DiagnosticLog& log);

// Setter of joints of a world, in order: later values replace earlier ones. Values first; then
// aims, once set_aims() is called, as they depend on the Sun and the camera.
//
// Fails: E0201 for an invalid value, E5013, E5014.
class JointSetter {
 public:
  explicit JointSetter(world::World& world) : world_(world) {}
  bool set(const JointText& text, DiagnosticLog& log);
  // Sets aims, and every joint that tracks the Sun. camera: its position; none: aims at it fail
  // (E5014). Reports: W5015.
  bool set_aims(const std::optional<Vec3>& camera, DiagnosticLog& log);

 private:
  struct Aim {
    JointPlace place;
    JointText text;
  };
  bool aim(const Aim& aim, const std::optional<Vec3>& camera, DiagnosticLog& log);

  world::World& world_;
  std::vector<Aim> aims_;
};

// Returns a value with its unit that reads back to the same bits: "0.5rad", "0.25m", "2".
std::string exact_value(geometry::JointKind kind, const geometry::JointValues& values);
// The same for people: "28.6479 deg".
std::string shown_value(geometry::JointKind kind, const geometry::JointValues& values);

}  // namespace panwright::workspace
