// What hands and needles make: emboss, seam, button.
#include <cmath>

#include "base/math.h"
#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

// Calls body(x, y, height) for each vertex.
template <class Body>
void for_vertices(const Grid& grid, const Job& job, const Body& body) {
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    for (std::size_t j = first; j < end; ++j)
      for (std::size_t i = 0; i < grid.columns; ++i)
        body(static_cast<double>(i) * grid.cell, static_cast<double>(j) * grid.cell,
             grid.row(j)[i]);
  });
}

constexpr double kFolds = 5;  // half widths that they reach from a seam

double fraction(double x) { return x - std::floor(x); }

}  // namespace

void apply(const Emboss& emboss, const Grid& grid, const Job& job) {
  const double cx = grid.width() / 2, cy = grid.height() / 2;
  for_vertices(grid, job, [&](double x, double y, double& h) {
    const double dx = (x - cx) / emboss.pitch, dy = (y - cy) / emboss.pitch;
    if (emboss.pattern == Pattern::quilt) {
      const double s = fraction(dx + 0.5), t = fraction(dy + 0.5);
      h += emboss.depth * 16 * (s * (1 - s)) * (t * (1 - t));
    } else {
      const double s = fraction((dx + dy) * std::sqrt(0.5) + 0.5);
      const double t = fraction((dx - dy) * std::sqrt(0.5) + 0.5);
      h += emboss.depth * (1 - std::max(std::fabs(2 * s - 1), std::fabs(2 * t - 1)));
    }
  });
}

void apply(const Seam& seam, const Grid& grid, const Job& job) {
  // of a fold between stitches: up and down in turn, each of its own height
  const auto fold = [&](double number) {
    const auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(number));
    const auto words =
        grid.words(static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32));
    const double size = 0.4 + 0.6 * in_unit(words[0]);
    return bits % 2 == 0 ? size : -size;
  };
  for_vertices(grid, job, [&](double x, double y, double& h) {
    const double across = std::fabs((seam.along_x ? y : x) - seam.position) * 2 / seam.width;
    // flat to 0.6 of the half width
    h += seam.height * smooth_step((1 - across) / 0.4);
    if (seam.stitch > 0 && across < kFolds) {
      const double along = 2 * (seam.along_x ? x : y) / seam.stitch;
      const double number = std::floor(along), t = along - number;
      const double fade = 2 * across / (1 + across * across);  // 1 at the border
      h += seam.pucker * ((1 - t) * fold(number) + t * fold(number + 1)) * (fade * fade) *
           smooth_step(1 - across / kFolds);
    }
  });
}

void apply(const Button& button, const Grid& grid, const Job& job) {
  // whole pitches between the outermost, which lie half a pitch from the edges or nearer
  const double nx = std::max(1.0, std::floor(grid.width() / button.pitch + 1e-9));
  const double ny = std::max(1.0, std::floor(grid.height() / button.pitch + 1e-9));
  const double x0 = (grid.width() - (nx - 1) * button.pitch) / 2;
  const double y0 = (grid.height() - (ny - 1) * button.pitch) / 2;
  for_vertices(grid, job, [&](double x, double y, double& h) {
    const double i = std::min(nx - 1, std::max(0.0, std::floor((x - x0) / button.pitch + 0.5)));
    const double j = std::min(ny - 1, std::max(0.0, std::floor((y - y0) / button.pitch + 0.5)));
    const double dx = x - (x0 + i * button.pitch), dy = y - (y0 + j * button.pitch);
    const double r = std::sqrt(dx * dx + dy * dy);
    const double t = (r - button.radius) / (button.reach - button.radius);
    h *= smooth_step(t);
    if (!(t > 0 && t < 1)) return;
    // cos(nφ + ψ) and cos((n + 3)φ + χ): five to eight puckers a button, and more
    const auto words = grid.words(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
    const std::uint32_t few = 5 + words[2] % 4;
    double re = 1, im = 0, puckers = 0;
    for (std::uint32_t n = 1; n <= few + 3; ++n) {
      const double next = (re * dx - im * dy) / r;
      im = (re * dy + im * dx) / r;
      re = next;
      if (n != few && n != few + 3) continue;
      const auto turned = det::sincos(2 * kPi * in_unit(words[n == few ? 0 : 1]));
      puckers += (re * turned.cos - im * turned.sin) / 2;
    }
    h += button.pucker * puckers * (6.75 * t * (1 - t) * (1 - t));  // most at a third of the way
  });
}

}  // namespace panwright::mli
