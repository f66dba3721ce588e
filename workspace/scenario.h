// Scenarios: frames over time from trajectory files, as views of a run. Syntax: docs/scenarios.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "scenario/sequence.h"
#include "workspace/labelling.h"
#include "workspace/scenario_instrument.h"
#include "workspace/views.h"

namespace panwright::workspace {

struct ScenarioOptions {
  std::string target;   // owner of a trajectory file that is opened alone; empty: the camera
  bool strict = false;  // deviations and unknown members are errors
};

// Times of frames.
struct FrameChoice {
  std::vector<double> at;       // seconds; empty: all
  std::optional<double> every;  // seconds between frames, > 0; none: those of the scenario
  // Of these, by order from 0, the first and the last; ~0: to the end.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> numbers;
};

inline constexpr std::size_t kMostFrames = 10'000'000;

struct Scenario {
  scenario::Sequence sequence;
  Settings settings;                 // of every frame, as a view has them
  std::optional<double> begin, end;  // seconds; none: those of the sequence
  std::optional<double> step;        // seconds between frames; none: frames of the sequence
  std::vector<std::string> files;    // files it was read from, itself first
  std::optional<Labelling> labels;   // of every frame; none: not asked for
  std::vector<ScenarioInstrument> instruments;
};

// Returns whether a file is one for open_scenario(), by its extension or its first word.
bool is_scenario(const std::filesystem::path& path);

// Opens a scenario (.toml), or one trajectory file alone: .csv, .fli, .json (keyframes), .oem, .aem
// and other texts by their content. Files in it are relative to its folder.
//
// Fails: E0101, E0102, E0104, E8001…E8009 (E8003 for a begin or end that its sources do not cover),
// E8013 for an invalid scenario.
Result<Scenario> open_scenario(const std::filesystem::path& path, const ScenarioOptions& options,
                               DiagnosticLog& log);

// Returns the chosen times, seconds since the epoch; of a sequence that has an order alone, numbers
// of frames.
//
// Fails: E0201 for a choice that has no frame, or over kMostFrames.
Result<std::vector<double>> frame_times(const Scenario& scenario, const FrameChoice& choice,
                                        DiagnosticLog& log);

// Returns a frame at one of these times. Fails: as scenario::Sequence::at().
Result<scenario::Frame> frame_at(const Scenario& scenario, double time, DiagnosticLog& log);

// Warns of what holds for every frame: W8019 for stars in axes that turn with an unknown orbit.
void check_stars(const Scenario& scenario, DiagnosticLog& log);

// Returns the view of a frame: the settings of the scenario, with the frame's own in their place:
// also its date, and the orbit of the origin.
//
//   number  of the frame, for its label
//   world   of the scenario's targets, which knows the kinds of their joints
// Expects: scenario and world outlive the view.
// Fails: E5013; E8009 for an orbit that contradicts the sources' origin or axes.
Result<View> view_of(const Scenario& scenario, const scenario::Frame& frame, std::size_t number,
                     const world::World& world, DiagnosticLog& log);

}  // namespace panwright::workspace
