#include "workspace/targets.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/text.h"
#include "preview/reference/ground_layer.h"
#include "terrain/sights.h"
#include "terrain/tiles.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace fs = std::filesystem;

namespace {

// radius of the sphere around a single point
constexpr double kLeastRadius = 1e-30;

std::string stem_of(const fs::path& path) {
  fs::path name = path.filename();
  if (extension_of(name) == ".gz") name = name.stem();
  const std::string stem = name.stem().string();
  return stem.empty() ? path.string() : stem;
}

// Parameters that no target has.
void check_parameters(const OpenOptions& options, const std::set<std::string>& declared,
                      DiagnosticLog& log) {
  const std::vector<std::string_view> all(declared.begin(), declared.end());
  for (const auto& [name, value] : options.parameters) {
    if (declared.contains(name)) continue;
    const auto near = nearest_name(name, all);
    log.report(Code("E1225"), {},
               all.empty() ? fmt::format("-D {}={}: no target has parameters", name, value)
                           : fmt::format("-D {}={}: no target has a parameter {}; there {} {}",
                                         name, value, in_quotes(name),
                                         all.size() == 1 ? "is" : "are", fmt::join(all, ", ")),
               near ? fmt::format("did you mean '{}'?", *near) : "");
  }
}

}  // namespace

TargetFile target_file(std::string_view text) {
  const std::size_t sign = text.find('=');
  std::error_code ignored;
  const bool named = sign != text.npos && sign > 0 && sign + 1 < text.size() &&
                     text.substr(0, sign).find('/') == text.npos && !fs::exists(text, ignored);
  if (!named) return {stem_of(text), text};
  return {std::string(text.substr(0, sign)), text.substr(sign + 1)};
}

Result<world::World> open_world(std::span<const TargetFile> targets, const OpenOptions& options,
                                DiagnosticLog& log, const Job& job, OpenReport* report) {
  if (targets.empty()) {
    log.report(Code("E5030"), {}, "no model file given, expected at least 1");
    return failed;
  }
  // names first: opening takes long
  std::map<std::string_view, const fs::path*> names;
  for (const TargetFile& target : targets) {
    const auto [known, added] = names.emplace(target.name, &target.file);
    if (added) continue;
    log.report(Code("E5009"), {},
               "duplicate target name " + in_quotes(target.name) + ": " +
                   in_quotes(known->second->string()) + " and " + in_quotes(target.file.string()),
               "NAME=FILE gives a target another name");
    return failed;
  }
  world::World world;
  std::map<fs::path, world::ModelPtr> models;
  // a parameter of one of several models is none of the others
  std::set<std::string> declared;
  OpenOptions open_options = options;
  const bool several = targets.size() > 1 && !options.parameters.empty();
  if (several) open_options.declared = &declared;
  for (const TargetFile& target : targets) {
    std::error_code error;
    fs::path key = fs::canonical(target.file, error);
    if (error) key = target.file;
    world::ModelPtr& model = models[key];
    if (model == nullptr) {
      const auto opened = open(target.file, open_options, log, job, report);
      if (!opened) return failed;
      model = *opened;
    }
    if (!world.add(target.name, model, log)) return failed;
  }
  if (several) check_parameters(options, declared, log);
  return world;
}

std::optional<Outline> outline(const world::World& world, const world::Camera& camera) {
  std::optional<Outline> out;
  const Mat3 turn = glm::mat3_cast(glm::conjugate(camera.world_from_camera));
  for (const world::Instance& target : world.instances()) {
    if (!target.visible()) continue;
    const world::EvaluatedInstance nodes = world::evaluated(target);
    const pan::Model& model = *target.model();
    for (const pan::layout::Instance& placed : model.instances()) {
      if (!nodes.node_visible[placed.node]) continue;
      const Mat4 matrix = target.pose().matrix() * nodes.model_from_nodes[placed.node];
      const auto& o = model.meshes()[placed.mesh].origin;
      const Vec3 from = turn * (Vec3(matrix * Vec4(o[0], o[1], o[2], 1)) - camera.position);
      const Mat3 along = turn * Mat3(matrix);
      for (const pan::layout::Float3& p : model.mesh(placed.mesh).positions) {
        const Vec3 at = from + along * Vec3(p.x, p.y, p.z);
        if (!(at.z > 0)) return std::nullopt;
        const Vec2 direction(at.x / at.z, at.y / at.z);
        if (!out) out = Outline{direction, direction};
        out->low = glm::min(out->low, direction);
        out->high = glm::max(out->high, direction);
      }
    }
  }
  return out;
}

Vec3 from_local(const Vec3& up, const Vec3& direction) {
  Vec3 east = glm::cross(Vec3(0, 0, 1), up);
  const double length = glm::length(east);
  east = length > 1e-9 ? east / length : Vec3(1, 0, 0);
  return glm::normalize(direction.x * east + direction.y * glm::cross(up, east) + direction.z * up);
}

void warn_of_terrain(const world::World& world, std::string_view what, DiagnosticLog& log) {
  for (const world::Instance& target : world.instances()) {
    if (!preview::has_ground(target)) continue;
    log.report_file(Code("W9620"), {},
                    fmt::format("{} leaves out the terrain of {}", what, in_quotes(target.name())),
                    "images, look-ups, labels, LiDARs and RADARs have it");
    return;
  }
}

namespace {

// Adds places of a chart on a body, evenly over it.
void add_places(const terrain::ChartRecord& chart, AxisBox& box) {
  constexpr int kSteps = 8;
  const terrain::Map map = terrain::map_of(chart);
  for (int row = 0; row <= kSteps; ++row)
    for (int column = 0; column <= kSteps; ++column) {
      const terrain::LatLon at = map.at(0.5 + (chart.width - 1.0) * column / kSteps,
                                        0.5 + (chart.height - 1.0) * row / kSteps);
      const Vec3 up = terrain::local_axes(at).up;
      for (const double height : {chart.low, chart.high}) box.add((chart.radius + height) * up);
    }
}

// The sphere about the terrain of a model, of less than a body about that part; none: it has no
// terrain.
std::optional<BoundingSphere> terrain_sphere(const world::ModelPtr& model) {
  constexpr double kMostOfBody = 0.7;  // of its radius
  DiagnosticLog log;                   // whoever opened the file has said what is wrong
  const auto tiles = terrain::Tiles::of(model, log);
  if (!tiles || !*tiles) return std::nullopt;
  AxisBox box;
  double body = 0;
  for (const terrain::ChartRecord& chart : (*tiles)->charts()) {
    if (chart.radius > 0) {
      body = std::max(body, std::max(chart.radius, chart.polar_radius) + chart.high);
      add_places(chart, box);
    } else {
      box.add(Vec3(chart.left, chart.top - (chart.height - 1) * chart.dy, chart.low));
      box.add(Vec3(chart.left + (chart.width - 1) * chart.dx, chart.top, chart.high));
    }
  }
  const double radius = std::max(0.5 * box.diagonal(), 1.0);
  if (body > 0 && radius > kMostOfBody * body) return BoundingSphere{Vec3(0), body};
  return BoundingSphere{box.centre(), radius,
                        body > 0 ? glm::normalize(box.centre()) : Vec3(0, 0, 1), true};
}

// Metres from the centre of a body to its lowest ground; 0: a plane; none: no terrain.
std::optional<double> lowest_ground(const world::Instance& target) {
  DiagnosticLog log;
  const auto tiles = terrain::Tiles::of(target.model(), log);
  if (!tiles || !*tiles || (*tiles)->charts().empty()) return std::nullopt;
  double least = INFINITY;
  for (const terrain::ChartRecord& chart : (*tiles)->charts())
    least = std::min(
        least, chart.radius > 0 ? std::min(chart.radius, chart.polar_radius) + chart.low : 0.0);
  return least;
}

// The vertical at a place, and its metres above the lowest ground, of lowest_ground().
struct Vertical {
  Vec3 up{0};
  double height = 0;
};
Vertical vertical_at(const world::Instance& ground, double lowest, const Vec3& place) {
  const Vec3 away = place - ground.pose().translation;
  const Vec3 up = ground.pose().rotation * Vec3(0, 0, 1);
  const double length = glm::length(away);
  if (!(lowest > 0 && length > 0)) return {up, glm::dot(away, up) - lowest};
  return {away / length, length - lowest};
}

}  // namespace

BoundingSphere BoundingSpheres::of(const world::Instance& target) {
  auto known = std::find_if(known_.begin(), known_.end(),
                            [&](const Known& each) { return each.stamp == target.shape_stamp(); });
  if (known == known_.end()) {
    constexpr std::size_t kMost = 2 * world::World::kMaxInstances;
    if (known_.size() >= kMost) known_.clear();
    std::optional<BoundingSphere> sphere;
    if (const auto bounds = target.visible() ? exact_bounds(target) : std::nullopt)
      sphere = {bounds->centre(), std::max(0.5 * bounds->diagonal(), kLeastRadius)};
    else if (target.visible())
      sphere = terrain_sphere(target.model());
    known = known_.insert(known_.end(), {target.shape_stamp(), sphere});
  }
  BoundingSphere sphere = known->sphere.value_or(BoundingSphere{});
  sphere.centre = Vec3(target.pose().matrix() * Vec4(sphere.centre, 1));
  if (sphere.ground) sphere.up = target.pose().rotation * sphere.up;
  return sphere;
}

BoundingSphere BoundingSpheres::of(const world::World& world) {
  std::vector<BoundingSphere> spheres;
  std::vector<const world::Instance*> grounds;
  for (const world::Instance& target : world.instances()) {
    if (!target.visible()) continue;
    const bool ground = preview::has_ground(target);
    if (ground) grounds.push_back(&target);
    if (!ground || !target.model()->meshes().empty()) spheres.push_back(of(target));
  }
  const bool alone = spheres.empty();
  if (alone)
    for (const world::Instance* target : grounds) spheres.push_back(of(*target));
  if (spheres.empty()) return {};
  if (alone && spheres.size() == 1) return spheres[0];
  BoundingSphere all = spheres[0];
  if (spheres.size() > 1) {
    Vec3 low = all.centre, high = all.centre;
    for (const BoundingSphere& each : spheres) {
      low = glm::min(low, each.centre - Vec3(each.radius));
      high = glm::max(high, each.centre + Vec3(each.radius));
    }
    all = {0.5 * low + 0.5 * high, 0};
    for (const BoundingSphere& each : spheres)
      all.radius = std::max(all.radius, glm::length(each.centre - all.centre) + each.radius);
  }
  for (const world::Instance* target : grounds) {
    const auto lowest = lowest_ground(*target);
    if (!lowest) continue;
    const Vertical vertical = vertical_at(*target, *lowest, all.centre);
    if (*lowest == 0 || std::fabs(vertical.height) < *lowest) all.up = vertical.up;
  }
  return all;
}

void warn_of_ground(const world::World& world, bool has_lamps, BoundingSpheres& spheres,
                    DiagnosticLog& log) {
  const auto has_surface = [](const world::Instance& target) {
    return target.visible() && !target.model()->meshes().empty();
  };
  const bool alone = std::ranges::none_of(world.instances(), has_surface);
  for (const world::Instance& ground : world.instances()) {
    if (!ground.visible() || !preview::has_ground(ground)) continue;
    const auto lowest = lowest_ground(ground);
    for (const world::Instance& target : world.instances()) {
      if (!lowest || !target.visible() || (preview::has_ground(target) && &target != &ground))
        continue;
      const BoundingSphere sphere = spheres.of(target);
      if (&target == &ground && !(alone && sphere.ground)) continue;
      const auto [up, height] = vertical_at(ground, *lowest, sphere.centre);
      if (*lowest > 0 && height + sphere.radius < 0) {
        log.report_file(Code("W5022"), {},
                        fmt::format("{} is {:.4g} m below all ground of {}",
                                    in_quotes(target.name()), -height, in_quotes(ground.name())),
                        "panwright dem --at prints a --pose on the ground");
        continue;
      }
      // the horizon as it is seen from there, and the Sun's radius
      const double top = *lowest + std::max(height + sphere.radius, 0.0);
      const double dip = *lowest > 0 ? det::acos(*lowest / top) : 0;
      const double sine = glm::dot(glm::normalize(world.sun().direction), up);
      const double elevation = det::asin(std::clamp(sine, -1.0, 1.0));
      if (has_lamps || elevation > -dip - 0.3 * kDegree) continue;
      log.report_file(Code("N5023"), {},
                      fmt::format("the Sun is {:.3g} deg below the horizon of {}",
                                  -elevation / kDegree, in_quotes(target.name())),
                      "panwright dem --at --light prints a --sun of an azimuth and an elevation");
    }
  }
}

}  // namespace panwright::workspace
