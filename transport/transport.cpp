#include "transport/transport.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "transport/internal/direct.h"

namespace panwright::transport {
namespace {

// Bounds of a target as a ball of the world.
struct Ball {
  Vec3 centre{0};
  double radius = 0;
};
Ball ball_of(const trace::Scene::Placed& placed) {
  const AxisBox& bounds = placed.target->bounds();
  return {placed.frame.world_from * bounds.centre() + placed.frame.position,
          0.5 * bounds.diagonal()};
}

// Whether a target fills more than a thousandth of what the other sees.
bool are_near(const Ball& a, const Ball& b) {
  constexpr double kShare = 1e-3;
  const double apart = glm::length(a.centre - b.centre);
  const double larger = std::max(a.radius, b.radius);
  return larger * larger > kShare * apart * apart;
}

Hash128 key_of(const trace::Target& target, std::span<const std::uint8_t> glossy,
               const TransportOptions& options) {
  KeyHasher key;
  key.number(4);  // of the entries' form
  key.list(glossy);
  key.number(options.surfels.surfels);
  key.number(options.surfels.points);
  const pan::Model& model = *target.model().model();
  for (std::size_t i = 0; i < target.parts().size(); ++i) {
    const trace::Model::Part& part = target.model().parts()[target.parts()[i]];
    const trace::Affine& place = target.placements()[i].model_from_mesh;
    key.number(target.parts()[i]);
    key.list(part.mesh.positions);
    key.number(part.mesh.indices.size());
    for (std::size_t k = 0; k < part.mesh.indices.size(); ++k) key.number(part.mesh.indices[k]);
    for (int k = 0; k < 3; ++k)
      for (int row = 0; row < 3; ++row) key.real(place.linear[k][row]);
    for (int row = 0; row < 3; ++row) key.real(place.offset[row]);
    key.real(model.meshes()[part.mesh_index].error);
    key.number(part.closed);
    if (part.cutout < 0) continue;
    key.list(part.mesh.texcoords);
    key.list(model.texels(static_cast<std::size_t>(part.cutout)));
    key.real(part.threshold);
    key.real(part.repeat.x);
    key.real(part.repeat.y);
  }
  return key.key();
}

}  // namespace

void Transport::place(const world::World& world, const Job& job) {
  // the finest meshes: relief of foil lights itself
  if (!scene_) scene_.emplace();
  scene_->update(world, job);
  std::vector<Slot> slots;
  slot_of_.assign(world.size(), ~0u);
  for (const std::uint32_t target : scene_->visible()) {
    Slot slot;
    const Stamp stamp = world[target].shape_stamp();
    const auto same = std::ranges::find(slots_, stamp, &Slot::shape_stamp);
    if (same != slots_.end()) slot = *same;
    slot.target = target;
    slot.shape_stamp = stamp;
    if (!slot.shape) slot.shape = make_shape(target, job);
    slot_of_[target] = static_cast<std::uint32_t>(slots.size());
    slots.push_back(std::move(slot));
  }
  slots_ = std::move(slots);
}

Transport::ShapePtr Transport::make_shape(std::uint32_t target, const Job& job) {
  constexpr std::uint32_t kAsked = 8;  // points for the mean tint
  auto shape = std::make_shared<Shape>();
  shape->target = scene_->targets()[target].target;
  shape->set = std::make_unique<const SurfelSet>(*scene_, target, options_.surfels, job);
  const trace::Model* model = &shape->target->model();
  std::erase_if(reflectances_, [](const auto& entry) { return entry.second.use_count() == 1; });
  auto& reflectance = reflectances_[model];
  if (!reflectance) reflectance = std::make_shared<const ModelReflectance>(*model);
  shape->reflectance = reflectance;
  const SurfelSet& set = *shape->set;
  for (std::size_t s = 0; s < set.surfels().size(); ++s) {
    const std::uint32_t begin = set.first(s), count = set.first(s + 1) - begin;
    ModelReflectance::At mean = reflectance->at(set.points()[begin]);
    mean.tint = Vec3(0);
    for (std::uint32_t k = 0; k < kAsked; ++k)
      mean.tint += reflectance->at(set.points()[begin + k * count / kAsked]).tint;
    mean.tint /= double{kAsked};
    shape->surfaces.push_back(mean);
    shape->glossy.push_back(mean.reflectance->is_glossy());
  }
  std::vector<light::SurfacePlace> places;
  for (const Point& point : set.points()) places.push_back({point.start, point.normal});
  // half a spacing: lists of those that light a place are not much longer than these
  shape->grid = std::make_shared<const light::SurfelGrid>(
      light::surfel_grid(set.surfels(), 0.5 * set.spacing(), places, job));
  ++counts_.shapes;
  return shape;
}

TransportLists Transport::kept_lists(const Slot& slot, std::span<const SurfelSet* const> sets,
                                     bool alone, const Job& job) {
  const std::size_t surfels = slot.shape->set->surfels().size();
  bool traced = false;
  const auto made = [&]() -> std::optional<TransportLists> {
    traced = true;
    ++counts_.lists;
    std::vector<std::vector<std::uint8_t>> glossy;
    for (const Slot& each : slots_) glossy.push_back(each.shape->glossy);
    return transport_lists(*scene_, slot.target, slot_of_, sets, glossy, job);
  };
  const auto write = [](const TransportLists& lists, ByteWriter& to) {
    to.list(lists.first);
    to.list(lists.entries);
    to.list(lists.first_glossy);
    to.list(lists.glossy);
    to.list(lists.ray_share);
    to.list(lists.open);
  };
  const auto read = [&](ByteReader& from) {
    TransportLists lists;
    from.list(lists.first);
    from.list(lists.entries);
    from.list(lists.first_glossy);
    from.list(lists.glossy);
    from.list(lists.ray_share);
    from.list(lists.open);
    const auto sound_rows = [&](const auto& first, const auto& entries) {
      return first.size() == surfels + 1 && first.back() == entries.size() &&
             std::ranges::is_sorted(first) && std::ranges::all_of(entries, [&](const auto& entry) {
               return entry.surfel < surfels;
             });
    };
    const bool sound =
        sound_rows(lists.first, lists.entries) && sound_rows(lists.first_glossy, lists.glossy) &&
        lists.ray_share.size() == surfels && lists.open.size() == slot.shape->set->points().size();
    if (!sound) from.fail();
    return lists;
  };
  const WorkCache* cache = alone ? cache_ : nullptr;
  auto lists = remember<TransportLists>(
      cache, Work::transport,
      [&] { return key_of(*slot.shape->target, slot.shape->glossy, options_); }, made, write, read);
  if (!traced) {
    ++counts_.kept;
    // the slot's number is of this world
    for (TransportLists::Entry& entry : lists->entries) entry.slot = slot_of_[slot.target];
    for (TransportLists::Glossy& ray : lists->glossy) ray.slot = slot_of_[slot.target];
  }
  return *std::move(lists);
}

// Traces lists that are out of date. Returns whether there were any.
bool Transport::trace_lists(const world::World& world, const Job& job) {
  std::vector<const SurfelSet*> sets;
  std::vector<Ball> balls;
  for (const Slot& slot : slots_) {
    sets.push_back(slot.shape->set.get());
    balls.push_back(ball_of(scene_->targets()[slot.target]));
  }
  bool any = false;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    std::vector<std::uint64_t> near{slot.shape_stamp, i};
    for (std::size_t k = 0; k < slots_.size(); ++k)
      if (k != i && are_near(balls[i], balls[k]))
        near.insert(near.end(), {k, slots_[k].shape_stamp, world[slots_[k].target].pose_stamp()});
    const bool alone = near.size() == 2;
    if (!alone) near.push_back(world[slot.target].pose_stamp());
    if (slot.lists && slot.near == near) continue;
    slot.lists = std::make_shared<const TransportLists>(kept_lists(slot, sets, alone, job));
    slot.near = std::move(near);
    any = true;
  }
  return any;
}

void Transport::find_light(const world::World& world, std::span<const light::Source> lamps,
                           std::span<const light::GroundShine> ground, const Job& job) {
  std::vector<Sources> sources;
  std::vector<DirectLights> lights;
  std::vector<const Sources*> each;
  std::vector<const TransportLists*> lists;
  std::vector<const SurfelSet*> sets;
  for (const Slot& slot : slots_) {
    const Ball ball = ball_of(scene_->targets()[slot.target]);
    const bool shone = slot.target < ground.size() && ground[slot.target].stamp != 0;
    lights.push_back(
        direct_lights(world, ball.centre, lamps, shone ? &ground[slot.target] : nullptr));
    sources.push_back(direct_sources(*scene_, slot.target, *slot.shape->set, *slot.lists,
                                     slot.shape->surfaces, lights.back(), job));
    lists.push_back(slot.lists.get());
    sets.push_back(slot.shape->set.get());
  }
  std::vector<Glossy> glossy;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    glossy.push_back({slots_[i].target, slots_[i].shape->surfaces, &lights[i], &sources[i]});
    each.push_back(&sources[i]);
  }
  for (std::size_t i = 0; i < slots_.size(); ++i)
    throw_sunlight(*scene_, slots_[i].target, *sets[i], *lists[i], glossy, sources[i], job);
  const std::vector<Arriving> found = interreflections(lists, each, sets, options_.bounces, job);
  light_.assign(world.size(), {});
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    light::SurfelLight& light = light_[slots_[i].target];
    light.grid = slots_[i].shape->grid;
    light.stamp = next_stamp();
    const auto surfels = sets[i]->surfels();
    light.sides = found[i].sides;
    slots_[i].sent.clear();
    for (std::size_t s = 0; s < surfels.size(); ++s) {
      const Vec3& irradiance = found[i].irradiance[s];
      const Vec3 again = sources[i].albedo[s] * irradiance;
      const Vec3 sent = sources[i].sent[s] + sources[i].glossy[s] + again;
      slots_[i].sent.push_back({static_cast<float>((sent.x + sent.y + sent.z) / 3),
                                static_cast<float>((again.x + again.y + again.z) / 3)});
      const glm::vec3 rgb(irradiance);
      light.irradiance.push_back({rgb.x, rgb.y, rgb.z, static_cast<float>(1 / surfels[s].radius)});
    }
  }
}

Transport::Change Transport::change_seen(const world::World& world,
                                         const world::Camera& camera) const {
  Change sum;
  for (const Slot& slot : slots_) {
    const world::Pose& pose = world[slot.target].pose();
    const Quat back = glm::conjugate(pose.rotation);
    const Vec3 from = back * (camera.position - pose.translation);
    const Vec3 towards = back * (camera.world_from_camera * Vec3(0, 0, -1));
    const auto surfels = slot.shape->set->surfels();
    for (std::size_t s = 0; s < surfels.size(); ++s) {
      const bool parallel = camera.projection == world::Projection::orthographic;
      const Vec3 way = parallel ? towards : from - surfels[s].position;
      const double squared = glm::dot(way, way);
      const double cosine = glm::dot(surfels[s].normal, way) / std::sqrt(squared);
      if (!(cosine > 0)) continue;
      const double angle = slot.shape->set->area(s) * cosine / (parallel ? 1 : squared);
      const double sent = double{slot.sent[s][0]} / kPi, again = double{slot.sent[s][1]} / kPi;
      sum.flux += angle * sent;
      sum.added += angle * again;
      sum.square += angle * sent * sent;
      sum.added_square += angle * again * again;
    }
  }
  return sum;
}

void Transport::update(const world::World& world, std::span<const light::Source> lamps,
                       std::span<const light::GroundShine> ground, const Job& job) {
  const std::vector<light::Source> now(lamps.begin(), lamps.end());
  std::vector<Stamp> shone;
  for (const light::GroundShine& shine : ground) shone.push_back(shine.stamp);
  if (stamp_ == world.stamp() && now == lamps_ && shone == ground_) return;
  std::vector<std::uint64_t> stamps{world.sun_stamp(), world.sky_stamp()};
  for (const world::Instance& target : world.instances())
    stamps.insert(stamps.end(), {target.shape_stamp(), target.pose_stamp()});
  stamp_ = 0;
  if (stamps != stamps_ || now != lamps_ || world.white() != white_ || shone != ground_ ||
      light_.empty()) {
    stamps_.clear();
    place(world, job);
    trace_lists(world, job);
    find_light(world, lamps, ground, job);
    ++counts_.lights;
    stamps_ = std::move(stamps);
    white_ = world.white();
    lamps_ = now;
    ground_ = std::move(shone);
  }
  stamp_ = world.stamp();
}

}  // namespace panwright::transport
