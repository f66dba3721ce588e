// Face sets of VRML 1.0, their bindings and materials.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "importers/vrml/internal/scene10.h"

namespace panwright::importers::vrml {

namespace {

constexpr std::size_t kMostParts = 256;  // of one face set, by material

using Index = std::vector<std::int32_t>;

// An index list as written; empty where it is the default.
std::span<const std::int32_t> written(const Node& node, std::string_view field) {
  const Field* found = node.find(field);
  if (found == nullptr) return {};
  const auto list = found->value.integers();
  return list.size() == 1 && list[0] == -1 ? std::span<const std::int32_t>() : list;
}

std::size_t face_count(std::span<const std::int32_t> coord_index) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < coord_index.size(); ++i)
    count += coord_index[i] < 0 || i + 1 == coord_index.size();
  return count;
}

// Items in the order of the corners.
Index counted_corners(std::span<const std::int32_t> coord_index) {
  Index index;
  index.reserve(coord_index.size());
  std::int32_t next = 0;
  for (const std::int32_t i : coord_index) index.push_back(i < 0 ? -1 : next++);
  return index;
}

Index counted_faces(std::span<const std::int32_t> coord_index) {
  Index index(face_count(coord_index));
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<std::int32_t>(i);
  return index;
}

Bound10 bound(Binding binding, std::span<const std::int32_t> given,
              std::span<const std::int32_t> coord_index) {
  Bound10 out;
  switch (binding) {
    case Binding::standard:
    case Binding::vertex_indexed:
      out.per_vertex = true;
      out.index = given;
      return out;
    case Binding::vertex:
      out.per_vertex = true;
      out.owned = counted_corners(coord_index);
      break;
    case Binding::face_indexed:
      if (!given.empty()) {
        out.index = given;
        return out;
      }
      [[fallthrough]];
    case Binding::face:
      out.owned = counted_faces(coord_index);
      break;
    case Binding::overall:
      out.owned.assign(face_count(coord_index), 0);
      break;
  }
  out.index = out.owned;
  return out;
}

// Items as faces use them, each once.
Index in_order_of_use(const Index& items, std::size_t count) {
  Index used;
  std::vector<bool> seen(count, false);
  for (const std::int32_t i : items) {
    if (i < 0 || seen[static_cast<std::size_t>(i)]) continue;
    seen[static_cast<std::size_t>(i)] = true;
    used.push_back(i);
  }
  return used;
}

// The faces of a list for which keep(face) holds. per_face: one item for each face.
template <class Keep>
Index filtered(std::span<const std::int32_t> list, std::span<const std::int32_t> coord_index,
               bool per_face, const Keep& keep) {
  Index out;
  std::size_t face = 0;
  for (std::size_t i = 0; i < coord_index.size(); ++i) {
    const bool last = coord_index[i] < 0 || i + 1 == coord_index.size();
    if (keep(face) && !per_face && i < list.size()) out.push_back(list[i]);
    if (last && keep(face) && per_face && face < list.size()) out.push_back(list[face]);
    face += last;
  }
  return out;
}

}  // namespace

// ---- materials

Materials10::Materials10(const Node* material) : node_(material) {
  if (node_ == nullptr) return;
  diffuse_ = list("diffuseColor");
  specular_ = list("specularColor");
  emissive_ = list("emissiveColor");
  shininess_ = list("shininess");
  transparency_ = list("transparency");
  if (diffuse_.empty() && !emissive_.empty()) {
    // light that was computed before: what is left to show is its colour
    std::swap(diffuse_, emissive_);
    lit_ = false;
  }
  others_ = std::max({specular_.size() / 3, emissive_.size() / 3, shininess_.size(),
                      transparency_.size(), std::size_t{1}});
  size_ = std::max(others_, diffuse_.size() / 3);
}

std::span<const double> Materials10::list(std::string_view field) const {
  return node_->numbers(field);
}

Phong Materials10::at(std::size_t item) const {
  Phong phong;
  if (node_ == nullptr) return phong;
  const std::size_t wanted = item % size_;
  const auto color = [&](std::span<const double> list, Vec3& out) {
    if (list.size() < 3) return;
    const std::size_t i = 3 * std::min(wanted, list.size() / 3 - 1);
    out = Vec3(list[i], list[i + 1], list[i + 2]);
  };
  const auto number = [&](std::span<const double> list, double& out) {
    if (!list.empty()) out = list[std::min(wanted, list.size() - 1)];
  };
  color(diffuse_, phong.diffuse);
  color(specular_, phong.specular);
  color(emissive_, phong.emissive);
  number(shininess_, phong.shininess);
  number(transparency_, phong.transparency);
  return phong;
}

std::vector<double> Materials10::diffuse_colors() const {
  std::vector<double> colors;
  for (std::size_t i = 0; i < size_; ++i) {
    const Vec3 c = at(i).diffuse;
    colors.insert(colors.end(), {c.x, c.y, c.z});
  }
  return colors;
}

std::string_view Materials10::name() const {
  return node_ == nullptr ? std::string_view() : node_->name;
}

// ---- face sets

std::int32_t Scene10::texture_index() {
  if (state_.texture == nullptr) return scene::kNone;
  const Node& node = *state_.texture;
  if (const Field* name = node.find("filename");
      name != nullptr && !node.string("filename").empty())
    return builder_.add_texture(name->value.strings(), name->where);
  const auto known = images_.find(&node);
  if (known != images_.end()) return known->second;
  const Field* image = node.find("image");
  const std::int32_t index =
      image == nullptr ? scene::kNone : builder_.add_image(image->value.integers(), image->where);
  return images_[&node] = index;
}

void Scene10::report(const Node& node, const ListProblems& problems) {
  for (const ListProblem& problem : problems) {
    const Node* holder = &node;
    std::string_view field;
    switch (problem.list) {
      case List::coord_index:
        field = "coordIndex";
        break;
      case List::normal_index:
        field = "normalIndex";
        break;
      case List::color_index:
        field = "materialIndex";
        break;
      case List::texcoord_index:
        field = "textureCoordIndex";
        break;
      case List::points:
        holder = state_.coordinates;
        field = "point";
        break;
      case List::normals:
        holder = state_.normals;
        field = "vector";
        break;
      case List::texcoords:
        holder = state_.texcoords;
        field = "point";
        break;
      case List::colors:
        holder = state_.material;
        field = "diffuseColor";
        break;
      default:
        break;
    }
    const Field* at = holder == nullptr || field.empty() ? nullptr : holder->find(field);
    SourceSpan where = node.where;
    if (at != nullptr) {
      const std::size_t width = std::max<std::size_t>(1, width_of(at->value.type));
      where = place_of_item(builder_.context.log.sources(), *at, width * problem.item);
    }
    builder_.context.log.report(problem.code, where, problem.message);
  }
}

void Scene10::face_set(Node& node) {
  const Field* coord_index = node.find("coordIndex");
  if (coord_index == nullptr || coord_index->value.integers().empty()) return;
  if (state_.coordinates == nullptr) {
    builder_.context.log.report(Code("W6009"), node.where, "no Coordinate3 before it");
    return;
  }
  Faces10 faces;
  faces.points = state_.coordinates->numbers("point");
  faces.coord_index = coord_index->value.integers();
  faces.material_index = written(node, "materialIndex");
  faces.normal_index = written(node, "normalIndex");
  faces.texcoord_index = written(node, "textureCoordIndex");
  faces.own_texcoords = !faces.texcoord_index.empty();
  if (state_.texcoords != nullptr) faces.texcoords = state_.texcoords->numbers("point");
  add_faces(node, faces);
}

void Scene10::add_faces(Node& node, const Faces10& faces) {
  const std::int32_t place = place_of(node, Mat4(1));
  if (place == scene::kNone) return;
  const std::int32_t texture = texture_index();
  const bool textured = texture != scene::kNone;
  const Materials10 materials(state_.material);
  const bool one = state_.material_binding == Binding::standard ||
                   state_.material_binding == Binding::overall || materials.size() == 1;
  const Mat3& t = state_.texture_transform;
  const Use use{
      {&node, state_.coordinates, state_.normals, state_.texcoords, one ? nullptr : state_.material,
       textured ? state_.texture : nullptr, state_.hints},
      {one ? Binding::overall : state_.material_binding, state_.normal_binding},
      {t[0][0], t[0][1], t[1][0], t[1][1], t[2][0], t[2][1]}};
  auto known = parts_.find(use);
  if (known == parts_.end()) known = parts_.emplace(use, parts_of(node, faces)).first;
  for (const Part& part : known->second) {
    const std::int32_t material =
        one && !part.colored
            ? builder_.add_phong(materials.at(0), materials.name(), textured, materials.where(node))
            : part.material;
    builder_.add_instance(place, part.shape, material, texture, node.where);
  }
}

FaceSet Scene10::set_of(Node& node, const Faces10& faces, const Bound10& normals) {
  FaceSet set;
  set.points = faces.points;
  set.coord_index = faces.coord_index;
  if (state_.normals != nullptr) set.normals = state_.normals->numbers("vector");
  set.normal_index = normals.index;
  set.normal_per_vertex = normals.per_vertex;
  const auto needed =
      normals.owned.empty() ? 0 : 1 + static_cast<std::size_t>(std::ranges::max(normals.owned));
  if (!set.normals.empty() && set.normals.size() < 3 * needed) {
    const auto has = set.normals.size() / 3;
    report(node, {{Code("W6114"), List::normals, has - 1,
                   fmt::format("the list has {} items where the NormalBinding needs {}, and is not "
                               "used",
                               has, needed)}});
    set.normals = {};
  }
  set.texcoords = faces.texcoords;
  set.texcoord_index = faces.texcoord_index;
  if (state_.hints != nullptr) {
    set.ccw = state_.hints->strings("vertexOrdering")[0] != "CLOCKWISE";
    if (state_.hints->find("creaseAngle") != nullptr)
      set.crease_angle = state_.hints->number("creaseAngle");
  }
  return set;
}

void Scene10::add_part(Node& node, const Faces10& faces, const FaceSet& set, Phong phong, bool once,
                       std::vector<Part>& parts) {
  const bool textured = texture_index() != scene::kNone;
  const Limits& limits = builder_.context.options.limits;
  FaceOptions options{builder_.context.options.crease_angle, limits.triangles, limits.memory,
                      textured};
  if (once && builder_.once) {
    const bool points = coordinates_are_served();
    options.served = [this, &node, points](List list) {
      if (list == List::coord_index) builder_.context.release(node, "coordIndex");
      if (list == List::points && points) builder_.context.release(*state_.coordinates, "point");
    };
  }
  ListProblems problems;
  geometry::Mesh mesh = mesh_of(set, options, problems);
  // normals and texcoords that were left by nodes before, and do not fit, were not meant
  std::erase_if(problems, [&](const ListProblem& p) {
    return (p.list == List::normals && state_.normal_binding == Binding::standard) ||
           (p.list == List::texcoords && !faces.own_texcoords && !textured);
  });
  report(node, problems);
  for (const ListProblem& problem : problems)
    if (problem.code == Code("E6002")) throw OverLimit{};
  if (mesh.triangles.empty()) return;
  builder_.triangles_made += mesh.triangles.size();
  if (builder_.triangles_made > options.max_triangles) throw OverLimit{"triangles", node.where};
  if (state_.texture_transform != Mat3(1)) {
    for (Vec2& at : mesh.texcoords) {
      const Vec2 moved(state_.texture_transform * Vec3(at, 1));
      if (is_finite(Vec3(moved, 0))) at = moved;
    }
  }
  // colours multiply the diffuse colour
  const bool colored = !mesh.colors.empty();
  if (colored) phong.diffuse = Vec3(1);
  const auto shape = std::make_shared<const geometry::Mesh>(std::move(mesh));
  const std::int32_t index = builder_.add_shape(shape, node.where);
  if (textured)
    builder_.lost_clamping(index, state_.texture->strings("wrapS")[0] != "CLAMP",
                           state_.texture->strings("wrapT")[0] != "CLAMP", state_.texture->where);
  const Materials10 materials(state_.material);
  parts.push_back({index,
                   builder_.add_phong(phong, materials.name(), textured, materials.where(node)),
                   colored});
}

std::vector<Scene10::Part> Scene10::parts_of(Node& node, const Faces10& faces) {
  const Materials10 materials(state_.material);
  if (!materials.lit()) builder_.lost("light that is part of colours", materials.where(node));
  const Bound10 normals = bound(state_.normal_binding, faces.normal_index, faces.coord_index);
  FaceSet set = set_of(node, faces, normals);
  std::vector<Part> parts;

  const Binding binding = state_.material_binding;
  if (binding == Binding::standard || binding == Binding::overall || materials.size() == 1) {
    add_part(node, faces, set, materials.at(0), true, parts);
    return parts;
  }
  const Bound10 bound_to = bound(binding, faces.material_index, faces.coord_index);
  Index items(bound_to.index.begin(), bound_to.index.end());
  if (items.empty()) items.assign(faces.coord_index.begin(), faces.coord_index.end());
  for (std::int32_t& i : items)
    if (i >= 0) i = static_cast<std::int32_t>(static_cast<std::size_t>(i) % materials.size());

  Index used;
  if (!materials.only_diffuse_varies() && !bound_to.per_vertex)
    used = in_order_of_use(items, materials.size());
  if (used.empty() || used.size() > kMostParts) {
    if (!materials.only_diffuse_varies())
      builder_.lost("materials that vary over one shape", node.where);
    const std::vector<double> colors = materials.diffuse_colors();
    set.colors = colors;
    set.color_index = items;
    set.color_per_vertex = bound_to.per_vertex;
    add_part(node, faces, set, materials.at(0), true, parts);
    return parts;
  }
  for (const std::int32_t item : used) {
    const auto keep = [&](std::size_t face) { return face < items.size() && items[face] == item; };
    const auto& corners = faces.coord_index;
    const Index coord_index = filtered(corners, corners, false, keep);
    const Index normal_index = filtered(set.normal_index, corners, !set.normal_per_vertex, keep);
    const Index texcoord_index = filtered(set.texcoord_index, corners, false, keep);
    FaceSet some = set;
    some.coord_index = coord_index;
    some.normal_index = normal_index;
    some.texcoord_index = texcoord_index;
    add_part(node, faces, some, materials.at(static_cast<std::size_t>(item)), false, parts);
  }
  return parts;
}

}  // namespace panwright::importers::vrml
