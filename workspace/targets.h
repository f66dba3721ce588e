// Worlds of files: targets by their names in options, views and ground truth.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "workspace/open.h"
#include "world/world.h"

namespace panwright::workspace {

// File and the name of its target.
struct TargetFile {
  std::string name;
  std::filesystem::path file;
};

// Parses "NAME=FILE", or "FILE", whose name without folder and extension is the target's. An
// existing file of the whole text takes precedence, '=' included.
TargetFile target_file(std::string_view text);

// Opens files as the targets of a world, in order, each at the origin. Repeated files are opened
// once and share their model.
//
// Fails: E5009 for two targets of one name, before anything is opened; E5010; E5030 for none; the
// codes of open().
Result<world::World> open_world(std::span<const TargetFile> targets, const OpenOptions& options,
                                DiagnosticLog& log, const Job& job = {},
                                OpenReport* report = nullptr);

// Says that something leaves out the terrain of a world, if there is any: "a glTF file
// leaves out the terrain of 'moon'". Reports: W9620.
void warn_of_terrain(const world::World& world, std::string_view what, DiagnosticLog& log);

// Bounding sphere, world axes, metres.
struct BoundingSphere {
  Vec3 centre{0};
  double radius = 1;
  Vec3 up{0, 0, 1};     // the vertical of ground there, else z
  bool ground = false;  // of ground alone, less than a body
};

// Unit vector of a direction to the east, the north and up, of any length; where the vertical is z,
// east is x.
Vec3 from_local(const Vec3& up, const Vec3& direction);

// Rectangle of directions from a camera: x/z and y/z in its frame.
struct Outline {
  Vec2 low{0}, high{0};
};
// Returns the rectangle around all visible vertices; nothing: there are none, or one is not in
// front of the camera. Cost: O(vertices).
std::optional<Outline> outline(const world::World& world, const world::Camera& camera);

// Bounding spheres of targets, each computed once for the state of its nodes.
class BoundingSpheres {
 public:
  // Returns the sphere about the centre of the bounds of a posed target, its terrain left out where
  // there are meshes; for a fully hidden one, of radius 1 about its origin. Cost: O(vertices) the
  // first time.
  BoundingSphere of(const world::Instance& target);
  // Returns the sphere around all visible targets, terrain left out beside others; one alone: of().
  // Without any: about the origin.
  BoundingSphere of(const world::World& world);

 private:
  struct Known {
    world::Stamp stamp = 0;
    std::optional<BoundingSphere> sphere;  // in the model's frame
  };
  std::vector<Known> known_;  // by shape stamp
};

// Says what keeps targets on terrain dark or out of view: targets inside a body, and without lamps
// a Sun below their horizon. Reports: W5022, N5023.
void warn_of_ground(const world::World& world, bool has_lamps, BoundingSpheres& spheres,
                    DiagnosticLog& log);

}  // namespace panwright::workspace
