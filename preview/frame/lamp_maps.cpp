#include "preview/frame/lamp_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "preview/frame/shadow.h"

namespace panwright::preview {
namespace {

// of the far end: depths are held to a millionth of themselves, whatever this is
constexpr double kNearestShare = 1e-4;
constexpr unsigned kLeastMapSide = 64;
// So many maps pay for casters of their own, with an error of so many texels.
constexpr std::size_t kManyMaps = 8;
constexpr double kCasterTexels = 0.25;

Tile whole_map(const world::Camera& camera) { return {0, 0, camera.width, camera.height}; }

bool has_rays_from_point(const LampMap& map) {
  return map.camera.projection == world::Projection::perspective;
}

// Whether a box may shadow what is on a map; of parallel rays all that is towards the light may.
bool may_shadow(const LampMap& map, PlacedBox box) {
  if (!has_rays_from_point(map)) {
    for (int column = 0; column < 3; ++column) box.camera_from_mesh[column].z = 0;
    box.camera_from_mesh[3].z = 1;
  }
  return may_touch(map.camera, whole_map(map.camera), 1, box);
}

// The width of a texel on a box at its nearest point, metres; 0: it is at the lamp.
double texel_on(const LampMap& map, const PlacedBox& box) {
  double depth = INFINITY;
  for (const Vec3& corner : corners(box.low, box.high))
    depth = std::min(depth, (box.camera_from_mesh * Vec4(corner, 1)).z);
  if (!has_rays_from_point(map)) depth = 1;
  return std::max(depth, 0.0) / map.camera.focal.x;
}

void set_map_side(LampMap& map, unsigned side) {
  map.camera.width = map.camera.height = side;
  map.camera.principal = Vec2(side / 2.0);
  map.camera.focal = Vec2((side - 4) / 2.0 / map.extent);  // two texels to spare all round
}

}  // namespace

Quat looking_along(const Vec3& z) {
  Vec3 up(0);
  up[std::fabs(z.z) < 0.8 ? 2 : 0] = 1;
  const Vec3 x = glm::normalize(glm::cross(z, up));
  return glm::normalize(glm::quat_cast(Mat3(x, glm::cross(z, x), z)));
}

LampMap parallel_map(const Vec3& centre, double radius, const Vec3& to_light,
                     std::uint32_t target) {
  LampMap map;
  map.camera.projection = world::Projection::orthographic;
  map.camera.position = centre + 1.01 * radius * to_light;
  map.camera.world_from_camera = looking_along(-to_light);
  map.extent = std::max(radius, 1e-300);
  map.target = target;
  return map;
}

void LampMaps::forget() { slots_.assign(slots_.size(), {}); }

// Sets the range of depths, and casters_.
void LampMaps::place(const FrameScene& scene, LampMap& map) {
  casters_.clear();
  double near = INFINITY;
  double far = 0;
  for (std::uint32_t i = 0; i < scene.world.size(); ++i) {
    const auto& bounds = scene.states[i].bounds;
    if (!bounds) continue;
    const PlacedBox box{camera_from(map.camera, scene.world[i].pose().matrix()), bounds->low,
                        bounds->high};
    if (i != map.target && !may_shadow(map, box)) continue;
    casters_.push_back(i);
    for (const Vec3& corner : corners(bounds->low, bounds->high)) {
      const double z = (box.camera_from_mesh * Vec4(corner, 1)).z;
      near = std::min(near, z);
      if (i == map.target) far = std::max(far, z);
    }
  }
  const double pad = std::max((far - near) * 0x1p-10, std::fabs(far) * 0x1p-44);
  far = std::max(far + pad, 0x1p-300);
  const double least = has_rays_from_point(map) ? std::max(far * kNearestShare, map.nearest) : 0;
  map.range = {std::min(std::max(near - pad, least), 0.999 * far), far};
}

LampMaps::Key LampMaps::key_of(const FrameScene& scene, const LampMap& map) const {
  Key key;
  const world::Camera& camera = map.camera;
  const Quat& q = camera.world_from_camera;
  key.numbers = {camera.position.x,
                 camera.position.y,
                 camera.position.z,
                 q.w,
                 q.x,
                 q.y,
                 q.z,
                 camera.focal.x,
                 map.range.near,
                 map.range.far,
                 has_rays_from_point(map) ? 1.0 : 0.0};
  key.stamps.push_back(map.target);
  key.stamps.push_back(simplified_);
  for (const std::uint32_t i : casters_) {
    key.stamps.push_back(scene.states[i].shape_stamp);
    key.stamps.push_back(scene.states[i].level);
    const world::Pose& pose = scene.world[i].pose();
    for (int k = 0; k < 3; ++k) key.numbers.push_back(pose.translation[k]);
    for (int k = 0; k < 4; ++k) key.numbers.push_back(pose.rotation[k]);
  }
  return key;
}

void LampMaps::add_draws(const GladGLContext& gl, const FrameScene& scene, const LampMap& map) {
  draws_.clear();
  const Tile whole = whole_map(map.camera);
  const bool clamped = !has_rays_from_point(map);
  for (const std::uint32_t target : casters_) {
    const TargetState& state = scene.states[target];
    const Mat4 camera_from_model = camera_from(map.camera, scene.world[target].pose().matrix());
    const std::span<const DrawItem> items = state.items();
    touched_.clear();
    std::size_t visible = 0;
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      if (!items[i].visible) continue;
      ++visible;
      if (may_shadow(map,
                     {camera_from_model * items[i].model_from_mesh, items[i].low, items[i].high}))
        touched_.push_back(i);
    }
    const PlacedBox bounds{camera_from_model, state.bounds->low, state.bounds->high};
    const double texel = texel_on(map, bounds);
    const bool simplified = simplified_ && texel > 0 && 2 * touched_.size() >= visible;
    const CasterMesh* mesh = nullptr;
    for (const std::uint32_t i : touched_) {
      const bool apart = !simplified || items[i].variant.cutout;
      if (!apart && mesh) continue;
      if (!apart)
        mesh = &meshes_.find(gl, state.model().model, items, state.shape_stamp, state.level,
                             kCasterTexels * texel);
      const Mat4 camera_from_mesh =
          apart ? camera_from_model * items[i].model_from_mesh : camera_from_model;
      const Mat4 clip = clip_from_mesh(map.camera, whole, map.range, camera_from_mesh);
      draws_.add(gl, target, i, 0, clamped, items[i], clip, apart ? nullptr : mesh);
    }
  }
}

bool LampMaps::update(Device::Impl& device, const FrameScene& scene, std::vector<LampMap>& maps,
                      unsigned side, std::uint64_t bytes, DiagnosticLog& log, const Job& job) {
  const GladGLContext& gl = device.context->gl();
  const std::uint32_t most = device.context->limits().framebuffer_side;
  ++update_;
  if (maps.empty()) return true;
  simplified_ = maps.size() >= kManyMaps;
  meshes_.begin();
  side = std::min(side, most);
  while (side > kLeastMapSide &&
         ShadowMaps::kTexelBytes * side * side * std::uint64_t{maps.size()} > bytes)
    side /= 2;
  if (side != side_ || maps.size() > slots_.size()) {
    slots_.clear();
    side_ = 0;
    if (!layers_.make(gl, side, side, most, static_cast<int>(maps.size()))) {
      log.report_file(Code("E5003"), {},
                      fmt::format("the context has no memory for {} shadow maps of lamps, each of "
                                  "{} by {} texels",
                                  maps.size(), side, side));
      return false;
    }
    side_ = side;
    slots_.resize(maps.size());
  }
  for (std::size_t i = 0; i < scene.states.size(); ++i) {
    for (const DrawItem& item : scene.states[i].items())
      for (const bool instanced : {false, true})
        device.programs.shadow(item.variant.cutout, instanced);
  }
  if (!device.programs_ready(log)) return false;
  std::vector<Key> keys;
  for (LampMap& map : maps) {
    set_map_side(map, side);
    place(scene, map);
    keys.push_back(key_of(scene, map));
    map.layer = ~0u;
    for (std::uint32_t s = 0; s < slots_.size(); ++s)
      if (slots_[s].last_use != update_ && slots_[s].key == keys.back()) {
        slots_[s].last_use = update_;
        map.layer = s;
        break;
      }
  }
  for (std::size_t m = 0; m < maps.size(); ++m) {
    LampMap& map = maps[m];
    if (map.layer != ~0u) continue;
    const auto oldest = std::ranges::min_element(slots_, {}, &Slot::last_use);
    map.layer = static_cast<std::uint32_t>(oldest - slots_.begin());
    *oldest = {{}, update_};
    place(scene, map);
    add_draws(gl, scene, map);
    layers_.begin(gl, static_cast<int>(map.layer));
    const auto show = [&](std::uint32_t) {
      gl.Viewport(0, 0, static_cast<GLsizei>(side), static_cast<GLsizei>(side));
    };
    ++drawn_;
    if (!draws_.draw(device, scene.states, std::cref(show), true, job)) {
      report_cancelled(log);
      return false;
    }
    oldest->key = std::move(keys[m]);
  }
  return true;
}

}  // namespace panwright::preview
