#include "preview/frame/lights.h"

#include <algorithm>
#include <cmath>

#include "light/light.h"
#include "preview/frame/blocks.h"
#include "sky/sky.h"
#include "world/lamps.h"

namespace panwright::preview {
namespace {

static_assert(sky::Sunset::kNodes == kSunsetNodes);

constexpr std::uint64_t kLampBytes = 1ull << 26;  // two maps of 2048, or 32 of 512
constexpr unsigned kPlanetSide = 512;
constexpr unsigned kShadowSide = 2048;  // where a pixel is few samples, or the Sun has many points

// What coarse texels lose of the light of foil and trusses is in docs/accuracy/shadows.md.
// Imposters' come in steps of a half octave, so that one map serves draws that differ little.
unsigned shadow_side_for(std::uint32_t texels, unsigned samples) {
  constexpr double kOfTexels = 5;
  constexpr double kLeast = 256;
  constexpr double kMost = 2896;
  if (texels == 0) return samples > 0 ? kShadowSide : static_cast<unsigned>(kMost);
  const double step = std::round(2 * std::log2(kOfTexels * texels)) / 2;
  return static_cast<unsigned>(std::clamp(std::exp2(step), kLeast, kMost)) / 16 * 16;
}

void add_shadows(const ShadowMaps& maps, SamplingReport& report) {
  report.shadow_edge = std::max(report.shadow_edge, maps.edge_error());
  report.penumbra = std::max(report.penumbra, maps.penumbra());
  report.sun_points = std::max(report.sun_points, maps.disc_points());
  report.sun_error = error_of_sun_points(report.sun_points);
}

void copy_light(const light::Incidence& light, LightBlock& block) {
  copy_floats(light.to_light, block.to_light);
  copy_floats(light.irradiance, block.irradiance);
  block.alpha2 = static_cast<float>(light.alpha2);
  block.limb_darkening = static_cast<float>(light.limb);
}

// Of a sphere around a receiver, metres.
double radius_of(const AxisBox& bounds) {
  return std::max(0.5 * glm::length(bounds.high - bounds.low), 1e-3);
}

void add_sunset(const sky::Sunset& sunset, LightBlock& block) {
  copy_floats(sunset.edge.gradient, block.eclipse);
  block.eclipse[3] = static_cast<float>(sunset.edge.value);
  block.sunset[0] = static_cast<float>(sunset.first);
  block.sunset[1] = static_cast<float>(1 / sunset.step);
  for (std::size_t k = 0; k < kSunsetNodes; ++k) {
    copy_floats(sunset.shares[k], block.sunset_shares + 4 * k);
    copy_floats(sunset.through[k], block.sunset_through + 4 * k);
  }
}

// Sets the shadow's edge of a body across a receiver; without shadow maps, and so without places of
// samples, its light at the middle. Returns whether the receiver has nothing of the Sun.
bool add_eclipse(const sky::Sky& sky, const Vec3& origin, double radius, bool places, bool bends,
                 LightBlock& block) {
  if (!places) {
    const Vec3 share = sky.sunlight(origin);
    for (int k = 0; k < 3; ++k) block.irradiance[k] *= static_cast<float>(share[k]);
    return share == Vec3(0);
  }
  const auto sunset = bends ? sky.sunset(origin, radius) : std::nullopt;
  if (sunset) add_sunset(*sunset, block);
  const auto bodies =
      bends ? sky.near_eclipses(origin, radius, sunset ? std::optional(sunset->body) : std::nullopt)
            : std::vector<sky::NearEclipse>();
  if (!bodies.empty()) {
    block.eclipses = static_cast<std::int32_t>(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const sky::NearEclipse& one = bodies[i];
      for (int row = 0; row < 3; ++row) {
        float* to = block.eclipse_space + 4 * (3 * i + static_cast<std::size_t>(row));
        for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(one.unit_from_world[k][row]);
        to[3] = static_cast<float>(one.from[row]);
      }
      copy_floats(one.to_sun, block.eclipse_sun + 12 * i);
      copy_floats(one.along, block.eclipse_sun + 12 * i + 4);
      copy_floats(one.across, block.eclipse_sun + 12 * i + 8);
    }
    // all of a ball that is smaller than the Sun's disc
    const light::Body& body = sky.body(bodies[0].body);
    const double most = body.radii.x;
    const bool ball = body.radii.y == most && body.radii.z == most && bodies.size() == 1 && !sunset;
    const double nearest = std::max(glm::length(body.centre - origin) - radius, most);
    block.eclipse_chords =
        static_cast<float>(ball ? std::min(1.05 * most / nearest / sky.sun_sine(), 1.0) : 1);
    return false;
  }
  // samples may stand a whole width of the bounds off
  if (sunset)
    return sunset->edge.value + 2 * radius * glm::length(sunset->edge.gradient) < sunset->first;
  const auto edge = sky.eclipse_edge(origin, radius);
  if (!edge) return false;
  copy_floats(edge->gradient, block.eclipse);
  block.eclipse[3] = static_cast<float>(edge->value);
  return edge->value + 2 * radius * glm::length(edge->gradient) < -1;
}

}  // namespace

void Lights::begin_image(const world::World& world, const world::Camera& camera,
                         const RenderOptions& options) {
  const world::Sun& sun = world.sun();
  maps_.begin_image();
  sunlight_ = options.sunlight;
  lamps_.begin_image(world::placed_lamps(world, camera));
  planets_.begin_image(world, options);
  indirect_.begin_image(options);
  SunDisc& disc = limits_.disc;
  disc = {};
  if (options.shadows == Shadows::hard ||
      (options.shadows == Shadows::automatic && options.samples > 0))
    return;
  disc.tangent = std::tan(std::asin(std::min(world::kSunSineAtOneAu / sun.distance, 0.999)));
  disc.limb_darkening = sun.limb_darkening;
  disc.always = options.shadows == Shadows::soft;
  disc.limited = !disc.always && options.work > 0;
  disc.most = options.sun_points;
  disc.points = disc.always ? options.sun_points
                            : std::min(options.sun_points, sun_points_for(options.pixel_error));
}

void Lights::begin_scene(const FrameScene& scene, const RenderOptions& options) {
  limits_.side = options.shadow_side.value_or(shadow_side_for(scene.texels, options.samples));
  limits_.soft_side = options.shadow_side.value_or(std::min(limits_.side, kShadowSide));
  limits_.bytes = options.max_shadow_bytes;
  lamp_bytes_ = options.max_shadow_bytes / 2;
  if (!options.shadow_side) lamp_bytes_ = std::min(lamp_bytes_, kLampBytes);
  lamps_.begin_scene(scene, limits_.disc);
  planets_.begin_scene(scene);
  eclipsed_ = false;
  if (scene.world.bodies().empty() || !shadows()) return;
  const sky::Sky sky(scene.world);
  for (std::size_t r = 0; r < scene.visible.targets.size(); ++r) {
    const AxisBox& box = *scene.state(r).bounds;
    const world::Pose& pose = scene.world[scene.visible.targets[r].target].pose();
    const Vec3 centre = pose.translation + pose.rotation * (0.5 * (box.low + box.high));
    const double radius = radius_of(box);
    eclipsed_ =
        eclipsed_ || sky.sunset_near(centre, radius) || !sky.near_eclipses(centre, radius).empty();
  }
}

bool Lights::update(Device::Impl& device, const FrameScene& scene, SamplingReport& report,
                    DiagnosticLog& log, const Job& job) {
  const GladGLContext& gl = device.context->gl();
  const std::size_t receivers = scene.visible.targets.size();
  samples_.clear();
  views_.assign(receivers, {});
  // from infinity: the same everywhere
  light::Incidence sunlight = light::incidence(scene.world.sun(), scene.camera.position);
  if (!sunlight_) sunlight.irradiance = Vec3(0);
  const bool shines = max_component(sunlight.irradiance) > 0;
  std::size_t dark = 0;  // receivers without the Sun
  std::optional<sky::Sky> sky;
  if (!scene.world.bodies().empty()) sky.emplace(scene.world);
  for (std::size_t r = 0; r < receivers; ++r) {
    const VisibleTarget& visible = scene.visible.targets[r];
    samples_.push_back(preview::model_from_sample(scene.camera, scene.world[visible.target].pose(),
                                                  *scene.state(r).bounds, visible));
    copy_light(sunlight, views_[r].block);
    views_[r].block.eclipse[3] = 1;
    bool eclipsed = false;
    if (sky) {
      const Mat4 world_from_sample = scene.world[visible.target].pose().matrix() * samples_[r];
      eclipsed = add_eclipse(*sky, Vec3(world_from_sample[3]), radius_of(*scene.state(r).bounds),
                             shadows(), eclipsed_, views_[r].block);
    }
    if (!shines || eclipsed) ++dark;
  }
  // a light that is off casts no shadows: blocks without points read no maps
  if (shadows() && dark < receivers) {
    if (!maps_.update(device, scene, limits_, log, job)) return false;
    add_shadows(maps_, report);
    for (std::size_t r = 0; r < receivers; ++r) maps_.add_to(views_[r], r, samples_[r]);
  }
  blocks_.upload(gl, views_.size(),
                 [&](std::size_t i, LightBlock& block) { block = views_[i].block; });
  const unsigned side = std::min(limits_.side, kShadowSide);
  return indirect_.update(*device.context, scene, samples_, log) &&
         planets_.update(device, scene, samples_, std::min(side, kPlanetSide), lamp_bytes_, log,
                         job) &&
         lamps_.update(device, scene, samples_, side, lamp_bytes_, report, log, job);
}

void Lights::bind(const GladGLContext& gl, std::size_t pass, std::size_t receiver) const {
  if (pass > 0) return lamps_.bind(gl, receiver);
  if (planets_.any()) planets_.bind(gl, receiver);
  if (indirect_.any()) indirect_.bind(gl, receiver);
  blocks_.bind(gl, kLightBinding, receiver);
  if (views_[receiver].depths == 0) return;
  gl.BindTextureUnit(kShadowDepthsUnit, views_[receiver].depths);
  gl.BindTextureUnit(kShadowSlopesUnit, views_[receiver].slopes);
}

}  // namespace panwright::preview
