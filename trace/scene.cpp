#include "trace/scene.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"

namespace panwright::trace {
namespace {

// far more than corners and slabs round by, of a target's size and of the largest distance
constexpr double kSizeSlack = 1e-5;
constexpr double kDistanceSlack = 1e-14;
constexpr std::size_t kRaysAtOnce = 256;  // of a thread
constexpr std::size_t kBundle = 16;       // rays that look together

double largest(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

template <class Visit>
void for_corners(const Vec3& low, const Vec3& high, Visit&& visit) {
  for (const double x : {low.x, high.x})
    for (const double y : {low.y, high.y})
      for (const double z : {low.z, high.z}) visit(Vec3(x, y, z));
}

[[maybe_unused]] bool is_sound(const Ray& ray, std::size_t targets) {
  return is_finite(ray.origin) && std::fabs(glm::dot(ray.direction, ray.direction) - 1) < 1e-6 &&
         (ray.frame == Ray::kObserver || ray.frame < targets);
}

terrain::GroundPoint ground_point(const Hit& hit) {
  terrain::GroundPoint point;
  point.position = hit.position;
  point.normal = hit.normal;
  point.chart = hit.chart;
  point.level = hit.level;
  point.column = hit.column;
  point.row = hit.row;
  point.triangle = hit.triangle;
  return point;
}

// The part of an instance for a pixel footprint.
std::uint32_t part_for(const Model& model, std::uint32_t instance, const Mat3& linear,
                       double footprint) {
  if (!(footprint > 0)) return instance;
  const auto levels = model.levels(instance);
  if (levels.empty()) return instance;
  const double stretch = stretch_of(Mat4(linear)).largest;
  const auto end = std::ranges::partition_point(
      levels, [&](const Model::Part& level) { return level.detail * stretch <= footprint; });
  if (end == levels.begin()) return instance;
  return static_cast<std::uint32_t>(&*std::prev(end) - model.parts().data());
}

template <class Answer>
void for_rays(std::size_t count, const Job& job, const Answer& answer) {
  const auto some = [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kRaysAtOnce);
    for (std::size_t i = chunk * kRaysAtOnce; i < end; ++i) answer(i);
  };
  parallel_for((count + kRaysAtOnce - 1) / kRaysAtOnce, some, job);
}

// A box about terrain: of a body all of it.
AxisBox box_of(const terrain::Ground& ground) {
  AxisBox box;
  for (const terrain::ChartRecord& chart : ground.tiles().charts()) {
    if (chart.kind == static_cast<std::uint32_t>(terrain::Map::Kind::none)) {
      box.add(Vec3(chart.left, chart.top - (chart.height - 1) * chart.dy, chart.low));
      box.add(Vec3(chart.left + (chart.width - 1) * chart.dx, chart.top, chart.high));
      continue;
    }
    const double reach = std::max(chart.radius, chart.polar_radius) + std::max(chart.high, 0.0);
    box.add(Vec3(-reach));
    box.add(Vec3(reach));
  }
  return box;
}

}  // namespace

Target::Target(std::shared_ptr<const Model> model, const world::Instance& instance,
               double footprint, const Job& job)
    : model_(std::move(model)) {
  constexpr std::uint32_t kNone = ~0u;
  const PlacedNodes nodes = placed_nodes(instance);
  std::vector<std::uint32_t> number(model_->model()->meshes().size(), kNone);
  number_of_.resize(model_->model()->instances().size(), kNone);
  for (std::uint32_t i = 0; i < number_of_.size(); ++i) {
    const std::uint32_t node = model_->parts()[i].node;
    if (!nodes.visible[node]) continue;
    const std::uint32_t index = part_for(*model_, i, nodes.model_from_node[node].linear, footprint);
    const Model::Part& part = model_->parts()[index];
    const Placement placement = model_->placement(index, nodes);
    std::uint32_t& mesh = number[part.mesh_index];
    if (mesh == kNone) mesh = caster_.add_mesh(model_->search_mesh(part.mesh_index));
    Mat4 matrix(placement.model_from_mesh.linear);
    matrix[3] = Vec4(placement.model_from_mesh.offset, 1);
    // filters are asked where something may not count: holes, and insides
    caster_.add(mesh, matrix, part.has_holes || part.closed);
    has_holes_ = has_holes_ || part.has_holes;
    for_corners(part.low, part.high,
                [&](const Vec3& corner) { bounds_.add(placement.model_from_mesh(corner)); });
    number_of_[i] = static_cast<std::uint32_t>(parts_.size());
    parts_.push_back(index);
    placements_.push_back(placement);
  }
  caster_.build(job);
  if (model_->ground() == nullptr || nodes.visible.empty() || !nodes.visible[0]) return;
  ground_ = model_->ground();
  const AxisBox box = box_of(*ground_);
  bounds_.add(box.low);
  bounds_.add(box.high);
}

bool Target::hole_filter(const void* data, const geometry::InstanceHit& hit) {
  const auto& target = *static_cast<const Target*>(data);
  return target.model_->is_there(target.parts_[hit.instance], hit.triangle, hit.barycentric);
}

bool Target::visible_filter(const void* data, const geometry::InstanceHit& hit) {
  const auto& target = *static_cast<const Target*>(data);
  const bool inside = !hit.front && target.model_->parts()[target.parts_[hit.instance]].closed;
  return !inside && hole_filter(data, hit);
}

geometry::HitFilter Target::filter_of(Insides insides) const {
  if (insides == Insides::pass) return {visible_filter, this};
  return has_holes_ ? geometry::HitFilter{hole_filter, this} : geometry::HitFilter{};
}

std::optional<geometry::InstanceHit> Target::closest(const geometry::Ray& ray,
                                                     Insides insides) const {
  return caster_.closest(ray, filter_of(insides));
}

void Target::closest(std::span<const geometry::Ray> rays,
                     std::span<std::optional<geometry::InstanceHit>> hits, Insides insides) const {
  caster_.closest(rays, hits, filter_of(insides));
}

bool Target::any(const geometry::Ray& ray, Insides insides) const {
  return caster_.any(ray, filter_of(insides));
}

terrain::SmoothGround Target::smooth_ground(const Hit& hit) const {
  return ground_->smooth(ground_point(hit));
}

terrain::GroundRelief Target::ground_relief(const Hit& hit) const {
  return ground_->relief(ground_point(hit));
}

Vec3 Target::normal(const Hit& hit, bool flat) const {
  if (hit.part == Hit::kGround) {
    const Vec3 normal = flat ? hit.normal : smooth_ground(hit).normal;
    return hit.front ? normal : -normal;
  }
  const Model::Part& part = model_->parts()[hit.part];
  const MeshPoint at =
      point_of(part.mesh, place_of(part.mesh, hit.triangle, hit.barycentric), flat);
  const Vec3 unit = unit_or(placement(hit.part).normals * at.smooth, Vec3(0));
  return part.closed || hit.front ? unit : -unit;
}

Surface Target::surface(const Hit& hit) const {
  if (hit.part == Hit::kGround) {
    const double side = hit.front ? 1 : -1;
    return {hit.position, side * hit.normal, side * smooth_ground(hit).normal, Vec2(0)};
  }
  const Model::Part& part = model_->parts()[hit.part];
  const Placement& placed = placement(hit.part);
  const Place place = place_of(part.mesh, hit.triangle, hit.barycentric);
  const MeshPoint at = point_of(part.mesh, place, false);
  const double side = part.closed || hit.front ? 1 : -1;
  Surface result;
  result.position = placed.model_from_mesh(at.position);
  result.facet = unit_or(placed.normals * at.facet, Vec3(0)) * side;
  result.normal = unit_or(placed.normals * at.smooth, Vec3(0)) * side;
  if (!part.mesh.texcoords.empty()) result.texcoord = texcoord_of(part.mesh, place);
  return result;
}

std::shared_ptr<const Model> Scene::model_of(const world::ModelPtr& model, const Job& job) {
  if (const auto found = models_.find(model.get()); found != models_.end()) return found->second;
  auto made = std::make_shared<const Model>(model, options_.footprint > 0, options_.ground, job);
  models_[model.get()] = made;
  ++work_.models;
  return made;
}

void Scene::update(const world::World& world, const Job& job) {
  std::unordered_map<world::Stamp, std::shared_ptr<const Target>> states;
  std::unordered_map<world::Stamp, RigidFrame> frames;
  targets_.clear();
  visible_.clear();
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    const world::Instance& instance = world[i];
    std::shared_ptr<const Target>& state = states[instance.shape_stamp()];
    if (const auto same = states_.find(instance.shape_stamp()); same != states_.end()) {
      state = same->second;
    } else {
      state = std::make_shared<const Target>(model_of(instance.model(), job), instance,
                                             options_.footprint, job);
      ++work_.shapes;
    }
    RigidFrame& frame = frames[instance.pose_stamp()];
    if (const auto same = frames_.find(instance.pose_stamp()); same != frames_.end()) {
      frame = same->second;
    } else {
      frame = frame_of(instance.pose());
      ++work_.poses;
    }
    if (!state->parts().empty() || state->ground()) visible_.push_back(i);
    targets_.push_back({state, frame, {}});
  }
  states_ = std::move(states);
  frames_ = std::move(frames);
  // no world can ask for a model again that is not held elsewhere
  std::erase_if(models_, [](const auto& entry) { return entry.second->model().use_count() == 1; });
  place_targets();
}

void Scene::place_observer(const world::Pose& world_from_observer, double ground_angle) {
  observer_ = frame_of(world_from_observer);
  ground_angle_ = ground_angle;
  place_targets();
}

void Scene::place_targets() {
  ground_levels_.assign(targets_.size(), std::nullopt);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    Placed& placed = targets_[i];
    placed.from_observer = between(placed.frame, observer_);
    if (const terrain::Ground* ground = placed.target->ground(); ground && ground_angle_ > 0)
      ground_levels_[i] = ground->levels(placed.from_observer.offset, ground_angle_);
  }
  std::vector<AxisBox> boxes(visible_.size());
  double far = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Placed& placed = targets_[visible_[i]];
    const Vec3 offset = placed.frame.position - observer_.position;
    const AxisBox& bounds = placed.target->bounds();
    for_corners(bounds.low, bounds.high, [&](const Vec3& corner) {
      boxes[i].add(placed.frame.world_from * corner + offset);
    });
    far = std::max({far, largest(boxes[i].low), largest(boxes[i].high), largest(bounds.low),
                    largest(bounds.high)});
  }
  for (AxisBox& box : boxes)
    box.widen(kSizeSlack * largest(box.high - box.low) + kDistanceSlack * far);
  tree_.build(std::move(boxes));
}

// A ray in the frame of a target's model.
geometry::Ray Scene::local(const Ray& ray, std::uint32_t target) const {
  if (ray.frame == target) return ray;
  const Placed& to = targets_[target];
  if (ray.frame == Ray::kObserver)
    return {to.from_observer(ray.origin), to.from_observer.linear * ray.direction, ray.min_distance,
            ray.max_distance};
  const RigidFrame& from = targets_[ray.frame].frame;
  // a row times a matrix: the inverse of a rotation is its transpose
  return {
      (from.world_from * ray.origin + (from.position - to.frame.position)) * to.frame.world_from,
      (from.world_from * ray.direction) * to.frame.world_from, ray.min_distance, ray.max_distance};
}

// Calls look(target, ray in its frame) for the targets that a ray may hit, that whose frame it is
// in first, until it returns true.
template <class Look>
void Scene::visit(const Ray& ray, const double& limit, const Look& look) const {
  const bool observed = ray.frame == Ray::kObserver;
  if (!observed && look(ray.frame, ray)) return;
  const RigidFrame& from = observed ? observer_ : targets_[ray.frame].frame;
  tree_.search(from.world_from * ray.origin + (from.position - observer_.position),
               from.world_from * ray.direction, ray.min_distance, limit, [&](std::uint32_t number) {
                 const std::uint32_t target = visible_[number];
                 if (target == ray.frame) return false;
                 geometry::Ray there = local(ray, target);
                 there.max_distance = limit;
                 return look(target, there);
               });
}

// Sets a nearer hit on the terrain of a target.
void Scene::meet_ground(std::uint32_t target, const geometry::Ray& ray, const GroundBeams* beams,
                        Hit& best, double& limit) const {
  const terrain::Ground* ground = targets_[target].target->ground();
  if (ground == nullptr) return;
  const auto& levels = ground_levels_[target];
  set_ground(target, ray.direction,
             ground->nearest(ray.origin, ray.direction, ray.min_distance, limit,
                             levels ? &*levels : nullptr, beam_of(beams, target)),
             best, limit);
}

void Scene::set_ground(std::uint32_t target, const Vec3& direction,
                       const std::optional<terrain::GroundHit>& hit, Hit& best, double& limit) {
  if (!hit || (best && hit->distance >= best.distance)) return;
  best = {};
  best.distance = limit = hit->distance;
  best.target = target;
  best.part = Hit::kGround;
  best.triangle = hit->point.triangle;
  best.direction = direction;
  best.position = hit->point.position;
  best.normal = hit->point.normal;
  best.chart = hit->point.chart;
  best.level = hit->point.level;
  best.column = hit->point.column;
  best.row = hit->point.row;
  best.front = glm::dot(best.normal, direction) <= 0;
}

// The nearest hit; of a scene of one target without its tree.
Hit Scene::closest(const Ray& ray, Insides insides) const {
  Hit best;
  double limit = ray.max_distance;
  const auto look = [&](std::uint32_t target, const geometry::Ray& there) {
    const Target& looked = *targets_[target].target;
    const auto hit = looked.closest(there, insides);
    // at equal distances the lower target
    if (hit && (!best || hit->distance < limit || target < best.target)) {
      best = {hit->distance,
              target,
              looked.parts()[hit->instance],
              hit->triangle,
              hit->barycentric,
              hit->front,
              there.direction,
              Vec3(0),
              Vec3(0),
              0,
              0,
              0,
              0};
      limit = hit->distance;
    }
    meet_ground(target, there, nullptr, best, limit);
    return false;
  };
  if (visible_.size() == 1)
    look(visible_[0], local(ray, visible_[0]));
  else
    visit(ray, limit, look);
  return best;
}

Hit Scene::nearest(const Ray& ray, Insides insides) const {
  assert(is_sound(ray, targets_.size()));
  // most rays meet outsides, which costs no questions
  const Hit hit = closest(ray, Insides::stop);
  return hit && insides == Insides::pass && is_inside(hit) ? closest(ray, insides) : hit;
}

// As closest() of rays that any inside stops. Expects: kBundle rays at most; no terrain.
void Scene::closest_of_bundle(std::span<const Ray> rays, std::span<Hit> hits) const {
  std::array<double, kBundle> limits;
  double farthest = 0;
  AxisBox directions;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] = {};
    limits[i] = rays[i].max_distance;
    farthest = std::max(farthest, limits[i]);
    if (visible_.size() > 1) directions.add(observer_.world_from * rays[i].direction);
  }
  const auto look = [&](std::uint32_t target) {
    std::array<geometry::Ray, kBundle> there;
    std::array<std::optional<geometry::InstanceHit>, kBundle> found;
    const Target& looked = *targets_[target].target;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      there[i] = local(rays[i], target);
      there[i].max_distance = limits[i];
    }
    looked.closest(std::span(there).first(rays.size()), std::span(found).first(rays.size()),
                   Insides::stop);
    farthest = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto& hit = found[i];
      // at equal distances the lower target
      if (hit && (!hits[i] || hit->distance < limits[i] || target < hits[i].target)) {
        hits[i] = {hit->distance,      target,           looked.parts()[hit->instance],
                   hit->triangle,      hit->barycentric, hit->front,
                   there[i].direction, Vec3(0),          Vec3(0)};
        limits[i] = hit->distance;
      }
      farthest = std::max(farthest, limits[i]);
    }
    return false;
  };
  if (visible_.size() == 1) {
    look(visible_[0]);
    return;
  }
  tree_.search(observer_.world_from * rays[0].origin, directions, rays[0].min_distance, farthest,
               [&](std::uint32_t number) { return look(visible_[number]); });
}

void Scene::nearest_bundle(std::span<const Ray> rays, std::span<Hit> hits, Insides insides) const {
  assert(rays.size() == hits.size());
  const auto has_ground = [&](std::uint32_t target) {
    return targets_[target].target->ground() != nullptr;
  };
  if (std::ranges::any_of(visible_, has_ground)) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = nearest(rays[i], insides);
    return;
  }
  for (std::size_t first = 0; first < rays.size(); first += kBundle) {
    const std::size_t count = std::min(kBundle, rays.size() - first);
    closest_of_bundle(rays.subspan(first, count), hits.subspan(first, count));
    for (std::size_t i = first; i < first + count; ++i)
      if (hits[i] && insides == Insides::pass && is_inside(hits[i]))
        hits[i] = closest(rays[i], insides);
  }
}

void Scene::report_damaged(DiagnosticLog& log) const {
  for (const Placed& placed : targets_)
    if (const terrain::Ground* ground = placed.target->ground())
      ground->tiles().report_damaged(log);
}

Hit Scene::nearest_ground(const Ray& ray, const GroundBeams* beams) const {
  Hit best;
  double limit = ray.max_distance;
  for (const std::uint32_t target : visible_)
    if (targets_[target].target->ground() != nullptr)
      meet_ground(target, local(ray, target), beams, best, limit);
  return best;
}

void Scene::nearest_ground(std::span<const Ray> rays, std::span<Hit> hits,
                           const GroundBeams& beams) const {
  assert(rays.size() == hits.size());
  const auto is_alike = [&](const Ray& ray) {
    return ray.origin == rays[0].origin && ray.frame == rays[0].frame && ray.min_distance == 0;
  };
  if (!std::ranges::all_of(rays, is_alike)) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = nearest_ground(rays[i], &beams);
    return;
  }
  static thread_local std::vector<Vec3> directions;
  static thread_local std::vector<double> limits;
  static thread_local std::vector<std::optional<terrain::GroundHit>> found;
  std::ranges::fill(hits, Hit{});
  limits.clear();
  for (const Ray& ray : rays) limits.push_back(ray.max_distance);
  found.resize(rays.size());
  for (const std::uint32_t target : visible_) {
    const terrain::Ground* ground = targets_[target].target->ground();
    if (ground == nullptr || rays.empty()) continue;
    directions.clear();
    for (const Ray& ray : rays) directions.push_back(local(ray, target).direction);
    const auto& levels = ground_levels_[target];
    ground->nearest(local(rays[0], target).origin, directions, limits, found,
                    levels ? &*levels : nullptr, beam_of(&beams, target));
    for (std::size_t i = 0; i < rays.size(); ++i)
      set_ground(target, directions[i], found[i], hits[i], limits[i]);
  }
}

GroundBeams Scene::ground_beams(const terrain::RayBeam& rays, std::uint32_t frame) const {
  GroundBeams out;
  out.beams_.resize(targets_.size());
  for (const std::uint32_t target : visible_) {
    const terrain::Ground* ground = targets_[target].target->ground();
    if (ground == nullptr) continue;
    const geometry::Ray axis = local({{rays.origin, rays.axis}, frame}, target);
    const auto& levels = ground_levels_[target];
    out.beams_[target] =
        ground->beam({axis.origin, rays.radius, axis.direction, rays.angle, rays.leaves_ground},
                     levels ? &*levels : nullptr);
  }
  return out;
}

const terrain::GroundBeam* Scene::beam_of(const GroundBeams* beams, std::uint32_t target) {
  return beams != nullptr && beams->beams_[target] ? &*beams->beams_[target] : nullptr;
}

bool Scene::is_blocked_by_ground(std::uint32_t target, const geometry::Ray& ray,
                                 const GroundBeams* beams) const {
  const terrain::Ground* ground = targets_[target].target->ground();
  const auto& levels = ground_levels_[target];
  return ground != nullptr &&
         ground->is_blocked(ray.origin, ray.direction, ray.min_distance, ray.max_distance,
                            levels ? &*levels : nullptr, beam_of(beams, target));
}

bool Scene::meets_ground(std::uint32_t target, const Ray& ray) const {
  return is_blocked_by_ground(target, local(ray, target), nullptr);
}

bool Scene::any(const Ray& ray, Insides insides, const GroundBeams* beams) const {
  assert(is_sound(ray, targets_.size()));
  const auto blocks = [&](std::uint32_t target, const geometry::Ray& there) {
    return targets_[target].target->any(there, insides) ||
           is_blocked_by_ground(target, there, beams);
  };
  if (visible_.size() == 1) return blocks(visible_[0], local(ray, visible_[0]));
  bool found = false;
  visit(ray, ray.max_distance, [&](std::uint32_t target, const geometry::Ray& there) {
    return found = blocks(target, there);
  });
  return found;
}

void Scene::nearest(std::span<const Ray> rays, std::span<Hit> hits, Insides insides,
                    const Job& job) const {
  assert(rays.size() == hits.size());
  for_rays(rays.size(), job, [&](std::size_t i) { hits[i] = nearest(rays[i], insides); });
}

void Scene::any(std::span<const Ray> rays, std::span<std::uint8_t> found, Insides insides,
                const Job& job) const {
  assert(rays.size() == found.size());
  for_rays(rays.size(), job, [&](std::size_t i) { found[i] = any(rays[i], insides); });
}

Ids Scene::ids(const Hit& hit) const {
  if (!hit) return {};
  if (hit.part == Hit::kGround) return {hit.target + 1, 1, 0, 0};
  const Model& traced = targets_[hit.target].target->model();
  const pan::Model& model = *traced.model();
  const std::uint32_t index = traced.parts()[hit.part].instance;
  const pan::layout::Instance& instance = model.instances()[index];
  const std::int32_t back = hit.front ? -1 : model.back_of(index);
  return {hit.target + 1, instance.node + 1,
          (back < 0 ? instance.material : static_cast<std::uint32_t>(back)) + 1, index + 1};
}

double half_pixel(const world::Camera& camera) {
  if (camera.projection == world::Projection::orthographic) return 0;
  world::Camera own = camera;
  own.position = Vec3(0);
  own.world_from_camera = Quat(1, 0, 0, 0);
  constexpr int kParts = 8;
  double least = kPi;
  for (int j = 0; j <= kParts; ++j)
    for (int i = 0; i <= kParts; ++i) {
      const Vec2 place(camera.width * double(i) / kParts, camera.height * double(j) / kParts);
      const auto here = world::distorted_ray(own, place);
      for (const Vec2& step : {Vec2(1, 0), Vec2(0, 1)}) {
        const auto next = world::distorted_ray(own, place + step);
        if (here && next) least = std::min(least, glm::length(next->direction - here->direction));
      }
    }
  // between the places that were asked angles differ by less
  return 0.45 * least;
}

}  // namespace panwright::trace
