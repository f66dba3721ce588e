#include "workspace/lamp_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/text.h"
#include "workspace/internal/forward.h"
#include "workspace/quantities.h"
#include "world/lamps.h"

namespace panwright::workspace {
namespace {

constexpr std::string_view kLampKinds[] = {"spot", "point", "disc", "led"};
constexpr std::string_view kLampWords[] = {"on",    "at",     "toward",     "intensity",
                                           "power", "radius", "half-angle", "exponent"};

struct LampNumbers {
  std::optional<Vec3> at, toward, intensity, power;
  std::optional<double> radius, half_angle, exponent;
};

// The power of a spot over its intensity on the axis.
double steradians(double half_angle, double exponent) {
  if (exponent == 0) return 2 * kPi * (1 - det::cos(half_angle));
  const double edge = std::max(det::cos(std::min(half_angle, kPi / 2)), 0.0);
  const double lost = edge > 0 ? det::exp((exponent + 1) * det::log(edge)) : 0;
  return 2 * kPi * (1 - lost) / (exponent + 1);
}

class LampReader {
 public:
  LampReader(std::string_view text, const world::World& world, DiagnosticLog& log)
      : text_(text), words_(words_of(text)), world_(world), log_(log) {}

  std::optional<world::Lamp> read() {
    if (words_.empty() || std::ranges::find(kLampKinds, words_[0]) == std::end(kLampKinds))
      return fail(words_.empty() ? "" : words_[0], "spot, point, disc or led");
    kind_ = words_[0];
    next_ = 1;
    while (next_ < words_.size())
      if (!part()) return std::nullopt;
    const auto source = made();
    if (!source) return std::nullopt;
    world::Lamp lamp;
    lamp.source = *source;
    if (!light::is_sound(lamp.source)) return fail(text_, "numbers that are finite and >= 0");
    if (!carrier_.empty() && !put_on(lamp)) return std::nullopt;
    return lamp;
  }

 private:
  std::nullopt_t fail(std::string_view found, std::string_view expected) {
    log_.report(
        Code::E0201, {},
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
      fail(word, "on, at, toward, intensity, power, radius, half-angle or exponent");
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
    const Vec3 intensity =
        n.intensity ? *n.intensity : *n.power / (point ? 4 * kPi : steradians(half, exponent));
    const double radius = n.radius.value_or(0);
    if (point) return light::Point{at, intensity, radius};
    if (kind_ == "disc") return light::Disc{at, axis, intensity, radius};
    return light::Spot{at, axis, intensity, half, exponent, radius};
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

}  // namespace

std::optional<world::Lamp> lamp_of(std::string_view text, const world::World& world,
                                   DiagnosticLog& log) {
  return LampReader(text, world, log).read();
}

std::optional<std::vector<world::Lamp>> lamps_of(const Settings& settings,
                                                 const world::World& world, std::string_view file,
                                                 DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  std::vector<world::Lamp> lamps;
  for (const std::string& text : *settings.lamp)
    if (const auto lamp = lamp_of(text, world, apart)) lamps.push_back(*lamp);
  const std::size_t count = settings.lamp->size() + world.lamps().size();
  if (count > world::World::kMaxLamps)
    apart.report(Code::E0201, {},
                 fmt::format("{} lamps, expected {} at most", count, world::World::kMaxLamps));
  const bool good = !apart.has_errors();
  forward(apart, file.empty() ? "" : "view", file, log);
  if (!good) return std::nullopt;
  return lamps;
}

}  // namespace panwright::workspace
