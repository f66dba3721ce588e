#include "importers/step/internal/bodies.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomLProp_SLProps.hxx>
#include <GeomLib.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Lin.hxx>
#include <map>
#include <unordered_map>

namespace panwright::importers::step {

namespace {

constexpr double kAngle = 0.35;  // radians between neighbouring chords: 18 about a circle
// directions of a surface that are this close to parallel give no normal
constexpr double kSingular = 1e-9;
// normals of two faces at one point that differ by less (radians) are one
constexpr double kSameNormal = 1e-6;
constexpr std::uint32_t kNoPoint = 0xffffffff;

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

// Points on edges and at vertices of a body, each once.
class SharedPoints {
 public:
  std::uint32_t add(const Vec3& position) {
    positions_.push_back(position);
    return static_cast<std::uint32_t>(positions_.size() - 1);
  }
  const Vec3& operator[](std::uint32_t point) const { return positions_[point]; }

  std::uint32_t of_vertex(const TopoDS_Vertex& vertex, const Vec3& position) {
    if (const std::uint32_t* known = vertices_.Seek(vertex)) return *known;
    const std::uint32_t point = add(position);
    vertices_.Bind(vertex, point);
    return point;
  }

  // One per node of the edge's polygon, in its own direction; made at the first call.
  template <typename PositionOf>
  const std::vector<std::uint32_t>& of_edge(const TopoDS_Edge& edge, int nodes,
                                            PositionOf position_of) {
    if (const auto* known = edges_.Seek(edge))
      if (known->size() == static_cast<std::size_t>(nodes)) return *known;
    std::vector<std::uint32_t> points;
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const TopoDS_Vertex first = TopExp::FirstVertex(forward);
    const TopoDS_Vertex last = TopExp::LastVertex(forward);
    for (int i = 1; i <= nodes; ++i) {
      if (i == 1 && !first.IsNull())
        points.push_back(of_vertex(first, position_of(i)));
      else if (i == nodes && !last.IsNull())
        points.push_back(of_vertex(last, position_of(i)));
      else
        points.push_back(add(position_of(i)));
    }
    edges_.Bind(edge, points);
    return edges_.Find(edge);
  }

 private:
  std::vector<Vec3> positions_;
  NCollection_DataMap<TopoDS_Shape, std::uint32_t, TopTools_ShapeMapHasher> vertices_;
  NCollection_DataMap<TopoDS_Shape, std::vector<std::uint32_t>, TopTools_ShapeMapHasher> edges_;
};

// Appends faces to one mesh.
class PatchBuilder {
 public:
  PatchBuilder() : mesh_(std::make_shared<geometry::Mesh>()) {}

  // shared: the body's point, or kNoPoint inside a face
  std::uint32_t vertex(std::uint32_t shared, const Vec3& position, const Vec3& normal) {
    std::vector<std::uint32_t>* here = nullptr;
    if (shared != kNoPoint) {
      here = &at_[shared];
      for (const std::uint32_t known : *here)
        if (glm::length(mesh_->normals[known] - normal) < kSameNormal) return known;
    }
    const auto index = static_cast<std::uint32_t>(mesh_->positions.size());
    mesh_->positions.push_back(position);
    mesh_->normals.push_back(normal);
    if (here != nullptr) here->push_back(index);
    return index;
  }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_->triangles.push_back({a, b, c});
  }

  const std::shared_ptr<geometry::Mesh>& mesh() const { return mesh_; }

 private:
  std::shared_ptr<geometry::Mesh> mesh_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> at_;
};

// The outward normals of a face; nothing where its surface has none.
class FaceNormals {
 public:
  // turned: outside is where the surface's own normal does not point
  FaceNormals(const TopoDS_Face& face, bool turned)
      : surface_(face, Standard_False), geometry_(BRep_Tool::Surface(face)), turned_(turned) {}

  std::optional<Vec3> at(const gp_Pnt2d& uv) const {
    gp_Pnt point;
    gp_Vec du;
    gp_Vec dv;
    surface_.D1(uv.X(), uv.Y(), point, du, dv);
    const Vec3 u = vec(du.XYZ());
    const Vec3 v = vec(dv.XYZ());
    const Vec3 across = glm::cross(u, v);
    const double length = glm::length(across);
    if (!(length > kSingular * glm::length(u) * glm::length(v)) ||
        !(glm::length(u) > kSingular * glm::length(v)) ||
        !(glm::length(v) > kSingular * glm::length(u)))
      return std::nullopt;
    return (turned_ ? -1.0 : 1.0) * across / length;
  }

  // At a pole or a tip, seen from a triangle there; inside: between its other corners.
  std::optional<Vec3> near(const gp_Pnt2d& uv, const gp_Pnt2d& inside) const {
    constexpr double kStep = 1e-3;
    gp_Pnt point;
    gp_Vec du;
    gp_Vec dv;
    surface_.D1(uv.X(), uv.Y(), point, du, dv);
    // the parameter that does not matter there says from which side the triangle comes
    const bool tip_in_u = du.Magnitude() < dv.Magnitude();
    gp_XY step = kStep * (inside.XY() - uv.XY());
    if (tip_in_u)
      step.SetX(inside.X() - uv.X());
    else
      step.SetY(inside.Y() - uv.Y());
    const auto beside = at(gp_Pnt2d(uv.XY() + step));
    gp_Dir limit;
    if (!beside || geometry_.IsNull() || GeomLib::NormEstim(geometry_, uv, 1e-7, limit) > 1)
      return beside;
    const Vec3 n = (turned_ ? -1.0 : 1.0) * vec(limit.XYZ());
    // the limit has to be close to what is beside it; at the tip of a cone there is none
    constexpr double kClose = 0.9999;
    return glm::dot(n, *beside) > kClose ? n : *beside;
  }

 private:
  BRepAdaptor_Surface surface_;
  Handle(Geom_Surface) geometry_;
  bool turned_;
};

// The shared point of each node of a face's triangulation.
std::vector<std::uint32_t> shared_nodes(const TopoDS_Face& face,
                                        const Handle(Poly_Triangulation) & triangulation,
                                        const TopLoc_Location& location,
                                        const std::vector<Vec3>& positions, SharedPoints& points) {
  std::vector<std::uint32_t> out(positions.size(), kNoPoint);
  for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges.Current());
    const Handle(Poly_PolygonOnTriangulation)& polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    if (polygon.IsNull()) continue;
    const int count = polygon->NbNodes();
    const auto node = [&](int i) { return static_cast<std::size_t>(polygon->Node(i) - 1); };
    if (BRep_Tool::Degenerated(edge)) {
      const TopoDS_Vertex vertex = TopExp::FirstVertex(edge);
      if (vertex.IsNull() || count == 0) continue;
      const std::uint32_t point = points.of_vertex(vertex, positions[node(1)]);
      for (int i = 1; i <= count; ++i) out[node(i)] = point;
      continue;
    }
    const auto& on_edge = points.of_edge(edge, count, [&](int i) { return positions[node(i)]; });
    for (int i = 1; i <= count; ++i) out[node(i)] = on_edge[static_cast<std::size_t>(i - 1)];
  }
  return out;
}

// The distance of a point from a surface, in millimetres.
//
//   uv  of a point of the surface that is near
double distance(const BRepAdaptor_Surface& surface, const gp_Pnt& point, gp_XY uv) {
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      return 0;  // by construction
    case GeomAbs_Sphere:
      return std::abs(point.Distance(surface.Sphere().Location()) - surface.Sphere().Radius());
    case GeomAbs_Cylinder:
      return std::abs(gp_Lin(surface.Cylinder().Axis()).Distance(point) -
                      surface.Cylinder().Radius());
    case GeomAbs_Cone: {
      const gp_Cone cone = surface.Cone();
      const double along = gp_Vec(cone.Location(), point).Dot(gp_Vec(cone.Axis().Direction()));
      const double radius = cone.RefRadius() + along * std::tan(cone.SemiAngle());
      return std::abs(gp_Lin(cone.Axis()).Distance(point) - std::abs(radius)) *
             std::cos(cone.SemiAngle());
    }
    case GeomAbs_Torus: {
      const gp_Torus torus = surface.Torus();
      const double along = gp_Vec(torus.Location(), point).Dot(gp_Vec(torus.Axis().Direction()));
      const double out = gp_Lin(torus.Axis()).Distance(point) - torus.MajorRadius();
      return std::abs(std::sqrt(out * out + along * along) - torus.MinorRadius());
    }
    default:
      break;
  }
  // the foot by two steps of Gauss and Newton
  constexpr int kSteps = 2;
  gp_Pnt foot;
  gp_Vec du;
  gp_Vec dv;
  for (int i = 0;; ++i) {
    surface.D1(uv.X(), uv.Y(), foot, du, dv);
    const gp_Vec off(foot, point);
    const double uu = du.Dot(du);
    const double uw = du.Dot(dv);
    const double ww = dv.Dot(dv);
    const double determinant = uu * ww - uw * uw;
    if (!(determinant > kSingular * uu * ww)) return off.Magnitude();
    const double u = (ww * off.Dot(du) - uw * off.Dot(dv)) / determinant;
    const double v = (uu * off.Dot(dv) - uw * off.Dot(du)) / determinant;
    const gp_Vec across = du.Crossed(dv);
    if (i == kSteps) return std::abs(off.Dot(across)) / across.Magnitude();
    uv += gp_XY(u, v);
  }
}

// How far a face's triangles are from its surface, in millimetres: at the middles of edges and
// triangles, where they are furthest off.
double deviation_of(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation)& triangulation = BRep_Tool::Triangulation(face, location);
  const BRepAdaptor_Surface surface(face, Standard_False);
  if (triangulation.IsNull() || !triangulation->HasUVNodes() || surface.GetType() == GeomAbs_Plane)
    return 0;
  const gp_Trsf transform = location.Transformation();
  double worst = 0;
  for (int t = 1; t <= triangulation->NbTriangles(); ++t) {
    int node[3];
    triangulation->Triangle(t).Get(node[0], node[1], node[2]);
    gp_XYZ at[3];
    gp_XY uv[3];
    for (int k = 0; k < 3; ++k) {
      at[k] = triangulation->Node(node[k]).Transformed(transform).XYZ();
      uv[k] = triangulation->UVNode(node[k]).XY();
    }
    for (int k = 0; k < 3; ++k)
      worst = std::max(worst, distance(surface, gp_Pnt((at[k] + at[(k + 1) % 3]) / 2),
                                       (uv[k] + uv[(k + 1) % 3]) / 2));
    worst = std::max(
        worst, distance(surface, gp_Pnt((at[0] + at[1] + at[2]) / 3), (uv[0] + uv[1] + uv[2]) / 3));
  }
  return worst;
}

// Gives a body triangles that are as close to it as asked, millimetres.
// note: OpenCASCADE takes the deflection for a hint; on spheres it is off by 1.2 of it
void triangulate(const TopoDS_Shape& body, double deflection) {
  constexpr int kMostRounds = 4;
  double aim = deflection;
  for (int round = 0; round < kMostRounds; ++round) {
    BRepTools::Clean(body);
    IMeshTools_Parameters parameters;
    parameters.Deflection = aim;
    parameters.Angle = kAngle;
    parameters.InParallel = Standard_False;  // one order, whatever the machine
    // five times as fast as the usual one, and closer
    parameters.MeshAlgo = IMeshTools_MeshAlgoType_Delabella;
    BRepMesh_IncrementalMesh mesher(body, parameters);
    double worst = 0;
    bool whole = true;
    for (TopExp_Explorer at(body, TopAbs_FACE); at.More(); at.Next()) {
      const TopoDS_Face& face = TopoDS::Face(at.Current());
      TopLoc_Location unused;
      whole = whole && !BRep_Tool::Triangulation(face, unused).IsNull();
      worst = std::max(worst, deviation_of(face));
    }
    if (!whole) {  // the usual one may mesh what this one does not
      parameters.MeshAlgo = IMeshTools_MeshAlgoType_Watson;
      BRepMesh_IncrementalMesh again(body, parameters);
    }
    if (!(worst > deflection) || round + 1 == kMostRounds) return;
    aim *= std::max(0.25, 0.95 * deflection / worst);
  }
}

// False: nothing of the face could be meshed.
bool add_face(const TopoDS_Face& face, SharedPoints& points, PatchBuilder& patch) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation)& triangulation = BRep_Tool::Triangulation(face, location);
  if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return false;
  const gp_Trsf transform = location.Transformation();
  const bool mirrored = transform.VectorialPart().Determinant() < 0;
  const bool turned = (face.Orientation() == TopAbs_REVERSED) != mirrored;
  const int count = triangulation->NbNodes();
  std::vector<Vec3> positions(static_cast<std::size_t>(count));
  for (int i = 1; i <= count; ++i)
    positions[static_cast<std::size_t>(i - 1)] =
        vec(triangulation->Node(i).Transformed(transform).XYZ()) / kMetre;
  const auto shared = shared_nodes(face, triangulation, location, positions, points);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (shared[i] != kNoPoint) positions[i] = points[shared[i]];
    if (!panwright::is_finite(positions[i])) return false;
  }

  const bool has_uv = triangulation->HasUVNodes();
  const FaceNormals normals(face, turned);
  std::vector<std::uint32_t> vertices(positions.size(), kNoPoint);
  std::vector<bool> singular(positions.size(), !has_uv);
  for (int t = 1; t <= triangulation->NbTriangles(); ++t) {
    int node[3];
    triangulation->Triangle(t).Get(node[0], node[1], node[2]);
    if (turned) std::swap(node[1], node[2]);
    std::size_t corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = static_cast<std::size_t>(node[k] - 1);
    const Vec3 across = glm::cross(positions[corner[1]] - positions[corner[0]],
                                   positions[corner[2]] - positions[corner[0]]);
    if (positions[corner[0]] == positions[corner[1]] ||
        positions[corner[1]] == positions[corner[2]] ||
        positions[corner[2]] == positions[corner[0]])
      continue;
    const double area = glm::length(across);
    const Vec3 flat = area > 0 ? across / area : Vec3(0, 0, 1);
    std::uint32_t out[3];
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = corner[k];
      if (vertices[i] == kNoPoint && !singular[i]) {
        const auto normal = normals.at(triangulation->UVNode(node[k]));
        if (normal)
          vertices[i] = patch.vertex(shared[i], positions[i], *normal);
        else
          singular[i] = true;
      }
      out[k] = vertices[i];
      if (!singular[i]) continue;
      std::optional<Vec3> normal;
      if (has_uv) {
        const gp_XY other = triangulation->UVNode(node[(k + 1) % 3]).XY();
        const gp_XY third = triangulation->UVNode(node[(k + 2) % 3]).XY();
        normal = normals.near(triangulation->UVNode(node[k]), gp_Pnt2d((other + third) / 2));
      }
      out[k] = patch.vertex(shared[i], positions[i], normal.value_or(flat));
    }
    patch.triangle(out[0], out[1], out[2]);
  }
  return true;
}

}  // namespace

Meshed meshed(const TopoDS_Shape& body, std::span<const std::int32_t> colors, double deflection) {
  triangulate(body, deflection * kMetre);
  Meshed out;
  SharedPoints points;
  std::map<std::int32_t, PatchBuilder> patches;
  std::size_t number = 0;
  for (TopExp_Explorer faces(body, TopAbs_FACE); faces.More(); faces.Next(), ++number) {
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    const std::int32_t color = number < colors.size() ? colors[number] : 0;
    if (!add_face(face, points, patches[color])) out.lost.push_back(face);
  }
  for (const auto& [color, builder] : patches)
    if (!builder.mesh()->triangles.empty()) out.patches.push_back({color, builder.mesh()});
  return out;
}

double expected_triangles(const TopoDS_Shape& body, double deflection) {
  constexpr int kSamples = 5;  // along u and v
  double sum = 0;
  for (TopExp_Explorer faces(body, TopAbs_FACE); faces.More(); faces.Next()) {
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    sum += 2;
    if (surface.IsNull() || !(std::abs(u1 - u0) < 1e10) || !(std::abs(v1 - v0) < 1e10)) continue;
    const bool ruled = BRepAdaptor_Surface(face, Standard_False).GetType() == GeomAbs_Cylinder;
    const double step = (u1 - u0) * (v1 - v0) / (kSamples * kSamples);
    for (int i = 0; i < kSamples; ++i) {
      for (int k = 0; k < kSamples; ++k) {
        GeomLProp_SLProps at(surface, u0 + (u1 - u0) * (i + 0.5) / kSamples,
                             v0 + (v1 - v0) * (k + 0.5) / kSamples, 2, 1e-9);
        const double area = std::abs(step) * at.D1U().Crossed(at.D1V()).Magnitude();
        if (!at.IsCurvatureDefined() || !std::isfinite(area)) continue;
        // edges of triangles: chords of the deflection along each principal direction
        const auto per_length = [&](double curvature) {
          return std::max(std::sqrt(std::abs(curvature) / (8 * deflection * kMetre)),
                          std::abs(curvature) / kAngle);
        };
        const double one = per_length(at.MaxCurvature());
        const double other = per_length(at.MinCurvature());
        const double most = std::max(one, other);
        // note: OpenCASCADE cuts across straight lines too, but on cylinders
        sum += 2 * area * most *
               (ruled ? std::min(one, other) : std::max(std::min(one, other), most / 4));
      }
    }
  }
  return sum;
}

}  // namespace panwright::importers::step
