#include "geometry/mesh/revolution_axes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/axis_box.h"
#include "geometry/mesh/face_groups.h"
#include "geometry/mesh/internal/revolved_fit.h"

namespace panwright::geometry {
namespace {

constexpr double kLeastBendCosine = 0.64278760968653936;  // cos 50°: sides of one surface
constexpr double kAcross = 0.05233595624294383;           // sin 3°: normals of a grown cylinder
constexpr double kLeastStep = 0.017452406437283512;       // sin 1°: bends that tell an axis
constexpr double kNearSeed = 0.02;      // of the radius: vertices from a circle that is a guess
constexpr std::size_t kMostSeeds = 64;  // guesses in a group that is no surface as a whole
constexpr double kLeastShare = 1e-3;    // of a group's area that a grown part has
constexpr std::size_t kLeastOnCircle = 6;

// A mesh brought to the size of 1 about the middle of its bounds, and back.
struct Scaled {
  Faces faces;
  Vec3 middle{0};
  double size = 1;
};

RevolvedFaces in_metres(const Scaled& mesh, const RevolvedFit& fit) {
  RevolvedFaces out;
  out.kind = fit.kind;
  out.axis = fit.axis;
  double low = fit.low, high = fit.high;
  int largest = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(out.axis[k]) > std::fabs(out.axis[largest]) + 1e-6) largest = k;
  if (out.axis[largest] < 0) {
    out.axis = -out.axis;
    low = -fit.high, high = -fit.low;
  }
  const double middle = (low + high) / 2;
  out.origin = mesh.middle + mesh.size * (fit.origin + middle * out.axis);
  out.low = mesh.size * (low - middle);
  out.high = mesh.size * (high - middle);
  out.radius = mesh.size * fit.widest;
  out.turn = fit.turn;
  out.area = mesh.size * mesh.size * fit.area;
  out.residual = mesh.size * fit.residual;
  return out;
}

// Grows cylinders inside a group that is none as a whole.
class Grower {
 public:
  Grower(const Faces& faces, const FaceGroup& group)
      : faces_(faces), group_(group), open_(faces.triangles.size(), false) {
    for (const std::uint32_t t : group) open_[t] = true;
  }

  std::vector<RevolvedFit> run() {
    std::vector<RevolvedFit> out;
    const double least = kLeastShare * area_of(faces_, group_);
    std::size_t tried = 0;
    for (const auto& [t, n] : seeds()) {
      if (!open_[t] || !open_[n]) continue;
      if (++tried > kMostSeeds) break;
      auto grown = cylinder_from(t, n);
      if (!grown || grown->second.area < least) continue;
      for (const std::uint32_t used : grown->first) open_[used] = false;
      out.push_back(std::move(grown->second));
    }
    return out;
  }

 private:
  // Neighbouring faces that are not flat together, the largest first.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> seeds() const {
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> pairs;
    for (const std::uint32_t t : group_)
      for (const std::uint32_t n : faces_.neighbours[t])
        if (n != kNoNeighbour && t < n && open_[n] &&
            glm::length(glm::cross(faces_.normals[t], faces_.normals[n])) >= kLeastStep &&
            glm::dot(faces_.normals[t], faces_.normals[n]) >= kLeastBendCosine)
          pairs.emplace_back(-std::min(faces_.areas[t], faces_.areas[n]), t, n);
    std::ranges::sort(pairs);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
    for (const auto& [area, t, n] : pairs) out.emplace_back(t, n);
    return out;
  }

  template <typename Fits>
  FaceGroup grown(std::uint32_t seed, const Fits& fits) const {
    std::vector<bool> seen(faces_.triangles.size(), false);
    FaceGroup out{seed};
    seen[seed] = true;
    for (std::size_t i = 0; i < out.size(); ++i)
      for (const std::uint32_t n : faces_.neighbours[out[i]])
        if (n != kNoNeighbour && open_[n] && !seen[n] && fits(n) &&
            glm::dot(faces_.normals[out[i]], faces_.normals[n]) >= kLeastBendCosine) {
          seen[n] = true;
          out.push_back(n);
        }
    std::sort(out.begin(), out.end());
    return out;
  }

  std::optional<std::pair<FaceGroup, RevolvedFit>> cylinder_from(std::uint32_t t,
                                                                 std::uint32_t n) const {
    Vec3 axis = glm::normalize(glm::cross(faces_.normals[t], faces_.normals[n]));
    const auto across = [&](std::uint32_t f) {
      return std::fabs(glm::dot(faces_.normals[f], axis)) <= kAcross;
    };
    FaceGroup part;
    for (int round = 0; round < 3; ++round) {
      part = grown(t, across);
      axis = axis_across(faces_, part);
    }
    if (auto fit = fitted(RevolvedKind::cylinder, faces_, part, kPartLimits))
      return std::pair(part, *fit);
    // what runs on into planes and other rounds: only what lies on the seed's circle
    axis = glm::normalize(glm::cross(faces_.normals[t], faces_.normals[n]));
    FaceGroup near{std::min(t, n), std::max(t, n)};
    for (int round = 0; round < 3; ++round) {
      const auto circle = cylinder_about(axis, faces_, near);
      if (!circle) return std::nullopt;
      near = grown(t, [&](std::uint32_t f) {
        return across(f) && std::ranges::all_of(faces_.triangles[f], [&](std::uint32_t v) {
                 return std::fabs(circle->off(faces_.points[v])) <= kNearSeed * circle->radius;
               });
      });
      axis = axis_across(faces_, near);
    }
    if (auto fit = fitted(RevolvedKind::cylinder, faces_, near, kPartLimits))
      return std::pair(near, *fit);
    return std::nullopt;
  }

  const Faces& faces_;
  const FaceGroup& group_;
  std::vector<bool> open_;
};

// The vertices of each loop of open edges.
std::vector<std::vector<std::uint32_t>> border_loops(const Faces& faces) {
  std::vector<std::uint32_t> next(faces.points.size(), kNoNeighbour);
  std::vector<char> crossed(faces.points.size(), 0);
  for (std::size_t t = 0; t < faces.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (faces.neighbours[t][k] != kNoNeighbour || faces.non_manifold[t]) continue;
      const std::uint32_t from = faces.triangles[t][k], to = faces.triangles[t][(k + 1) % 3];
      if (next[from] != kNoNeighbour) crossed[from] = 1;
      next[from] = to;
    }
  std::vector<std::vector<std::uint32_t>> out;
  std::vector<char> seen(faces.points.size(), 0);
  for (std::uint32_t first = 0; first < next.size(); ++first) {
    if (next[first] == kNoNeighbour || seen[first]) continue;
    std::vector<std::uint32_t> loop;
    bool sound = true;
    std::uint32_t at = first;
    while (at != kNoNeighbour && !seen[at]) {
      seen[at] = 1;
      sound = sound && !crossed[at];
      loop.push_back(at);
      at = next[at];
    }
    if (sound && at == first && loop.size() >= kLeastOnCircle) out.push_back(std::move(loop));
  }
  return out;
}

}  // namespace

std::string_view name_of(RevolvedKind kind) {
  switch (kind) {
    case RevolvedKind::cylinder:
      return "cylinder";
    case RevolvedKind::cone:
      return "cone";
    case RevolvedKind::torus:
      return "torus";
    case RevolvedKind::circle:
      break;
  }
  return "circle";
}

bool share_axis(const RevolvedFaces& a, const RevolvedFaces& b) {
  constexpr double kAngle = 0.0087265354983739345;  // sin 0.5°
  if (glm::length(glm::cross(a.axis, b.axis)) > kAngle) return false;
  const Vec3 apart = b.origin - a.origin;
  return glm::length(apart - glm::dot(apart, a.axis) * a.axis) <=
         0.01 * std::max(a.radius, b.radius);
}

std::vector<RevolvedFaces> revolved_faces(const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  Scaled scaled;
  AxisBox box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) box.add(mesh.positions[v]);
  const auto& [low, high] = box;
  scaled.middle = low + (high - low) / 2.0;
  scaled.size = glm::length(high / 2.0 - low / 2.0);
  if (!(scaled.size > 0) || !std::isfinite(1 / scaled.size)) return {};
  Mesh unit;
  for (const Vec3& p : mesh.positions) unit.positions.push_back((p - scaled.middle) / scaled.size);
  unit.triangles = mesh.triangles;
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  scaled.faces = chosen_faces(unit, all, 0);
  const Faces& faces = scaled.faces;
  FaceGroup every(faces.triangles.size());
  std::iota(every.begin(), every.end(), 0u);

  std::vector<RevolvedFaces> out;
  for (const FaceGroup& group : connected(faces, every, kLeastBendCosine)) {
    if (group.size() < 3) continue;
    std::optional<RevolvedFit> whole;
    for (const RevolvedKind kind : {RevolvedKind::cylinder, RevolvedKind::cone})
      if (!whole) whole = fitted(kind, faces, group);
    if (!whole && is_sphere(faces, group)) continue;
    if (!whole) whole = fitted(RevolvedKind::torus, faces, group);
    if (whole) {
      out.push_back(in_metres(scaled, *whole));
      continue;
    }
    for (const RevolvedFit& fit : Grower(faces, group).run()) out.push_back(in_metres(scaled, fit));
  }
  if (out.empty())
    for (const auto& loop : border_loops(faces))
      if (const auto circle = circle_through(faces, loop))
        out.push_back(in_metres(scaled, *circle));
  std::ranges::stable_sort(out, [](const auto& a, const auto& b) { return a.area > b.area; });
  return out;
}

}  // namespace panwright::geometry
