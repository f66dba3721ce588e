// Scenario that the window plays: its frames, and the tracks of what moves.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "workspace/frame.h"
#include "workspace/scenario.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::studio {

// Positions of the camera or of a target over the frames.
struct Track {
  std::string target;                  // its name; empty: the camera
  std::vector<std::uint64_t> numbers;  // of frames, ascending
  std::vector<Vec3> points;            // at these, world, metres
};

struct Play {
  std::string file;
  workspace::Scenario scenario;
  std::vector<double> times;         // of all frames, or their numbers in an order
  std::vector<std::string> targets;  // NAME=FILE: of the scenario, and those given beside it
  std::vector<Track> tracks;         // the camera's, and those of targets that move

  // True: Moment leaves out something of the scenario's settings.
  bool is_reduced() const;
};

// Opens a scenario, or a trajectory alone.
//
//   owner   of a trajectory alone: a target's name; empty: the camera
//   models  NAME=FILE: in place of the scenario's targets of the same names, or beside them
//   camera  file in place of the scenario's camera; empty: its own
// Fails: as workspace::open_scenario() and frame_times(); E8013 without a model.
Result<Play> open_play(const std::string& file, const std::string& owner,
                       const std::vector<std::string>& models, const std::string& camera,
                       DiagnosticLog& log);

// A frame as the window shows it: at one time, where an exposure would blur it, and by OpenGL. A
// detector is exposed as long as in the scenario.
struct Moment {
  std::uint64_t number = 0;  // from 0
  double time = 0;           // seconds; of frames with an order alone: their number
  std::string date;          // as "2026-01-01T00:00:00 UTC"; empty: the scenario has none
  workspace::View view;
  workspace::Frame frame;  // of the view
};

// Fails: as workspace::frame_at(), view_of() and FrameMaker. Expects: number < play.times.size().
Result<std::shared_ptr<const Moment>> moment_of(const Play& play, std::uint64_t number,
                                                const world::World& world,
                                                workspace::FrameMaker& maker, DiagnosticLog& log);

// Finds the tracks, of at most 2001 frames, and so checks these. Fails: as moment_of().
bool find_tracks(Play& play, const world::World& world, DiagnosticLog& log);

}  // namespace panwright::studio
