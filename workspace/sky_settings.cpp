#include "workspace/sky_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>

#include "base/diagnostic.h"
#include "base/text.h"
#include "scenario/time.h"
#include "sky/star_catalogue.h"
#include "workspace/internal/planet_maps.h"
#include "workspace/orbit_text.h"
#include "workspace/quantities.h"

namespace panwright::workspace {

namespace {

constexpr std::string_view kFileKeys[] = {"map=", "clouds=", "night="};
constexpr std::string_view kExpected =
    "a position x y z, with or without units, then if need be a quaternion w x y z and radius=, "
    "albedo=, law=, air=, and last map=, clouds= or night=";

constexpr std::string_view kSkyNames[] = {"stars", "earth", "moon", "sun"};
constexpr double kFaintestOfHipparcos = 8;

// in place of a centre: none, though the scene of a model has one
constexpr std::string_view kNoPlanet = "off";

struct PlanetText {
  light::Body body;
  PlanetFiles files;
  std::optional<bool> air;
  bool placed = false;  // by its own text
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

bool has_name(const Settings& settings, std::string_view name) {
  const auto names = words_of(*settings.sky);
  return std::ranges::find(names, name) != names.end();
}

// Magnitude of the faintest stars that are drawn; none: no stars.
std::optional<double> faintest_of(const Settings& settings) {
  if (settings.stars) return settings.stars->number;
  if (has_name(settings, "stars")) return kFaintestOfHipparcos;
  return std::nullopt;
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

std::string set_air(std::span<const std::string_view> words, PlanetText& out) {
  const std::string_view name = words.size() == 1 ? words[0] : std::string_view();
  if (name != "earth" && name != "sunset" && name != "none") return "air=earth, sunset or none";
  out.air = name != "none";
  out.body.sunset = name == "sunset";
  return {};
}

std::string set_member(const Word& word, PlanetText& out, bool& sized) {
  light::Body& body = out.body;
  if (word.key == "law") return set_law(word.values, body);
  if (word.key == "air") return set_air(word.values, out);
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
  if (name.empty()) return "NAME=\"X Y Z\" with the name of a body, as earth=\"0 0 -6778km\"";
  const auto preset = light::body_preset(name);
  if (preset) out.body = *preset;
  out.body.name = name;
  bool sized = preset.has_value();
  bool empty_file = false;
  const std::vector<Word> words = words_by_key(text, out, empty_file);
  // the place of the Earth and Moon may be that of the date
  out.placed = !preset || !words[0].values.empty();
  if (out.placed)
    if (std::string wrong = set_place(words[0].values, out.body); !wrong.empty()) return wrong;
  for (std::size_t i = 1; i < words.size(); ++i)
    if (std::string wrong = set_member(words[i], out, sized); !wrong.empty()) return wrong;
  if (empty_file) return "map=, clouds= and night= with a file";
  if (!sized) {
    const auto near = nearest_name(name, light::kBodyPresets);
    return fmt::format("radius=, since only earth and moon have one of their own{}",
                       near ? fmt::format("; did you mean '{}'?", *near) : "");
  }
  const Vec3& radii = out.body.radii;
  const bool suits = out.body.photometry == light::Photometry() &&
                     std::min({radii.x, radii.y, radii.z}) >= light::Air::kLeastRadius;
  out.body.air = out.air.value_or(out.body.air && suits);
  if (out.body.air && !suits)
    return "air=earth or sunset with law=lambert and a radius= of 1,000 km or more";
  if (!light::is_sound(out.body))
    return "finite numbers, semi-axes within 1:100, parameters of a law within their range";
  return {};
}

bool check_words(const Settings& settings, DiagnosticLog& log) {
  bool good = true;
  for (const std::string_view word : words_of(*settings.sky)) {
    if (std::ranges::find(kSkyNames, word) != std::end(kSkyNames)) continue;
    const auto near = nearest_name(word, kSkyNames);
    log.report(Code("E0201"), {},
               fmt::format("--sky is {}, expected any of {}; others are placed by --planet "
                           "NAME=\"X Y Z\"{}",
                           in_quotes(word), fmt::join(kSkyNames, ", "),
                           near ? fmt::format("; did you mean '{}'?", *near) : ""),
               "docs/sky-by-date.md");
    good = false;
  }
  return good;
}

// Returns whether a text of `planet` leaves the place to the date.
bool is_dated(const std::string& name, std::string_view text) {
  PlanetText ignored;
  bool empty_file = false;
  return light::body_preset(name) && words_by_key(text, ignored, empty_file)[0].values.empty();
}

// A body of `sky` that `planet` does not name; or one of `planet` without a place; empty: none.
std::string first_dated(const Settings& settings) {
  for (const auto& [name, text] : *settings.planet)
    if (is_dated(name, text)) return name;
  for (const std::string_view name : light::kBodyPresets)
    if (has_name(settings, name) &&
        std::ranges::find(*settings.planet, name, &std::pair<std::string, std::string>::first) ==
            settings.planet->end())
      return std::string(name);
  return {};
}

bool check_date(const Settings& settings, DiagnosticLog& log) {
  if (!settings.date) return true;
  std::string problem;
  if (scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem)) return true;
  log.report(Code("E0201"), {},
             fmt::format("--date is {}, expected a date in UTC, as 2026-01-01T12:00:00",
                         in_quotes(*settings.date)),
             problem);
  return false;
}

bool check_orbit(const Settings& settings, DiagnosticLog& log) {
  if (!settings.orbit) return true;
  scenario::Orbit orbit;
  const std::string wrong = read_orbit(*settings.orbit, orbit);
  if (wrong.empty()) return true;
  log.report(Code("E0201"), {},
             fmt::format("--orbit is {}, expected {}", in_quotes(*settings.orbit), wrong),
             "docs/sky-by-date.md");
  return false;
}

scenario::Epoch date_of(const Settings& settings) {
  std::string problem;
  return *scenario::parse_epoch(*settings.date, scenario::TimeSystem::utc, problem);
}

}  // namespace

void place_sky_files(const std::filesystem::path& folder, Settings& settings) {
  const auto placed = [&](std::string_view file) {
    return (folder / std::filesystem::path(file)).lexically_normal().string();
  };
  if (settings.star_catalogue) settings.star_catalogue = placed(*settings.star_catalogue);
  if (!settings.planet) return;
  auto planets = *settings.planet;
  for (auto& [name, text] : planets) {
    PlanetText planet;
    bool empty_file = false;
    static_cast<void>(words_by_key(text, planet, empty_file));
    const std::string* const files[] = {&planet.files.map, &planet.files.clouds,
                                        &planet.files.night};
    std::string out = text.substr(0, next_file(text, 0));
    for (std::size_t k = 0; k < std::size(kFileKeys); ++k)
      if (!files[k]->empty())
        out += fmt::format("{}{}{}", out.empty() || out.back() == ' ' ? "" : " ", kFileKeys[k],
                           placed(*files[k]));
    if (!empty_file) text = std::move(out);  // check_sky() reports it
  }
  settings.planet = std::move(planets);
}

bool shows_sky(const Settings& settings) {
  return !settings.planet->empty() || !settings.sky->empty() || settings.stars->number;
}

bool uses_date(const Settings& settings) {
  return faintest_of(settings) || settings.orbit || needs_orbit(settings) ||
         shows_dated_sun(settings);
}

bool shows_stars(const Settings& settings) { return bool(faintest_of(settings)); }

bool shows_dated_sun(const Settings& settings) {
  return has_name(settings, "sun") && !settings.sun;
}

bool needs_orbit(const Settings& settings) { return !first_dated(settings).empty(); }

bool check_sky(const Settings& settings, DiagnosticLog& log) {
  bool good = check_words(settings, log);
  good = check_date(settings, log) && good;
  good = check_orbit(settings, log) && good;
  if (settings.star_catalogue && !faintest_of(settings)) {
    log.report(Code("E0201"), {}, "--star-catalogue requires --stars V or --sky stars");
    good = false;
  }
  std::set<std::string_view> names;
  for (const auto& [name, text] : *settings.planet) {
    if (text == kNoPlanet) continue;
    PlanetText planet;
    std::string wrong = read_planet(name, text, planet);
    if (!names.insert(name).second) wrong = "each body once";
    if (wrong.empty()) continue;
    log.report(Code("E0201"), {},
               fmt::format("--planet {} is {}, expected {}", name.empty() ? "''" : name,
                           in_quotes(text), wrong),
               "docs/sky.md");
    good = false;
  }
  return good;
}

Result<std::optional<scenario::DatedSky>> dated_sky_of(const Settings& settings,
                                                       DiagnosticLog& log) {
  const std::string dated = first_dated(settings);
  const auto fail = [&](std::string message) {
    log.report(Code("E0201"), {}, std::move(message), "docs/sky-by-date.md");
    return failed;
  };
  if (!settings.orbit) {
    scenario::Orbit centre;
    centre.at_centre = true;
    if (dated.empty())
      return settings.date && shows_dated_sun(settings)
                 ? scenario::dated_sky(centre, date_of(settings))
                 : std::nullopt;
    return fail(
        fmt::format("the place of the {} is not known, expected --date and --orbit, or "
                    "--planet {}=\"X Y Z\"",
                    dated, dated));
  }
  if (!settings.date)
    return fail("--orbit needs a date, expected --date UTC, as 2026-01-01T12:00:00");
  scenario::Orbit orbit;
  if (!read_orbit(*settings.orbit, orbit).empty()) return failed;
  const auto sky = scenario::dated_sky(orbit, date_of(settings));
  if (!sky)
    return fail(
        fmt::format("--date is {}, expected one from 1972 to 2050 at which the orbit has a "
                    "place",
                    in_quotes(*settings.date)));
  return sky;
}

bool SkyReader::read_stars(const Settings& settings, const std::optional<scenario::DatedSky>& dated,
                           light::Stars& stars, DiagnosticLog& log) {
  stars.faintest = *faintest_of(settings);
  if (settings.star_catalogue) {
    const std::string& path = *settings.star_catalogue;
    auto& own = catalogues_[path];
    if (own == nullptr) {
      if (refused_.contains(path)) return false;
      auto read = sky::read_stars(path, log);
      if (!read) {
        refused_.insert(path);
        return false;
      }
      own = std::make_shared<const light::StarCatalogue>(*std::move(read));
    }
    stars.catalogue = own;
  } else {
    stars.catalogue = sky::hipparcos_stars();
    if (stars.faintest > kFaintestOfHipparcos && refused_.insert(std::string()).second)
      log.report(Code("W5041"), {},
                 fmt::format("--stars is {}; the catalogue of Hipparcos ends at magnitude {}, "
                             "fainter stars are not drawn",
                             stars.faintest, kFaintestOfHipparcos),
                 "--star-catalogue FILE.csv has your own stars");
  }
  if (!settings.date) return true;
  std::string problem;
  constexpr double kJulianYear = 365.25 * 86400;
  // noon of 2000-01-01, TT
  const auto begin =
      scenario::parse_epoch("2000-01-01T12:00:00", scenario::TimeSystem::tt, problem);
  const scenario::Epoch date = date_of(settings);
  stars.year = 2000 + scenario::seconds_between(*begin, date) / kJulianYear;
  stars.velocity = dated ? dated->velocity : scenario::earth_velocity(date);
  if (dated) stars.world_from_icrs = dated->world_from_icrf;
  return true;
}

bool SkyReader::read_maps(const PlanetFiles& files, light::Body& body, DiagnosticLog& log) {
  Vec3 ground = body.albedo;
  if (const auto air = light::air_of(body)) {
    ground = light::ground_albedo(body, *air);
    if (body.albedo.x < air->albedo().x || body.albedo.y < air->albedo().y ||
        body.albedo.z < air->albedo().z)
      log.report(Code("W5043"), {},
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
    if (map == nullptr && refused_.insert(key).second) map = albedo_map(files, ground, log);
    if (map == nullptr) return false;
    body.map = map;
  }
  if (files.night.empty()) return true;
  const std::string key = "\n" + files.night;
  auto& night = maps_[key];
  if (night == nullptr && refused_.insert(key).second) night = night_map(files.night, log);
  body.night = night;
  return night != nullptr;
}

Result<std::shared_ptr<const SkyState>> SkyReader::read(
    const Settings& settings, const std::optional<scenario::DatedSky>& dated, DiagnosticLog& log) {
  if (!shows_sky(settings)) return {nullptr};
  auto sky = std::make_shared<SkyState>();
  if (faintest_of(settings) && !read_stars(settings, dated, sky->stars, log)) return failed;
  sky->sun_visible = has_name(settings, "sun");
  const auto add = [&](light::Body body, bool placed) {
    if (!placed) {
      const scenario::DatedBody& place = body.name == "moon" ? dated->moon : dated->earth;
      body.centre = place.centre;
      body.world_from_body = place.world_from_body;
    }
    sky->bodies.push_back(std::move(body));
  };
  for (const auto& [name, text] : *settings.planet) {
    if (text == kNoPlanet) continue;
    PlanetText planet;
    if (!read_planet(name, text, planet).empty() || (!planet.placed && !dated)) return failed;
    if (!read_maps(planet.files, planet.body, log)) return failed;
    add(std::move(planet.body), planet.placed);
  }
  for (const std::string_view name : light::kBodyPresets)
    if (has_name(settings, name) &&
        std::ranges::none_of(sky->bodies, [&](const auto& body) { return body.name == name; })) {
      if (!dated) return failed;
      add(*light::body_preset(name), false);
    }
  return std::shared_ptr<const SkyState>(std::move(sky));
}

}  // namespace panwright::workspace
