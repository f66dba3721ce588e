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

double place_of(int texel, int side) { return (2 * texel + 1.0) / side - 1; }

// Directions of a grid's texels, and their solid angles.
struct ShineDirections {
  explicit ShineDirections(int side) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Vec3 at = light::octahedron_direction({place_of(x, side), place_of(y, side)});
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

// A part's light in the texels around it.
void add_part(const light::ShinePart& part, const ShineDirections& directions, ShineGrid& grid) {
  around(light::octahedron_place(part.direction), grid.side, [&](int x, int y, double share) {
    Vec3& texel = const_cast<Vec3&>(continued(grid, x, y));
    const auto index = static_cast<std::size_t>(&texel - grid.values.data());
    texel += part.irradiance * (share / directions.solid[index]);
  });
}

// The radiance itself, by the mean of 2×2 directions of a texel. Small bodies have all of their
// light in the texels around them.
ShineGrid sharp_radiance(const Sky& sky, const Vec3& point, const light::GroundShine* ground) {
  constexpr double kSmall = 6 * kDegree;
  ShineGrid grid(ShineTable::kSide);
  const ShineDirections directions(grid.side);
  const auto hidden = [&](const Vec3& direction) {
    return ground != nullptr && ground->hides(direction);
  };
  if (ground != nullptr && ground->radiance.empty())
    for (const light::ShinePart& part : ground->parts) add_part(part, directions, grid);
  else if (ground != nullptr)
    grid.values = ground->radiance;
  std::vector<ShineBody> large;
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const Vec3 toward = sky.shape(i).centre - point;
    const double distance = glm::length(toward);
    const Vec3& radii = sky.body(i).radii;
    const double sine = std::max({radii.x, radii.y, radii.z}) / std::max(distance, 1e-300);
    if (sine < std::sin(kSmall)) {
      for_parts(sky, i, point, {12, 24}, [&](const light::ShinePart& part) {
        if (!hidden(part.direction)) add_part(part, directions, grid);
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
        const Vec3 direction = glm::normalize(light::octahedron_direction({u, v}));
        if (!hidden(direction))
          grid.at(x, y) += 0.25 * radiance_along(sky, large, direction, kFootprint);
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

// Weights of a blur on the sphere by a Gaussian, exp((cos − 1)/σ²), from a grid to one of half the
// table's side.
struct BlurWeights {
  BlurWeights(int side, double sigma) {
    constexpr double kLeast = 1e-4;  // weights below change nothing
    const ShineDirections directions(side), out(ShineTable::kSide / 2);
    const double scale = 1 / (sigma * sigma);
    const double furthest = 1 + det::log(kLeast) / scale;
    for (const Vec3& to : out.unit) {
      double sum = 0;
      for (std::size_t j = 0; j < directions.unit.size(); ++j) {
        const double cosine = glm::dot(to, directions.unit[j]);
        if (cosine < furthest) continue;
        const double weight = directions.solid[j] * det::exp((cosine - 1) * scale);
        sum += weight;
        from.push_back(static_cast<std::uint16_t>(j));
        weights.push_back(weight);
      }
      ends.push_back(from.size());
      sums.push_back(sum);
    }
  }
  // Those of a layer, from the one before; 6 MB together, made once.
  static const BlurWeights& of_layer(int layer) {
    constexpr int kSide = ShineTable::kSide;
    static const BlurWeights all[] = {between(0, kSide / 2), between(1, kSide / 4),
                                      between(2, kSide / 4)};
    return all[layer - 1];
  }

  std::vector<std::uint16_t> from;
  std::vector<double> weights;
  std::vector<std::size_t> ends;  // of each direction
  std::vector<double> sums;

 private:
  static BlurWeights between(int layer, int side) {
    const double width = kShineWidths[layer], wanted = kShineWidths[layer + 1];
    return BlurWeights(side, std::sqrt(wanted * wanted - width * width));
  }
};

ShineGrid blurred(const ShineGrid& grid, const BlurWeights& blur) {
  ShineGrid out(ShineTable::kSide / 2);
  std::size_t k = 0;
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    for (; k < blur.ends[i]; ++k) out.values[i] += blur.weights[k] * grid.values[blur.from[k]];
    out.values[i] /= blur.sums[i];
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

ShineTable shine_table(const Sky& sky, const Vec3& point, const light::GroundShine* ground) {
  ShineTable table;
  table.rgba.resize(std::size_t{4} * ShineTable::kLayers * ShineTable::kRow * ShineTable::kRow);
  ShineGrid radiance = sharp_radiance(sky, point, ground);
  store(radiance, 0, table);
  for (int k = 1; k < ShineTable::kLayers; ++k) {
    radiance = blurred(halved(radiance), BlurWeights::of_layer(k));
    store(radiance, k, table);
  }
  return table;
}

}  // namespace panwright::sky
