#include "geometry/tessellate/internal/subdiv_limit.h"

#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::geometry::internal {

namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// the ratio of what settles to what stays is below 0.8 a level
constexpr int kSettlingLevels = 120;

// What OpenSubdiv asks of a value that it refines.
struct Point {
  Vec3 at{0};
  void Clear() { at = Vec3(0); }
  void AddWithWeight(const Point& other, double weight) { at += weight * other.at; }
};

// The arrays that an OpenSubdiv descriptor points to. Vertices that no face uses are left out.
struct Arrays {
  Arrays(const Subdiv& shape, const Cage& cage, std::span<const Vec3> positions) {
    std::vector<int> number(positions.size(), -1);
    for (std::size_t f = 0; f < cage.faces(); ++f) sides.push_back(static_cast<int>(cage.sides(f)));
    for (const std::uint32_t v : cage.vertex) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(points.size());
        points.push_back({positions[v]});
        if (cage.vertex_sharpness[v] > 0) {
          corners.push_back(number[v]);
          corner_sharpness.push_back(cage.vertex_sharpness[v]);
        }
      }
      vertices.push_back(number[v]);
    }
    for (const Cage::Edge& e : cage.edges) {
      if (e.border() || !(e.sharpness > 0)) continue;
      creases.push_back(number[e.a]);
      creases.push_back(number[e.b]);
      crease_sharpness.push_back(e.sharpness);
    }
    descriptor.numVertices = static_cast<int>(points.size());
    descriptor.numFaces = static_cast<int>(sides.size());
    descriptor.numVertsPerFace = sides.data();
    descriptor.vertIndicesPerFace = vertices.data();
    descriptor.numCreases = static_cast<int>(crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = creases.data();
    descriptor.creaseWeights = crease_sharpness.data();
    descriptor.numCorners = static_cast<int>(corners.size());
    descriptor.cornerVertexIndices = corners.data();
    descriptor.cornerWeights = corner_sharpness.data();
    scheme.SetVtxBoundaryInterpolation(shape.smooth_border
                                           ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                           : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  }

  std::vector<Point> points;
  std::vector<int> sides, vertices, creases, corners;
  std::vector<float> crease_sharpness, corner_sharpness;
  Far::TopologyDescriptor descriptor;
  Sdc::Options scheme;
};

// The faces about a vertex between two sharp edges, or all of them, counter-clockwise: one point of
// an edge before each face, and one after the last where it is no ring.
struct Fan {
  Vec3 centre;
  std::vector<Vec3> edges;
  std::vector<Vec3> faces;  // the corners opposite to the centre
  bool ring = false;
};

Vec3 unit_or_zero(const Vec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : Vec3(0);
}

// By the triangles about the centre: the limit where a vertex is a corner, and good for shading
// where tangents vanish.
Vec3 mean_normal(const Fan& fan) {
  Vec3 sum(0);
  for (std::size_t i = 0; i < fan.faces.size(); ++i)
    sum +=
        glm::cross(fan.edges[i] - fan.centre, fan.edges[(i + 1) % fan.edges.size()] - fan.centre);
  return unit_or_zero(sum);
}

// Halstead, Kass and DeRose, "Efficient, fair interpolation using Catmull-Clark surfaces", 1993.
CornerLimit smooth_limit(const Fan& fan) {
  const std::size_t n = fan.faces.size();
  const auto count = static_cast<double>(n);
  Vec3 edges(0), faces(0);
  for (const Vec3& e : fan.edges) edges += e;
  for (const Vec3& f : fan.faces) faces += f;
  CornerLimit limit;
  limit.position = (count * count * fan.centre + 4.0 * edges + faces) / (count * (count + 5));
  if (n < 3) {
    limit.normal = mean_normal(fan);
    return limit;
  }
  const double turn = 2 * kPi / count;
  const double scale =
      1 + det::cos(turn) + det::cos(turn / 2) * std::sqrt(2 * (9 + det::cos(turn)));
  Vec3 tangents[2] = {Vec3(0), Vec3(0)};
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(i);
    const double c0 = det::cos(k * turn), c1 = det::cos((k + 1) * turn);
    const double s0 = det::sin(k * turn), s1 = det::sin((k + 1) * turn);
    // about the centre, so that nothing large cancels
    const Vec3 e = fan.edges[i] - fan.centre, f = fan.faces[i] - fan.centre;
    tangents[0] += scale * c0 * e + (c0 + c1) * f;
    tangents[1] += scale * s0 * e + (s0 + s1) * f;
  }
  limit.normal = unit_or_zero(glm::cross(tangents[0], tangents[1]));
  return limit;
}

// The subdivision of the faces about a vertex, about it: borders of a fan are sharp, and one edge
// of a ring may be; a number past them is none.
struct FanRule {
  FanRule(const Fan& fan, std::size_t sharp_edge)
      : n(fan.faces.size()), count(fan.edges.size()), ring(fan.ring), sharp(sharp_edge) {}

  bool is_sharp(std::size_t i) const { return i == sharp || (!ring && (i == 0 || i == n)); }
  std::size_t before(std::size_t i) const { return (i + n - 1) % n; }

  std::size_t n, count;
  bool ring;
  std::size_t sharp;
};

// Where the vertex of a ring goes.
Vec3 settled_position(const Fan& fan, const FanRule& rule) {
  Vec3 centre = fan.centre;
  std::vector<Vec3> edges, faces, middles(rule.n);
  for (const Vec3& e : fan.edges) edges.push_back(e - centre);
  for (const Vec3& f : fan.faces) faces.push_back(f - centre);
  for (int level = 0; level < kSettlingLevels; ++level) {
    for (std::size_t i = 0; i < rule.n; ++i)
      middles[i] = 0.25 * (edges[i] + faces[i] + edges[(i + 1) % rule.n]);
    Vec3 move(0);
    for (std::size_t i = 0; i < rule.n; ++i) move += edges[i] + middles[i];
    move /= static_cast<double>(rule.n * rule.n);
    for (std::size_t i = 0; i < rule.n; ++i) {
      edges[i] = (rule.is_sharp(i) ? 0.5 * edges[i]
                                   : 0.25 * (edges[i] + middles[rule.before(i)] + middles[i])) -
                 move;
      faces[i] = middles[i] - move;
    }
    centre += move;
  }
  return centre;
}

// What weights of the points of a level are worth as weights of the level before: of edges, then of
// faces.
std::vector<double> weights_before(const FanRule& rule, const std::vector<double>& w) {
  const std::size_t n = rule.n, count = rule.count;
  double sum = 0;
  for (const double x : w) sum += x;
  const double of_ring = rule.ring ? sum / static_cast<double>(n * n) : 0;
  std::vector<double> middles(n), out(w.size());
  for (std::size_t i = 0; i < n; ++i) middles[i] = w[count + i] - of_ring;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = (rule.is_sharp(i) ? 0.5 : 0.25) * w[i] - of_ring;
    if (!rule.ring && (i == 0 || i == n)) out[i] -= 0.125 * sum;
    if (rule.is_sharp(i)) continue;
    middles[i % n] += 0.25 * w[i];
    middles[rule.before(i)] += 0.25 * w[i];
  }
  for (std::size_t i = 0; i < n; ++i) {
    out[i] += 0.25 * middles[i];
    out[(i + 1) % count] += 0.25 * middles[i];
    out[count + i] = 0.25 * middles[i];
  }
  return out;
}

void make_unit(std::vector<double>& w) {
  double squared = 0;
  for (const double x : w) squared += x * x;
  for (double& x : w) x /= std::sqrt(squared);
}

// The plane in which the faces about a vertex settle, by the two weights that last longest:
// orthogonal iteration.
Vec3 settled_normal(const Fan& fan, const FanRule& rule) {
  std::vector<double> w[2];
  for (std::vector<double>& x : w) x.assign(rule.count + rule.n, 0.0);
  w[0][0] = 1;
  w[1][rule.ring ? rule.n / 3 : rule.n / 2] = 1;
  for (int level = 0; level < kSettlingLevels; ++level) {
    for (std::vector<double>& x : w) x = weights_before(rule, x);
    make_unit(w[0]);
    double common = 0;
    for (std::size_t i = 0; i < w[0].size(); ++i) common += w[0][i] * w[1][i];
    for (std::size_t i = 0; i < w[0].size(); ++i) w[1][i] -= common * w[0][i];
    make_unit(w[1]);
  }
  Vec3 tangents[2] = {Vec3(0), Vec3(0)};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < w[k].size(); ++i)
      tangents[k] +=
          w[k][i] * ((i < rule.count ? fan.edges[i] : fan.faces[i - rule.count]) - fan.centre);
  const Vec3 normal = unit_or_zero(glm::cross(tangents[0], tangents[1]));
  const Vec3 about = mean_normal(fan);
  return glm::dot(normal, about) < 0 ? -normal : normal;
}

// note: the masks for tangents of Biermann, Levin and Zorin, which OpenSubdiv has, are those of
// their own rules for edges next to creases: of Catmull-Clark's they are off by up to 0.003 rad
CornerLimit crease_limit(const Fan& fan) {
  const Vec3 a = fan.edges.front() - fan.centre, b = fan.edges.back() - fan.centre;
  CornerLimit limit;
  limit.position = fan.centre + (a + b) / 6.0;
  // of a single face the sides keep their plane
  limit.normal = fan.faces.size() == 1 ? mean_normal(fan)
                                       : settled_normal(fan, FanRule(fan, fan.edges.size()));
  return limit;
}

bool contains(Far::ConstIndexArray list, Far::Index value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

}  // namespace

struct LimitSurface::Impl {
  std::unique_ptr<Far::TopologyRefiner> refiner;
  std::unique_ptr<Far::PatchTable> patches;
  std::unique_ptr<Far::PatchMap> map;
  std::vector<Vec3> points;         // of all levels
  std::vector<std::size_t> offset;  // of each level
  int settled = 1;                  // the first level without semi-sharp features

  CornerLimit limit(int level, Far::Index face, Far::Index vertex) const;
  void descend(int from, int to, Far::Index& face, Far::Index& vertex) const;
  std::size_t sharp_edge(int level, Far::Index face, Far::Index vertex) const;
  Fan fan(int level, Far::Index face, Far::Index vertex, bool whole) const;
};

LimitSurface::LimitSurface(const Subdiv& shape, const Cage& cage, std::span<const Vec3> positions,
                           int depth)
    : impl_(std::make_unique<Impl>()) {
  assert(depth >= 1 && depth <= kMaxDepth);
  Arrays arrays(shape, cage, positions);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  impl_->settled = std::max(1, sharp_levels(cage));
  impl_->refiner.reset(
      Factory::Create(arrays.descriptor, Factory::Options(Sdc::SCHEME_CATMARK, arrays.scheme)));
  Far::PatchTableFactory::Options options(static_cast<unsigned>(depth));
  options.useInfSharpPatch = true;
  // note: these two leave regular patches exact, and mark the others
  options.generateLegacySharpCornerPatches = false;
  options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_BILINEAR_BASIS);
  options.SetPatchPrecision<double>();
  Far::TopologyRefiner& refiner = *impl_->refiner;
  refiner.RefineAdaptive(options.GetRefineAdaptiveOptions());
  impl_->patches.reset(Far::PatchTableFactory::Create(refiner, options));
  impl_->map = std::make_unique<Far::PatchMap>(*impl_->patches);

  std::vector<Point> all(static_cast<std::size_t>(refiner.GetNumVerticesTotal()));
  std::copy(arrays.points.begin(), arrays.points.end(), all.begin());
  const Far::PrimvarRefinerReal<double> primvars(refiner);
  Point* source = all.data();
  impl_->offset.push_back(0);
  for (int level = 1; level < refiner.GetNumLevels(); ++level) {
    Point* target = source + refiner.GetLevel(level - 1).GetNumVertices();
    primvars.Interpolate(level, source, target);
    source = target;
    impl_->offset.push_back(static_cast<std::size_t>(target - all.data()));
  }
  impl_->points.reserve(all.size());
  for (const Point& p : all) impl_->points.push_back(p.at);
}

LimitSurface::~LimitSurface() = default;

bool LimitSurface::evaluate(std::uint32_t patch, double u, double v, LimitPoint& out) const {
  const Far::PatchMap::Handle* handle = impl_->map->FindPatch(static_cast<int>(patch), u, v);
  if (handle == nullptr) return false;
  const Far::PatchTable& table = *impl_->patches;
  if (table.GetPatchDescriptor(*handle).GetType() != Far::PatchDescriptor::REGULAR) return false;
  double p[16], du[16], dv[16];
  table.EvaluateBasis(*handle, u, v, p, du, dv, static_cast<double*>(nullptr),
                      static_cast<double*>(nullptr), static_cast<double*>(nullptr));
  const Far::ConstIndexArray indices = table.GetPatchVertices(*handle);
  out = {};
  for (int i = 0; i < 16; ++i) {
    const Vec3& q = impl_->points[static_cast<std::size_t>(indices[i])];
    out.position += p[i] * q;
    out.du += du[i] * q;
    out.dv += dv[i] * q;
  }
  return true;
}

Fan LimitSurface::Impl::fan(int number, Far::Index face, Far::Index vertex, bool whole) const {
  const Far::TopologyLevel& level = refiner->GetLevel(number);
  const Far::ConstIndexArray edges = level.GetVertexEdges(vertex);
  const Far::ConstIndexArray faces = level.GetVertexFaces(vertex);
  const auto at = [&](Far::Index v) {
    return points[offset[static_cast<std::size_t>(number)] + static_cast<std::size_t>(v)];
  };
  const auto end_of = [&](int e) {
    const Far::ConstIndexArray ends = level.GetEdgeVertices(edges[e]);
    return at(ends[0] == vertex ? ends[1] : ends[0]);
  };
  const int n = faces.size();
  int first = 0;
  while (faces[first] != face) ++first;
  int last = first;
  bool ring = edges.size() == n;
  if (ring && (whole || std::none_of(edges.begin(), edges.end(),
                                     [&](Far::Index e) { return level.IsEdgeInfSharp(e); }))) {
    last = first + n - 1;
  } else {
    // edge i stands before face i
    const auto wrapped = [&](int i) { return ring ? (i + n) % n : i; };
    const auto sharp = [&](int i) { return level.IsEdgeInfSharp(edges[wrapped(i)]); };
    while (last - first < n - 1 && !sharp(first)) --first;
    while (last - first < n - 1 && !sharp(last + 1)) ++last;
    ring = false;
  }
  Fan result{at(vertex), {}, {}, ring};
  for (int i = first; i <= last + (ring ? 0 : 1); ++i) {
    const int e = edges.size() == n ? (i + n) % n : i;
    result.edges.push_back(end_of(e));
    if (i > last) break;
    const Far::ConstIndexArray corners = level.GetFaceVertices(faces[e]);
    int k = 0;
    while (corners[k] != vertex) ++k;
    result.faces.push_back(at(corners[(k + 2) % 4]));
  }
  return result;
}

// The number in the fan of the one edge that is sharp.
std::size_t LimitSurface::Impl::sharp_edge(int number, Far::Index face, Far::Index vertex) const {
  const Far::TopologyLevel& level = refiner->GetLevel(number);
  const Far::ConstIndexArray edges = level.GetVertexEdges(vertex);
  const Far::ConstIndexArray faces = level.GetVertexFaces(vertex);
  int first = 0, sharp = 0;
  while (faces[first] != face) ++first;
  while (sharp + 1 < edges.size() && !level.IsEdgeInfSharp(edges[sharp])) ++sharp;
  return static_cast<std::size_t>((sharp - first + edges.size()) % edges.size());
}

// To the same vertex of a finer level, and a face there.
void LimitSurface::Impl::descend(int from, int to, Far::Index& face, Far::Index& vertex) const {
  for (int i = from; i < to; ++i) {
    const Far::TopologyLevel& level = refiner->GetLevel(i);
    const Far::TopologyLevel& finer = refiner->GetLevel(i + 1);
    vertex = level.GetVertexChildVertex(vertex);
    assert(vertex >= 0);
    for (const Far::Index child : level.GetFaceChildFaces(face)) {
      if (child < 0 || !contains(finer.GetFaceVertices(child), vertex)) continue;
      face = child;
      break;
    }
  }
}

CornerLimit LimitSurface::Impl::limit(int level, Far::Index face, Far::Index vertex) const {
  // note: finer levels say the same with fewer digits
  const int at = std::max(level, std::min(settled, refiner->GetMaxLevel()));
  descend(level, at, face, vertex);
  const Sdc::Crease::Rule rule = refiner->GetLevel(at).GetVertexRule(vertex);
  if (rule == Sdc::Crease::RULE_SMOOTH) return smooth_limit(fan(at, face, vertex, true));
  if (rule == Sdc::Crease::RULE_CREASE) return crease_limit(fan(at, face, vertex, false));
  if (rule == Sdc::Crease::RULE_DART) {
    const Fan about = fan(at, face, vertex, true);
    const FanRule dart(about, sharp_edge(at, face, vertex));
    return {settled_position(about, dart), settled_normal(about, dart)};
  }
  descend(at, refiner->GetMaxLevel(), face, vertex);
  const Fan about = fan(refiner->GetMaxLevel(), face, vertex, false);
  return {about.centre, mean_normal(about)};
}

CornerLimit LimitSurface::at_corner(std::uint32_t face, std::uint32_t corner) const {
  const auto f = static_cast<Far::Index>(face);
  return impl_->limit(0, f,
                      impl_->refiner->GetLevel(0).GetFaceVertices(f)[static_cast<int>(corner)]);
}

CornerLimit LimitSurface::at_centre(std::uint32_t face, std::uint32_t corner) const {
  const auto f = static_cast<Far::Index>(face);
  const Far::TopologyLevel& level = impl_->refiner->GetLevel(0);
  return impl_->limit(1, level.GetFaceChildFaces(f)[static_cast<int>(corner)],
                      level.GetFaceChildVertex(f));
}

}  // namespace panwright::geometry::internal
