#include "importers/gltf/animation.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/math.h"
#include "base/text.h"
#include "importers/gltf/read.h"

namespace panwright::importers::gltf {

namespace {

// How far a number of a node's transform may be from its first frame, as a part of its size, and
// still be at rest: single precision, and scales that exporters baked from matrices.
constexpr double kAtRest = 1e-4;
// Names of animations in a message.
constexpr std::size_t kMostNames = 12;

enum class AnimatedPath : std::uint8_t { translation, rotation, scale };

std::optional<AnimatedPath> path_of(std::string_view text) {
  if (text == "translation") return AnimatedPath::translation;
  if (text == "rotation") return AnimatedPath::rotation;
  if (text == "scale") return AnimatedPath::scale;
  return std::nullopt;
}

// Times of keys, of one accessor.
struct Times {
  std::vector<double> list;  // seconds
  bool increasing = true;
};

// Keys of one property.
struct Keys {
  const std::vector<double>& times;  // seconds, increasing
  const std::vector<Vec4>& values;   // per key one; cubic: in-tangent, value, out-tangent
  bool step = false;
  bool cubic = false;
};

Vec4 unit(const Vec4& q) {
  const double length = glm::length(q);
  return length > 0 ? q / length : Vec4(0, 0, 0, 1);
}

// Along the shorter arc between unit quaternions.
Vec4 slerp(const Vec4& a, Vec4 b, double s) {
  double cosine = glm::dot(a, b);
  if (cosine < 0) {
    b = -b;
    cosine = -cosine;
  }
  // so close together that the arc is its chord, to 1e-16
  if (cosine > 1 - 1e-9) return unit(glm::mix(a, b, s));
  const double angle = det::acos(std::fmin(cosine, 1));
  return (det::sin((1 - s) * angle) * a + det::sin(s * angle) * b) / det::sin(angle);
}

Vec4 value_at(const Keys& keys, double time, AnimatedPath path) {
  const bool turns = path == AnimatedPath::rotation;
  const auto value = [&](std::size_t k) {
    const Vec4& v = keys.values[keys.cubic ? 3 * k + 1 : k];
    return turns ? unit(v) : v;
  };
  const std::size_t last = keys.times.size() - 1;
  if (!(time > keys.times.front())) return value(0);
  if (!(time < keys.times.back())) return value(last);
  const auto after = std::upper_bound(keys.times.begin(), keys.times.end(), time);
  const auto k = static_cast<std::size_t>(after - keys.times.begin()) - 1;
  const double span = keys.times[k + 1] - keys.times[k];
  const double s = (time - keys.times[k]) / span;
  if (keys.step) return value(k);
  if (!keys.cubic)
    return turns ? slerp(value(k), value(k + 1), s) : glm::mix(value(k), value(k + 1), s);
  const double s2 = s * s, s3 = s2 * s;
  const Vec4 out = (2 * s3 - 3 * s2 + 1) * keys.values[3 * k + 1] +
                   span * (s3 - 2 * s2 + s) * keys.values[3 * k + 2] +
                   (-2 * s3 + 3 * s2) * keys.values[3 * k + 4] +
                   span * (s3 - s2) * keys.values[3 * k + 3];
  return turns ? unit(out) : out;
}

std::vector<double> rest_of(const tinygltf::Node& node, AnimatedPath path) {
  switch (path) {
    case AnimatedPath::translation:
      return node.translation.size() == 3 ? node.translation : std::vector<double>{0, 0, 0};
    case AnimatedPath::rotation:
      return node.rotation.size() == 4 ? node.rotation : std::vector<double>{0, 0, 0, 1};
    case AnimatedPath::scale:
      break;
  }
  return node.scale.size() == 3 ? node.scale : std::vector<double>{1, 1, 1};
}

// How far apart two values of a property are, as a part of their size.
double difference(const std::vector<double>& rest, const Vec4& posed, AnimatedPath path) {
  double most = 1e-9, apart = 0, turned = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const double x = posed[static_cast<int>(k)];
    most = std::max({most, std::fabs(rest[k]), std::fabs(x)});
    apart = std::fmax(apart, std::fabs(rest[k] - x));
    turned = std::fmax(turned, std::fabs(rest[k] + x));
  }
  // q and −q are one rotation
  return (path == AnimatedPath::rotation ? std::fmin(apart, turned) : apart) / most;
}

class Poser {
 public:
  Poser(Document& document, tinygltf::Model& model, const PoseChoice& choice)
      : d_(document),
        model_(model),
        choice_(choice),
        animations_(document.root.list("animations")) {}

  Result<std::size_t> run() {
    const auto& wanted = choice_.animation;
    if (wanted && *wanted == "none") return std::size_t{0};
    std::vector<std::size_t> chosen;
    if (!choose(chosen)) return failed;
    const bool asked = wanted || choice_.time;
    // before the first key a property is what it is there
    const double time = choice_.time.value_or(-std::numeric_limits<double>::infinity());
    for (const std::size_t i : chosen) evaluate(i, time);
    std::set<std::size_t> moved;
    double furthest = 0;
    for (const Pose& pose : poses_) {
      const std::vector<double> rest = rest_of(model_.nodes[pose.node], pose.path);
      if (!(difference(rest, pose.value, pose.path) > kAtRest)) continue;
      moved.insert(pose.node);
      if (pose.path == AnimatedPath::translation)
        furthest =
            std::fmax(furthest, glm::length(Vec3(pose.value) - Vec3(rest[0], rest[1], rest[2])));
    }
    if (choice_.time) say_if_idle(chosen.size(), moved.size());
    if (!asked && moved.empty()) return std::size_t{0};
    for (const Pose& pose : poses_) place(pose);
    if (!asked)
      d_.report(
          Code("N6216"), nullptr, "/animations",
          fmt::format("the model stands at the first frame of {4}: at rest {0} of {1} animated "
                      "{2} elsewhere, by up to {3:.3g} of the file's units",
                      moved.size(), count_nodes(), moved.size() == 1 ? "node is" : "nodes are",
                      furthest, counted(chosen.size(), "animation")),
          "--animation none keeps the nodes as the file places them, --time SECONDS and "
          "--animation NAME choose another pose; <import> has attributes of these names");
    return chosen.size();
  }

 private:
  // A time that changes nothing.
  void say_if_idle(std::size_t animations, std::size_t moved) {
    const double time = *choice_.time;
    const auto say = [&](const std::string& text) {
      d_.report(Code("N1405"), nullptr, "/animations", text);
    };
    if (animations == 0 || !(first_ <= last_))
      say("--time has no effect: the file has no animation");
    else if (time < first_ || time > last_)
      say(fmt::format("{:.4g} s is {} key of the animations, at {:.4g} s: the nodes have that pose",
                      time, time < first_ ? "before the first" : "after the last",
                      time < first_ ? first_ : last_));
    else if (moved == 0)
      say(fmt::format("at {:.4g} s no node is elsewhere than at rest", time));
  }

  struct Pose {
    std::size_t node;
    AnimatedPath path;
    Vec4 value;
  };

  std::string name_of(std::size_t index) const {
    const Json* name = animations_[index].find("name");
    return name && name->is(Json::Kind::string) ? name->text : std::string();
  }

  // All, or those of the name that is asked for, or the one of that number.
  bool choose(std::vector<std::size_t>& chosen) {
    const auto& wanted = choice_.animation;
    for (std::size_t i = 0; i < animations_.size(); ++i)
      if (!wanted || (!wanted->empty() && name_of(i) == *wanted)) chosen.push_back(i);
    if (!wanted || !chosen.empty()) return true;
    const auto number = parse_double(*wanted);
    if (number && *number >= 0 && *number < static_cast<double>(animations_.size()) &&
        *number == std::floor(*number)) {
      chosen.push_back(static_cast<std::size_t>(*number));
      return true;
    }
    std::string names;
    for (std::size_t i = 0; i < std::min(animations_.size(), kMostNames); ++i)
      names += fmt::format("{}{}", i == 0 ? ": " : ", ", in_quotes(name_of(i)));
    if (animations_.size() > kMostNames) names += "…";
    d_.report(Code("E6217"), nullptr, "/animations",
              fmt::format("unknown animation {}; the file has {}{}", in_quotes(*wanted),
                          counted(animations_.size(), "animation"), names));
    return false;
  }

  void evaluate(std::size_t index, double time) {
    const std::vector<Json>& samplers = animations_[index].list("samplers");
    for (const Json& channel : animations_[index].list("channels")) {
      const Json* sampler = channel.find("sampler");
      const Json* target = channel.find("target");
      const Json* node = target ? target->find("node") : nullptr;
      const Json* path = target ? target->find("path") : nullptr;
      if (channel.broken || !sampler || !node || !path) continue;
      const auto property = path_of(path->text);
      const auto at = static_cast<std::size_t>(sampler->number);
      const auto which = static_cast<std::size_t>(node->number);
      if (!property || at >= samplers.size() || which >= model_.nodes.size()) continue;
      if (!taken_.insert({which, *property}).second) continue;
      const auto keys = keys_of(index, at, samplers[at]);
      if (!keys) continue;
      const Vec4 value = value_at(*keys, time, *property);
      if (std::isfinite(value.x + value.y + value.z + value.w))
        poses_.push_back({which, *property, value});
    }
  }

  // Accessors are read once, however many samplers share them.
  const Times& times_of(std::size_t accessor, const std::string& object) {
    const auto [place, is_new] = times_.try_emplace(accessor);
    Times& times = place->second;
    if (!is_new) return times;
    // the time is the first number of each element
    for (const Vec2& time : read_vectors<Vec2>(d_, accessor, object)) times.list.push_back(time.x);
    times.increasing = std::ranges::adjacent_find(times.list, [](double a, double b) {
                         return !(a < b);
                       }) == times.list.end();
    return times;
  }

  const std::vector<Vec4>& values_of(std::size_t accessor, const std::string& object) {
    const auto [place, is_new] = values_.try_emplace(accessor);
    if (is_new) place->second = read_vectors<Vec4>(d_, accessor, object);
    return place->second;
  }

  std::optional<Keys> keys_of(std::size_t animation, std::size_t index, const Json& sampler) {
    const std::string object =
        fmt::format("{}/samplers/{}", pointer("animations", animation), index);
    const Json* input = sampler.find("input");
    const Json* output = sampler.find("output");
    if (sampler.broken || !input || !output) return std::nullopt;
    const Times& times = times_of(static_cast<std::size_t>(input->number), object + "/input");
    const Json* interpolation = sampler.find("interpolation");
    const Keys keys{times.list,
                    values_of(static_cast<std::size_t>(output->number), object + "/output"),
                    interpolation && interpolation->text == "STEP",
                    interpolation && interpolation->text == "CUBICSPLINE"};
    if (keys.times.empty() || keys.values.empty()) return std::nullopt;
    if (!times.increasing) {
      // zeros that no view holds: times that an exporter left out
      if (d_.accessors[static_cast<std::size_t>(input->number)].view < 0) return std::nullopt;
      d_.report(Code("E6206"), input, object + "/input", "the times of the keys do not increase");
      return std::nullopt;
    }
    first_ = std::min(first_, keys.times.front());
    last_ = std::max(last_, keys.times.back());
    if (keys.values.size() != (keys.cubic ? 3 : 1) * keys.times.size()) {
      d_.report(Code("E6206"), output, object + "/output",
                fmt::format("{} values for {} of {}", keys.values.size(),
                            counted(keys.times.size(), "key"),
                            keys.cubic ? "CUBICSPLINE" : "one value each"));
      return std::nullopt;
    }
    return keys;
  }

  std::size_t count_nodes() const {
    std::set<std::size_t> nodes;
    for (const Pose& pose : poses_) nodes.insert(pose.node);
    return nodes.size();
  }

  void place(const Pose& pose) {
    tinygltf::Node& node = model_.nodes[pose.node];
    // a node that is animated has no matrix, says the specification
    if (node.matrix.size() == 16) return;
    const Vec4& v = pose.value;
    switch (pose.path) {
      case AnimatedPath::translation:
        node.translation = {v.x, v.y, v.z};
        return;
      case AnimatedPath::rotation:
        node.rotation = {v.x, v.y, v.z, v.w};
        return;
      case AnimatedPath::scale:
        node.scale = {v.x, v.y, v.z};
        return;
    }
  }

  Document& d_;
  tinygltf::Model& model_;
  const PoseChoice& choice_;
  const std::vector<Json>& animations_;
  std::set<std::pair<std::size_t, AnimatedPath>> taken_;
  std::vector<Pose> poses_;
  std::map<std::size_t, Times> times_;               // by accessor
  std::map<std::size_t, std::vector<Vec4>> values_;  // by accessor
  // seconds, of the keys of those chosen
  double first_ = std::numeric_limits<double>::infinity();
  double last_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

Result<std::size_t> pose_nodes(Document& document, tinygltf::Model& model,
                               const PoseChoice& choice) {
  return Poser(document, model, choice).run();
}

}  // namespace panwright::importers::gltf
