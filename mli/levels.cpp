#include "mli/levels.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "geometry/mesh/strip.h"

namespace panwright::mli {
namespace {

constexpr std::uint32_t kLeastFlat = 2, kLeastRound = 48;

// The smallest radius of a form, metres; 0: it is made of planes.
double radius_of(const Form& form, const Sheet& sheet) {
  const double width = sheet.spacing.x * (sheet.columns - 1);
  if (const auto* tube = std::get_if<Tube>(&form))
    return tube->radius > 0 ? tube->radius : width / (2 * kPi);
  if (const auto* cone = std::get_if<Cone>(&form)) return cone->radius;
  return 0;
}

}  // namespace

double height_error(const Sheet& fine, const Sheet& coarse) {
  const Vec2 size = fine.spacing * Vec2(fine.columns - 1, fine.rows - 1);
  const Vec2 cells(coarse.columns - 1, coarse.rows - 1);
  double most = 0;
  for (std::uint32_t j = 0; j < fine.rows; ++j)
    for (std::uint32_t i = 0; i < fine.columns; ++i) {
      const Vec2 at = Vec2(i, j) * fine.spacing / size * cells;
      const Vec2 low = glm::min(glm::floor(at), cells - 1.0);
      const Vec2 in = at - low;
      const auto column = static_cast<std::uint32_t>(low.x), row = static_cast<std::uint32_t>(low.y);
      const double a = coarse.at(column, row), d = coarse.at(column + 1, row + 1);
      // cut from (i, j) to (i + 1, j + 1)
      const double height = in.x >= in.y
                                ? a + in.x * (coarse.at(column + 1, row) - a) +
                                      in.y * (d - coarse.at(column + 1, row))
                                : a + in.y * (coarse.at(column, row + 1) - a) +
                                      in.x * (d - coarse.at(column, row + 1));
      most = std::max(most, std::fabs(fine.at(i, j) - height));
    }
  return most;
}

std::vector<Level> levels_of(const Sheet& sheet, const Form& form, double crease_angle,
                             double max_vertices, const Job& job) {
  std::vector<Level> levels;
  const std::uint32_t least = std::holds_alternative<Flat>(form) ? kLeastFlat : kLeastRound;
  const double radius = radius_of(form, sheet);
  double vertices = 0;
  for (std::uint32_t cells = (sheet.columns - 1) / 2; cells >= least; cells /= 2) {
    job.poll();
    const Sheet coarse = filtered(sheet, cells, job);
    vertices += static_cast<double>(coarse.heights.size());
    if (vertices > max_vertices) {
      vertices -= static_cast<double>(coarse.heights.size());
      continue;
    }
    DiagnosticLog log;  // what the finest sheet has to say has been said
    auto mesh = formed(coarse, form, log);
    if (!mesh) break;
    geometry::compute_normals(*mesh, crease_angle);
    Level& level = levels.emplace_back();
    level.mesh = *std::move(mesh);
    level.detail = coarse.spacing.x;
    level.error = height_error(sheet, coarse) +
                  (radius > 0 ? level.detail * level.detail / (8 * radius) : 0);
    level.removed = coarse.removed_slope_covariance;
  }
  return levels;
}

}  // namespace panwright::mli
