#include "workspace/sky_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>

#include "base/text.h"
#include "scenario/time.h"
#include "sky/star_catalogue.h"
#include "workspace/internal/planet_maps.h"
#include "workspace/quantities.h"

namespace panwright::workspace {

namespace {

constexpr std::string_view kFileKeys[] = {"map=", "clouds=", "night="};
constexpr std::string_view kExpected =
    "a position x y z, with or without units, then if need be a quaternion w x y z and radius=, "
    "albedo=, law=, air=, and last map=, clouds= or night=";

struct PlanetText {
  light::Body body;
  PlanetFiles files;
  std::optional<bool> air;
};

struct Word {
  std::string_view key;  // empty: of the position
  std::vector<std::string_view> values;
};

// Where the next key of a file begins, at the begin of a word.
std::size_t next_file(std::string_view text, std::size_t from) {
  std::size_t first = text.size();
  for (const std::string_view key : kFileKeys)
    for (std::size_t at = text.find(key, from); at < first; at = text.find(key, at + 1))
      if (at == 0 || text[at - 1] == ' ' || text[at - 1] == ',') first = at;
  return first;
}

// "X Y Z [QW QX QY QZ] key=value…"; keys of files come last, and take the text up to the next one.
std::vector<Word> words_by_key(std::string_view text, PlanetText& out, bool& empty_file) {
  const std::size_t end = next_file(text, 0);
  std::string* const files[] = {&out.files.map, &out.files.clouds, &out.files.night};
  for (std::size_t at = end; at < text.size();) {
    const std::size_t next = next_file(text, at + 1);
    const std::string_view part = text.substr(at, next - at);
    for (std::size_t k = 0; k < std::size(kFileKeys); ++k)
      if (part.starts_with(kFileKeys[k])) {
        std::string_view name = part.substr(kFileKeys[k].size());
        while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
        *files[k] = name;
        empty_file |= name.empty();
      }
    at = next;
  }
  text = text.substr(0, end);
  std::vector<Word> words = {{}};
  for (const std::string_view word : words_of(text)) {
    const std::size_t sign = word.find('=');
    if (sign != word.npos) {
      words.push_back({word.substr(0, sign), {}});
      if (sign + 1 < word.size()) words.back().values.push_back(word.substr(sign + 1));
    } else {
      words.back().values.push_back(word);
    }
  }
  return words;
}

// One number or `count`.
std::optional<std::vector<double>> numbers(std::span<const std::string_view> words,
                                           std::size_t count, bool lengths) {
  if (words.size() != 1 && words.size() != count) return std::nullopt;
  std::vector<double> out;
  for (const std::string_view word : words) {
    const auto number = lengths ? parse_length(word) : parse_double(word);
    if (!number) return std::nullopt;
    out.push_back(*number);
  }
  out.resize(count, out[0]);
  return out;
}

std::string set_place(std::span<const std::string_view> words, light::Body& body) {
  if (words.size() != 3 && words.size() != 7) return std::string(kExpected);
  const auto place = numbers(words.first(3), 3, true);
  if (!place) return std::string(kExpected);
  body.centre = Vec3((*place)[0], (*place)[1], (*place)[2]);
  if (words.size() == 3) return {};
  const auto turn = numbers(words.subspan(3), 4, false);
  if (!turn) return std::string(kExpected);
  const auto unit = unit_quaternion({(*turn)[0], (*turn)[1], (*turn)[2], (*turn)[3]});
  if (!unit) return "a unit quaternion w x y z";
  body.world_from_body = *unit;
  return {};
}

std::string set_law(std::span<const std::string_view> words, light::Body& body) {
  constexpr std::array<std::string_view, 5> kLaws = {"lambert", "lommel-seeliger", "lunar-lambert",
                                                     "hapke", "rolo"};
  const auto found = std::ranges::find(kLaws, words.empty() ? std::string_view() : words[0]);
  const std::size_t law = static_cast<std::size_t>(found - kLaws.begin());
  if (law == kLaws.size() || (law != 3 && words.size() > 1))
    return "law=lambert, lommel-seeliger, lunar-lambert, rolo or hapke";
  body.photometry = {};
  body.photometry.law = law == 4 ? light::Law::lunar_lambert : static_cast<light::Law>(law);
  body.photometry.rolo = law == 4;
  if (words.size() == 1) return {};
  const auto values = numbers(words.subspan(1), 4, false);
  if (words.size() != 5 || !values)
    return "law=hapke and its single scattering albedo, asymmetry, surge and width of the surge";
  body.photometry.single_scattering = (*values)[0];
  body.photometry.asymmetry = (*values)[1];
  body.photometry.surge = (*values)[2];
  body.photometry.surge_width = (*values)[3];
  return {};
}

std::string set_air(std::span<const std::string_view> words, std::optional<bool>& air) {
  const std::string_view name = words.size() == 1 ? words[0] : std::string_view();
  if (name != "earth" && name != "none") return "air=earth or none";
  air = name == "earth";
  return {};
}

std::string set_member(const Word& word, PlanetText& out, bool& sized) {
  light::Body& body = out.body;
  if (word.key == "law") return set_law(word.values, body);
  if (word.key == "air") return set_air(word.values, out.air);
  if (word.key != "radius" && word.key != "albedo")
    return fmt::format("radius=, albedo=, law=, air=, map=, clouds= or night= instead of {}",
                       in_quotes(std::string(word.key) + "="));
  const auto values = numbers(word.values, 3, word.key == "radius");
  if (!values) return fmt::format("{}= with one number or three", word.key);
  const Vec3 three((*values)[0], (*values)[1], (*values)[2]);
  if (word.key == "albedo") {
    if (!(std::min({three.x, three.y, three.z}) >= 0 && max_component(three) <= 100))
      return "albedo= from 0 to 100";
    body.albedo = three;
    return {};
  }
  if (!(std::min({three.x, three.y, three.z}) > 0)) return "radius= above 0";
  body.radii = three;
  sized = true;
  return {};
}

// Returns what is expected instead; empty: it is read.
std::string read_planet(const std::string& name, std::string_view text, PlanetText& out) {
  if (name.empty()) return "NAME=\"X Y Z\", with the name of a body";
  const auto preset = light::body_preset(name);
  if (preset) out.body = *preset;
  out.body.name = name;
  bool sized = preset.has_value();
  bool empty_file = false;
  const std::vector<Word> words = words_by_key(text, out, empty_file);
  if (std::string wrong = set_place(words[0].values, out.body); !wrong.empty()) return wrong;
  for (std::size_t i = 1; i < words.size(); ++i)
    if (std::string wrong = set_member(words[i], out, sized); !wrong.empty()) return wrong;
  if (empty_file) return "map=, clouds= and night= with a file";
  if (!sized) return "radius=, since only earth and moon have one of their own";
  const Vec3& radii = out.body.radii;
  const bool suits = out.body.photometry == light::Photometry() &&
                     std::min({radii.x, radii.y, radii.z}) >= light::Air::kLeastRadius;
  out.body.air = out.air.value_or(out.body.air && suits);
  if (out.body.air && !suits) return "air=earth with law=lambert and a radius= of 1,000 km or more";
  if (!light::is_sound(out.body))
    return "finite numbers, semi-axes within 1:100, parameters of a law within their range";
  return {};
}

bool check_words(const Settings& settings, DiagnosticLog& log) {
  bool good = true;
  for (const std::string_view word : words_of(*settings.sky)) {
    if (word == "sun") continue;
    log.report(
        Code::E0201, {},
        fmt::format("--sky is {}, expected sun; bodies are placed by --planet NAME=\"X Y Z\"",
                    in_quotes(word)),
        "docs/sky.md");
    good = false;
  }
  return good;
}

}  // namespace

bool shows_sky(const Settings& settings) {
  return !settings.planet->empty() || !settings.sky->empty() || settings.stars->number;
}

bool check_sky(const Settings& settings, DiagnosticLog& log) {
  bool good = check_words(settings, log);
  if (settings.date) {
    std::string problem;
    if (!scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem)) {
      log.report(Code::E0201, {},
                 fmt::format("--date is {}, expected a date in UTC, as 2026-01-01T12:00:00",
                             in_quotes(*settings.date)),
                 problem);
      good = false;
    }
  }
  for (const auto& [name, text] : *settings.planet) {
    PlanetText planet;
    const std::string wrong = read_planet(name, text, planet);
    if (wrong.empty()) continue;
    log.report(Code::E0201, {},
               fmt::format("--planet {} is {}, expected {}", name, in_quotes(text), wrong),
               "docs/sky.md");
    good = false;
  }
  return good;
}

bool SkyReader::read_stars(const Settings& settings, light::Stars& stars, DiagnosticLog& log) {
  stars.faintest = *settings.stars->number;
  if (settings.star_catalogue) {
    auto& own = catalogues_[*settings.star_catalogue];
    if (own == nullptr) {
      auto read = sky::read_stars(*settings.star_catalogue, log);
      if (!read) return false;
      own = std::make_shared<const light::StarCatalogue>(*std::move(read));
    }
    stars.catalogue = own;
  } else {
    stars.catalogue = sky::hipparcos_stars();
  }
  if (!settings.date) return true;
  std::string problem;
  constexpr double kJulianYear = 365.25 * 86400;
  // noon of 2000-01-01, TT
  const auto begin =
      scenario::parse_epoch("2000-01-01T12:00:00", scenario::TimeSystem::tt, problem);
  const auto date = scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem);
  stars.year = 2000 + scenario::seconds_between(*begin, *date) / kJulianYear;
  return true;
}

bool SkyReader::read_maps(const PlanetFiles& files, light::Body& body, DiagnosticLog& log) {
  Vec3 ground = body.albedo;
  if (const auto air = light::air_of(body)) {
    ground = light::ground_albedo(body, *air);
    if (body.albedo.x < air->albedo().x || body.albedo.y < air->albedo().y ||
        body.albedo.z < air->albedo().z)
      log.report(Code::W5043, {},
                 fmt::format("the air of {} alone has the albedo {:.2f} {:.2f} {:.2f}, more than "
                             "albedo= {:.2g} {:.2g} {:.2g}: the ground is black in such bands",
                             in_quotes(body.name), air->albedo().x, air->albedo().y,
                             air->albedo().z, body.albedo.x, body.albedo.y, body.albedo.z),
                 "air=none leaves the air out");
  }
  if (!files.map.empty() || !files.clouds.empty()) {
    // clouds above a ground depend on its albedo
    const std::string key = files.clouds.empty()
                                ? files.map
                                : fmt::format("{}\n{}\n{} {} {}", files.map, files.clouds, ground.x,
                                              ground.y, ground.z);
    auto& map = maps_[key];
    if (map == nullptr) map = albedo_map(files, ground, log);
    if (map == nullptr) return false;
    body.map = map;
  }
  if (files.night.empty()) return true;
  auto& night = maps_["\n" + files.night];
  if (night == nullptr) night = night_map(files.night, log);
  body.night = night;
  return night != nullptr;
}

Result<std::shared_ptr<const SkyState>> SkyReader::read(const Settings& settings,
                                                        DiagnosticLog& log) {
  if (!shows_sky(settings)) return {nullptr};
  auto sky = std::make_shared<SkyState>();
  if (settings.stars->number && !read_stars(settings, sky->stars, log)) return failed;
  for (const std::string_view word : words_of(*settings.sky)) sky->sun_visible |= word == "sun";
  for (const auto& [name, text] : *settings.planet) {
    PlanetText planet;
    if (!read_planet(name, text, planet).empty()) return failed;
    if (!read_maps(planet.files, planet.body, log)) return failed;
    std::erase_if(sky->bodies,
                  [&](const light::Body& body) { return body.name == planet.body.name; });
    sky->bodies.push_back(std::move(planet.body));
  }
  return std::shared_ptr<const SkyState>(std::move(sky));
}

}  // namespace panwright::workspace
