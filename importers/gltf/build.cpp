#include "importers/gltf/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include "base/hash.h"
#include "base/text.h"
#include "geometry/mesh/strip.h"
#include "importers/gltf/joints.h"
#include "importers/gltf/materials.h"
#include "importers/gltf/own_export.h"
#include "importers/gltf/read.h"
#include "importers/gltf/skins.h"

namespace panwright::importers::gltf {

namespace {

using tinygltf::Node;
using tinygltf::Primitive;

std::string tidy_name(const std::string& name) {
  std::string tidy = name;
  std::replace(tidy.begin(), tidy.end(), '/', '_');
  return tidy;
}

Vec3 vec3_of(const std::vector<double>& numbers, Vec3 otherwise) {
  return numbers.size() == 3 ? Vec3(numbers[0], numbers[1], numbers[2]) : otherwise;
}

// Whether b is a with every triangle turned round, corner by corner.
bool is_turned_round(const geometry::Mesh& a, const geometry::Mesh& b) {
  if (a.positions != b.positions || a.triangles.size() != b.triangles.size()) return false;
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    const geometry::Triangle &s = a.triangles[i], &t = b.triangles[i];
    const auto first = static_cast<std::size_t>(std::find(t.begin(), t.end(), s[0]) - t.begin());
    if (first == 3 || t[(first + 1) % 3] != s[2] || t[(first + 2) % 3] != s[1]) return false;
  }
  return true;
}

int position_of(const Primitive& primitive) {
  const auto found = primitive.attributes.find("POSITION");
  return found == primitive.attributes.end() ? -1 : found->second;
}

// A primitive's triangles, once read.
struct Loaded {
  std::map<std::array<double, 3>, std::int32_t> shapes;  // in the scene, by their shift
  geometry::MeshShape mesh;
  SkinWeights skin;
  bool has_texcoords = false;
};

class SceneBuilder {
 public:
  SceneBuilder(Document& document, const tinygltf::Model& model, std::size_t posing)
      : d_(document), model_(model), posing_(posing), texture_cache_(document, model, out_.scene) {
    for (const tinygltf::Mesh& mesh : model.meshes)
      for (const Primitive& primitive : mesh.primitives) ++position_users_[position_of(primitive)];
  }

  Result<Imported> build() {
    out_.format = Format::gltf;
    scene::Node root;
    root.name = "root";
    out_.scene.nodes.push_back(root);
    std::vector<int> roots;
    if (!choose_scene(roots)) return failed;
    if (const auto exported = exported_root(model_, roots)) {
      out_.z_up = true;
      const Node& node = model_.nodes[static_cast<std::size_t>(*exported)];
      scene_nodes_[*exported] = 0;
      if (node.mesh >= 0) add_mesh(*exported, node, 0);
      roots = node.children;
    }
    for (auto i = roots.rbegin(); i != roots.rend(); ++i) todo_.push_back({*i, 0, 1});
    std::vector<bool> seen(model_.nodes.size());
    while (!todo_.empty() && !full_) {
      const Visit visit = todo_.back();
      todo_.pop_back();
      if (seen[static_cast<std::size_t>(visit.node)]) continue;
      seen[static_cast<std::size_t>(visit.node)] = true;
      add_node(visit);
    }
    read_the_rest();
    add_joints(d_, model_, scene_nodes_, axes_, out_.scene);
    say_what_is_left();
    out_.scene.inputs = std::move(d_.inputs);
    return std::move(out_);
  }

 private:
  struct Visit {
    int node;
    std::int32_t parent;  // in the scene
    std::uint32_t depth;
  };

  bool choose_scene(std::vector<int>& roots) {
    const std::vector<tinygltf::Scene>& scenes = model_.scenes;
    std::size_t chosen = 0;
    const Json* usual = d_.root.find("scene");
    if (usual) chosen = static_cast<std::size_t>(usual->number);
    if (const auto& wanted = d_.options.scene) {
      const auto named = std::find_if(scenes.begin(), scenes.end(),
                                      [&](const auto& scene) { return scene.name == *wanted; });
      const auto number = parse_double(*wanted);
      if (named != scenes.end()) {
        chosen = static_cast<std::size_t>(named - scenes.begin());
      } else if (number && *number >= 0 && *number < static_cast<double>(scenes.size())) {
        chosen = static_cast<std::size_t>(*number);
      } else {
        std::vector<std::string> names;
        for (const auto& scene : scenes) names.push_back(scene.name);
        d_.report(Code("E6205"), nullptr, "/scenes",
                  fmt::format("unknown scene {}; the file has {}: {}", in_quotes(*wanted),
                              counted(scenes.size(), "scene"), fmt::join(names, ", ")));
        return false;
      }
    }
    if (chosen < scenes.size()) {
      roots = scenes[chosen].nodes;
      other_scenes_ = scenes.size() - 1;
      return true;
    }
    std::vector<bool> is_child(model_.nodes.size());
    for (const Node& node : model_.nodes)
      for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) roots.push_back(static_cast<int>(i));
    return true;
  }

  std::string name_of(int index) const {
    const Node& node = model_.nodes[static_cast<std::size_t>(index)];
    if (!node.name.empty()) return tidy_name(node.name);
    if (node.mesh >= 0) {
      const std::string& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)].name;
      if (!mesh.empty()) return tidy_name(mesh);
    }
    return fmt::format("node{}", index);
  }

  std::int32_t add(const std::string& name, std::int32_t parent,
                   const scene::Transform& transform) {
    if (out_.scene.nodes.size() >= d_.options.limits.nodes) {
      if (!full_)
        d_.report(Code("E6002"), nullptr, "/nodes",
                  fmt::format("more than {} nodes", d_.options.limits.nodes));
      full_ = true;
      return scene::kNone;
    }
    scene::Node node;
    node.name = name;
    node.parent = parent;
    node.parent_from_node = transform;
    node.source.file = d_.file.path;
    out_.scene.nodes.push_back(std::move(node));
    return static_cast<std::int32_t>(out_.scene.nodes.size() - 1);
  }

  // A node of any affine matrix; a shear takes two. kNone, with a warning, where it flattens space.
  std::int32_t add_matrix(const std::string& name, std::int32_t parent, const Mat4& matrix,
                          const std::string& object) {
    const auto parts = scene::decomposed(matrix);
    if (!parts) {
      d_.report(Code("W6009"), nullptr, object, "the part is left out: its matrix flattens it");
      return scene::kNone;
    }
    if (!parts->sheared) return add(name, parent, parts->outer);
    d_.report(Code("W6215"), nullptr, object,
              "the matrix shears, which a node of glTF must not; it is kept");
    const std::int32_t outer = add(name + "_shear", parent, parts->outer);
    return outer < 0 ? outer : add(name, outer, parts->inner);
  }

  std::int32_t add_transform(int index, std::int32_t parent) {
    const Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const std::string object = pointer("nodes", static_cast<std::size_t>(index));
    if (node.matrix.size() == 16) {
      Mat4 matrix;
      for (int k = 0; k < 16; ++k) matrix[k / 4][k % 4] = node.matrix[static_cast<std::size_t>(k)];
      return add_matrix(name_of(index), parent, matrix, object);
    }
    scene::Transform t;
    t.translation = vec3_of(node.translation, Vec3(0));
    t.scale = vec3_of(node.scale, Vec3(1));
    t.rotation = rotation_of(node);
    if (t.scale.x == 0 || t.scale.y == 0 || t.scale.z == 0) {
      d_.report(Code("W6009"), nullptr, object + "/scale",
                "the part is left out: its scale flattens it");
      return scene::kNone;
    }
    return add(name_of(index), parent, t);
  }

  void add_node(const Visit& visit) {
    const Node& node = model_.nodes[static_cast<std::size_t>(visit.node)];
    if (visit.depth > d_.options.limits.depth) {
      d_.report(Code("E6002"), nullptr, pointer("nodes", static_cast<std::size_t>(visit.node)),
                fmt::format("nodes are nested deeper than {}", d_.options.limits.depth));
      return;
    }
    if (add_exported(visit, node)) return;
    const std::int32_t placed = add_transform(visit.node, visit.parent);
    if (placed < 0) return;
    out_.scene.nodes[static_cast<std::size_t>(placed)].marks.label =
        label_of(d_, model_, visit.node);
    scene_nodes_[visit.node] = placed;
    if (node.mesh >= 0) add_mesh(visit.node, node, placed);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      todo_.push_back({*child, placed, visit.depth + 1});
  }

  static Quat rotation_of(const Node& node) {
    const auto& r = node.rotation;
    if (r.size() != 4) return {1, 0, 0, 0};
    const Quat q(r[3], r[0], r[1], r[2]);
    constexpr double kRounding = 2e-15;  // unit ones keep their bits
    return std::fabs(glm::dot(q, q) - 1) <= kRounding ? q : glm::normalize(q);
  }

  // What a node holds belongs to the node above.
  void put_contents(const Visit& visit, const Node& node) {
    scene_nodes_[visit.node] = visit.parent;
    if (node.mesh >= 0) add_mesh(visit.node, node, visit.parent);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      todo_.push_back({*child, visit.parent, visit.depth + 1});
  }

  // What our exporter writes as a node, and is none in the model.
  bool add_exported(const Visit& visit, const Node& node) {
    const NodeKind kind = kind_of(d_, model_, visit.node);
    const Vec3 at = vec3_of(node.translation, Vec3(0));
    const auto is_new = [&](const auto& list) {
      return std::ranges::none_of(list, [&](const auto& one) { return one.name == node.name; });
    };
    scene::Source source;
    source.file = d_.file.path;
    switch (kind) {
      case NodeKind::part:
        return false;
      case NodeKind::origin:
        add_mesh(visit.node, node, visit.parent, at);
        return true;
      case NodeKind::motion: {
        scene::Transform& above =
            out_.scene.nodes[static_cast<std::size_t>(visit.parent)].parent_from_node;
        const Mat4 motion = matrix_from_trs(at, rotation_of(node), vec3_of(node.scale, Vec3(1)));
        const auto parts = scene::decomposed(above.matrix() * motion);
        if (!parts || parts->sheared || visit.parent == 0) return false;
        above = parts->outer;
        put_contents(visit, node);
        return true;
      }
      case NodeKind::axis:
        axes_[visit.node] = rotation_of(node);
        put_contents(visit, node);
        return true;
      case NodeKind::frame:
        if (!is_new(out_.scene.frames)) return false;
        out_.scene.frames.push_back({node.name, visit.parent, at, rotation_of(node), source});
        return true;
      case NodeKind::keypoint:
        if (!is_new(out_.scene.keypoints)) return false;
        out_.scene.keypoints.push_back({node.name, visit.parent, at, source});
        return true;
    }
    return false;
  }

  // shift: of the mesh at the node
  void add_mesh(int index, const Node& node, std::int32_t placed, const Vec3& shift = Vec3(0)) {
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
    const std::vector<std::int32_t> places = instance_nodes(index, node, placed);
    used_meshes_.resize(model_.meshes.size());
    used_meshes_[static_cast<std::size_t>(node.mesh)] = true;
    const bool morphed = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                     [](const Primitive& p) { return !p.targets.empty(); });
    if (morphed) ++morphed_;
    std::int32_t skinned_place = scene::kNone;
    Sides sides;
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const Primitive& primitive = mesh.primitives[p];
      Loaded& loaded = load(node.mesh, p, weights);
      if (!loaded.mesh || loaded.mesh->triangles.empty()) continue;
      const std::int32_t material = material_index(primitive.material, loaded.has_texcoords);
      if (invisible_[static_cast<std::size_t>(material)]) {
        ++invisible_parts_;
        continue;
      }
      note_losses(*loaded.mesh, material);
      if (node.skin >= 0 && loaded.skin.sets > 0) {
        if (skinned_place < 0)
          skinned_place = add(name_of(index) + "_skinned", 0, scene::Transform{});
        add_skinned(node, loaded, skinned_place, material);
        continue;
      }
      std::optional<SideKey> side;
      if (may_be_side(primitive)) {
        side = key_of(primitive, *loaded.mesh);
        if (is_back_of(sides, *side, loaded, material)) continue;
      }
      const auto [shape, is_new] = loaded.shapes.try_emplace(
          {shift.x, shift.y, shift.z}, static_cast<std::int32_t>(out_.scene.shapes.size()));
      if (is_new) out_.scene.shapes.emplace_back(shifted(with_normals(loaded.mesh), shift));
      if (side && !places.empty())
        sides.emplace(*side, Side{loaded.mesh, out_.scene.instances.size(), places.size()});
      for (const std::int32_t place : places) add_instance(place, shape->second, material);
    }
  }

  // A primitive of a mesh, with its instances.
  struct Side {
    geometry::MeshShape mesh;
    std::size_t first, count;
  };
  // Accessor of positions, number of triangles, hash of the positions.
  using SideKey = std::tuple<int, std::size_t, std::uint64_t>;
  using Sides = std::multimap<SideKey, Side>;

  bool may_be_side(const Primitive& one) const {
    return one.material >= 0 &&
           !model_.materials[static_cast<std::size_t>(one.material)].doubleSided &&
           position_users_.at(position_of(one)) > 1;
  }

  static SideKey key_of(const Primitive& one, const geometry::Mesh& mesh) {
    return {position_of(one), mesh.triangles.size(),
            hash64(std::as_bytes(std::span(mesh.positions)))};
  }

  // Two primitives over the same positions, seen from one side each and turned against each other,
  // are the two sides of one surface: the later one is the back of the instances of the earlier.
  bool is_back_of(const Sides& sides, const SideKey& key, const Loaded& loaded,
                  std::int32_t material) {
    std::vector<scene::Instance>& instances = out_.scene.instances;
    for (auto [it, end] = sides.equal_range(key); it != end; ++it) {
      const Side& side = it->second;
      if (instances[side.first].back != scene::kNone) continue;
      const auto& front =
          out_.scene.materials[static_cast<std::size_t>(instances[side.first].material)];
      if (!scene::same_holes(front, out_.scene.materials[static_cast<std::size_t>(material)]) ||
          !is_turned_round(*side.mesh, *loaded.mesh))
        continue;
      for (std::size_t i = 0; i < side.count; ++i) instances[side.first + i].back = material;
      return true;
    }
    return false;
  }

  // What a material loses on a mesh: vertex colours multiply the diffuse colour alone, and textures
  // repeat.
  void note_losses(const geometry::Mesh& mesh, std::int32_t material) {
    const auto index = static_cast<std::size_t>(material);
    const auto is_white = [](const Vec3& color) { return color == Vec3(1); };
    if (!mesh.colors.empty() && out_.materials[index].metallic > 0 &&
        !std::all_of(mesh.colors.begin(), mesh.colors.end(), is_white) &&
        coloured_metals_.insert(material).second)
      lost_["vertex colours on metal"].push_back(out_.materials[index].object);
    const bool u = repeats_[index][0];
    const bool v = repeats_[index][1];
    if (u && v) return;
    constexpr double kRounding = 1e-5;
    const auto leaves = [](double at) { return at < -kRounding || at > 1 + kRounding; };
    const auto is_lost = [&](const Vec2& at) {
      return (!u && leaves(at.x)) || (!v && leaves(at.y));
    };
    if (std::any_of(mesh.texcoords.begin(), mesh.texcoords.end(), is_lost) &&
        beyond_edges_.insert(material).second)
      lost_["textures that do not repeat"].push_back(out_.materials[index].object);
  }

  // A mesh that has joints waits for them without normals, and may stand somewhere without them.
  geometry::MeshShape with_normals(const geometry::MeshShape& mesh) const {
    if (!mesh->normals.empty()) return mesh;
    auto copy = std::make_shared<geometry::Mesh>(*mesh);
    geometry::compute_normals(*copy, d_.options.crease_angle);
    return copy;
  }

  static geometry::MeshShape shifted(geometry::MeshShape mesh, const Vec3& shift) {
    if (shift == Vec3(0)) return mesh;
    auto copy = std::make_shared<geometry::Mesh>(*mesh);
    for (Vec3& p : copy->positions) p += shift;
    return copy;
  }

  void add_instance(std::int32_t node, std::int32_t shape, std::int32_t material) {
    scene::Instance instance;
    instance.node = node;
    instance.shape = shape;
    instance.material = material;
    instance.source.file = d_.file.path;
    out_.scene.instances.push_back(std::move(instance));
  }

  void add_skinned(const Node& node, const Loaded& loaded, std::int32_t place,
                   std::int32_t material) {
    if (place < 0) return;
    ++skinned_;
    if (!skins_) skins_ = std::make_unique<SkinPoser>(d_, model_);
    const auto shape = static_cast<std::int32_t>(out_.scene.shapes.size());
    out_.scene.shapes.emplace_back(skins_->posed(node.skin, *loaded.mesh, loaded.skin));
    add_instance(place, shape, material);
  }

  // EXT_mesh_gpu_instancing: a node for each instance; else the node itself.
  std::vector<std::int32_t> instance_nodes(int index, const Node& node, std::int32_t placed) {
    const auto found = node.extensions.find("EXT_mesh_gpu_instancing");
    if (found == node.extensions.end()) return {placed};
    const tinygltf::Value& attributes = found->second.Get("attributes");
    const std::string object = pointer("nodes", static_cast<std::size_t>(index)) +
                               "/extensions/EXT_mesh_gpu_instancing/attributes/";
    const auto accessor = [&](const char* name) -> std::ptrdiff_t {
      return attributes.Has(name) ? attributes.Get(name).GetNumberAsInt() : -1;
    };
    std::uint64_t count = 0;
    bool agree = true;
    for (const std::string& name : attributes.Keys()) {
      const Accessor& a =
          d_.accessors[static_cast<std::size_t>(attributes.Get(name).GetNumberAsInt())];
      agree = agree && (count == 0 || a.count == count);
      count = a.count;
    }
    if (!agree || count > d_.options.limits.nodes) {
      d_.report(agree ? Code("E6002") : Code("E6211"), nullptr, object,
                fmt::format("{} instances", agree ? fmt::format("{}", count)
                                                  : std::string("different numbers of")));
      return {placed};
    }
    if (count == 0) return {placed};
    std::vector<Vec3> moves, scales;
    std::vector<Vec4> turns;
    if (const auto a = accessor("TRANSLATION"); a >= 0)
      moves = read_vectors<Vec3>(d_, static_cast<std::size_t>(a), object + "TRANSLATION");
    if (const auto a = accessor("SCALE"); a >= 0)
      scales = read_vectors<Vec3>(d_, static_cast<std::size_t>(a), object + "SCALE");
    if (const auto a = accessor("ROTATION"); a >= 0)
      turns = read_vectors<Vec4>(d_, static_cast<std::size_t>(a), object + "ROTATION");
    std::vector<std::int32_t> places;
    for (std::size_t i = 0; i < count && !full_; ++i) {
      scene::Transform t;
      if (i < moves.size()) t.translation = moves[i];
      if (i < scales.size()) t.scale = scales[i];
      if (i < turns.size() && glm::length(turns[i]) > 1e-12)
        t.rotation = glm::normalize(Quat(turns[i].w, turns[i].x, turns[i].y, turns[i].z));
      if (t.scale.x == 0 || t.scale.y == 0 || t.scale.z == 0) continue;
      const std::int32_t place = add(fmt::format("{}_{}", name_of(index), i), placed, t);
      if (place >= 0) places.push_back(place);
    }
    return places;
  }

  Loaded& load(int mesh, std::size_t p, const std::vector<double>& weights) {
    const Primitive& primitive = model_.meshes[static_cast<std::size_t>(mesh)].primitives[p];
    const TexcoordChoice texcoords = texcoords_of(model_, primitive.material);
    const auto [place, is_new] = loaded_.try_emplace(surface_key(primitive, weights, texcoords));
    Loaded& loaded = place->second;
    if (!is_new) return loaded;
    d_.file.job.poll();
    const std::string object = fmt::format("/meshes/{}/primitives/{}", mesh, p);
    const bool shared = position_users_.at(position_of(primitive)) > 1;
    Surface surface = surface_of(d_, primitive, shared, weights, texcoords, object);
    if (surface.skipped) {
      ++flat_;
      return loaded;
    }
    triangles_ += surface.mesh.triangles.size();
    if (triangles_ > d_.options.limits.triangles) {
      if (!full_)
        d_.report(Code("E6002"), nullptr, object,
                  fmt::format("more than {} triangles", d_.options.limits.triangles));
      full_ = true;
      return loaded;
    }
    if (surface.mesh.normals.empty() && !surface.mesh.triangles.empty() && surface.skin.sets == 0)
      geometry::compute_normals(surface.mesh, d_.options.crease_angle);
    loaded.has_texcoords = surface.has_texcoords;
    loaded.skin = std::move(surface.skin);
    loaded.mesh = std::make_shared<const geometry::Mesh>(std::move(surface.mesh));
    return loaded;
  }

  // Meshes that the scene does not use are looked at as well.
  void read_the_rest() {
    used_meshes_.resize(model_.meshes.size());
    for (std::size_t m = 0; m < model_.meshes.size() && !full_; ++m) {
      if (used_meshes_[m]) continue;
      ++unused_;
      for (std::size_t p = 0; p < model_.meshes[m].primitives.size() && !full_; ++p) {
        load(static_cast<int>(m), p, model_.meshes[m].weights).mesh.reset();
      }
    }
  }

  std::int32_t material_index(int material, bool with_textures) {
    const auto [place, is_new] = material_places_.try_emplace(
        {material, with_textures}, static_cast<std::int32_t>(out_.scene.materials.size()));
    if (!is_new) return place->second;
    BuiltMaterial built = material_of(model_, material, with_textures, texture_cache_);
    if (material >= 0) {
      built.cad.object = pointer("materials", static_cast<std::size_t>(material));
      built.cad.where = d_.place_of(built.cad.object);
    }
    for (const LostProperty& lost : built.cad.lost) lost_[lost.what].push_back(built.cad.object);
    if (built.coat_changed > worst_coat_.first) worst_coat_ = {built.coat_changed, built.cad.name};
    out_.scene.materials.push_back(std::move(built.material));
    out_.materials.push_back(std::move(built.cad));
    repeats_.push_back(built.repeats);
    invisible_.push_back(built.invisible);
    return place->second;
  }

  void say_what_is_left() {
    std::vector<std::string> skipped;
    const auto count = [&](std::size_t number, std::string_view noun) {
      if (number > 0) skipped.push_back(counted(number, noun));
    };
    if (const std::size_t idle = d_.root.list("animations").size() - posing_; idle > 0)
      skipped.push_back(counted(idle, "animation") +
                        (posing_ > 0 || d_.options.animation ? ""
                         : idle == 1 ? " that moves nothing at its first frame"
                                     : " that move nothing at their first frame"));
    count(d_.root.list("cameras").size(), "camera");
    if (const Json* all = d_.root.find("extensions"))
      if (const Json* lights = all->find("KHR_lights_punctual"))
        count(lights->list("lights").size(), "light");
    if (invisible_parts_ > 0)
      skipped.push_back(counted(invisible_parts_, "primitive") + " of alpha 0");
    if (flat_ > 0) skipped.push_back(counted(flat_, "primitive") + " of points or lines");
    count(other_scenes_, "other scene");
    if (!skipped.empty())
      d_.report(Code("N6007"), nullptr, "", fmt::format("{} left out", fmt::join(skipped, ", ")));
    if (skinned_ + morphed_ > 0)
      d_.report(Code("N6214"), nullptr, "",
                fmt::format("{} and {} are at rest", counted(skinned_, "skinned surface"),
                            counted(morphed_, "morphed shape")));
    std::vector<std::string> lost;
    std::string first;
    for (const auto& [what, materials] : lost_) {
      std::string text = what;
      if (what == "clearcoat" && worst_coat_.first > 0)
        text += fmt::format(", which changes {:.2g} % of the light of {}", 100 * worst_coat_.first,
                            in_quotes(worst_coat_.second));
      if (materials.size() > 1) text += fmt::format(" ({} materials)", materials.size());
      if (first.empty()) first = materials[0];
      if (materials[0] != first) text += " at " + materials[0];
      lost.push_back(std::move(text));
    }
    if (!lost.empty())
      d_.report(Code("W6008"), nullptr, first,
                fmt::format("unsupported material properties ignored: {}", fmt::join(lost, ", ")));
  }

  Document& d_;
  const tinygltf::Model& model_;
  std::size_t posing_;  // animations that nodes stand by
  Imported out_;
  TextureReader texture_cache_;
  std::vector<Visit> todo_;
  std::map<int, std::int32_t> scene_nodes_;    // by glTF's number
  std::map<int, Quat> axes_;                   // the same, of NodeKind::axis
  std::map<int, std::size_t> position_users_;  // primitives, by accessor
  std::map<std::string, Loaded> loaded_;
  std::map<std::pair<int, bool>, std::int32_t> material_places_;
  std::map<std::string, std::vector<std::string>> lost_;  // materials, by property
  std::pair<double, std::string> worst_coat_;  // share of the light that is lost, and its material
  std::set<std::int32_t> coloured_metals_;
  std::set<std::int32_t> beyond_edges_;  // of textures that do not repeat
  std::vector<char> invisible_;          // BuiltMaterial's, of each material
  std::size_t invisible_parts_ = 0;
  std::vector<std::array<bool, 2>> repeats_;  // BuiltMaterial's, of each material
  std::unique_ptr<SkinPoser> skins_;
  std::vector<bool> used_meshes_;
  std::uint64_t triangles_ = 0;
  std::size_t flat_ = 0, other_scenes_ = 0, skinned_ = 0, morphed_ = 0, unused_ = 0;
  bool full_ = false;
};

}  // namespace

Result<Imported> scene_of(Document& document, const tinygltf::Model& model, std::size_t posing) {
  return SceneBuilder(document, model, posing).build();
}

}  // namespace panwright::importers::gltf
