// Measurements of RADARs as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "instruments/radar.h"

namespace panwright::tools {

// Returns one object, as `panwright radar --json` has it.
nlohmann::ordered_json radar_json(const instruments::Radar& radar,
                                  const instruments::RadarHistogram& found);

// Returns the record that files of a histogram hold, JSON in ASCII.
//
//   facts  of radar_json()
std::string radar_record(std::string_view command, const std::string& file,
                         const instruments::RadarOptions& how, const nlohmann::ordered_json& facts);

}  // namespace panwright::tools
