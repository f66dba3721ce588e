#include "tools/radar_json.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "workspace/record.h"

namespace panwright::tools {

using Json = nlohmann::ordered_json;

Json radar_json(const instruments::Radar& radar, const instruments::RadarHistogram& found) {
  Json out;
  out["radar"] = radar.name;
  out["ranges"] = {
      {"count", found.ranges}, {"first_m", found.first_range}, {"step_m", found.range_step}};
  out["speeds"] = {
      {"count", found.speeds}, {"first_m_s", found.first_speed}, {"step_m_s", found.speed_step}};
  out["gain"] = found.gain;
  out["echo_power_w"] = found.echo_power;
  out["outside"] = found.outside;
  out["noise_w"] = found.noise;
  out["response_sum"] = found.response_sum;
  out["rays"] = found.rays;
  out["hits"] = found.hits;
  out["ray_spacing_rad"] = found.spacing;
  Json& targets = out["targets"] = Json::array();
  for (const auto& each : found.targets) {
    Json& target =
        targets.emplace_back(Json{{"name", each.name}, {"cross_section_m2", each.cross_section}});
    if (std::isnan(each.range)) continue;
    target["range_m"] = each.range;
    target["speed_m_s"] = each.speed;
  }
  if (found.altitude) out["altitude_m"] = *found.altitude;
  return out;
}

std::string radar_record(std::string_view command, const std::string& file,
                         const instruments::RadarOptions& how, const Json& facts) {
  Json record{{"program", workspace::recorded_program()},
              {"command", command},
              {"radar_file", std::filesystem::path(file).filename().string()},
              {"ideal", how.ideal},
              {"noise_seed", how.seed},
              {"frame_number", how.frame}};
  for (const char* name : {"radar", "ranges", "speeds", "gain", "echo_power_w", "outside",
                           "noise_w", "response_sum", "targets", "altitude_m"})
    if (facts.contains(name)) record[name] = facts[name];
  return record.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace panwright::tools
