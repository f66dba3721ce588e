// Look-ups against a caster without a tree, and LiDARs against the sphere, by processor time.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>

#include "base/parallel.h"
#include "bench/bench.h"
#include "bench/scenes.h"
#include "instruments/lidar.h"
#include "instruments/lookup.h"
#include "workspace/open.h"
#include "world/evaluation.h"

namespace panwright::bench::case_instruments {

namespace {

constexpr double kCores = 2;

// Processor time over two cores: other work on the machine leaves it as it is.
Timing processor_timed(const std::function<void()>& work, int runs) {
  work();
  std::vector<double> seconds;
  for (int k = 0; k < runs; ++k) {
    const std::clock_t begin = std::clock();
    work();
    seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kCores);
  }
  std::ranges::sort(seconds);
  const auto at = [&](double share) {
    return seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
  };
  return {at(0.5), at(0.25), at(0.75), runs};
}

struct Triangles {
  std::vector<std::array<Vec3, 3>> corners;
  trace::Ids ids;
  bool closed = false;
  Vec3 centre{0};
  double radius = 0;
};

// The triangles of one target at rest, by instance, world axes.
std::vector<Triangles> triangles_of(const world::World& world) {
  const pan::Model& model = *world[0].model();
  const world::EvaluatedInstance state = world::evaluated(world[0]);
  std::vector<Triangles> out;
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const auto& instance = model.instances()[i];
    const auto& record = model.meshes()[instance.mesh];
    const pan::MeshView mesh = model.mesh(instance.mesh);
    const Mat4& place = state.model_from_nodes[instance.node];
    Triangles& part = out.emplace_back();
    part.ids = {1, instance.node + 1, instance.material + 1, i + 1};
    part.closed = (record.flags & pan::layout::kMeshClosed) != 0;
    AxisBox box;
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      std::array<Vec3, 3> corner;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& p = mesh.positions[mesh.indices[k + c]];
        const Vec3 local(record.origin[0] + p.x, record.origin[1] + p.y, record.origin[2] + p.z);
        corner[c] = Vec3(place * Vec4(local, 1));
        box.add(corner[c]);
      }
      if (glm::determinant(Mat3(place)) < 0) std::swap(corner[1], corner[2]);
      part.corners.push_back(corner);
    }
    part.centre = box.centre();
    part.radius = 0.5001 * box.diagonal();
  }
  return out;
}

struct Found {
  double distance = HUGE_VAL, margin = 1;
  trace::Ids ids;
};

// Möller and Trumbore's solution for all triangles whose instance a ray comes near.
Found without_tree(const std::vector<Triangles>& parts, const geometry::Ray& ray) {
  Found best;
  for (const Triangles& part : parts) {
    if (glm::length(glm::cross(part.centre - ray.origin, ray.direction)) > part.radius) continue;
    for (const auto& [a, b, c] : part.corners) {
      const Vec3 ab = b - a, ac = c - a, p = glm::cross(ray.direction, ac);
      const double det = glm::dot(ab, p);
      if (det == 0 || (part.closed && det < 0)) continue;
      const Vec3 from = ray.origin - a, q = glm::cross(from, ab);
      const double u = glm::dot(from, p) / det, v = glm::dot(ray.direction, q) / det;
      const double margin = std::min({u, v, 1 - u - v}), t = glm::dot(ac, q) / det;
      if (t < 0) continue;
      if (std::fabs(margin) < 1e-6) best.margin = std::min(best.margin, std::fabs(margin));
      if (margin >= 0 && t < best.distance) best = {t, best.margin, part.ids};
    }
  }
  return best;
}

void run_lookups(Context& context) {
  DiagnosticLog log;
  const auto model = workspace::open(context.source("examples/servicer/servicer.pxn"), {}, log);
  if (!model) return context.note("the servicer could not be opened: " + to_text(log));
  world::World world;
  (void)world.add("servicer", *model, log);
  instruments::Lookups lookups;
  lookups.update(world);
  world::Camera camera;
  const std::uint32_t side = context.quick() ? 64 : 1024;
  world::set_field_of_view(camera, side, side, 45 * kDegree);
  camera.position = {9, -9, 6};
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), {}, log);
  std::vector<Vec2> places;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) places.emplace_back(x + 0.5, y + 0.5);
  std::vector<instruments::SurfacePoint> found(places.size());
  const Timing timing =
      processor_timed([&] { lookups.pixels(camera, places, found); }, context.quick() ? 1 : 5);
  // some of the same rays, and of rays from afar
  const std::vector<Triangles> parts = triangles_of(world);
  const std::size_t count = context.quick() ? 200 : 100'000;
  std::vector<geometry::Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    rays[i] = world::pixel_ray(camera, places[i * 7919 % places.size()]);
    if (i % 2 == 1) rays[i].origin -= std::pow(10, 1 + 5.0 * i / count) * rays[i].direction;
  }
  std::vector<instruments::SurfacePoint> asked(count);
  lookups.rays(rays, asked);
  std::vector<double> errors(count);
  std::vector<std::uint8_t> wrong(count);
  parallel_for((count + 99) / 100, [&](std::size_t chunk) {
    for (std::size_t i = 100 * chunk; i < std::min(count, 100 * (chunk + 1)); ++i) {
      const Found other = without_tree(parts, rays[i]);
      if (other.margin < 1e-6) continue;  // at an edge
      const bool same = asked[i].ids.node == other.ids.node &&
                        asked[i].ids.instance == other.ids.instance &&
                        bool(asked[i]) == (other.distance < HUGE_VAL);
      wrong[i] = same ? 0 : 1;
      if (same && asked[i]) errors[i] = std::fabs(asked[i].distance / other.distance - 1);
    }
  });
  const auto wrongs = std::ranges::count(wrong, 1);
  if (wrongs > 0) context.note(fmt::format("{} of {} rays have other ids", wrongs, count));
  Row row{.case_name = "instruments",
          .setting = fmt::format("look-ups of pixels, servicer, {}x{}; two cores by processor time",
                                 side, side),
          .speed_unit = "Mray/s",
          .error = *std::ranges::max_element(errors),
          .error_unit = "of the range",
          .reference = fmt::format("caster without a tree, {} rays from 14 m to 1e6 m", count),
          .reference_error = 1e-10,
          .must = 1,
          .must_error = 1e-9};
  set_rate(row, timing, 1e-6 * static_cast<double>(places.size()));
  context.add(row);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < places.size(); i += 16)
    points.push_back(3.0 * glm::normalize(rays[i % count].direction + Vec3(0.1 * (i % 7), 0, 0)));
  found.resize(points.size());
  Row near = row;
  near.setting = "look-ups of nearest surfaces, servicer; two cores by processor time";
  near.speed_unit = "Mpoint/s";
  near.must = 0;
  near.must_error = 0;
  near.reference = "least distance of the corners above it: 0 if none is nearer";
  near.reference_error = 0;
  near.error_unit = "m";
  set_rate(near, processor_timed([&] { lookups.nearest(points, found); }, context.quick() ? 1 : 3),
           1e-6 * static_cast<double>(points.size()));
  near.error = 0;
  for (std::size_t i = 0; i < points.size(); i += 997)
    for (const Triangles& part : parts)
      for (const auto& corners : part.corners)
        for (const Vec3& corner : corners)
          near.error = std::max(near.error, found[i].distance - glm::length(corner - points[i]));
  context.add(near);
}

void run_lidar(Context& context) {
  DiagnosticLog log;
  instruments::Lidar lidar;
  lidar.scan.pattern = instruments::ScanPattern::raster;
  lidar.scan.columns = lidar.scan.rows = context.quick() ? 32 : 512;
  lidar.sub_rays = 16;
  lidar.electronics_e = 10;
  lidar.threshold_e = 60;
  lidar.gate = {1, 3000};
  const auto row_of = [&](const char* what, const world::World& world, const world::Pose& pose,
                          double angle, double albedo) {
    lidar.scan.azimuth = lidar.scan.elevation = {-angle, angle};
    instruments::LidarCloud cloud;
    const Timing timing =
        processor_timed([&] { cloud = *instruments::measure(lidar, world, pose, {}, log); },
                        context.quick() ? 1 : 3);
    const double count = static_cast<double>(cloud.pulses.size());
    Row row{.case_name = "instruments",
            .setting = fmt::format("LiDAR, {}, {} pulses of 16 sub-rays, noise, {:.0f} % answer; "
                                   "two cores by processor time",
                                   what, cloud.pulses.size(),
                                   100 * static_cast<double>(cloud.points.size()) / count),
            .speed_unit = "kpulse/s",
            .error_unit = albedo > 0 ? "mean intensity, relative" : "mean range, relative",
            .reference = albedo > 0 ? "albedo times the cosine" : "truth of each point",
            .must = 300,
            .must_error = 0.01};
    set_rate(row, timing, 1e-3 * count);
    // reflectance against albedo·cos, and ranges, of points that hold one surface
    double sum = 0, of = 0;
    for (const auto& p : cloud.points) {
      if (p.flags != 0) continue;
      if (albedo > 0) {
        // of the axis on the exact sphere, where the footprint is small on it
        const Vec3& d = cloud.pulses[p.pulse].direction;
        const double impact = glm::length(pose.translation) * std::sqrt(1 - d.z * d.z);
        if (impact > 0.5) continue;
        sum += p.reflectance / (albedo * std::sqrt(1 - impact * impact)) - 1;
      } else {
        sum += p.range / p.true_range - 1;
      }
      ++of;
    }
    row.error = std::fabs(sum / std::max(of, 1.0));
    context.add(row);
  };
  const auto sphere = compiled_model(sphere_scene({400, 400}, lambert_material(0.5)), log);
  if (sphere == nullptr) return context.note("no sphere: " + to_text(log));
  world::World one;
  (void)one.add("sphere", sphere, log);
  lidar.pulse_energy = 1e-4;
  row_of("Lambert sphere of 320,000 triangles at 100 m", one, {Vec3(0, 0, -100), {1, 0, 0, 0}},
         0.007, 0.5);
  const auto model = workspace::open(context.source("examples/servicer/servicer.pxn"), {}, log);
  if (!model) return context.note("the servicer could not be opened: " + to_text(log));
  world::World world;
  (void)world.add("servicer", *model, log);
  const Vec3 from(60, -60, 40);
  const auto turn = world::looking_at(from, Vec3(0), {}, log);
  row_of("servicer at 94 m", world, {from, *turn}, 0.04, 0);
}

void run(Context& context) {
  run_lookups(context);
  run_lidar(context);
}

const bool kAdded = add_case({"instruments", "look-ups and LiDARs", run});

}  // namespace

}  // namespace panwright::bench::case_instruments
