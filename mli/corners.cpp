#include "mli/corners.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace panwright::mli {
namespace {

// of a squared distance: what is less is rounding, as over an outer edge, which is as far as the
// way
constexpr double kEqual = 1e-9;
// of `most`: what is less is rounding on an inner edge
constexpr double kOnEdge = 1e-9;
constexpr int kHalvings = 40;

// Squared, to the nearest point of a triangle. Ericson, "Real-Time Collision Detection", 2005,
// 5.1.5.
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to = [&](const Vec3& q) { return glm::dot(p - q, p - q); };
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return to(a);
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + d1 / (d1 - d3) * ab);
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return to(b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b));
  const double sum = va + vb + vc;
  return to(a + vb / sum * ab + vc / sum * ac);
}

}  // namespace

void Corners::add(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t owner) {
  const Vec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  if (length > 0) faces_.push_back({a, b, c, cross / length, owner});
}

AxisBox Corners::Face::box() const {
  AxisBox out;
  for (const Vec3& p : {a, b, c}) out.add(p);
  return out;
}

void Corners::build() {
  std::vector<AxisBox> boxes;
  boxes.reserve(faces_.size());
  for (const Face& face : faces_) boxes.push_back(face.box());
  tree_.build(std::move(boxes));
}

double Corners::room(std::uint32_t owner, const Vec3& from, const Vec3& along, double most) const {
  std::vector<std::uint32_t> near;
  tree_.near(from, 4 * most * most, [&](std::uint32_t index) {
    if (faces_[index].owner != owner) near.push_back(index);
  });
  // note: the order in which a tree finds them depends on faces that are far away, and how often
  // a way is halved on the order
  std::ranges::sort(near);
  double free = most;
  for (const std::uint32_t index : near) {
    const Face& face = faces_[index];
    // note: distances change by no more than the way, so what is farther than the way at its end
    // was farther all along
    const auto nearer = [&](double way) {
      return squared_distance(from + way * along, face.a, face.b, face.c) <
             (1 - kEqual) * way * way;
    };
    if (!nearer(free)) continue;
    double low = 0;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + free);
      (nearer(middle) ? free : low) = middle;
    }
    free = low > kOnEdge * most ? low : 0;
  }
  return free;
}

bool Corners::crossed(std::uint32_t owner, const Vec3& a, const Vec3& b, double tolerance) const {
  bool out = false;
  const Vec3 middle = 0.5 * (a + b);
  const double half = 0.5 * glm::length(b - a) + tolerance, reach = half * half;
  tree_.near(middle, reach, [&](std::uint32_t index) {
    const Face& face = faces_[index];
    if (out || face.owner == owner) return;
    const double from = glm::dot(a - face.a, face.normal), to = glm::dot(b - face.a, face.normal);
    if (std::fabs(from) <= tolerance && std::fabs(to) <= tolerance) return;  // in its plane
    if (std::min(from, to) > tolerance || std::max(from, to) < -tolerance) return;
    const double part = std::clamp(from / (from - to), 0.0, 1.0);
    out = squared_distance(a + part * (b - a), face.a, face.b, face.c) <= tolerance * tolerance;
  });
  return out;
}

bool Corners::add_near(std::uint32_t owner, std::span<const AxisBox> boxes, KeyHasher& key) const {
  std::vector<std::uint32_t> near;
  std::vector<char> met(faces_.size(), 0);
  for (const AxisBox& box : boxes) {
    const Vec3 half = 0.5 * (box.high - box.low);
    tree_.near(box.low + half, glm::dot(half, half), [&](std::uint32_t index) {
      const Face& face = faces_[index];
      if (face.owner == owner || met[index] != 0 || !box.meets(face.box())) return;
      met[index] = 1;
      near.push_back(index);
    });
  }
  std::ranges::sort(near);
  key.number(near.size());
  for (const std::uint32_t index : near)
    for (const Vec3& p : {faces_[index].a, faces_[index].b, faces_[index].c})
      for (int k = 0; k < 3; ++k) key.real(p[k]);
  return !near.empty();
}

}  // namespace panwright::mli
