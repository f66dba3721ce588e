#include "workspace/lamp_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/text.h"
#include "scene/scene.h"
#include "workspace/internal/forward.h"
#include "workspace/quantities.h"
#include "world/lamps.h"

namespace panwright::workspace {
namespace {

constexpr std::string_view kLampKinds[] = {"spot", "point", "disc", "led"};
constexpr std::string_view kLampWords[] = {"on",     "at",         "toward",   "intensity", "power",
                                           "radius", "half-angle", "exponent", "pulse"};

struct LampNumbers {
  std::optional<Vec3> at, toward, intensity, power;
  std::optional<double> radius, half_angle, exponent;
  std::optional<world::Pulse> pulse;
};

// The power of a lamp over its intensity on the axis.
double steradians(const light::Source& source) {
  scene::Lamp lamp;
  if (const auto* spot = std::get_if<light::Spot>(&source)) {
    lamp.half_angle = spot->half_angle;
    lamp.exponent = spot->exponent;
  } else {
    lamp.kind = std::holds_alternative<light::Disc>(source) ? scene::Lamp::Kind::disc
                                                            : scene::Lamp::Kind::point;
  }
  return scene::steradians(lamp);
}

bool is_kind(std::string_view word) {
  return std::ranges::find(kLampKinds, word) != std::end(kLampKinds);
}

class LampReader {
 public:
  LampReader(std::string_view text, const world::World& world, DiagnosticLog& log)
      : text_(text), words_(words_of(text)), world_(world), log_(log) {}

  std::optional<world::Lamp> read() {
    if (words_.empty() || !is_kind(words_[0]))
      return fail(words_.empty() ? "" : words_[0], "spot, point, disc or led");
    kind_ = words_[0];
    next_ = 1;
    while (next_ < words_.size())
      if (!part()) return std::nullopt;
    const auto source = made();
    if (!source) return std::nullopt;
    world::Lamp lamp;
    lamp.source = *source;
    lamp.pulse = numbers_.pulse;
    if (!light::is_sound(lamp.source)) return fail(text_, "numbers that are finite and >= 0");
    if (!carrier_.empty() && !put_on(lamp)) return std::nullopt;
    return lamp;
  }

  // Changes a lamp by the words behind its name, `skipped` characters long.
  bool change(std::size_t skipped, world::Lamp& lamp) {
    words_ = words_of(text_.substr(skipped));
    next_ = 0;
    lamp.on = true;
    while (next_ < words_.size()) {
      const std::string_view word = words_[next_];
      if (word == "on" || word == "off") {
        lamp.on = word == "on";
        ++next_;
        continue;
      }
      if (word == "at" || word == "toward" ||
          std::ranges::find(kLampWords, word) == std::end(kLampWords)) {
        fail(word, "on, off, intensity, power, radius, half-angle, exponent or pulse");
        return false;
      }
      if (!part()) return false;
    }
    if (numbers_.intensity && numbers_.power) {
      fail("power", "intensity or power");
      return false;
    }
    return set_numbers(lamp);
  }

 private:
  bool set_numbers(world::Lamp& lamp) {
    const LampNumbers& n = numbers_;
    if (n.pulse) lamp.pulse = n.pulse;
    auto* const spot = std::get_if<light::Spot>(&lamp.source);
    if (spot == nullptr && (n.half_angle || n.exponent)) {
      fail(in_quotes(lamp.name), "no half-angle and no exponent, since it is no spot");
      return false;
    }
    if (spot != nullptr) {
      spot->half_angle = n.half_angle.value_or(spot->half_angle);
      spot->exponent = n.exponent.value_or(spot->exponent);
    }
    const double power = n.power ? steradians(lamp.source) : 1;
    std::visit(
        [&](auto& source) {
          if constexpr (requires { source.radius; }) {
            source.radius = n.radius.value_or(source.radius);
            source.intensity = n.power ? *n.power / power : n.intensity.value_or(source.intensity);
          }
        },
        lamp.source);
    if (light::is_sound(lamp.source)) return true;
    fail(in_quotes(lamp.name), "a radius above 0 of a disc, and numbers that are finite");
    return false;
  }

  std::nullopt_t fail(std::string_view found, std::string_view expected) {
    log_.report(
        Code("E0201"), {},
        fmt::format("--lamp {} has {}, expected {}", in_quotes(text_), in_quotes(found), expected));
    return std::nullopt;
  }

  // A keyword and its values.
  bool part() {
    const std::string_view word = words_[next_++];
    const auto once = [&](const auto& given) {
      if (given) fail(word, "each word once");
      return !given;
    };
    if (std::ranges::find(kLampWords, word) == std::end(kLampWords)) {
      fail(word, "on, at, toward, intensity, power, radius, half-angle, exponent or pulse");
      return false;
    }
    if (word == "on") {
      if (!carrier_.empty() || next_ == words_.size()) {
        fail(word, "camera, TARGET/FRAME or TARGET/NODE after it, once");
        return false;
      }
      carrier_ = words_[next_++];
      return true;
    }
    if (word == "at") return once(numbers_.at) && vector(word, false, numbers_.at);
    if (word == "toward") return once(numbers_.toward) && vector(word, false, numbers_.toward);
    if (word == "intensity")
      return once(numbers_.intensity) && vector(word, true, numbers_.intensity);
    if (word == "power") return once(numbers_.power) && vector(word, true, numbers_.power);
    if (word == "radius")
      return once(numbers_.radius) && scalar(word, &parse_length, 0, 1e9, numbers_.radius);
    if (word == "half-angle")
      return once(numbers_.half_angle) &&
             scalar(word, &parse_angle, 1e-6, kPi, numbers_.half_angle);
    if (word == "pulse") return once(numbers_.pulse) && pulse();
    return once(numbers_.exponent) && scalar(word, &parse_double, 0, 1e6, numbers_.exponent);
  }

  // Three numbers; of bands one will do.
  bool vector(std::string_view word, bool bands, std::optional<Vec3>& out) {
    std::vector<double> values;
    while (next_ < words_.size() && values.size() < 3) {
      const auto value = bands ? parse_double(words_[next_]) : parse_length(words_[next_]);
      if (!value) break;
      values.push_back(*value);
      ++next_;
    }
    const bool good = values.size() == 3 || (bands && values.size() == 1);
    if (!good || std::ranges::any_of(values, [&](double v) {
          return !(std::fabs(v) <= 1e30) || (bands && v < 0);
        })) {
      fail(word, bands ? "one number or three after it, 0 to 1e30" : "three lengths after it");
      return false;
    }
    out = values.size() == 1 ? Vec3(values[0]) : Vec3(values[0], values[1], values[2]);
    return true;
  }

  template <class Parse>
  bool scalar(std::string_view word, Parse parse, double least, double most,
              std::optional<double>& out) {
    const std::optional<double> value =
        next_ < words_.size() ? parse(words_[next_]) : std::optional<double>();
    if (!value || !(*value >= least && *value <= most)) {
      fail(next_ < words_.size() ? words_[next_] : word,
           word == "radius"       ? "a length >= 0 after radius"
           : word == "half-angle" ? "an angle up to 180deg after half-angle"
                                  : "a number from 0 to 1e6 after exponent");
      return false;
    }
    ++next_;
    out = value;
    return true;
  }

  bool pulse() {
    std::optional<double> times[2];
    for (auto& time : times)
      if (next_ < words_.size()) time = parse_time(words_[next_++]);
    if (!times[0] || !times[1] || !(*times[0] < *times[1]) ||
        !(std::max(-*times[0], *times[1]) <= 1e9)) {
      fail("pulse", "two times after it, begin and end, as -1ms 1ms: seconds after the frame's");
      return false;
    }
    numbers_.pulse = world::Pulse{*times[0], *times[1]};
    return true;
  }

  std::optional<light::Source> made() {
    const LampNumbers& n = numbers_;
    const bool point = kind_ == "point";
    const bool spot = kind_ == "spot";
    if (n.intensity.has_value() == n.power.has_value()) return fail(kind_, "intensity or power");
    if (!spot && (n.half_angle || n.exponent)) return fail(kind_, "no half-angle and no exponent");
    if (point && n.toward) return fail(kind_, "no direction: it lights all of them");
    if (kind_ == "disc" && !(n.radius && *n.radius > 0)) return fail(kind_, "a radius above 0");
    const Vec3 at = n.at.value_or(Vec3(0));
    const Vec3 axis = n.toward ? *n.toward - at : Vec3(0, 0, 1);
    if (axis == Vec3(0)) return fail("toward", "another point than that of the lamp");
    const double half = spot ? n.half_angle.value_or(30 * kDegree) : kPi / 2;
    const double exponent = spot ? n.exponent.value_or(0) : 1;
    const double radius = n.radius.value_or(0);
    const auto with = [&](const Vec3& intensity) -> light::Source {
      if (point) return light::Point{at, intensity, radius};
      if (kind_ == "disc") return light::Disc{at, axis, intensity, radius};
      return light::Spot{at, axis, intensity, half, exponent, radius};
    };
    return with(n.intensity ? *n.intensity : *n.power / steradians(with(Vec3(1))));
  }

  bool put_on(world::Lamp& lamp) {
    if (carrier_ == "camera") {
      lamp.carrier = world::Lamp::Carrier::camera;
      return true;
    }
    for (std::size_t at = carrier_.find('/'); at != carrier_.npos; at = carrier_.find('/', at + 1))
      if (const auto target = world_.find(carrier_.substr(0, at)))
        return world::put_on_node(lamp, world_, *target, carrier_.substr(at + 1), log_);
    if (world_.size() == 1) return world::put_on_node(lamp, world_, 0, carrier_, log_);
    fail(carrier_, "camera, TARGET/FRAME or TARGET/NODE");
    return false;
  }

  std::string_view text_;
  std::vector<std::string_view> words_;
  const world::World& world_;
  DiagnosticLog& log_;
  std::size_t next_ = 0;
  std::string_view kind_;
  std::string_view carrier_;
  LampNumbers numbers_;
};

// Whether a name fits a pattern, in which '*' stands for any characters.
bool fits(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  name.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  // each part where it stands first, and the last one at the end
  for (std::size_t next; (next = pattern.find('*')) != pattern.npos;
       pattern.remove_prefix(next + 1)) {
    const std::size_t at = name.find(pattern.substr(0, next));
    if (at == name.npos) return false;
    name.remove_prefix(at + next);
  }
  return name.ends_with(pattern);
}

// The lamps that the beginning of a text names, and how long their name is there.
struct NamedLamps {
  std::vector<std::size_t> lamps;
  std::size_t length = 0;
};

// Names may hold blanks: the longest that is followed by one, or by the end.
NamedLamps named_lamps(std::string_view text, const std::vector<world::Lamp>& lamps) {
  NamedLamps found;
  const std::string_view word = words_of(text)[0];
  if (word.find('*') != word.npos) {
    found.length = static_cast<std::size_t>(word.data() - text.data()) + word.size();
    for (std::size_t i = 0; i < lamps.size(); ++i)
      if (!lamps[i].name.empty() && (fits(lamps[i].name, word) || fits(lamp_path(lamps[i]), word)))
        found.lamps.push_back(i);
    return found;
  }
  const auto begins = [&](std::string_view name) {
    return !name.empty() && text.starts_with(name) &&
           (text.size() == name.size() || text[name.size()] == ' ');
  };
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    if (lamps[i].name.empty()) continue;
    const std::string path = lamp_path(lamps[i]);
    for (const std::string_view name : {std::string_view(path), std::string_view(lamps[i].name)}) {
      if (!begins(name) || is_kind(name) || name.size() < found.length) continue;
      if (name.size() > found.length) found.lamps.clear();
      found.length = name.size();
      found.lamps.push_back(i);
    }
  }
  return found;
}

std::string hint_of_names(std::string_view word, const std::vector<world::Lamp>& lamps) {
  std::vector<std::string> paths;
  for (const world::Lamp& lamp : lamps)
    if (!lamp.name.empty()) paths.push_back(lamp_path(lamp));
  if (paths.empty()) return {};
  std::vector<std::string_view> names(paths.begin(), paths.end());
  for (const world::Lamp& lamp : lamps)
    if (!lamp.name.empty()) names.push_back(lamp.name);
  if (const auto near = nearest_name(word, names)) return fmt::format("did you mean '{}'?", *near);
  constexpr std::size_t kMost = 6;
  const bool more = paths.size() > kMost;
  if (more) paths.resize(kMost);
  return fmt::format("lamps of models: {}{}", fmt::join(paths, ", "), more ? ", …" : "");
}

}  // namespace

std::string lamp_path(const world::Lamp& lamp) { return lamp.target + "/" + lamp.name; }

bool set_lamp(std::string_view text, const world::World& world, std::vector<world::Lamp>& lamps,
              DiagnosticLog& log) {
  const auto words = words_of(text);
  const bool is_new = words.empty() || is_kind(words[0]);
  const NamedLamps named = is_new ? NamedLamps{} : named_lamps(text, lamps);
  if (is_new) {
    const auto lamp = lamp_of(text, world, log);
    if (lamp) lamps.push_back(*lamp);
    return lamp.has_value();
  }
  const auto refuse = [&](const std::string& what, const std::string& hint) {
    log.report(Code("E0201"), {}, fmt::format("--lamp {} {}", in_quotes(text), what), hint);
    return false;
  };
  if (named.lamps.empty())
    return refuse(fmt::format("has {}, expected spot, point, disc, led or the name of a lamp of a "
                              "model",
                              in_quotes(words[0])),
                  hint_of_names(words[0], lamps));
  const bool pattern = words[0].find('*') != words[0].npos;
  if (named.lamps.size() > 1 && !pattern)
    return refuse(
        fmt::format("names {} lamps, expected TARGET/NAME or a pattern", named.lamps.size()),
        fmt::format("as '{}'", lamp_path(lamps[named.lamps[0]])));
  for (const std::size_t i : named.lamps)
    if (!LampReader(text, world, log).change(named.length, lamps[i])) return false;
  return true;
}

std::string lamp_text(const world::Lamp& lamp) {
  std::string text;
  const auto words = [&](std::string_view word, const Vec3& v) {
    text += fmt::format(" {} {} {} {}", word, v.x, v.y, v.z);
  };
  std::visit(
      [&](const auto& source) {
        using Kind = std::decay_t<decltype(source)>;
        if constexpr (requires { source.radius; }) {
          text = std::is_same_v<Kind, light::Spot>   ? "spot"
                 : std::is_same_v<Kind, light::Disc> ? "disc"
                                                     : "point";
          words("at", source.position);
          if constexpr (requires { source.axis; }) words("toward", source.position + source.axis);
          words("intensity", source.intensity);
          if constexpr (std::is_same_v<Kind, light::Spot>)
            text +=
                fmt::format(" half-angle {}rad exponent {}", source.half_angle, source.exponent);
          if (source.radius > 0) text += fmt::format(" radius {}", source.radius);
        }
      },
      lamp.source);
  if (lamp.pulse) text += fmt::format(" pulse {} {}", lamp.pulse->begin, lamp.pulse->end);
  return text;
}

std::vector<std::string> fixed_lamp_texts(const std::vector<std::string>& texts,
                                          const std::vector<world::Lamp>& lamps,
                                          const world::Camera& camera) {
  world::World fixed;
  fixed.set_lamps(lamps);
  world::fix_lamps(fixed, camera);
  std::vector<std::string> out;
  std::size_t next = 0;
  for (const std::string& text : texts) {
    out.push_back(text);
    const auto words = words_of(text);
    if (words.empty() || !is_kind(words[0])) continue;
    while (next < lamps.size() && !lamps[next].name.empty()) ++next;
    if (next == lamps.size()) continue;
    if (lamps[next].carrier == world::Lamp::Carrier::camera)
      out.back() = lamp_text(fixed.lamps()[next]);
    ++next;
  }
  return out;
}

std::optional<world::Lamp> lamp_of(std::string_view text, const world::World& world,
                                   DiagnosticLog& log) {
  return LampReader(text, world, log).read();
}

std::optional<std::vector<world::Lamp>> lamps_of(const Settings& settings,
                                                 const world::World& world, std::string_view file,
                                                 DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  std::vector<world::Lamp> lamps(world.lamps().begin(), world.lamps().end());
  for (const std::string& text : *settings.lamp) (void)set_lamp(text, world, lamps, apart);
  const auto on = static_cast<std::size_t>(std::ranges::count(lamps, true, &world::Lamp::on));
  if (on > world::World::kMaxLamps)
    apart.report(Code("E0201"), {},
                 fmt::format("{} lamps are on, expected {} at most", on, world::World::kMaxLamps),
                 "--lamp \"* off\" switches those of models off");
  const bool good = !apart.has_errors();
  forward(apart, file.empty() ? "" : "view", file, log);
  if (!good) return std::nullopt;
  return lamps;
}

}  // namespace panwright::workspace
