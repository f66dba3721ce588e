#include "workspace/sky_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/text.h"
#include "image/decode.h"
#include "scenario/time.h"
#include "sky/star_catalogue.h"
#include "workspace/orbit_text.h"
#include "workspace/quantities.h"

namespace panwright::workspace {
namespace {

constexpr std::uint64_t kMostMapBytes = 1ull << 30;
constexpr std::string_view kExpected =
    "a position x y z, with or without units, then if need be a quaternion w x y z and radius=, "
    "albedo=, law= or map=";

constexpr std::string_view kSkyNames[] = {"stars", "earth", "moon", "sun"};
constexpr double kFaintestOfHipparcos = 8;

struct PlanetText {
  light::Body body;
  std::string map;      // path; empty: none
  bool placed = false;  // by its own text
};

struct Word {
  std::string_view key;  // empty: of the position
  std::vector<std::string_view> values;
};

// "X Y Z [QW QX QY QZ] key=value…"; map= takes the rest.
std::vector<Word> words_by_key(std::string_view text, std::string& map) {
  if (const std::size_t at = text.find("map="); at != text.npos) {
    std::string_view rest = text.substr(at + 4);
    while (!rest.empty() && rest.back() == ' ') rest.remove_suffix(1);
    map = rest;
    text = text.substr(0, at);
  }
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

std::string set_member(const Word& word, light::Body& body, bool& sized) {
  if (word.key == "law") return set_law(word.values, body);
  if (word.key != "radius" && word.key != "albedo")
    return fmt::format("radius=, albedo=, law= or map= instead of {}",
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
  const std::vector<Word> words = words_by_key(text, out.map);
  // the place of the Earth and Moon may be that of the date
  out.placed = !preset || !words[0].values.empty();
  if (out.placed)
    if (std::string wrong = set_place(words[0].values, out.body); !wrong.empty()) return wrong;
  for (std::size_t i = 1; i < words.size(); ++i)
    if (std::string wrong = set_member(words[i], out.body, sized); !wrong.empty()) return wrong;
  if (text.find("map=") != text.npos && out.map.empty()) return "map= with a file";
  if (!sized) {
    const auto near = nearest_name(name, light::kBodyPresets);
    return fmt::format("radius=, since only earth and moon have one of their own{}",
                       near ? fmt::format("; did you mean '{}'?", *near) : "");
  }
  if (!light::is_sound(out.body))
    return "finite numbers, semi-axes within 1:100, parameters of a law within their range";
  return {};
}

bool check_words(const Settings& settings, DiagnosticLog& log) {
  bool good = true;
  for (const std::string_view word : words_of(*settings.sky)) {
    if (std::ranges::find(kSkyNames, word) != std::end(kSkyNames)) continue;
    const auto near = nearest_name(word, kSkyNames);
    log.report(Code::E0201, {},
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
  std::string map;
  return light::body_preset(name) && words_by_key(text, map)[0].values.empty();
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
  log.report(Code::E0201, {},
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
  log.report(Code::E0201, {},
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
  if (settings.star_catalogue)
    settings.star_catalogue = (folder / *settings.star_catalogue).string();
  if (!settings.planet) return;
  auto planets = *settings.planet;
  for (auto& [name, text] : planets)
    if (const std::size_t at = text.find("map="); at != text.npos && at + 4 < text.size())
      text = text.substr(0, at + 4) + (folder / text.substr(at + 4)).string();
  settings.planet = std::move(planets);
}

bool shows_sky(const Settings& settings) {
  return !settings.planet->empty() || !settings.sky->empty() || settings.stars->number;
}

bool uses_date(const Settings& settings) {
  return faintest_of(settings) || settings.orbit || needs_orbit(settings) ||
         shows_dated_sun(settings);
}

bool shows_dated_sun(const Settings& settings) {
  return has_name(settings, "sun") && !settings.sun;
}

bool needs_orbit(const Settings& settings) { return !first_dated(settings).empty(); }

bool check_sky(const Settings& settings, DiagnosticLog& log) {
  bool good = check_words(settings, log);
  good = check_date(settings, log) && good;
  good = check_orbit(settings, log) && good;
  if (settings.star_catalogue && !faintest_of(settings)) {
    log.report(Code::E0201, {}, "--star-catalogue requires --stars V or --sky stars");
    good = false;
  }
  std::set<std::string_view> names;
  for (const auto& [name, text] : *settings.planet) {
    PlanetText planet;
    std::string wrong = read_planet(name, text, planet);
    if (!names.insert(name).second) wrong = "each body once";
    if (wrong.empty()) continue;
    log.report(Code::E0201, {},
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
    log.report(Code::E0201, {}, std::move(message), "docs/sky-by-date.md");
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

namespace {

std::shared_ptr<const light::BodyMap> map_of(const std::string& path, DiagnosticLog& log) {
  const auto bytes = read_file(path, kMostMapBytes, log);
  if (!bytes) return nullptr;
  image::DecodedImage image;
  const auto problem = image::decode_image(std::as_bytes(std::span(*bytes)), kMostMapBytes, image);
  if (problem.code) {
    log.report_file(*problem.code, path, problem.message);
    return nullptr;
  }
  if (image.width != 2 * std::uint64_t{image.height}) {
    log.report_file(Code::E0201, path,
                    fmt::format("a map of {} by {} pixels, expected twice as wide as high: "
                                "longitudes from -180 to 180 degrees, the north at the top",
                                image.width, image.height),
                    "docs/sky.md");
    return nullptr;
  }
  return std::make_shared<light::BodyMap>(image.width, image.height, image.rgba);
}

}  // namespace

std::shared_ptr<const light::BodyMap> SkyReader::map(const std::string& path, DiagnosticLog& log) {
  auto& known = maps_[path];
  if (known != nullptr || refused_.contains(path)) return known;
  known = map_of(path, log);
  if (known == nullptr) refused_.insert(path);
  return known;
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
      log.report(Code::W5041, {},
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
    PlanetText planet;
    if (!read_planet(name, text, planet).empty() || (!planet.placed && !dated)) return failed;
    if (!planet.map.empty()) {
      planet.body.map = map(planet.map, log);
      if (planet.body.map == nullptr) return failed;
    }
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
