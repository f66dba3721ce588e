#include "preview/reference/ground_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "preview/reference/internal/ground_shine.h"
#include "preview/reference/internal/path.h"
#include "preview/reference/internal/trace_scene.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview {

using namespace reference;

namespace {

// Depths of targets; where there is none, the largest of the pixels around, else 0.
std::vector<float> depths_of_targets(const image::Image& image) {
  std::vector<float> depths(image.pixels(), 0);
  const auto width = static_cast<std::int64_t>(image.width),
             height = static_cast<std::int64_t>(image.height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      float& depth = depths[static_cast<std::size_t>(y * width + x)];
      depth = image.depth[static_cast<std::size_t>(y * width + x)];
      if (std::isfinite(depth)) continue;
      depth = 0;
      for (std::int64_t j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, width - 1);
             ++i) {
          const float other = image.depth[static_cast<std::size_t>(j * width + i)];
          if (std::isfinite(other)) depth = std::max(depth, other);
        }
    }
  return depths;
}

Vec2 gaussian_of(double u, double v) {
  const double radius = std::sqrt(-2 * det::log(u));
  const det::SinCos turn = det::sincos(2 * kPi * v);
  return radius * Vec2(turn.cos, turn.sin);
}

// One view of terrain.
struct GroundView {
  const TraceScene& scene;
  const world::Camera& camera;
  const GroundOptions& options;
  std::vector<Sun> suns;
  std::vector<Bodies> bodies;
  TraceLamps lamps;
  PathOptions path;

  struct Sums {
    Vec3 before{0}, behind{0};  // radiance
    double before_share = 0, behind_share = 0;
  };
  // Ray of a pixel, and what it meets.
  struct Sample {
    trace::Ray ray;
    trace::Hit hit;
    std::uint32_t column, row, number;
    Vec2 sun;  // place on the disc
    Vec3 light{0};
  };

  void add_samples(std::uint32_t column, std::uint32_t row, std::vector<Sample>& out) const {
    const std::uint32_t side = options.samples, count = side * side;
    const std::array<double, 4> turn = numbers({row * camera.width + column, 0, 0, 0}, 0);
    for (std::uint32_t k = 0; k < count; ++k) {
      // steps of a plane-filling sequence
      const auto step = [&](double at, double by) {
        const double x = at + k * by;
        return x - std::floor(x);
      };
      Vec2 place(column + (k % side + 0.5) / side, row + (k / side + 0.5) / side);
      if (options.psf_sigma > 0)
        place += options.psf_sigma * gaussian_of(1 - step(turn[2], 0.7548776662466927),
                                                 step(turn[3], 0.5698402909980532));
      const auto ray = view_ray(camera, place);
      if (!ray) continue;
      out.push_back({{*ray, trace::Ray::kObserver},
                     {},
                     column,
                     row,
                     k,
                     {step(turn[0], 0.7548776662466927), step(turn[1], 0.5698402909980532)}});
    }
  }

  // Beams of the rays to the Sun from where samples meet terrain: of the target of the first.
  trace::GroundBeams sun_beams(std::span<const Sample> samples) const {
    AxisBox box;
    std::optional<std::uint32_t> target;
    for (const Sample& sample : samples) {
      if (!sample.hit) continue;
      if (!target) target = sample.hit.target;
      if (sample.hit.target == *target) box.add(sample.hit.position);
    }
    if (!target) return {};
    const Sun& sun = suns[*target];
    // they start beside these places
    const double radius = 1 + 0.55 * box.diagonal();
    return scene.rays().ground_beams({box.centre(), radius, sun.centre(), 1.001 * sun.sine(), true},
                                     *target);
  }

  Sums pixel(std::span<const Sample> samples, double depth) const {
    Sums sums;
    const double count = options.samples * options.samples;
    for (const Sample& sample : samples) {
      if (!sample.hit) continue;
      const Vec3& light = sample.light;
      const geometry::Ray& ray = sample.ray;
      const bool before = ray.origin.z + sample.hit.distance * ray.direction.z < depth;
      (before ? sums.before : sums.behind) += light / count;
      (before ? sums.before_share : sums.behind_share) += 1.0 / count;
    }
    return sums;
  }

  // Pixels of a square, its corner at (left, top).
  void add_square(std::uint32_t left, std::uint32_t top, std::uint32_t side,
                  std::span<const float> depths, image::Image& image) const {
    const std::uint32_t right = std::min(left + side, image.width),
                        bottom = std::min(top + side, image.height);
    static thread_local std::vector<Sample> samples;
    samples.clear();
    for (std::uint32_t row = top; row < bottom; ++row)
      for (std::uint32_t column = left; column < right; ++column) add_samples(column, row, samples);
    const trace::GroundBeams beams =
        scene.rays().ground_beams(beam_about(samples), trace::Ray::kObserver);
    meet(samples, beams);
    const trace::GroundBeams to_sun = sun_beams(samples);
    PathOptions lit = path;
    lit.beams = &to_sun;
    light(samples, lit);
    static thread_local std::vector<Sample> centres;
    centres.clear();
    for (auto next = samples.begin(); next != samples.end();) {
      const auto begin = next;
      while (next != samples.end() && next->column == begin->column && next->row == begin->row)
        ++next;
      if (!add_pixel({begin, next}, depths, image) || !options.truth) continue;
      if (const auto ray = view_ray(camera, {begin->column + 0.5, begin->row + 0.5}))
        centres.push_back(
            {{*ray, trace::Ray::kObserver}, begin->hit, begin->column, begin->row, 0, Vec2(0)});
    }
    // the only sample of a pixel is its centre
    if (options.samples > 1 || options.psf_sigma > 0) meet(centres, beams);
    for (const Sample& centre : centres) set_truth(centre, image);
  }

  void meet(std::span<Sample> samples, const trace::GroundBeams& beams) const {
    static thread_local std::vector<trace::Ray> rays;
    static thread_local std::vector<trace::Hit> hits;
    rays.clear();
    for (const Sample& sample : samples) rays.push_back(sample.ray);
    hits.resize(rays.size());
    scene.rays().nearest_ground(rays, hits, beams);
    for (std::size_t i = 0; i < hits.size(); ++i) samples[i].hit = hits[i];
  }

  void light(std::span<Sample> samples, const PathOptions& lit) const {
    static thread_local std::vector<SunSample> seen;
    static thread_local std::vector<Vec3> radiances;
    seen.clear();
    for (const Sample& sample : samples)
      if (sample.hit) seen.push_back({&sample.hit, sample.sun});
    radiances.resize(seen.size());
    if (lit.lamps == nullptr && bodies.empty() && sunlit(scene, suns, seen, lit, radiances)) {
      auto next = radiances.begin();
      for (Sample& sample : samples)
        if (sample.hit) sample.light = *next++;
      return;
    }
    RayCounts counts;
    for (Sample& sample : samples) {
      if (!sample.hit) continue;
      FirstRandoms first;
      first.sun = sample.sun;
      const std::uint32_t number = sample.row * camera.width + sample.column;
      sample.light = traced_from(scene, suns, bodies, sample.hit, first,
                                 {number, 0, sample.number, 0}, lit, counts)
                         .radiance;
    }
  }

  // Returns whether terrain is in it.
  bool add_pixel(std::span<const Sample> samples, std::span<const float> depths,
                 image::Image& image) const {
    const std::uint32_t column = samples[0].column, row = samples[0].row;
    const std::size_t pixel = std::size_t{row} * image.width + column;
    const float covered = image.coverage[pixel];
    const Sums sums = this->pixel(samples, covered > 0 ? double(depths[pixel]) : 0);
    if (sums.before_share + sums.behind_share == 0) return false;
    const double left = 1 - sums.before_share, open = 1 - double(covered);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<int>(k);
      float& light = image.radiance[3 * pixel + k];
      light = static_cast<float>(double(light) * left + sums.before[i] + open * sums.behind[i]);
    }
    image.coverage[pixel] = static_cast<float>(
        std::min(1.0, double(covered) * left + sums.before_share + open * sums.behind_share));
    return true;
  }

  static terrain::RayBeam beam_about(std::span<const Sample> samples) {
    AxisBox origins, directions;
    for (const Sample& sample : samples) {
      origins.add(sample.ray.origin);
      directions.add(sample.ray.direction);
    }
    if (origins.empty()) return {Vec3(0), 0, Vec3(0, 0, 1), kPi};
    // of unit vectors half a radian apart at most: half the diagonal, and a tenth for arcs and the
    // centre's length
    return {origins.centre(), 0.5 * origins.diagonal(), glm::normalize(directions.centre()),
            0.65 * directions.diagonal()};
  }

  // centre: of a pixel
  void set_truth(const Sample& centre, image::Image& image) const {
    const std::size_t pixel = std::size_t{centre.row} * image.width + centre.column;
    const trace::Hit& hit = centre.hit;
    const double depth = centre.ray.origin.z + hit.distance * centre.ray.direction.z;
    if (!hit || !(depth < double(image.depth[pixel]))) return;
    const trace::Scene::Placed& placed = scene.rays().targets()[hit.target];
    const Vec3 normal = placed.frame.world_from * placed.target->normal(hit, options.flat);
    const trace::Ids ids = scene.rays().ids(hit);
    image.depth[pixel] = static_cast<float>(depth);
    image.range[pixel] = static_cast<float>(hit.distance);
    for (std::size_t k = 0; k < 3; ++k)
      image.normal[3 * pixel + k] = static_cast<float>(normal[static_cast<int>(k)]);
    image.target_id[pixel] = ids.target;
    image.node_id[pixel] = ids.node;
    image.material_id[pixel] = ids.material;
  }
};

}  // namespace

struct GroundLayer::Impl {
  TraceScene scene{true};
  std::vector<Stamp> shine_key;  // what `shine` depends on
  std::shared_ptr<const std::vector<light::GroundShine>> shine;
};

GroundLayer::GroundLayer() : impl_(std::make_unique<Impl>()) {}
GroundLayer::GroundLayer(GroundLayer&&) noexcept = default;
GroundLayer& GroundLayer::operator=(GroundLayer&&) noexcept = default;
GroundLayer::~GroundLayer() = default;

// H. Sato et al., "Resolved Hapke parameter maps of the Moon", 2014: means of maps.
materials::Material lunar_regolith() {
  materials::Material material;
  material.weights = Vec3(1, 0, 0);
  material.diffuse = Vec3(1);
  material.diffuse_brdf = materials::Hapke{
      .w = 0.384, .h = 0.052, .b0 = 1.70, .roughness = 23.657 * kDegree, .b = 0.229, .c = 0.426};
  materials::fit(material);
  return material;
}

bool has_ground(const world::Instance& target) {
  return std::ranges::any_of(target.model()->directory(), [](const auto& entry) {
    return entry.kind == terrain::kTilesSection;
  });
}

bool has_ground(const world::World& world) {
  return std::ranges::any_of(world.instances(),
                             [](const world::Instance& target) { return has_ground(target); });
}

void GroundLayer::add(const world::World& world, const world::Camera& camera,
                      const GroundOptions& options, image::Image& image, const Job& job) {
  TraceScene& scene = impl_->scene;
  scene.update(world, job);
  const double half_pixel = trace::half_pixel(camera);
  scene.place_camera(camera, half_pixel);
  GroundView view{scene, camera, options, {}, {}, {}, {}};
  for (const trace::Scene::Placed& placed : scene.rays().targets()) {
    view.suns.emplace_back(world.sun(), placed.frame.world_from, options.sun_disc);
    if (!world.bodies().empty())
      view.bodies.emplace_back(world.bodies(), placed.frame, view.suns.back(),
                               radiance_unit(world));
  }
  view.lamps = trace_lamps(world, camera, scene.rays());
  view.path = {world.lamps().empty() ? nullptr : &view.lamps, 0, options.flat, world.white()};
  const bool parallel = camera.projection == world::Projection::orthographic;
  view.path.footprint = {parallel ? 1 / (camera.focal.x * options.samples) : 0,
                         2 * half_pixel / options.samples};
  std::vector<float> depths;  // empty: of no target
  if (std::ranges::any_of(image.coverage, [](float covered) { return covered > 0; }))
    depths = depths_of_targets(image);
  // some hundred rays look together
  const std::uint32_t side = std::max(1u, 16 / options.samples);
  const std::uint32_t across = (image.width + side - 1) / side,
                      down = (image.height + side - 1) / side;
  parallel_for(
      std::size_t{across} * down,
      [&](std::size_t square) {
        const auto i = static_cast<std::uint32_t>(square);
        view.add_square(i % across * side, i / across * side, side, depths, image);
      },
      job);
}

std::shared_ptr<const std::vector<light::GroundShine>> GroundLayer::shine(const world::World& world,
                                                                          const Job& job) {
  if (!has_ground(world)) return nullptr;
  std::vector<Stamp> key{world.sun_stamp(), world.sky_stamp()};
  for (const world::Instance& target : world.instances()) {
    key.push_back(target.shape_stamp());
    key.push_back(target.pose_stamp());
  }
  if (impl_->shine && key == impl_->shine_key) return impl_->shine;
  TraceScene& scene = impl_->scene;
  scene.update(world, job);
  std::vector<Sun> suns;
  std::vector<Bodies> bodies;
  for (const trace::Scene::Placed& placed : scene.rays().targets()) {
    suns.emplace_back(world.sun(), placed.frame.world_from, true);
    if (!world.bodies().empty())
      bodies.emplace_back(world.bodies(), placed.frame, suns.back(), radiance_unit(world));
  }
  auto shine = std::make_shared<std::vector<light::GroundShine>>(world.size());
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    const trace::Target& target = *scene.rays().targets()[i].target;
    if (target.ground() == nullptr && !target.bounds().empty())
      (*shine)[i] = ground_shine(scene, suns, bodies, i, job);
  }
  impl_->shine_key = std::move(key);
  impl_->shine = std::move(shine);
  return impl_->shine;
}

void GroundLayer::report_damaged(DiagnosticLog& log) const {
  impl_->scene.rays().report_damaged(log);
}

namespace {

// Whether terrain may stand between a sphere of the world and the Sun.
bool may_shade(const trace::Scene::Placed& ground, const Vec3& centre, double radius,
               const Sun& sun) {
  const Vec3 at = (centre - ground.frame.position) * ground.frame.world_from;
  for (const terrain::ChartRecord& chart : ground.target->ground()->tiles().charts()) {
    if (chart.radius > 0) {
      // the ray to the Sun that comes nearest to the middle of the body
      const double along = std::max(-glm::dot(at, sun.centre()), 0.0);
      const double nearest = glm::length(at + along * sun.centre()) - radius - sun.sine() * along;
      if (nearest <= std::max(chart.radius, chart.polar_radius) + chart.high) return true;
    } else if (at.z - radius <= chart.high || sun.centre().z <= sun.sine()) {
      return true;
    }
  }
  return false;
}

// Shares of the Sun that terrain leaves to points of targets.
struct GroundShade {
  const trace::Scene& rays;
  std::vector<Sun> suns;  // of the targets with terrain
  std::vector<std::uint32_t> grounds;

  bool is_blocked(const Vec3& at, double least, const Sun::Sample& light,
                  std::size_t ground) const {
    const std::uint32_t target = grounds[ground];
    const Vec3 to_light = rays.targets()[target].frame.world_from * light.to_light;
    const trace::Ray ray{{at, to_light * rays.observer().world_from, least}, trace::Ray::kObserver};
    return rays.meets_ground(target, ray);
  }

  // at: of the observer; least: metres, below which nothing shades. turn: radians, of the places on
  // the disc.
  double share(const Vec3& at, double least, double turn) const {
    double lit = 1;
    for (std::size_t k = 0; k < grounds.size(); ++k) lit *= share(at, least, turn, k);
    return lit;
  }

  double share(const Vec3& at, double least, double turn, std::size_t ground) const {
    constexpr int kProbes = 8, kPlaces = 64;
    const Sun& sun = suns[ground];
    const bool blocked = is_blocked(at, least, sun.at(Vec2(0)), ground);
    if (!sun.has_disc()) return blocked ? 0 : 1;
    bool mixed = false;
    for (int i = 0; i < kProbes && !mixed; ++i) {
      const auto [s, c] = det::sincos(2 * kPi * i / kProbes);
      mixed = is_blocked(at, least, sun.at(0.999 * Vec2(c, s)), ground) != blocked;
    }
    if (!mixed) return blocked ? 0 : 1;
    constexpr double kGolden = 2.399963229728653;  // radians
    double all = 0, open = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const double radius = std::sqrt((i + 0.5) / kPlaces);
      const auto [s, c] = det::sincos(turn + kGolden * i);
      const Sun::Sample light = sun.at(radius * Vec2(c, s));
      const double weight = light.irradiance.x + light.irradiance.y + light.irradiance.z;
      all += weight;
      if (!is_blocked(at, least, light, ground)) open += weight;
    }
    return all > 0 ? open / all : 1;
  }
};

// Pixels without a depth take the share of one beside them that has one.
void spread_shares(const image::Image& image, const std::vector<std::uint8_t>& known,
                   const std::vector<float>& of_target, std::vector<float>& shares) {
  const auto width = static_cast<std::int64_t>(image.width),
             height = static_cast<std::int64_t>(image.height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * width + x);
      if (known[pixel] || !(image.coverage[pixel] > 0)) continue;
      double sum = 0;
      int count = 0;
      for (std::int64_t j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, width - 1);
             ++i) {
          const auto other = static_cast<std::size_t>(j * width + i);
          if (!known[other]) continue;
          sum += double(shares[other]);
          ++count;
        }
      shares[pixel] = count > 0 ? static_cast<float>(sum / count) : of_target[pixel];
    }
}

}  // namespace

std::vector<float> GroundLayer::sun_shares(const world::World& world, const world::Camera& camera,
                                           bool sun_disc, const image::Image& image,
                                           const Job& job) {
  TraceScene& scene = impl_->scene;
  scene.update(world, job);
  scene.place_camera(camera, trace::half_pixel(camera));
  const trace::Scene& rays = scene.rays();
  GroundShade shade{rays, {}, {}};
  std::vector<Vec3> middles;  // of the targets that may be in shadow, in the observer's frame
  for (const std::uint32_t g : rays.visible()) {
    const trace::Scene::Placed& ground = rays.targets()[g];
    if (ground.target->ground() == nullptr) continue;
    const Sun sun(world.sun(), ground.frame.world_from, sun_disc);
    bool needed = false;
    for (const trace::Scene::Placed& placed : rays.targets()) {
      const AxisBox& box = placed.target->bounds();
      if (placed.target->ground() != nullptr || box.empty()) continue;
      const Vec3 middle =
          placed.frame.world_from * (0.5 * (box.low + box.high)) + placed.frame.position;
      if (!may_shade(ground, middle, 0.5 * box.diagonal(), sun)) continue;
      middles.push_back((middle - rays.observer().position) * rays.observer().world_from);
      needed = true;
    }
    if (!needed) continue;
    shade.suns.push_back(sun);
    shade.grounds.push_back(g);
  }
  if (shade.grounds.empty()) return {};
  std::vector<float> shares(image.pixels(), 1), of_target(image.pixels(), 1);
  std::vector<std::uint8_t> known(image.pixels());
  const auto add_row = [&](std::size_t y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t pixel = y * image.width + x;
      if (!(image.coverage[pixel] > 0)) continue;
      const auto ray = view_ray(camera, {x + 0.5, double(y) + 0.5});
      if (!ray) continue;
      const double turn = 2 * kPi * numbers({static_cast<std::uint32_t>(pixel), 0, 0, 0}, 0)[0];
      const std::uint32_t id = image.target_id[pixel];
      if (id > 0 && rays.targets()[id - 1].target->ground() == nullptr) {
        constexpr double kRounding = 4 * 0x1p-23;  // of the depth, a float
        const double range = double(image.range[pixel]);
        known[pixel] = 1;
        shares[pixel] = static_cast<float>(shade.share(
            ray->origin + range * ray->direction, kRounding * double(image.depth[pixel]), turn));
      } else if (id == 0) {
        // of a target that no pixel's middle meets: the one whose middle lies nearest to the ray
        const auto beside = [&](const Vec3& at) {
          const Vec3 off = at - ray->origin;
          return glm::length(off - glm::dot(off, ray->direction) * ray->direction) /
                 std::max(glm::length(off), 1e-300);
        };
        const Vec3& at = *std::ranges::min_element(middles, {}, beside);
        of_target[pixel] = static_cast<float>(shade.share(at, 0, turn));
      }
    }
  };
  parallel_for(image.height, add_row, job);
  spread_shares(image, known, of_target, shares);
  if (std::ranges::all_of(shares, [](float share) { return share == 1; })) return {};
  return shares;
}

void shade(std::span<const float> shares, const image::Image& rest, image::Image& image) {
  for (std::size_t pixel = 0; pixel < shares.size(); ++pixel) {
    if (shares[pixel] == 1) continue;
    for (std::size_t k = 3 * pixel; k < 3 * pixel + 3; ++k)
      image.radiance[k] = rest.radiance[k] + shares[pixel] * (image.radiance[k] - rest.radiance[k]);
  }
}

}  // namespace panwright::preview
