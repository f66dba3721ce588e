#include "server/stage.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "server/packing.h"
#include "workspace/targets.h"
#include "world/evaluation.h"

namespace panwright::server {

namespace {

using workspace::Settings;

constexpr std::uint32_t layer_bit(image::FileLayer layer) {
  return 1u << static_cast<unsigned>(layer);
}

Vec3 irradiance_of(const world::Sun& sun) { return sun.irradiance.value_or(Vec3(1)); }

// The twelve vertices of an icosahedron: the sum of their positive cosines is 3 within 8 % for any
// normal, so that each gives a third of the light.
std::vector<Vec3> even_directions() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> out;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 v(0);
        v[axis] = a;
        v[(axis + 1) % 3] = b;
        out.push_back(glm::normalize(v));
      }
  return out;
}

}  // namespace

Result<std::unique_ptr<Stage>> Stage::open(const StageOptions& options, DiagnosticLog& log,
                                           const Job& job) {
  std::vector<workspace::TargetFile> targets;
  for (const std::string& text : options.targets) targets.push_back(workspace::target_file(text));
  if (!options.defaults.ev->number) {
    log.report(
        Code("E0201"), {},
        "--ev is 'auto', expected a number of stops: replies do not depend on earlier images");
    return failed;
  }
  auto world = targets.empty() && workspace::shows_sky(options.defaults)
                   ? Result<world::World>(world::World())
                   : workspace::open_world(targets, options.open, log, job);
  if (!world) return failed;
  std::unique_ptr<Stage> stage(new Stage(options, *std::move(world)));
  if (!stage->begin(log)) return failed;
  return stage;
}

workspace::View Stage::view_at(const world::Pose& pose) const {
  workspace::View view(options_.defaults);
  view.settings.camera = pose.translation;
  view.settings.quat = pose.rotation;
  view.settings.look_at = Settings().look_at;
  view.settings.camera_frame = Settings().camera_frame;
  return view;
}

bool Stage::begin(DiagnosticLog& log) {
  workspace::View view(options_.defaults);
  view.motion = [&](double, DiagnosticLog&) { return std::optional(options_.defaults); };
  auto frame = maker_.frame(view, log);
  if (!frame) return false;
  base_ = *std::move(frame);
  base_.moments.clear();
  base_.shutter.reset();
  initial_.world = maker_world_;
  workspace::show(base_, maker_world_, initial_.world);
  initial_.viewpoint = {base_.camera().position, base_.camera().world_from_camera};
  if (base_.sky) {
    catalogue_ = base_.sky->stars.catalogue;
    initial_.world_from_icrs = base_.sky->stars.world_from_icrs;
    initial_.faintest = base_.sky->stars.faintest;
    if (catalogue_) initial_.sky.type = 2;
  }
  if (!catalogue_) {
    // stars may be switched on later; without a catalogue they stay off
    DiagnosticLog apart = log.apart();
    workspace::View with_stars = view_at(initial_.viewpoint);
    with_stars.motion = view.motion;
    with_stars.settings.stars = initial_.faintest;
    if (const auto starry = maker_.frame(with_stars, apart); starry && starry->sky)
      catalogue_ = starry->sky->stars.catalogue;
  }
  const world::Sun& sun = initial_.world.sun();
  if (base_.white || sun.irradiance) initial_.world.set_white(initial_.world.white());
  return true;
}

std::optional<std::size_t> Stage::target_of(const State& state, std::uint32_t object) const {
  if (const auto named = state.world.find(std::to_string(object))) return named;
  if (object < state.world.size()) return object;
  return std::nullopt;
}

std::optional<ObjectFrame> Stage::frame_of(const State& state, std::uint32_t camera) const {
  if (camera < kFirstFrameCamera) return std::nullopt;
  std::size_t left = camera - kFirstFrameCamera;
  for (std::size_t i = 0; i < state.world.size(); ++i) {
    const std::size_t count = state.world[i].model()->frames().size();
    if (left < count) return ObjectFrame{i, static_cast<std::uint32_t>(left)};
    left -= count;
  }
  return std::nullopt;
}

world::Pose Stage::pose_of(const State& state, const ObjectFrame& at) const {
  const world::Instance& target = state.world[at.target];
  const pan::layout::Frame& frame = target.model()->frames()[at.frame];
  const auto nodes = world::evaluated(target);
  world::Camera camera;
  world::place_in_frame(
      camera, target.pose().matrix() * nodes.model_from_nodes[frame.node],
      Vec3(frame.origin[0], frame.origin[1], frame.origin[2]),
      Quat(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]));
  return {camera.position, camera.world_from_camera};
}

std::optional<world::Camera> Stage::camera_of(const State& state, std::uint32_t number) const {
  world::Camera camera = base_.camera();
  world::Pose pose = state.viewpoint;
  if (own_camera(number) != 0) {
    const auto frame = frame_of(state, number);
    if (!frame) return std::nullopt;
    pose = pose_of(state, *frame);
  }
  camera.position = pose.translation;
  camera.world_from_camera = pose.rotation;
  const auto found = state.lenses.find(own_camera(number));
  if (found == state.lenses.end()) return camera;
  const Lens& lens = found->second;
  const Vec2 middle(0.5 * camera.width, 0.5 * camera.height);
  if (lens.orthographic) {
    camera.projection = world::Projection::orthographic;
    camera.distortion = nullptr;
    camera.principal = middle;
    camera.focal = Vec2(camera.width / lens.ortho.x, camera.height / lens.ortho.y);
  } else if (lens.field_of_view || lens.aspect) {
    if (lens.field_of_view) {
      world::set_field_of_view(camera, camera.width, camera.height, *lens.field_of_view);
      camera.projection = world::Projection::perspective;
      camera.distortion = nullptr;
    }
    camera.focal.y = camera.focal.x * lens.aspect.value_or(1);
  }
  return camera;
}

void Stage::light_world(const State& state, const world::Camera& camera,
                        world::World& world) const {
  std::vector<world::Lamp> lamps(world.lamps().begin(), world.lamps().end());
  if (state.light.on && own_camera(state.light.camera) == own_camera(state.camera)) {
    world::Lamp lamp;
    lamp.carrier = world::Lamp::Carrier::camera;
    const Vec3& intensity = state.light.intensity;
    if (state.light.half_angle > 0.75 * kPi)
      lamp.source = light::Point{state.light.position, intensity, 0};
    else
      lamp.source = light::Spot{state.light.position,   state.light.axis,     intensity,
                                state.light.half_angle, state.light.exponent, 0};
    lamps.push_back(lamp);
  }
  if (max_component(state.ambient) > 0)
    for (const Vec3& direction : even_directions()) {
      world::Lamp lamp;
      lamp.source =
          light::Sun{.direction = direction,
                     .irradiance = state.ambient * irradiance_of(initial_.world.sun()) / 3.0};
      lamps.push_back(lamp);
    }
  const auto on = std::ranges::count_if(lamps, &world::Lamp::on);
  if (static_cast<std::size_t>(on) <= world::World::kMaxLamps) world.set_lamps(std::move(lamps));
  if (catalogue_ && (state.sky.shows_stars() || world.stars().catalogue)) {
    light::Stars stars = base_.sky ? base_.sky->stars : light::Stars();
    stars.catalogue = state.sky.shows_stars() ? catalogue_ : nullptr;
    stars.faintest = state.faintest;
    stars.world_from_icrs = state.world_from_icrs;
    world.set_stars(stars);
  }
  (void)camera;
}

bool Stage::add_motion(const State& state, const world::Camera& camera, const Lens& lens,
                       workspace::Frame& frame, DiagnosticLog& log) {
  const world::Pose start{camera.position, camera.world_from_camera};
  workspace::View view = view_at(start);
  const auto place_targets = [&](Settings& settings) {
    std::vector<workspace::PoseSetting> poses;
    for (const world::Instance& target : state.world.instances())
      poses.push_back({target.name(), target.pose()});
    settings.pose = poses;
  };
  place_targets(view.settings);
  view.motion = [&](double time, DiagnosticLog&) -> std::optional<Settings> {
    workspace::View then = view_at(lens.motion.at(start, time));
    place_targets(then.settings);
    return then.settings;
  };
  auto moving = maker_.frame(view, log);
  if (!moving) return false;
  frame.shutter = moving->shutter;
  for (const workspace::Moment& moment : moving->moments) {
    workspace::Moment own;
    own.position = moment.position;
    own.world_from_camera = moment.world_from_camera;
    frame.moments.push_back(std::move(own));
  }
  return true;
}

bool Stage::draw(const State& state, const world::Camera& camera, const Lens* lens, bool ranges,
                 const std::function<void(Drawing& drawing)>& use, DiagnosticLog& log,
                 const Job& job) {
  world::World world = state.world;
  light_world(state, camera, world);
  workspace::Frame frame;
  frame.settings = base_.settings;
  frame.imager = base_.imager;
  frame.instrument = workspace::CameraInstrument(camera);
  std::uint32_t layers = layer_bit(image::FileLayer::radiance) |
                         layer_bit(image::FileLayer::coverage) | layer_bit(image::FileLayer::dn);
  if (ranges) layers |= layer_bit(image::FileLayer::range) | layer_bit(image::FileLayer::depth);
  frame.settings.layers = layers;
  if (lens != nullptr && !lens->motion.still() && !add_motion(state, camera, *lens, frame, log))
    return false;
  const double white = max_component(irradiance_of(initial_.world.sun())) *
                       std::exp2(-*options_.defaults.ev->number);
  workspace::RunOptions options;
  options.context = options_.context;
  options.listener.kept = [&](workspace::Kept& kept) {
    auto& product = std::get<workspace::ImageProduct>(kept.product);
    Drawing drawing{std::move(product.image), white};
    use(drawing);
    product.image = std::move(drawing.image);
  };
  return bool(runner_.run(world, std::span(&frame, 1), options, log, job));
}

trace::Scene& Stage::rays(const State& state, const Job& job) {
  rays_.update(state.world, job);
  rays_.place_observer({state.viewpoint.translation, Quat(1, 0, 0, 0)});
  return rays_;
}

}  // namespace panwright::server
