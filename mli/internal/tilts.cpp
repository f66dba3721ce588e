#include "mli/internal/tilts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/axis_box.h"
#include "base/math.h"

namespace panwright::mli {
namespace {

// of a normal along the one below: steeper ones are seams, which are no foil that lies
constexpr double kSteep = 0.2;
// of TiltMap::power
constexpr double kLowest = -0.6, kHighest = 0.9;
constexpr std::size_t kMost = 20011;  // triangles that are looked at; a prime

// The middles of 16 equal parts of a triangle.
const std::array<Vec3, 16>& places() {
  static const std::array<Vec3, 16> all = [] {
    std::array<Vec3, 16> out;
    std::size_t count = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; i + j < 4; ++j) {
        out[count++] = Vec3(i + 1 / 3.0, j + 1 / 3.0, 4 - i - j - 2 / 3.0) / 4.0;
        if (i + j < 3) out[count++] = Vec3(i + 2 / 3.0, j + 2 / 3.0, 4 - i - j - 4 / 3.0) / 4.0;
      }
    return out;
  }();
  return all;
}

double stretch(const TiltMap& map, double square) {
  return map.power == 0 ? map.factor
                        : map.factor * det::pow(1 + square / map.scale, -0.5 * map.power);
}

Vec2 leant(const TiltMap& map, const Vec2& slope) {
  return {glm::dot(map.along, slope), glm::dot(map.up, slope)};
}

// Symmetric 2×2 matrices: the square root, the inverse, and a·b·a.
Covariance root(const Covariance& a) {
  const double s = std::sqrt(std::max(a.xx * a.yy - a.xy * a.xy, 0.0));
  const double t = std::sqrt(a.xx + a.yy + 2 * s);
  return {(a.xx + s) / t, a.xy / t, (a.yy + s) / t};
}
Covariance inverse(const Covariance& a) {
  const double det = a.xx * a.yy - a.xy * a.xy;
  return {a.yy / det, -a.xy / det, a.xx / det};
}
Covariance between(const Covariance& a, const Covariance& b) {
  const Vec2 x(a.xx * b.xx + a.xy * b.xy, a.xx * b.xy + a.xy * b.yy);
  const Vec2 y(a.xy * b.xx + a.yy * b.xy, a.xy * b.xy + a.yy * b.yy);
  return {x.x * a.xx + x.y * a.xy, x.x * a.xy + x.y * a.yy, y.x * a.xy + y.y * a.yy};
}

}  // namespace

Tilts::Tilts(const geometry::Mesh& mesh, std::span<const Vec3> below) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> corner_of(mesh.normals.size(), kUnused);
  const auto along = [&](std::uint32_t v) { return glm::dot(mesh.normals[v], below[v]); };
  const std::size_t step = mesh.triangles.size() / kMost + 1;
  for (std::size_t k = 0; k < mesh.triangles.size(); k += step) {
    const geometry::Triangle& t = mesh.triangles[k];
    if (std::ranges::any_of(t, [&](std::uint32_t v) { return !(along(v) > kSteep); })) continue;
    const Vec3 area = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                 mesh.positions[t[2]] - mesh.positions[t[0]]);
    const double weight = glm::dot(area, below[t[0]] + below[t[1]] + below[t[2]]);
    // a seam between normals that are smooth
    if (!(weight > kSteep * glm::length(area))) continue;
    geometry::Triangle corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = t[i];
      if (corner_of[v] == kUnused) {
        corner_of[v] = static_cast<std::uint32_t>(corners_.size());
        corners_.push_back({mesh.normals[v] / along(v) - below[v], along(v)});
      }
      corners[i] = corner_of[v];
    }
    triangles_.push_back(corners);
    weights_.push_back(weight);
  }
  unit_ = spread(TiltMap{}, false).variance;
}

TiltSpread Tilts::spread(const TiltMap& map, bool with_level) const {
  std::vector<Corner> at = corners_;
  if (map.factor != 1 || map.power != 0 || map.leans())
    for (Corner& corner : at) {
      corner.slope *= stretch(map, glm::dot(corner.slope, corner.slope));
      if (map.leans()) corner.slope = Vec3(leant(map, Vec2(corner.slope)), 0);
      corner.along = 1 / std::sqrt(1 + glm::dot(corner.slope, corner.slope));
    }
  double sum = 0, squares = 0, level = 0, mirror = 0;
  Covariance slopes;
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const geometry::Triangle& t = triangles_[k];
    double square_here = 0, level_here = 0, mirror_here = 0;
    Covariance slopes_here;
    for (const Vec3& place : places()) {
      Vec3 slope(0);
      double along = 0;
      for (int i = 0; i < 3; ++i) {
        const Corner& corner = at[t[static_cast<std::size_t>(i)]];
        slope += place[i] * corner.along * corner.slope;
        along += place[i] * corner.along;
      }
      slope /= along;
      const double square = glm::dot(slope, slope);
      square_here += square;
      slopes_here.xx += slope.x * slope.x;
      slopes_here.xy += slope.x * slope.y;
      slopes_here.yy += slope.y * slope.y;
      if (!with_level || !(unit_ > 0)) continue;
      const double here = det::exp(-square / unit_), cube = here * here * here;
      level_here += here;
      mirror_here += cube * cube * cube;
    }
    sum += weights_[k];
    squares += weights_[k] * square_here / 16;
    slopes.xx += weights_[k] * slopes_here.xx / 16;
    slopes.xy += weights_[k] * slopes_here.xy / 16;
    slopes.yy += weights_[k] * slopes_here.yy / 16;
    level += weights_[k] * level_here / 16;
    mirror += weights_[k] * mirror_here / 16;
  }
  if (!(sum > 0)) return {};
  return {squares / sum,
          level / sum,
          mirror / sum,
          {slopes.xx / sum, slopes.xy / sum, slopes.yy / sum}};
}

TiltSpread Tilts::scaled_to(TiltMap& map, double variance) const {
  // the variance is about proportional to the factor's square: within 1 %, the next factor is right
  // to 1e-4
  for (int step = 0; step < 4; ++step) {
    const double got = spread(map, false).variance;
    if (!(got > 0)) {
      map.factor = 1;
      break;
    }
    map.factor *= std::sqrt(variance / got);
    if (std::fabs(got - variance) < 1e-2 * variance) break;
  }
  return spread(map, true);
}

TiltMap Tilts::towards(const TiltSpread& wanted, TiltSpread& reached) const {
  reached = {};
  if (!(wanted.variance > 0) || !(unit_ > 0)) return {};
  return shaped({}, wanted, reached);
}

TiltMap Tilts::towards_all(const TiltSpread& wanted) const {
  TiltSpread reached;
  TiltMap map = towards(wanted, reached);
  const Covariance& goal = wanted.slopes;
  // one of nearly one direction has no inverse to speak of
  if (!(goal.xx * goal.yy - goal.xy * goal.xy > 1e-6 * wanted.variance * wanted.variance))
    return map;
  for (int step = 0; step < 2; ++step) {
    const Covariance& got = reached.slopes;
    if (!(got.xx * got.yy - got.xy * got.xy > 1e-6 * wanted.variance * wanted.variance)) break;
    // of all matrices that make one of the other, the symmetric one
    const Covariance half = root(got);
    const Covariance lean = between(inverse(half), root(between(half, goal)));
    TiltMap next;
    next.along = lean.xx * map.along + lean.xy * map.up;
    next.up = lean.xy * map.along + lean.yy * map.up;
    map = next;
    map = shaped(map, wanted, reached);
  }
  return map;
}

TiltMap Tilts::shaped(TiltMap map, const TiltSpread& wanted, TiltSpread& reached) const {
  Tilts like = *this;
  like.unit_ = wanted.variance;
  map.scale = wanted.variance;
  // of powers, what is more level than wanted by how much; false position, with either end let go
  // of when it stays twice (Illinois)
  double low = kLowest, high = kHighest, more_low = 0, more_high = 0;
  const auto more_at = [&](double power) {
    map.power = power;
    reached = like.scaled_to(map, wanted.variance);
    return reached.level - wanted.level;
  };
  if (more_low = more_at(low); !(more_low > 0)) return map;
  if (more_high = more_at(high); !(more_high < 0)) return map;
  for (int step = 0, side = 0; step < 6; ++step) {
    const double power = (low * more_high - high * more_low) / (more_high - more_low);
    const double more = more_at(power);
    if (std::fabs(more) < 1e-4 * wanted.level) break;
    if (more > 0) {
      low = power, more_low = more;
      if (side == 1) more_high /= 2;
      side = 1;
    } else {
      high = power, more_high = more;
      if (side == -1) more_low /= 2;
      side = -1;
    }
  }
  return map;
}

void tilt(std::vector<Vec3>& normals, std::span<const Vec3> below, std::span<const Vec3> along,
          const TiltMap& map) {
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double height = glm::dot(normals[v], below[v]);
    if (!(height > kSteep)) continue;
    Vec3 slope = normals[v] / height - below[v];
    slope *= stretch(map, glm::dot(slope, slope));
    if (map.leans()) {
      const Vec3 x = along[v] - below[v] * glm::dot(along[v], below[v]);
      const double length = glm::length(x);
      if (length > 0) {
        const Vec3 u = x / length, w = glm::cross(below[v], u);
        const Vec2 all = leant(map, Vec2(glm::dot(slope, u), glm::dot(slope, w)));
        slope = all.x * u + all.y * w;
      }
    }
    normals[v] = glm::normalize(below[v] + slope);
  }
}

std::vector<char> below_diagonals(const geometry::Mesh& mesh) {
  std::vector<char> lower;
  lower.reserve(mesh.triangles.size());
  // Sampler::add_grid()
  for (const geometry::Triangle& t : mesh.triangles) lower.push_back(t[1] == t[0] + 1 ? 1 : 0);
  return lower;
}

namespace {

// Of the facets of either kind around each corner's vertex, by area: sums of their normals.
struct KindNormals {
  KindNormals(const geometry::Mesh& mesh, std::span<const char> lower)
      : sums{std::vector<Vec3>(mesh.positions.size()), std::vector<Vec3>(mesh.positions.size())} {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const geometry::Triangle& t = mesh.triangles[k];
      const Vec3 area = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                   mesh.positions[t[2]] - mesh.positions[t[0]]);
      for (const std::uint32_t v : t) sums[lower[k] != 0][v] += area;
    }
  }
  std::vector<Vec3> sums[2];
};

// Against the surface below; nothing where it is steep.
Vec3 slope_of(const Vec3& normal, const Vec3& below) {
  const double along = glm::dot(normal, below);
  return along > kSteep * glm::length(normal) ? normal / along - below : Vec3(0);
}

}  // namespace

void set_apart(geometry::Mesh& mesh, std::vector<Vec3>& below, const geometry::Mesh& surface,
               std::span<const char> lower, double apart) {
  const KindNormals kinds(mesh, lower), flat(surface, lower);
  // note: the surface's vertices need not be copied where the mesh's are
  std::vector<std::uint32_t> on_surface(mesh.positions.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) on_surface[mesh.triangles[k][i]] = surface.triangles[k][i];
  const std::size_t count = mesh.positions.size();
  std::vector<std::uint32_t> other(count);  // of the kind above diagonals
  std::vector<Vec3> normals = mesh.normals;
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3 own = slope_of(mesh.normals[v], below[v]);
    const auto moved = [&](std::size_t kind) {
      const Vec3 off = slope_of(kinds.sums[kind][v], below[v]) - own -
                       slope_of(flat.sums[kind][on_surface[v]], below[v]);
      const bool lies = glm::dot(mesh.normals[v], below[v]) > kSteep;
      return lies ? glm::normalize(below[v] + own + apart * off) : mesh.normals[v];
    };
    const bool has[2] = {kinds.sums[0][v] != Vec3(0), kinds.sums[1][v] != Vec3(0)};
    if (has[1]) normals[v] = moved(1);
    other[v] = static_cast<std::uint32_t>(has[1] ? mesh.positions.size() : v);
    if (!has[0]) continue;
    if (!has[1]) {
      normals[v] = moved(0);
      continue;
    }
    mesh.positions.push_back(Vec3(mesh.positions[v]));
    if (!mesh.texcoords.empty()) mesh.texcoords.push_back(Vec2(mesh.texcoords[v]));
    normals.push_back(moved(0));
    below.push_back(Vec3(below[v]));
  }
  mesh.normals = std::move(normals);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    if (lower[k] == 0)
      for (std::uint32_t& v : mesh.triangles[k]) v = other[v];
}

std::vector<Vec3> along_sheet(const geometry::Mesh& mesh, const geometry::Mesh& surface,
                              std::span<const char> lower) {
  std::vector<Vec3> out(mesh.normals.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const geometry::Triangle& t = surface.triangles[k];
    // a, b, c below the diagonal of a cell, a, c, d above it
    const Vec3 edge = lower[k] != 0 ? surface.positions[t[1]] - surface.positions[t[0]]
                                    : surface.positions[t[1]] - surface.positions[t[2]];
    for (const std::uint32_t v : mesh.triangles[k]) out[v] += edge;
  }
  return out;
}

Moments moments_of(const geometry::Mesh& mesh, const Vec2& side) {
  struct Square {
    Vec2 sum{0};
    double squares = 0, count = 0;
  };
  AxisRectangle bounds;
  for (const Vec3& p : mesh.positions) bounds.add(Vec2(p));
  const auto& [low, high] = bounds;
  const auto columns = static_cast<std::size_t>((high.x - low.x) / side.x + 2);
  const auto rows = static_cast<std::size_t>((high.y - low.y) / side.y + 2);
  std::vector<Square> squares[2];
  for (auto& one : squares) one.resize(columns * rows);
  Square all;
  for (const geometry::Triangle& t : mesh.triangles) {
    Vec2 slopes[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& n = mesh.normals[t[i]];
      slopes[i] = Vec2(-n.x, -n.y) / n.z;
    }
    for (const Vec3& place : places()) {
      Vec2 at(0), slope(0);
      for (int i = 0; i < 3; ++i) {
        at += place[i] * Vec2(mesh.positions[t[static_cast<std::size_t>(i)]]);
        slope += place[i] * slopes[i];
      }
      const auto add = [&](Square& to) {
        to.sum += slope;
        to.squares += glm::dot(slope, slope);
        to.count += 1;
      };
      add(all);
      for (int k = 0; k < 2; ++k) {
        const Vec2 cell = (at - low) / side + 0.5 * k;
        const auto i = std::min(static_cast<std::size_t>(cell.x), columns - 1),
                   j = std::min(static_cast<std::size_t>(cell.y), rows - 1);
        add(squares[k][j * columns + i]);
      }
    }
  }
  if (!(all.count > 0)) return {};
  Moments out{all.squares / all.count - glm::dot(all.sum, all.sum) / (all.count * all.count), 0};
  for (const auto& half : squares)
    for (const Square& one : half)
      if (one.count > 0) out.within += one.squares - glm::dot(one.sum, one.sum) / one.count;
  out.within /= 2 * all.count;
  return out;
}

std::vector<Vec3> normals_below(const geometry::Mesh& mesh, const geometry::Mesh& surface) {
  std::vector<Vec3> out(mesh.normals.size(), Vec3(0, 0, 1));
  for (std::size_t k = mesh.triangles.size(); k-- > 0;)
    for (std::size_t i = 0; i < 3; ++i)
      out[mesh.triangles[k][i]] = surface.normals[surface.triangles[k][i]];
  return out;
}

}  // namespace panwright::mli
