#include <fmt/core.h>

#include <algorithm>

#include "pxn/writer.h"

namespace panwright::pxn {

namespace {

bool same_shape(const geometry::Shape& a, const geometry::Shape& b) {
  const auto* mesh_a = std::get_if<geometry::MeshShape>(&a);
  const auto* mesh_b = std::get_if<geometry::MeshShape>(&b);
  if (mesh_a == nullptr || mesh_b == nullptr) return a == b;
  const geometry::Mesh& m = **mesh_a;
  const geometry::Mesh& n = **mesh_b;
  return m.positions == n.positions && m.normals == n.normals && m.texcoords == n.texcoords &&
         m.colors == n.colors && m.triangles == n.triangles && m.error == n.error &&
         m.closed == n.closed;
}

// Which item of one list is which of another; each has one partner.
class Pairs {
 public:
  Pairs(std::size_t a, std::size_t b) : b_of_(a, scene::kNone), a_of_(b, scene::kNone) {}

  // Whether two indices may be partners. alike() looks at the items, the first time.
  template <class Alike>
  bool match(std::int32_t a, std::int32_t b, const Alike& alike) {
    if (a < 0 || b < 0) return a < 0 && b < 0;
    std::int32_t& partner = b_of_[static_cast<std::size_t>(a)];
    std::int32_t& back = a_of_[static_cast<std::size_t>(b)];
    if (partner == b && back == a) return true;
    if (one_to_one_ && (partner != scene::kNone || back != scene::kNone)) return false;
    if (!alike()) return false;
    partner = b;
    back = a;
    return true;
  }
  void allow_copies() { one_to_one_ = false; }

 private:
  std::vector<std::int32_t> b_of_;
  std::vector<std::int32_t> a_of_;
  bool one_to_one_ = true;
};

class Comparison {
 public:
  Comparison(const scene::Scene& a, const scene::Scene& b, Likeness likeness)
      : a_(a),
        b_(b),
        strict_(likeness == Likeness::same),
        shapes_(a.shapes.size(), b.shapes.size()),
        materials_(a.materials.size(), b.materials.size()),
        textures_(a.textures.size(), b.textures.size()) {
    if (strict_) return;
    shapes_.allow_copies();
    materials_.allow_copies();
    textures_.allow_copies();
    world_a_ = scene::world_from_nodes(a);
    world_b_ = scene::world_from_nodes(b);
  }

  std::string run() {
    if (strict_) nodes();
    list("instance", a_.instances, b_.instances,
         [&](const auto& x, const auto& y) { return instance(x, y); });
    list("frame", a_.frames, b_.frames, [&](const auto& x, const auto& y) {
      return x.name == y.name && place(x.node, y.node) && x.origin == y.origin &&
                     x.rotation == y.rotation
                 ? ""
                 : x.name;
    });
    list("keypoint", a_.keypoints, b_.keypoints, [&](const auto& x, const auto& y) {
      return x.name == y.name && place(x.node, y.node) && x.position == y.position ? "" : x.name;
    });
    list("lamp", a_.lamps, b_.lamps, [&](const auto& x, const auto& y) {
      return x.name == y.name && place(x.node, y.node) && x.kind == y.kind &&
                     x.position == y.position && x.axis == y.axis && x.intensity == y.intensity &&
                     x.half_angle == y.half_angle && x.exponent == y.exponent &&
                     x.radius == y.radius && x.on == y.on && x.pulse == y.pulse
                 ? ""
                 : x.name;
    });
    list("setting", a_.settings, b_.settings, [](const auto& x, const auto& y) {
      return x.name == y.name && x.value == y.value ? "" : x.name;
    });
    list("joint", a_.joints, b_.joints, [&](const auto& x, const auto& y) {
      return x.name == y.name && (!strict_ || place(x.node, y.node)) && x.kind == y.kind &&
                     x.axis == y.axis && x.lower == y.lower && x.upper == y.upper &&
                     scene::initial_values(x) == scene::initial_values(y) && x.mimic == y.mimic &&
                     x.multiplier == y.multiplier && x.offset == y.offset &&
                     x.pointing == y.pointing && x.gimbal == y.gimbal && x.point_at == y.point_at
                 ? ""
                 : x.name;
    });
    list("decal", a_.decals, b_.decals,
         [&](const auto& x, const auto& y) { return decal(x, y) ? "" : "its texture or place"; });
    const scene::Budget &m = a_.budget, &n = b_.budget;
    if (m.tolerance != n.tolerance || m.nearest != n.nearest || m.ifov != n.ifov ||
        m.pixels != n.pixels || m.flux != n.flux || m.centroid != n.centroid ||
        m.approach != n.approach || m.corridor != n.corridor)
      say("the budget");
    return difference_;
  }

 private:
  void say(std::string difference) {
    if (difference_.empty()) difference_ = std::move(difference);
  }

  template <class Item, class Difference>
  void list(const char* noun, const std::vector<Item>& a, const std::vector<Item>& b,
            const Difference& difference) {
    if (a.size() != b.size()) return say(fmt::format("{} {}s, not {}", b.size(), noun, a.size()));
    for (std::size_t i = 0; i < a.size() && difference_.empty(); ++i) {
      const std::string found = difference(a[i], b[i]);
      if (!found.empty()) say(fmt::format("{} {}: {}", noun, i + 1, found));
    }
  }

  void nodes() {
    list("node", a_.nodes, b_.nodes, [](const scene::Node& x, const scene::Node& y) {
      if (x.name != y.name) return fmt::format("called '{}', not '{}'", y.name, x.name);
      if (x.marks != y.marks) return fmt::format("'{}' has another label", x.name);
      if (x.parent != y.parent) return fmt::format("'{}' is in another node", x.name);
      const bool moved = !(x.parent_from_node == y.parent_from_node);
      return moved ? fmt::format("'{}' is placed otherwise", x.name) : std::string();
    });
  }

  bool place(std::int32_t a, std::int32_t b) const {
    if (strict_) return a == b;
    return world_a_[static_cast<std::size_t>(a)] == world_b_[static_cast<std::size_t>(b)];
  }

  bool texture(std::int32_t a, std::int32_t b) {
    return textures_.match(a, b, [&] {
      const scene::Texture& x = a_.textures[static_cast<std::size_t>(a)];
      const scene::Texture& y = b_.textures[static_cast<std::size_t>(b)];
      return (!strict_ || x.name == y.name) && x.width == y.width && x.height == y.height &&
             x.linear == y.linear && x.rgba == y.rgba;
    });
  }

  bool material(std::int32_t a, std::int32_t b) {
    return materials_.match(a, b, [&] {
      materials::Material x = a_.materials[static_cast<std::size_t>(a)];
      materials::Material y = b_.materials[static_cast<std::size_t>(b)];
      for (const auto map :
           {&materials::Maps::albedo, &materials::Maps::normal, &materials::Maps::roughness,
            &materials::Maps::reflectance, &materials::Maps::cutout}) {
        if (!texture(x.maps.*map, y.maps.*map)) return false;
        x.maps.*map = y.maps.*map = scene::kNone;
      }
      if (!strict_) x.name = y.name;
      return x == y;
    });
  }

  std::string instance(const scene::Instance& x, const scene::Instance& y) {
    if (!place(x.node, y.node)) return "its place";
    if (!shapes_.match(x.shape, y.shape, [&] {
          return same_shape(a_.shapes[static_cast<std::size_t>(x.shape)],
                            b_.shapes[static_cast<std::size_t>(y.shape)]);
        }))
      return "its shape";
    if (!material(x.material, y.material)) return "its material";
    if ((x.back == scene::kNone) != (y.back == scene::kNone) ||
        (x.back != scene::kNone && !material(x.back, y.back)))
      return "its back";
    if (!texture(x.texture, y.texture) || x.mapping != y.mapping ||
        !(x.texture_from_shape == y.texture_from_shape))
      return "its texture";
    return x.tolerance == y.tolerance ? "" : "its tolerance";
  }

  bool decal(const scene::Decal& x, const scene::Decal& y) {
    return x.name == y.name && x.instance == y.instance && texture(x.texture, y.texture) &&
           x.at == y.at && x.normal == y.normal && x.up == y.up && x.width == y.width &&
           x.height == y.height;
  }

  const scene::Scene& a_;
  const scene::Scene& b_;
  bool strict_;
  Pairs shapes_;
  Pairs materials_;
  Pairs textures_;
  std::vector<Mat4> world_a_;
  std::vector<Mat4> world_b_;
  std::string difference_;
};

}  // namespace

std::string scene_difference(const scene::Scene& a, const scene::Scene& b, Likeness likeness) {
  return Comparison(a, b, likeness).run();
}

}  // namespace panwright::pxn
