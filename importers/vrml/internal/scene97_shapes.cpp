#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "importers/vrml/internal/scene97.h"

namespace panwright::importers::vrml {

namespace {

// TextureTransform: Tc' = −C·S·R·C·T·Tc (6.49).
void transform_texcoords(const Node& node, geometry::Mesh& mesh) {
  const Vec2 centre = node.vec2("center");
  const Vec2 scale = node.vec2("scale");
  const Vec2 translation = node.vec2("translation");
  const det::SinCos turn = det::sincos(node.number("rotation"));
  for (Vec2& tc : mesh.texcoords) {
    const Vec2 at = tc + translation + centre;
    const Vec2 turned(turn.cos * at.x - turn.sin * at.y, turn.sin * at.x + turn.cos * at.y);
    const Vec2 out = scale * turned - centre;
    if (std::isfinite(out.x) && std::isfinite(out.y)) tc = out;
  }
}

struct Place {
  List list;
  std::string_view member;  // node of a node; empty: the node itself
  std::string_view field;
};

constexpr Place kPlaces[] = {
    {List::points, "coord", "point"},
    {List::coord_index, "", "coordIndex"},
    {List::normals, "normal", "vector"},
    {List::normal_index, "", "normalIndex"},
    {List::colors, "color", "color"},
    {List::color_index, "", "colorIndex"},
    {List::texcoords, "texCoord", "point"},
    {List::texcoord_index, "", "texCoordIndex"},
    {List::heights, "", "height"},
    {List::spine, "", "spine"},
    {List::cross_section, "", "crossSection"},
    {List::scales, "", "scale"},
    {List::orientations, "", "orientation"},
};

constexpr std::pair<std::string_view, std::span<const std::int32_t> FaceSet::*> kIndices[] = {
    {"coordIndex", &FaceSet::coord_index},
    {"normalIndex", &FaceSet::normal_index},
    {"colorIndex", &FaceSet::color_index},
    {"texCoordIndex", &FaceSet::texcoord_index}};
constexpr std::pair<std::string_view, bool FaceSet::*> kFlags[] = {
    {"normalPerVertex", &FaceSet::normal_per_vertex},
    {"colorPerVertex", &FaceSet::color_per_vertex},
    {"ccw", &FaceSet::ccw},
    {"convex", &FaceSet::convex}};

bool is_geometry(const Node& node) {
  constexpr std::string_view kTypes[] = {"Box",           "Cone",           "Cylinder", "Extrusion",
                                         "ElevationGrid", "IndexedFaceSet", "Sphere"};
  return node.spec != nullptr && std::ranges::find(kTypes, node.spec->name) != std::end(kTypes);
}

std::optional<double> crease_of(const Node& node) {
  if (node.find("creaseAngle") == nullptr) return std::nullopt;
  return node.number("creaseAngle");
}

}  // namespace

// ---- shapes

std::int32_t Scene97::add_shape(const Node& node, std::string_view name, std::int32_t parent) {
  Node* written = node.node("geometry");
  for (Node* child : node.children) {
    // reported by the parser: the word before it is missing
    if (written == nullptr && is_geometry(*child))
      written = child;
    else
      add(child, parent);
  }
  Node* geometry = context_.actual(written);
  if (geometry == nullptr || geometry->spec == nullptr) return scene::kNone;
  const std::string_view type = geometry->spec->name;
  if (type == "IndexedLineSet" || type == "PointSet" || type == "Text") {
    builder_.skipped(type);
    return scene::kNone;
  }
  Look look = look_of(node);
  look.once = node.owner == nullptr && written == geometry && !geometry->again &&
              geometry->owner == nullptr;
  look.own = node.owner == nullptr && node.node("appearance") == look.appearance &&
             (look.appearance == nullptr ||
              (!look.appearance->again && look.appearance->owner == nullptr));
  std::int32_t made = scene::kNone;
  if (add_primitive(*geometry, look, parent, name, &made)) return made;
  if (type != "IndexedFaceSet" && type != "ElevationGrid" && type != "Extrusion") {
    context_.log.report(Code("W6115"), geometry->where,
                        fmt::format("{} is not a geometry", in_quotes(geometry->type)));
    return scene::kNone;
  }
  bool colored = false;
  const std::int32_t shape = mesh_shape(*geometry, look, &colored);
  if (shape == scene::kNone) return scene::kNone;
  if (look.texture != scene::kNone && !(look.repeat_s && look.repeat_t))
    builder_.lost_clamping(shape, look.repeat_s, look.repeat_t, node.where);
  made = builder_.add_node(parent, Mat4(1), name, "Shape", node.where);
  builder_.add_instance(made, shape, material_of(look, colored), look.texture, node.where);
  return made;
}

bool Scene97::sound(const geometry::Shape& shape, const Node& geometry) {
  const auto problem = geometry::problem_of(shape);
  if (!problem) return true;
  context_.log.report(Code("W6009"), geometry.where,
                      fmt::format("the {} is left out: {}", geometry.type, problem->message));
  return false;
}

std::int32_t Scene97::place(const Primitive& primitive, const Look& look, std::int32_t parent,
                            std::string_view name, const Node& geometry) {
  const geometry::Shape& shape = primitive.shape;
  if (!sound(shape, geometry)) return scene::kNone;
  const std::int32_t made =
      builder_.add_node(parent, primitive.theirs_from_shape, name, "Shape", geometry.where);
  if (look.transform != nullptr && look.texture != scene::kNone)
    builder_.lost("texture transforms on primitives", look.transform->where);
  builder_.add_instance(made, builder_.add_shape(shape, geometry.where), material_of(look, false),
                        look.texture, geometry.where);
  return made;
}

// Whether the geometry is a primitive: it is added then, unless there is nothing of it.
bool Scene97::add_primitive(const Node& geometry, const Look& look, std::int32_t parent,
                            std::string_view name, std::int32_t* made) {
  const std::string_view type = geometry.spec->name;
  const std::uint32_t segments = context_.options.primitives;
  if (type == "Box") {
    const Vec3 size = geometry.vec3("size");
    const auto sheet = sheet_of(size);
    if (sheet)
      context_.log.report(Code("W6009"), geometry.where,
                          "the Box has a side of 0 m; it is a sheet, visible from both sides");
    *made = place(sheet ? *sheet : box_of(size, look.texture != scene::kNone), look, parent, name,
                  geometry);
    return true;
  }
  if (type == "Sphere") {
    *made = place(sphere_of(geometry.number("radius"), segments), look, parent, name, geometry);
    return true;
  }
  return add_round(geometry, look, parent, name, made);
}

// Cylinders and cones, whose parts can be switched off.
bool Scene97::add_round(const Node& geometry, const Look& look, std::int32_t parent,
                        std::string_view name, std::int32_t* made) {
  const std::string_view type = geometry.spec->name;
  const bool cone = type == "Cone";
  if (!cone && type != "Cylinder") return false;
  const double radius = geometry.number(cone ? "bottomRadius" : "radius");
  const double height = geometry.number("height");
  const bool side = geometry.flag("side");
  const bool bottom = geometry.flag("bottom");
  const bool top = !cone && geometry.flag("top");
  const std::uint32_t segments = context_.options.primitives;
  if (side) {
    const geometry::Caps caps = bottom && (top || cone) ? geometry::Caps::both
                                : bottom                ? geometry::Caps::bottom
                                : top                   ? geometry::Caps::top
                                                        : geometry::Caps::none;
    *made = place(cone ? cone_of(radius, height, caps, segments)
                       : cylinder_of(radius, height, caps, segments),
                  look, parent, name, geometry);
    return true;
  }
  if (top) *made = place(disc_of(radius, height / 2, true, segments), look, parent, name, geometry);
  if (bottom)
    *made = place(disc_of(radius, -height / 2, false, segments), look, parent, name, geometry);
  return true;
}

// ---- meshes

std::span<const double> Scene97::list_of(const Node& node, std::string_view member,
                                         std::string_view field) {
  const Field* const written = node.find(member);
  if (written == nullptr || written->value.nodes().empty()) return {};
  const Node* list = context_.actual(written->value.nodes()[0]);
  if (list == nullptr || list->spec == nullptr || list->spec->find(field) == nullptr) return {};
  return list->numbers(field);
}

FaceOptions Scene97::face_options(const Look& look) const {
  const Limits& limits = context_.options.limits;
  return {context_.options.crease_angle, limits.triangles,
          limits.memory - std::min(limits.memory, context_.memory_used),
          look.texture != scene::kNone};
}

geometry::Mesh Scene97::face_set(Node& node, const Look& look, ListProblems& problems) {
  FaceSet faces;
  faces.points = list_of(node, "coord", "point");
  faces.normals = list_of(node, "normal", "vector");
  const bool replaced = look.texture != scene::kNone && !look.grey;
  if (!replaced) faces.colors = list_of(node, "color", "color");
  faces.texcoords = list_of(node, "texCoord", "point");
  // what is not written is as FaceSet has it: small parts are many, and mostly write two fields
  for (const Field& field : node.fields) {
    for (const auto& [name, list] : kIndices)
      if (field.name == name) faces.*list = field.value.integers();
    for (const auto& [name, flag] : kFlags)
      if (field.name == name) faces.*flag = field.value.integers()[0] != 0;
  }
  faces.crease_angle = crease_of(node);
  FaceOptions options = face_options(look);
  if (look.once) options.served = [&](List list) { release(node, list); };
  return mesh_of(faces, options, problems);
}

// A list of a face set that is not asked for again.
void Scene97::release(Node& geometry, List list) {
  if (list == List::coord_index) return context_.release(geometry, "coordIndex");
  Node* coord = geometry.node("coord");
  const bool own = coord != nullptr && !coord->again && coord->owner == nullptr;
  if (own && coord->prototype == nullptr) context_.release(*coord, "point");
}

geometry::Mesh Scene97::elevation_grid(const Node& node, const Look& look, ListProblems& problems) {
  ElevationGrid grid;
  grid.x_dimension = node.integer("xDimension");
  grid.z_dimension = node.integer("zDimension");
  grid.x_spacing = node.number("xSpacing");
  grid.z_spacing = node.number("zSpacing");
  grid.heights = node.numbers("height");
  grid.normals = list_of(node, "normal", "vector");
  grid.normal_per_vertex = node.flag("normalPerVertex");
  const bool replaced = look.texture != scene::kNone && !look.grey;
  if (!replaced) grid.colors = list_of(node, "color", "color");
  grid.color_per_vertex = node.flag("colorPerVertex");
  grid.texcoords = list_of(node, "texCoord", "point");
  grid.ccw = node.flag("ccw");
  grid.crease_angle = crease_of(node);
  return mesh_of(grid, face_options(look), problems);
}

geometry::Mesh Scene97::extrusion(const Node& node, const Look& look, ListProblems& problems) {
  Extrusion shape;
  shape.cross_section = node.numbers("crossSection");
  shape.spine = node.numbers("spine");
  shape.scales = node.numbers("scale");
  shape.orientations = node.numbers("orientation");
  shape.begin_cap = node.flag("beginCap");
  shape.end_cap = node.flag("endCap");
  shape.ccw = node.flag("ccw");
  shape.convex = node.flag("convex");
  shape.crease_angle = crease_of(node);
  return mesh_of(shape, face_options(look), problems);
}

void Scene97::report(const ListProblems& problems, const Node& node) {
  for (const ListProblem& problem : problems) {
    SourceSpan where = node.where;
    for (const Place& place : kPlaces) {
      // grids and extrusions make points and faces of their own
      if (place.list != problem.list ||
          (!place.member.empty() && node.spec->find(place.member) == nullptr))
        continue;
      const Node* holder = place.member.empty() ? &node : context_.actual(node.node(place.member));
      const Field* field = holder != nullptr ? holder->find(place.field) : nullptr;
      if (field != nullptr) where = place_of_item(context_.log.sources(), *field, problem.item);
    }
    context_.log.report(problem.code, where, problem.message);
  }
}

std::int32_t Scene97::mesh_shape(Node& geometry, const Look& look, bool* colored) {
  Cache97::Meshed meshed;
  if (builder_.once && look.once) {
    meshed = make_mesh(geometry, look);
  } else {
    const bool textured = look.texture != scene::kNone;
    const auto [it, added] =
        cache_.meshes.try_emplace({&geometry, textured ? look.transform : nullptr,
                                   (textured ? 1 : 0) + (textured && !look.grey ? 2 : 0)});
    if (added) it->second = make_mesh(geometry, look);
    meshed = it->second;
  }
  *colored = meshed.colored;
  return meshed.shape;
}

Cache97::Meshed Scene97::make_mesh(Node& geometry, const Look& look) {
  Cache97::Meshed meshed;
  ListProblems problems;
  const std::string_view type = geometry.spec->name;
  geometry::Mesh mesh = type == "IndexedFaceSet"  ? face_set(geometry, look, problems)
                        : type == "ElevationGrid" ? elevation_grid(geometry, look, problems)
                                                  : extrusion(geometry, look, problems);
  report(problems, geometry);
  for (const ListProblem& problem : problems)
    if (problem.code == Code("E6002")) throw OverLimit{};
  if (mesh.triangles.empty()) {
    context_.log.report(Code("W6009"), geometry.where,
                        fmt::format("this {} has no faces", geometry.type));
    return meshed;
  }
  if (look.texture != scene::kNone) {
    if (!builder_.once || !look.once) count_made(geometry, mesh.triangles.size());
    if (look.transform != nullptr) transform_texcoords(*look.transform, mesh);
  }
  meshed.colored = !mesh.colors.empty();
  meshed.shape =
      builder_.add_shape(std::make_shared<const geometry::Mesh>(std::move(mesh)), geometry.where);
  return meshed;
}

// Equal meshes are one in the scene, but making them again and again takes time, too.
void Scene97::count_made(const Node& geometry, std::uint64_t triangles) {
  if (cache_.textured.insert(&geometry).second) return;
  cache_.made_again += triangles;
  if (cache_.made_again > context_.options.limits.triangles)
    throw OverLimit{"triangles", geometry.where};
}

// ---- looks

Scene97::Look Scene97::look_of(const Node& shape) {
  Look look;
  const Node* written = shape.node("appearance");
  look.appearance = context_.actual(shape.node("appearance"));
  if (look.appearance == nullptr || look.appearance->spec == nullptr ||
      look.appearance->spec->name != "Appearance") {
    look.appearance = nullptr;
    return look;
  }
  const Node* material = look.appearance->node("material");
  look.material = context_.actual(look.appearance->node("material"));
  if (look.material != nullptr &&
      (look.material->spec == nullptr || look.material->spec->name != "Material"))
    look.material = nullptr;
  for (const Node* named : {material, look.material, written, look.appearance})
    if (named != nullptr && look.name.empty()) look.name = named->name;
  const Node* transform = context_.actual(look.appearance->node("textureTransform"));
  if (transform != nullptr && transform->spec != nullptr &&
      transform->spec->name == "TextureTransform")
    look.transform = transform;
  const Node* texture = context_.actual(look.appearance->node("texture"));
  if (texture == nullptr || texture->spec == nullptr) return look;
  const std::string_view type = texture->spec->name;
  if (type != "ImageTexture" && type != "PixelTexture" && type != "MovieTexture") return look;
  if (type == "ImageTexture") {
    if (const Field* urls = texture->find("url"))
      look.texture = builder_.add_texture(urls->value.strings(), urls->where);
  } else if (type == "PixelTexture") {
    if (const Field* image = texture->find("image")) {
      const auto [it, added] = cache_.pixels.try_emplace(texture, scene::kNone);
      if (added) it->second = builder_.add_image(image->value.integers(), image->where);
      look.texture = it->second;
    }
  } else {
    builder_.skipped(type);
  }
  look.grey = builder_.is_grey(look.texture);
  look.repeat_s = texture->flag("repeatS");
  look.repeat_t = texture->flag("repeatT");
  return look;
}

std::int32_t Scene97::material_of(const Look& look, bool colored) {
  const bool textured = look.texture != scene::kNone;
  const bool replaced = colored || (textured && !look.grey);
  if (builder_.once && look.own && look.appearance != nullptr)
    return make_material(look, textured, replaced);
  const auto [it, added] = cache_.materials.try_emplace(
      {look.appearance, nullptr, (textured ? 1 : 0) + (replaced ? 2 : 0)}, 0);
  if (added) it->second = make_material(look, textured, replaced);
  return it->second;
}

std::int32_t Scene97::make_material(const Look& look, bool textured, bool replaced) {
  Phong phong;
  if (const Node* material = look.material) {
    phong.diffuse = material->vec3("diffuseColor");
    phong.specular = material->vec3("specularColor");
    phong.emissive = material->vec3("emissiveColor");
    phong.shininess = material->number("shininess");
    phong.transparency = material->number("transparency");
  }
  // a texture in colour and colours of the mesh replace the diffuse colour (4.14.4)
  if (replaced) phong.diffuse = Vec3(1);
  const Node* const from = look.material != nullptr ? look.material : look.appearance;
  return builder_.add_phong(phong, look.name, textured,
                            from != nullptr ? from->where : SourceSpan());
}

}  // namespace panwright::importers::vrml
