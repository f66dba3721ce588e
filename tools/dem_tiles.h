// Terrain tiles in the command dem, and in check.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "terrain/dem.h"
#include "tools/command_context.h"

namespace panwright::tools {

// Writes elevation files as terrain of a pan file, and shows what it holds. error: metres, 0 exact.
void write_terrain(const std::vector<std::string>& files, const terrain::DemOptions& reading,
                   const std::string& output, double error, CommandContext& context);

// Questions to terrain, each as numbers or a file of rows.
struct TerrainQuestions {
  std::vector<std::string> places;  // "LAT LON [ABOVE]"
  std::vector<std::string> sights;  // "LAT LON ABOVE LAT LON ABOVE"
  std::vector<std::string> ranges;  // "LAT LON ABOVE AZ EL"
  Vec2 light{0};                    // azimuth and elevation, radians, of a Sun at the places
  bool any() const { return !places.empty() || !sights.empty() || !ranges.empty(); }
};

// Shows the terrain of a pan file, with questions their answers.
void show_terrain(const std::string& file, const TerrainQuestions& questions,
                  CommandContext& context);

// Reports the damaged tiles of a pan file, if it has terrain. Fails: E9610, E9611.
void check_terrain(const std::string& file, DiagnosticLog& log, const Job& job);

}  // namespace panwright::tools
