#include "workspace/orbit_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "base/diagnostic.h"
#include "base/text.h"
#include "workspace/quantities.h"

namespace panwright::workspace {
namespace {

using scenario::Orbit;

constexpr std::string_view kKeys[] = {"a", "e",     "i",     "raan", "aop", "nu",
                                      "r", "about", "epoch", "axes", "v"};
constexpr std::string_view kOrbitExample =
    "a semi-major axis a= with e=, i=, raan=, aop= and nu=, or a state r=X Y Z v=VX VY VZ, or "
    "earth "
    "or moon";

// A bare number is m/s.
std::optional<double> parse_speed(std::string_view text) {
  double scale = 1;
  for (const auto& [unit, metres] : {std::pair<std::string_view, double>("km/s", 1000), {"m/s", 1}})
    if (text.ends_with(unit)) {
      text.remove_suffix(unit.size());
      scale = metres;
      break;
    }
  const auto number = parse_double(text);
  return number ? std::optional(scale * *number) : std::nullopt;
}

using Words = std::map<std::string_view, std::vector<std::string_view>>;

std::string split(std::string_view text, Words& out) {
  std::vector<std::string_view>* values = nullptr;
  for (const std::string_view word : words_of(text)) {
    const std::size_t sign = word.find('=');
    if (sign == word.npos) {
      if (values == nullptr) return std::string(kOrbitExample);
      values->push_back(word);
      continue;
    }
    const std::string_view key = word.substr(0, sign);
    if (std::ranges::find(kKeys, key) == std::end(kKeys)) {
      const auto near = nearest_name(key, kKeys);
      return fmt::format(
          "a=, e=, i=, raan=, aop=, nu=, r=, v=, about=, epoch= or axes= instead of "
          "{}{}",
          in_quotes(std::string(key) + "="),
          near ? fmt::format("; did you mean '{}='?", *near) : "");
    }
    if (out.contains(key)) return fmt::format("{}= once", key);
    values = &out[key];
    if (sign + 1 < word.size()) values->push_back(word.substr(sign + 1));
  }
  return {};
}

template <class Parse>
std::string one(const Words& words, std::string_view key, std::string_view what, const Parse& parse,
                double& out) {
  const auto found = words.find(key);
  if (found == words.end()) return {};
  const auto number = found->second.size() == 1 ? parse(found->second[0]) : std::nullopt;
  if (!number || !std::isfinite(*number)) return fmt::format("{}= with {}", key, what);
  out = *number;
  return {};
}

template <class Parse>
std::string three(const Words& words, std::string_view key, std::string_view what,
                  const Parse& parse, Vec3& out) {
  const auto found = words.find(key);
  if (found == words.end() || found->second.size() != 3)
    return fmt::format("{}= with three {}", key, what);
  for (int k = 0; k < 3; ++k) {
    const auto number = parse(found->second[static_cast<std::size_t>(k)]);
    if (!number || !std::isfinite(*number)) return fmt::format("{}= with three {}", key, what);
    out[k] = *number;
  }
  return {};
}

std::string read_elements(const Words& words, Orbit& out) {
  scenario::OrbitElements elements;
  constexpr std::string_view kAngle = "an angle, bare numbers are degrees";
  std::string wrong = one(words, "a", "a length, as 6778km", parse_length, elements.semi_major);
  const auto next = [&](std::string found) {
    if (wrong.empty()) wrong = std::move(found);
  };
  next(one(words, "e", "a number", parse_double, elements.eccentricity));
  next(one(words, "i", kAngle, parse_angle, elements.inclination));
  next(one(words, "raan", kAngle, parse_angle, elements.node));
  next(one(words, "aop", kAngle, parse_angle, elements.periapsis));
  next(one(words, "nu", kAngle, parse_angle, elements.true_anomaly));
  if (!wrong.empty()) return wrong;
  const auto state = scenario::state_of(elements, scenario::gravity_of(out.about));
  if (!state)
    return "elements of an orbit: e= from 0, below 1 with a= above 0, above 1 with a= below 0";
  out.start = *state;
  return {};
}

std::string read_state(const Words& words, Orbit& out) {
  std::string wrong =
      three(words, "r", "lengths, as r=6778km 0 0", parse_length, out.start.position);
  if (wrong.empty())
    wrong = three(words, "v", "speeds, as v=0 4.7km/s 6km/s", parse_speed, out.start.velocity);
  if (!wrong.empty()) return wrong;
  const double size = glm::length(out.start.position) * glm::length(out.start.velocity);
  if (!(glm::length(glm::cross(out.start.position, out.start.velocity)) > 1e-9 * size))
    return "a velocity across the position";
  return {};
}

std::string word_of(const Words& words, std::string_view key) {
  const auto found = words.find(key);
  if (found == words.end()) return {};
  return found->second.size() == 1 ? std::string(found->second[0]) : std::string("?");
}

std::string read_others(const Words& words, Orbit& out) {
  const std::string about = word_of(words, "about"), axes = word_of(words, "axes"),
                    epoch = word_of(words, "epoch");
  if (!about.empty() && about != "earth" && about != "moon") return "about=earth or about=moon";
  if (about == "moon") out.about = scenario::Centre::moon;
  if (!axes.empty() && axes != "j2000" && axes != "rtn") return "axes=j2000 or axes=rtn";
  if (axes == "rtn") out.axes = scenario::WorldAxes::rtn;
  if (epoch.empty()) return {};
  std::string problem;
  out.epoch = scenario::parse_epoch(epoch, scenario::TimeSystem::utc, problem);
  return out.epoch ? std::string() : "epoch= with a date in UTC, as 2026-01-01T12:00:00";
}

}  // namespace

std::string read_orbit(std::string_view text, Orbit& out) {
  out = {};
  if (text == "earth" || text == "moon") {
    out.at_centre = true;
    out.about = text == "moon" ? scenario::Centre::moon : scenario::Centre::earth;
    return {};
  }
  Words words;
  std::string wrong = split(text, words);
  if (wrong.empty()) wrong = read_others(words, out);
  if (!wrong.empty()) return wrong;
  const bool elements = words.contains("a");
  const bool state = words.contains("r") || words.contains("v");
  if (elements == state) return std::string(kOrbitExample);
  for (const char* key : {"e", "i", "raan", "aop", "nu"})
    if (state && words.contains(key)) return fmt::format("{}= beside a=, or r= and v= alone", key);
  wrong = elements ? read_elements(words, out) : read_state(words, out);
  if (!wrong.empty()) return wrong;
  const double distance = glm::length(out.start.position);
  if (!(distance > scenario::least_radius(out.about)))
    return fmt::format(
        "a place outside the {}, found one at {:.6g} km from its centre (bare "
        "lengths are metres, and not heights)",
        out.about == scenario::Centre::earth ? "Earth" : "Moon", distance / 1000);
  return {};
}

std::string completed_orbit(std::string_view text, const scenario::Epoch& epoch,
                            std::string_view axes) {
  std::string out(text);
  if (text.find("epoch=") == text.npos)
    out += " epoch=" + scenario::epoch_text(epoch, scenario::TimeSystem::utc);
  if (text.find("axes=") == text.npos) out += fmt::format(" axes={}", axes);
  return out;
}

}  // namespace panwright::workspace
