#include "sky/planetshine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace panwright::sky {
namespace {

// A part of a disc: its direction, and its irradiance on a plane that faces it.
struct Part {
  Vec3 direction;  // unit
  Vec3 irradiance;
  double flux = 0;  // the sum over the bands
};

Vec3 perpendicular(const Vec3& axis) {
  const Vec3 other = std::fabs(axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  return glm::normalize(glm::cross(axis, other));
}

struct PartAxes {
  Vec3 x, y, z;
};

// Calls f(part) for the lit parts of a body's air beside its disc.
template <class F>
void for_air(const Sky& sky, std::size_t index, const Vec3& from, const PartAxes& axes,
             const CapGrid& grid, const F& f) {
  const light::Air* air = sky.air(index);
  if (air == nullptr) return;
  const Ellipsoid& shape = sky.shape(index);
  const double distance = std::sqrt(glm::dot(from, from));
  // cosines of the ground's limb and of the air's; within the air all of the sky
  const auto cosine_of = [&](double r) {
    return std::sqrt(std::max(0.0, (distance - r) * (distance + r))) / distance;
  };
  const bool outside = distance > air->top();
  const double low = outside ? cosine_of(air->top()) : -1, high = cosine_of(1);
  const int rings = outside ? 1 + grid.rings / 8 : grid.rings;
  const double solid = 2 * kPi * (high - low) / rings / grid.sectors;
  for (int ring = 0; ring < rings; ++ring) {
    // closer to each other at the ground
    const double t = (ring + 0.5) / rings, along = high - (high - low) * t * t;
    const double across = std::sqrt(std::max(0.0, (1 - along) * (1 + along)));
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / grid.sectors);
      const Vec3 ray = along * axes.z + across * (turn.cos * axes.x + turn.sin * axes.y);
      const Vec3 toward = shape.world_from_unit * ray;
      const double stretch = std::sqrt(glm::dot(toward, toward));
      const Vec3 light = sky.air_light(index, from, toward).light *
                         (2 * t * solid * shape.volume / (stretch * stretch * stretch));
      const double flux = light.x + light.y + light.z;
      if (flux > 0) f(Part{toward / stretch, light, flux});
    }
  }
}

// Calls f(part) for the lit parts of a body's disc. Solid angles of the ellipsoid's space become
// those of the world by the map's determinant.
template <class F>
void for_parts(const Sky& sky, std::size_t index, const Vec3& point, const CapGrid& grid,
               const F& f) {
  const Ellipsoid& shape = sky.shape(index);
  const Vec3 from = shape.from(point);
  const double distance = std::sqrt(glm::dot(from, from));
  if (!(distance > 1)) return;
  const Vec3 axis = -from / distance;
  const Vec3 x = perpendicular(axis), y = glm::cross(axis, x);
  for_air(sky, index, from, {x, y, axis}, grid, f);
  const bool in_air = sky.air(index) && distance < sky.air(index)->top();
  const double cosine = std::sqrt((distance - 1) * (distance + 1)) / distance;
  const double height = 1 / (distance * distance) / (1 + cosine);  // 1 − cos of the disc's radius
  const double solid = 2 * kPi * height / grid.rings / grid.sectors;
  const double footprint = std::sqrt(4 * kPi / grid.rings / grid.sectors) * 0.5;
  for (int ring = 0; ring < grid.rings; ++ring) {
    const double h = height * (ring + 0.5) / grid.rings;
    const double across = std::sqrt(h * (2 - h)), along = 1 - h;
    const double beside = distance * across;
    const double way = distance * along - std::sqrt(std::max(0.0, (1 - beside) * (1 + beside)));
    for (int sector = 0; sector < grid.sectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / grid.sectors);
      const Vec3 ray = along * axis + across * (turn.cos * x + turn.sin * y);
      const Vec3 place = glm::normalize(from + way * ray);
      const Vec3 toward = shape.world_from_unit * ray;
      const double stretch = std::sqrt(glm::dot(toward, toward));
      const Vec3 direction = toward / stretch;
      const Vec3 light =
          sky.radiance(index, place, -direction, footprint, in_air ? &from : nullptr) *
          (solid * shape.volume / (stretch * stretch * stretch));
      const double flux = light.x + light.y + light.z;
      if (flux > 0) f(Part{direction, light, flux});
    }
  }
}

// Parts [begin, end) that one light stands for.
struct Cell {
  std::size_t begin, end;
  double flux = 0;
  Vec3 axis{0};      // along which it is widest, unit
  double error = 0;  // flux times the square of its size
};

// Sum of a cell: its light, with the second moment of a disc.
materials::Incidence light_of(const Cell& cell, const std::vector<Part>& parts) {
  Vec3 toward(0), total(0);
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    toward += parts[i].flux * parts[i].direction;
    total += parts[i].irradiance;
  }
  const double length = std::sqrt(glm::dot(toward, toward));
  materials::Incidence light;
  light.to_light = toward / length;
  // what a plate that sees all of it gets
  light.irradiance = total * (length / cell.flux);
  double moment = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const Vec3 offset = parts[i].direction - light.to_light;
    moment += parts[i].flux * glm::dot(offset, offset);
  }
  // of a disc of radius r the mean square is r²/2
  light.alpha2 = moment / cell.flux / 4;
  return light;
}

void measure(Cell& cell, const std::vector<Part>& parts) {
  Vec3 middle(0);
  cell.flux = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    middle += parts[i].flux * parts[i].direction;
    cell.flux += parts[i].flux;
  }
  middle /= cell.flux;
  const Vec3 x = perpendicular(middle), y = glm::normalize(glm::cross(middle, x));
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const Vec3 offset = parts[i].direction - middle;
    const double a = glm::dot(offset, x), b = glm::dot(offset, y);
    xx += parts[i].flux * a * a;
    xy += parts[i].flux * a * b;
    yy += parts[i].flux * b * b;
  }
  const double turn = 0.5 * det::atan2(2 * xy, xx - yy);
  const det::SinCos t = det::sincos(turn);
  cell.axis = t.cos * x + t.sin * y;
  cell.error = xx + yy;
}

// Splits a cell at half its flux, across its longest axis.
Cell split(Cell& cell, std::vector<Part>& parts) {
  const auto first = parts.begin() + static_cast<std::ptrdiff_t>(cell.begin);
  const auto last = parts.begin() + static_cast<std::ptrdiff_t>(cell.end);
  std::stable_sort(first, last, [&](const Part& a, const Part& b) {
    return glm::dot(a.direction, cell.axis) < glm::dot(b.direction, cell.axis);
  });
  double sum = 0;
  std::size_t middle = cell.begin;
  while (middle + 1 < cell.end && sum + 0.5 * parts[middle].flux < 0.5 * cell.flux)
    sum += parts[middle++].flux;
  middle = std::max(middle, cell.begin + 1);
  Cell other{middle, cell.end};
  cell.end = middle;
  measure(cell, parts);
  measure(other, parts);
  return other;
}

}  // namespace

Vec3 irradiance(const Sky& sky, const Vec3& point, const Vec3& normal, const CapGrid& grid) {
  Vec3 sum(0);
  for (std::size_t i = 0; i < sky.size(); ++i)
    for_parts(sky, i, point, grid, [&](const Part& part) {
      sum += part.irradiance * std::max(0.0, glm::dot(normal, part.direction));
    });
  return sum;
}

std::vector<materials::Incidence> planet_lights(const Sky& sky, const Vec3& point,
                                                std::size_t count) {
  constexpr double kSmall = kDegree;
  constexpr double kNothing = 1e-9;  // of the Sun's irradiance, that no image shows
  std::vector<Part> parts;
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < sky.size(); ++i) {
    Cell cell{parts.size(), 0};
    for_parts(sky, i, point, {48, 96}, [&](const Part& part) { parts.push_back(part); });
    cell.end = parts.size();
    if (cell.begin == cell.end) continue;
    measure(cell, parts);
    const Vec3& sun = sky.irradiance();
    if (!(cell.flux > kNothing * (sun.x + sun.y + sun.z))) continue;
    cells.push_back(cell);
  }
  while (!cells.empty() && cells.size() < count) {
    Cell* worst = nullptr;
    for (Cell& cell : cells) {
      const bool splits = cell.end - cell.begin > 1 && cell.error > kSmall * kSmall / 4 * cell.flux;
      if (splits && (worst == nullptr || cell.flux > worst->flux)) worst = &cell;
    }
    if (worst == nullptr) break;
    cells.push_back(split(*worst, parts));
  }
  std::ranges::stable_sort(cells, std::ranges::greater(), &Cell::flux);
  if (cells.size() > count) cells.resize(count);
  std::vector<materials::Incidence> lights;
  for (const Cell& cell : cells) lights.push_back(light_of(cell, parts));
  return lights;
}

}  // namespace panwright::sky
