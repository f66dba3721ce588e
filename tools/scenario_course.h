// Courses of targets over the frames of a scenario: what `panwright scenario` prints and plots.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/job.h"
#include "tools/plot.h"
#include "workspace/frame.h"
#include "workspace/scenario.h"
#include "workspace/views.h"

namespace panwright::tools {

// Of a target over the frames: time and value. Those of models are empty without.
struct Course {
  std::string name;
  PlotPoints range;     // metres from the camera
  PlotPoints phase;     // degrees between the Sun and the camera as the target has them
  PlotPoints pixels;    // of its convex outline in the image
  PlotPoints in_image;  // share of that outline in the image
  PlotPoints sun;       // share of the Sun's disc that bodies of the sky leave its centre
};

// Adds a frame to the courses of its targets; of a frame without targets to that of the origin.
void add(const scenario::Frame& frame, double time, std::vector<Course>& courses);

// Models of a scenario as its camera sees them.
class SeenTargets {
 public:
  // Expects: a scenario with targets, which outlives the result. Fails: as open_world().
  static Result<SeenTargets> of(const workspace::Scenario& scenario, DiagnosticLog& log,
                                const Job& job);
  // Finds the mistakes of a frame that its models show: names of targets and joints, values. False:
  // as workspace::view_of(), FrameMaker::frame().
  bool check(const scenario::Frame& frame, std::uint64_t number, DiagnosticLog& log);
  // Adds the image of a frame to the courses. False: as FrameMaker::frame().
  bool add(const scenario::Frame& frame, std::uint64_t number, double time,
           std::vector<Course>& courses, DiagnosticLog& log);

 private:
  SeenTargets(const workspace::Scenario& scenario, world::World world);
  const workspace::Scenario* scenario_;
  std::unique_ptr<const world::World> world_;
  std::unique_ptr<workspace::FrameMaker> maker_;
  world::World shown_;
  std::map<world::Stamp, std::vector<Vec3>> points_;  // extreme ones, by shape stamp
};

}  // namespace panwright::tools
