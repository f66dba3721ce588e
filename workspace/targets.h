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

// A file and the name of its target.
struct TargetFile {
  std::string name;
  std::filesystem::path file;
};

// "NAME=FILE", or "FILE", whose name without folder and extension is the target's. A file that is
// there under the whole text is taken as it is, '=' and all.
TargetFile target_file(std::string_view text);

// Opens files as the targets of a world, in order, each at the origin. A file that is given several
// times is opened once, and its model shared.
//
// Fails: E5009 for two targets of one name, before anything is opened; E5010; E5030 for none; what
// open() fails with.
Result<world::World> open_world(std::span<const TargetFile> targets, const OpenOptions& options,
                                DiagnosticLog& log, const Job& job = {},
                                OpenReport* report = nullptr);

// A bounding sphere, world axes, metres.
struct BoundingSphere {
  Vec3 centre{0};
  double radius = 1;
};

// Bounding spheres of targets, each computed once for the state of its nodes.
class BoundingSpheres {
 public:
  // About the centre of the bounds of a target as it is posed; of a target of which nothing is
  // visible, of radius 1 about its origin. Cost: O(vertices) the first time.
  BoundingSphere of(const world::Instance& target);
  // Around all visible targets; one alone: of(). Without any: about the origin.
  BoundingSphere of(const world::World& world);

 private:
  struct Known {
    world::Stamp stamp = 0;
    std::optional<BoundingSphere> sphere;  // in the model's frame
  };
  std::vector<Known> known_;  // by shape stamp
};

}  // namespace panwright::workspace
