#include "sky/shine_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "sky/internal/disc_parts.h"

namespace panwright::sky {
namespace {

// Texels of an unfolded octahedron, row by row.
struct ShineGrid {
  explicit ShineGrid(int texels)
      : side(texels), values(static_cast<std::size_t>(texels) * static_cast<std::size_t>(texels)) {}
  Vec3& at(int x, int y) { return values[static_cast<std::size_t>(y * side + x)]; }
  const Vec3& at(int x, int y) const { return values[static_cast<std::size_t>(y * side + x)]; }

  int side;
  std::vector<Vec3> values;
};

// A place of the square, −1 to 1, on the octahedron.
Vec3 unfolded(double x, double y) {
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z >= 0) return {x, y, z};
  return {std::copysign(1 - std::fabs(y), x), std::copysign(1 - std::fabs(x), y), z};
}

Vec2 folded(const Vec3& direction) {
  const Vec3 d =
      direction / (std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z));
  if (d.z >= 0) return {d.x, d.y};
  return {std::copysign(1 - std::fabs(d.y), d.x), std::copysign(1 - std::fabs(d.x), d.y)};
}

double place_of(int texel, int side) { return (2 * texel + 1.0) / side - 1; }

// Directions of a grid's texels, and their solid angles.
struct ShineDirections {
  explicit ShineDirections(int side) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Vec3 at = unfolded(place_of(x, side), place_of(y, side));
        const double square = glm::dot(at, at);
        unit.push_back(at / std::sqrt(square));
        solid.push_back(4.0 / (side * side) / (square * std::sqrt(square)));
      }
  }
  std::vector<Vec3> unit;
  std::vector<double> solid;
};

// A texel beyond the border is one across the fold.
const Vec3& continued(const ShineGrid& grid, int x, int y) {
  const int last = grid.side - 1;
  if (x < 0 || x > last) {
    x = std::clamp(x, 0, last);
    y = last - y;
  }
  if (y < 0 || y > last) {
    y = std::clamp(y, 0, last);
    x = last - x;
  }
  return grid.at(x, y);
}

// The four texels around a place of the square and their shares: calls f(x, y, share).
template <class F>
void around(const Vec2& place, int side, const F& f) {
  const double x = (place.x + 1) * 0.5 * side - 0.5, y = (place.y + 1) * 0.5 * side - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  for (int k = 0; k < 4; ++k) {
    const double across = (k & 1) != 0 ? x - left : left + 1 - x;
    const double down = (k & 2) != 0 ? y - top : top + 1 - y;
    f(static_cast<int>(left) + (k & 1), static_cast<int>(top) + k / 2, across * down);
  }
}

// A body along a ray from a point; none: it passes.
struct ShineBody {
  std::size_t index;
  Vec3 from;       // in its own space
  double cosine;   // of directions that may meet it, at least
  Vec3 direction;  // to its centre
};

Vec3 radiance_along(const Sky& sky, const std::vector<ShineBody>& bodies, const Vec3& direction,
                    double footprint) {
  double nearest = INFINITY;
  Vec3 light(0);
  for (const ShineBody& body : bodies) {
    if (glm::dot(direction, body.direction) < body.cosine) continue;
    const Vec3 ray = sky.shape(body.index).unit_from_world * direction;
    const double way = way_to_sphere(body.from, ray);
    if (!(way < nearest)) continue;
    nearest = way;
    const light::Air* air = sky.air(body.index);
    const bool in_air = air != nullptr && glm::dot(body.from, body.from) < air->top() * air->top();
    light = sky.radiance(body.index, glm::normalize(body.from + way * ray), -direction, footprint,
                         in_air ? &body.from : nullptr);
  }
  if (nearest == INFINITY)
    for (const ShineBody& body : bodies)
      if (sky.air(body.index) != nullptr)
        light += sky.air_light(body.index, body.from, direction).light;
  return light;
}

// The radiance itself, by the mean of 2×2 directions of a texel. Small bodies have all of their
// light in the texels around them.
ShineGrid sharp_radiance(const Sky& sky, const Vec3& point) {
  constexpr double kSmall = 6 * kDegree;
  ShineGrid grid(ShineTable::kSide);
  const ShineDirections directions(grid.side);
  std::vector<ShineBody> large;
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const Vec3 toward = sky.shape(i).centre - point;
    const double distance = glm::length(toward);
    const Vec3& radii = sky.body(i).radii;
    const double sine = std::max({radii.x, radii.y, radii.z}) / std::max(distance, 1e-300);
    if (sine < std::sin(kSmall)) {
      for_parts(sky, i, point, {12, 24}, [&](const Part& part) {
        around(folded(part.direction), grid.side, [&](int x, int y, double share) {
          Vec3& texel = const_cast<Vec3&>(continued(grid, x, y));
          const auto index = static_cast<std::size_t>(&texel - grid.values.data());
          texel += part.irradiance * (share / directions.solid[index]);
        });
      });
      continue;
    }
    const Vec3 from = sky.shape(i).from(point);
    if (!(glm::dot(from, from) > 1)) continue;
    const double cosine = sine < 1 ? std::sqrt(1 - sine * sine) - 1e-6 : -1;
    large.push_back({i, from, cosine, toward / distance});
  }
  if (large.empty()) return grid;
  constexpr double kFootprint = 0.02;
  for (int y = 0; y < grid.side; ++y)
    for (int x = 0; x < grid.side; ++x)
      for (int k = 0; k < 4; ++k) {
        const double u = place_of(2 * x + (k & 1), 2 * grid.side);
        const double v = place_of(2 * y + k / 2, 2 * grid.side);
        grid.at(x, y) +=
            0.25 * radiance_along(sky, large, glm::normalize(unfolded(u, v)), kFootprint);
      }
  return grid;
}

ShineGrid halved(const ShineGrid& grid) {
  const ShineDirections directions(grid.side);
  ShineGrid out(grid.side / 2);
  for (int y = 0; y < out.side; ++y)
    for (int x = 0; x < out.side; ++x) {
      double solid = 0;
      for (int k = 0; k < 4; ++k) {
        const int from_x = 2 * x + (k & 1), from_y = 2 * y + k / 2;
        const double own = directions.solid[static_cast<std::size_t>(from_y * grid.side + from_x)];
        out.at(x, y) += own * grid.at(from_x, from_y);
        solid += own;
      }
      out.at(x, y) /= solid;
    }
  return out;
}

// The mean about each direction by a Gaussian on the sphere, exp((cos − 1)/σ²).
ShineGrid blurred(const ShineGrid& grid, double sigma, const ShineDirections& out_directions) {
  constexpr double kLeast = 1e-4;  // weights below change nothing
  const ShineDirections directions(grid.side);
  const double scale = 1 / (sigma * sigma);
  const double furthest = 1 + det::log(kLeast) / scale;
  ShineGrid out(static_cast<int>(std::lround(std::sqrt(double(out_directions.unit.size())))));
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < grid.values.size(); ++j) {
      const double cosine = glm::dot(out_directions.unit[i], directions.unit[j]);
      if (cosine < furthest) continue;
      const double weight = directions.solid[j] * det::exp((cosine - 1) * scale);
      sum += weight;
      out.values[i] += weight * grid.values[j];
    }
    out.values[i] /= sum;
  }
  return out;
}

Vec3 value_at(const ShineGrid& grid, double x, double y) {
  Vec3 value(0);
  around(Vec2(x, y), grid.side,
         [&](int column, int row, double share) { value += share * continued(grid, column, row); });
  return value;
}

void store(const ShineGrid& grid, int layer, ShineTable& table) {
  float* to = table.rgba.data() + std::ptrdiff_t{4} * layer * ShineTable::kRow * ShineTable::kRow;
  ShineGrid whole(ShineTable::kSide);
  for (int y = 0; y < whole.side; ++y)
    for (int x = 0; x < whole.side; ++x)
      whole.at(x, y) = grid.side == whole.side
                           ? grid.at(x, y)
                           : value_at(grid, place_of(x, whole.side), place_of(y, whole.side));
  for (int y = -1; y <= whole.side; ++y)
    for (int x = -1; x <= whole.side; ++x, to += 4) {
      const Vec3& value = continued(whole, x, y);
      for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(value[k]);
    }
}

}  // namespace

ShineTable shine_table(const Sky& sky, const Vec3& point) {
  ShineTable table;
  table.rgba.resize(std::size_t{4} * ShineTable::kLayers * ShineTable::kRow * ShineTable::kRow);
  const ShineDirections half(ShineTable::kSide / 2);
  ShineGrid radiance = sharp_radiance(sky, point);
  store(radiance, 0, table);
  double width = 0;
  for (int k = 1; k < ShineTable::kLayers; ++k) {
    const double wanted = kShineWidths[k];
    radiance = blurred(halved(radiance), std::sqrt(wanted * wanted - width * width), half);
    store(radiance, k, table);
    width = wanted;
  }
  return table;
}

}  // namespace panwright::sky
