#include "workspace/sky_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "base/file.h"
#include "base/text.h"
#include "image/decode.h"
#include "scenario/time.h"
#include "sky/star_catalogue.h"
#include "workspace/quantities.h"

namespace panwright::workspace {
namespace {

constexpr std::uint64_t kMostMapBytes = 1ull << 30;
constexpr std::string_view kExpected =
    "a position x y z, with or without units, then if need be a quaternion w x y z and radius=, "
    "albedo=, law= or map=";

// in place of a centre: none, though the scene of a model has one
constexpr std::string_view kNoPlanet = "off";

struct PlanetText {
  light::Body body;
  std::string map;  // path; empty: none
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
  if (name.empty()) return "NAME=\"X Y Z\", with the name of a body";
  const auto preset = light::body_preset(name);
  if (preset) out.body = *preset;
  out.body.name = name;
  bool sized = preset.has_value();
  const std::vector<Word> words = words_by_key(text, out.map);
  if (std::string wrong = set_place(words[0].values, out.body); !wrong.empty()) return wrong;
  for (std::size_t i = 1; i < words.size(); ++i)
    if (std::string wrong = set_member(words[i], out.body, sized); !wrong.empty()) return wrong;
  if (text.find("map=") != text.npos && out.map.empty()) return "map= with a file";
  if (!sized) return "radius=, since only earth and moon have one of their own";
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
    if (text == kNoPlanet) continue;
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

Result<std::shared_ptr<const SkyState>> SkyReader::read(const Settings& settings,
                                                        DiagnosticLog& log) {
  if (!shows_sky(settings)) return {nullptr};
  auto sky = std::make_shared<SkyState>();
  if (settings.stars->number && !read_stars(settings, sky->stars, log)) return failed;
  for (const std::string_view word : words_of(*settings.sky)) sky->sun_visible |= word == "sun";
  for (const auto& [name, text] : *settings.planet) {
    if (text == kNoPlanet) continue;
    PlanetText planet;
    if (!read_planet(name, text, planet).empty()) return failed;
    if (!planet.map.empty()) {
      auto& map = maps_[planet.map];
      if (map == nullptr) map = map_of(planet.map, log);
      if (map == nullptr) return failed;
      planet.body.map = map;
    }
    std::erase_if(sky->bodies,
                  [&](const light::Body& body) { return body.name == planet.body.name; });
    sky->bodies.push_back(std::move(planet.body));
  }
  return std::shared_ptr<const SkyState>(std::move(sky));
}

}  // namespace panwright::workspace
