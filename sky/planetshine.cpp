#include "sky/planetshine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sky/internal/disc_parts.h"

namespace panwright::sky {
namespace {

// Parts [begin, end) that one light stands for.
struct Cell {
  std::size_t begin, end;
  double flux = 0;
  Vec3 axis{0};      // along which it is widest, unit
  double error = 0;  // flux times the square of its size
};

// Sum of a cell: its light, with the second moment of a disc.
materials::Incidence light_of(const Cell& cell, const std::vector<light::ShinePart>& parts) {
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

void measure(Cell& cell, const std::vector<light::ShinePart>& parts) {
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
Cell split(Cell& cell, std::vector<light::ShinePart>& parts) {
  const auto first = parts.begin() + static_cast<std::ptrdiff_t>(cell.begin);
  const auto last = parts.begin() + static_cast<std::ptrdiff_t>(cell.end);
  std::stable_sort(first, last, [&](const light::ShinePart& a, const light::ShinePart& b) {
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
    for_parts(sky, i, point, grid, [&](const light::ShinePart& part) {
      sum += part.irradiance * std::max(0.0, glm::dot(normal, part.direction));
    });
  return sum;
}

std::vector<materials::Incidence> planet_lights(const Sky& sky, const Vec3& point,
                                                std::size_t count,
                                                const light::GroundShine* ground) {
  constexpr double kSmall = kDegree;
  constexpr double kNothing = 1e-9;  // of the Sun's irradiance, that no image shows
  std::vector<light::ShinePart> parts;
  std::vector<Cell> cells;
  const auto add_cell = [&](std::size_t begin) {
    Cell cell{begin, parts.size()};
    if (cell.begin == cell.end) return;
    measure(cell, parts);
    const Vec3& sun = sky.irradiance();
    if (cell.flux > kNothing * (sun.x + sun.y + sun.z)) cells.push_back(cell);
  };
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const std::size_t begin = parts.size();
    for_parts(sky, i, point, {48, 96}, [&](const light::ShinePart& part) {
      if (ground == nullptr || !ground->hides(part.direction)) parts.push_back(part);
    });
    add_cell(begin);
  }
  if (ground != nullptr) {
    const std::size_t begin = parts.size();
    parts.insert(parts.end(), ground->parts.begin(), ground->parts.end());
    add_cell(begin);
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
