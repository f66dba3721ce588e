#include "pxn/reader/cell_grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "base/text.h"
#include "geometry/mesh/flat_faces.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/reader/metric.h"

namespace panwright::pxn {

namespace {

// node names in a message
constexpr std::size_t kMostNodeNames = 6;
// of all meshes made for cells: instances of one mesh may each have a scale of their own
constexpr std::size_t kMostTriangles = std::size_t{1} << 24;

// A shape as triangles, with texture coordinates: exact where it is flat, else to a thousandth of
// its size, as its area is all that is asked for. Null where it cannot be made.
geometry::MeshShape grid_mesh_of(const geometry::Shape& shape) {
  double size = 1e300;
  geometry::MeshShape out;
  for (const double part : {1.0, 1e-3}) {
    DiagnosticLog ignored;
    auto made =
        geometry::tessellated(shape, {.max_error = part * size, .texcoords = true}, {}, ignored);
    if (!made) return nullptr;
    AxisBox box;
    for (const Vec3& p : made->positions) box.add(p);
    size = box.diagonal();
    out = std::make_shared<const geometry::Mesh>(std::move(*made));
  }
  return out;
}

// The chosen triangles of a mesh. Vertices are copied for each face that uses them, with
// coordinates in metres where the face has some and they are wanted.
geometry::Mesh grid_part_of(const geometry::Mesh& mesh, const std::vector<Vec3>& metres,
                            const geometry::FlatFaces& found, bool with_cells, bool in_metres) {
  using geometry::kNoFace;
  geometry::Mesh out;
  out.error = mesh.error;
  struct Corner {
    std::uint32_t face, vertex, triangle, corner;
  };
  std::vector<Corner> corners;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t face = found.face_of[t];
    const bool laid = face != kNoFace && found.faces[face].layout != geometry::FaceLayout::none;
    if (laid != with_cells) continue;
    const std::uint32_t copy = with_cells && in_metres ? face : 0;
    for (std::uint32_t k = 0; k < 3; ++k)
      corners.push_back(
          {copy, mesh.triangles[t][k], static_cast<std::uint32_t>(corners.size() / 3), k});
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::array{a.face, a.vertex, a.triangle} < std::array{b.face, b.vertex, b.triangle};
  });
  out.triangles.resize(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& c = corners[i];
    if (i == 0 || c.face != corners[i - 1].face || c.vertex != corners[i - 1].vertex) {
      out.positions.push_back(mesh.positions[c.vertex]);
      if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[c.vertex]);
      if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[c.vertex]);
      if (with_cells && in_metres) {
        const geometry::FlatFace& face = found.faces[c.face];
        const Vec3& p = metres[c.vertex];
        out.texcoords.push_back(Vec2(glm::dot(face.u, p), glm::dot(face.v, p)) + face.origin);
      } else if (!mesh.texcoords.empty()) {
        out.texcoords.push_back(mesh.texcoords[c.vertex]);
      }
    }
    out.triangles[c.triangle][c.corner] = static_cast<std::uint32_t>(out.positions.size() - 1);
  }
  // seams of coordinates open no mesh
  out.closed = mesh.closed && out.triangles.size() == mesh.triangles.size();
  return out;
}

std::string faces(std::size_t count, double area) {
  return fmt::format("{} ({:.3g} m2)", counted(count, "imported face"), area);
}

}  // namespace

void CellGrids::append(scene::Instance instance, const Mat4& world_from_node) {
  const auto of_side = [&](std::int32_t material) {
    if (material == scene::kNone) return std::pair(false, false);
    const materials::Material& side = scene_.materials[static_cast<std::size_t>(material)];
    return std::pair(side.cells.has_value(), side.maps.any());
  };
  const auto [front_has_cells, front_has_maps] = of_side(instance.material);
  const auto [back_has_cells, back_has_maps] = of_side(instance.back);
  if (!front_has_cells && !back_has_cells) {
    scene_.instances.push_back(std::move(instance));
    return;
  }
  const auto* mesh =
      std::get_if<geometry::MeshShape>(&scene_.shapes[static_cast<std::size_t>(instance.shape)]);
  const bool has_texcoords = mesh && !(*mesh)->texcoords.empty();
  const bool textured =
      instance.texture != scene::kNone || front_has_maps || (back_has_maps && has_texcoords);
  const Laid& laid = this->laid(instance.shape, textured, world_from_node);
  const auto add = [](Faces& to, const Faces& from) {
    to.count += from.count;
    to.area += from.area;
  };
  add(file_, laid.file);
  add(rectangles_, laid.rectangles);
  add(off_, laid.off);
  const std::string& node = scene_.nodes[static_cast<std::size_t>(instance.node)].name;
  if (laid.off.count > 0 && off_names_.insert(node).second) off_nodes_.push_back(node);
  if (laid.without != scene::kNone) {
    scene::Instance plain = instance;
    plain.shape = laid.without;
    if (front_has_cells) plain.material = without_cells(instance.material);
    if (back_has_cells) plain.back = without_cells(instance.back);
    if (laid.with_cells == scene::kNone) {
      scene_.instances.push_back(std::move(plain));
      return;
    }
    instance.shape = laid.with_cells;
    scene_.instances.push_back(std::move(instance));
    scene_.instances.push_back(std::move(plain));
    return;
  }
  instance.shape = laid.with_cells;
  scene_.instances.push_back(std::move(instance));
}

const CellGrids::Laid& CellGrids::laid(std::int32_t shape, bool textured,
                                       const Mat4& world_from_node) {
  const std::array<double, 6> metric = metric_of(world_from_node);
  const auto [known, added] = known_.try_emplace(Key(shape, textured, metric));
  if (added) known->second = lay_out(shape, textured, metric);
  return known->second;
}

CellGrids::Laid CellGrids::lay_out(std::int32_t shape, bool textured,
                                   const std::array<double, 6>& metric) {
  using geometry::FaceLayout;
  const geometry::Shape& given = scene_.shapes[static_cast<std::size_t>(shape)];
  geometry::MeshShape mesh;
  if (const auto* authored = std::get_if<geometry::MeshShape>(&given)) {
    mesh = *authored;
  } else {
    mesh = grid_mesh_of(given);
  }
  Laid out;
  const bool flat =
      std::holds_alternative<geometry::MeshShape>(given) ||
      std::holds_alternative<geometry::Plane>(given) ||
      (std::holds_alternative<geometry::Box>(given) && std::get<geometry::Box>(given).bevel == 0);
  std::vector<Vec3> metres;
  geometry::FlatFaces found;
  if (mesh) {
    triangles_ += mesh->triangles.size();
    const Mat3 in_metres = metres_of(metric);
    for (const Vec3& p : mesh->positions) metres.push_back(in_metres * p);
    if (triangles_ <= kMostTriangles)
      found = geometry::flat_faces(metres, mesh->texcoords, mesh->triangles);
  }
  std::size_t with_cells = 0;
  for (geometry::FlatFace& face : found.faces) {
    // a texture lies by the coordinates of the file, which a rectangle would replace
    if (!flat || (textured && face.layout == FaceLayout::rectangle)) face.layout = FaceLayout::none;
    Faces& to = face.layout == FaceLayout::file        ? out.file
                : face.layout == FaceLayout::rectangle ? out.rectangles
                                                       : out.off;
    ++to.count;
    to.area += face.area;
    with_cells += face.layout != FaceLayout::none;
  }
  if (!flat || found.faces.empty()) out.off.count = 1;
  if (with_cells == 0) {
    out.without = shape;
    return out;
  }
  const auto add = [&](bool cells) -> std::int32_t {
    auto part =
        std::make_shared<geometry::Mesh>(grid_part_of(*mesh, metres, found, cells, !textured));
    if (part->triangles.empty()) return scene::kNone;
    scene_.shapes.emplace_back(geometry::MeshShape(std::move(part)));
    return static_cast<std::int32_t>(scene_.shapes.size() - 1);
  };
  out.with_cells = add(true);
  out.without = add(false);
  return out;
}

std::int32_t CellGrids::without_cells(std::int32_t material) {
  const auto [known, added] =
      plain_materials_.try_emplace(material, static_cast<std::int32_t>(scene_.materials.size()));
  if (added) {
    materials::Material plain = scene_.materials[static_cast<std::size_t>(material)];
    plain.cells.reset();
    plain.name += " without cells";
    scene_.materials.push_back(std::move(plain));
  }
  return known->second;
}

void CellGrids::report(SourceSpan where, DiagnosticLog& log) const {
  if (file_.count + rectangles_.count > 0)
    log.report(Code("N2021"), where,
               fmt::format("solar cells lie along the edges of {}, columns and rows per metre: {} "
                           "by texture coordinates of the file, {} as rectangles",
                           faces(file_.count + rectangles_.count, file_.area + rectangles_.area),
                           file_.count, rectangles_.count));
  if (off_.count == 0) return;
  std::string names;
  for (std::size_t i = 0; i < off_nodes_.size() && i < kMostNodeNames; ++i)
    names += (i == 0 ? "" : ", ") + in_quotes(off_nodes_[i]);
  if (off_nodes_.size() > kMostNodeNames)
    names += fmt::format(" and {} more", off_nodes_.size() - kMostNodeNames);
  log.report(Code("W6008"), where,
             fmt::format("no grid of solar cells on {} of {} {}: not flat rectangles, and without "
                         "texture coordinates that lie unsheared along their longest edge",
                         faces(off_.count, off_.area),
                         off_nodes_.size() == 1 ? "the node" : "the nodes", names),
             "assign a material without <cells> there, or give the faces such coordinates");
}

}  // namespace panwright::pxn
