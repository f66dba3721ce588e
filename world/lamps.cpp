#include "world/lamps.h"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "world/evaluation.h"
#include "world/internal/missing_name.h"

namespace panwright::world {
namespace {

// Frame of what carries a lamp.
struct CarrierFrame {
  Mat3 linear{1};
  Vec3 offset{0};
  Vec3 point(const Vec3& p) const { return linear * p + offset; }
  Vec3 direction(const Vec3& v) const {
    const Vec3 turned = linear * v;
    return turned == Vec3(0) ? v : turned;  // a node of scale 0 along it
  }
};

light::Source placed_source(const light::Source& source, const CarrierFrame& frame) {
  return std::visit(
      [&](auto one) -> light::Source {
        using Kind = decltype(one);
        if constexpr (std::is_same_v<Kind, light::Sun>)
          one.direction = frame.direction(one.direction);
        else
          one.position = frame.point(one.position);
        if constexpr (requires { one.axis; }) one.axis = frame.direction(one.axis);
        return one;
      },
      source);
}

// Evaluates each target once.
class NodeFrames {
 public:
  explicit NodeFrames(const World& world) : world_(world) {}

  std::optional<CarrierFrame> find(const Lamp& lamp) {
    const std::optional<std::size_t> index = world_.find(lamp.target);
    if (!index || !world_[*index].visible()) return std::nullopt;
    const Instance& target = world_[*index];
    auto at = std::ranges::find(known_, *index, &Known::first);
    if (at == known_.end()) at = known_.insert(at, {*index, evaluated(target)});
    const EvaluatedInstance& state = at->second;
    if (lamp.node >= state.model_from_nodes.size() || state.node_visible[lamp.node] == 0)
      return std::nullopt;
    const Mat4& node = state.model_from_nodes[lamp.node];
    const Mat3 turn = glm::mat3_cast(target.pose().rotation);
    return CarrierFrame{turn * Mat3(node), turn * Vec3(node[3]) + target.pose().translation};
  }

 private:
  using Known = std::pair<std::size_t, EvaluatedInstance>;
  const World& world_;
  std::vector<Known> known_;
};

CarrierFrame frame_of_camera(const Camera& camera) {
  return {glm::mat3_cast(camera.world_from_camera), camera.position};
}

}  // namespace

std::vector<Lamp> lamps_of(const std::string& target, const pan::Model& model) {
  std::vector<Lamp> lamps;
  for (std::size_t i = 0; i < model.lamps().size(); ++i) {
    const pan::layout::Lamp& record = model.lamps()[i];
    const auto vector = [](const double(&v)[3]) { return Vec3(v[0], v[1], v[2]); };
    const Vec3 position = vector(record.position), axis = vector(record.axis),
               intensity = vector(record.intensity);
    Lamp& lamp = lamps.emplace_back();
    switch (static_cast<pan::layout::LampKind>(record.kind)) {
      case pan::layout::LampKind::spot:
        lamp.source = light::Spot{position,        axis,         intensity, record.half_angle,
                                  record.exponent, record.radius};
        break;
      case pan::layout::LampKind::point:
        lamp.source = light::Point{position, intensity, record.radius};
        break;
      case pan::layout::LampKind::disc:
        lamp.source = light::Disc{position, axis, intensity, record.radius};
        break;
    }
    lamp.carrier = Lamp::Carrier::node;
    lamp.target = target;
    lamp.node = record.node;
    lamp.on = (record.flags & pan::layout::kLampOff) == 0;
    lamp.name = model.lamp_name(i);
    if ((record.flags & pan::layout::kLampPulsed) != 0)
      lamp.pulse = Pulse{record.pulse[0], record.pulse[1]};
  }
  return lamps;
}

std::vector<light::Source> placed_lamps(const World& world, const Camera& camera) {
  std::vector<light::Source> placed;
  NodeFrames nodes(world);
  for (const Lamp& lamp : world.lamps()) {
    if (!lamp.on) continue;
    std::optional<CarrierFrame> frame;
    switch (lamp.carrier) {
      case Lamp::Carrier::world:
        frame.emplace();
        break;
      case Lamp::Carrier::camera:
        frame = frame_of_camera(camera);
        break;
      case Lamp::Carrier::node:
        frame = nodes.find(lamp);
        break;
    }
    if (!frame) continue;
    const light::Source source = placed_source(lamp.source, *frame);
    // what overflows is nowhere
    if (light::is_sound(source)) placed.push_back(source);
  }
  return placed;
}

bool put_on_node(Lamp& lamp, const World& world, std::size_t target, std::string_view name,
                 DiagnosticLog& log) {
  const pan::Model& model = *world[target].model();
  lamp.carrier = Lamp::Carrier::node;
  lamp.target = world[target].name();
  if (const auto found = model.find_frame(name)) {
    const pan::layout::Frame& frame = model.frames()[*found];
    const Quat turn(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]);
    const Vec3 origin(frame.origin[0], frame.origin[1], frame.origin[2]);
    lamp.source = placed_source(lamp.source, {glm::mat3_cast(turn), origin});
    lamp.node = frame.node;
    return true;
  }
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < model.frames().size(); ++i) names.push_back(model.frame_name(i));
  for (std::size_t i = 0; i < model.nodes().size(); ++i)
    if (model.node_path(i) == name) {
      lamp.node = static_cast<std::uint32_t>(i);
      return true;
    }
  report_missing(Code("E5005"), model.name(), "unknown frame or node", name, names, log);
  return false;
}

std::vector<Lamp> lamps_during(std::vector<Lamp> lamps, double begin, double end) {
  for (Lamp& lamp : lamps) {
    if (!lamp.pulse) continue;
    const Pulse pulse = *lamp.pulse;
    lamp.pulse.reset();
    const double common = std::min(end, pulse.end) - std::max(begin, pulse.begin);
    const bool at_once = pulse.begin <= begin && begin < pulse.end;
    const double share = begin < end ? std::clamp(common / (end - begin), 0.0, 1.0)
                         : at_once   ? 1.0
                                     : 0.0;
    lamp.on = lamp.on && share > 0;
    if (!lamp.on || share == 1) continue;
    std::visit(
        [&](auto& source) {
          if constexpr (requires { source.intensity; })
            source.intensity *= share;
          else
            source.irradiance = share * source.irradiance.value_or(Vec3(1));
        },
        lamp.source);
  }
  return lamps;
}

void fix_lamps(World& world, const Camera& camera) {
  std::vector<Lamp> lamps(world.lamps().begin(), world.lamps().end());
  for (Lamp& lamp : lamps) {
    if (lamp.carrier != Lamp::Carrier::camera) continue;
    lamp.carrier = Lamp::Carrier::world;
    lamp.source = placed_source(lamp.source, frame_of_camera(camera));
  }
  world.set_lamps(std::move(lamps));
}

}  // namespace panwright::world
