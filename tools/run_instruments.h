// Instruments of a scenario: what they measure of the frames of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "instruments/lidar.h"
#include "instruments/radar.h"
#include "tools/command_context.h"
#include "workspace/scenario.h"
#include "workspace/session.h"

namespace panwright::tools {

class RunInstruments {
 public:
  // Expects: scenario and context outlive it.
  RunInstruments(const workspace::Scenario& scenario, CommandContext& context)
      : scenario_(scenario), context_(context), log_(context.log()) {}

  // Reads the instruments' files. Fails: as their readers; E0201, E5011 for names of no target.
  bool open(const world::World& world);

  bool any() const { return !all_.empty(); }
  // Names of the files of a frame, by the stem of its files.
  std::vector<std::string> outputs_of(const std::string& stem) const;
  // Returns whether all of them are in a folder, and whole as far as their headers tell.
  bool has_frame(const std::filesystem::path& folder, const std::string& stem) const;
  // All that decides what is measured, for run.json.
  nlohmann::ordered_json settings() const;

  // Returns true if the sources cover what the instruments measure after the time of a frame.
  bool is_covered(double time) const;

  // Measures a frame and writes the files.
  //
  //   number  of the frame, which chooses the noise
  // Expects: open(). Fails: E0001, E0103; as frames of the scenario.
  bool measure(workspace::ViewSession& session, const world::World& world, double time,
               std::uint64_t number, const std::filesystem::path& folder, const std::string& stem);

 private:
  struct One {
    const workspace::ScenarioInstrument* what = nullptr;
    std::string text;    // of its file
    std::string pulses;  // hash of a table of pulses; empty: none
    std::int32_t frame_of = instruments::LidarOptions::kInstrument;
    instruments::Lidar lidar;
    instruments::Radar radar;
    double span = 0;  // seconds from the first pulse to the last, or of the dwell
  };
  struct Moment;
  class Clock;

  bool open_one(const workspace::ScenarioInstrument& what, const world::World& world);
  bool measure_lidar(const One& one, Clock& clock, std::uint64_t seed, std::uint32_t frame,
                     const std::vector<std::string>& outputs, DiagnosticLog& log);
  bool measure_radar(const One& one, Clock& clock, std::uint64_t seed, std::uint32_t frame,
                     const std::vector<std::string>& outputs, DiagnosticLog& log);
  void wrote(const std::vector<std::string>& outputs, nlohmann::ordered_json facts,
             const std::string& words);
  bool moves() const { return !scenario_.sequence.ordered(); }

  const workspace::Scenario& scenario_;
  CommandContext& context_;
  DiagnosticLog& log_;
  std::vector<One> all_;
  bool warned_ = false;  // by the first frame that is measured
};

}  // namespace panwright::tools
