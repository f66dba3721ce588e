// What forms share.
#pragma once

#include <string_view>

#include "mli/form.h"

namespace panwright::mli {

struct Sampler {
  const Sheet& sheet;

  // The height at a place, linear along x, then y; at the nearest edge outside.
  double at(double x, double y) const;
  Vec2 size() const;  // metres

  // Two triangles for each cell of a grid of vertices, counter-clockwise where y is left of x.
  static void add_grid(geometry::Mesh& mesh, std::size_t first, std::size_t columns,
                       std::size_t rows);
};

// Says what is wrong with a form; true: nothing.
struct FormProblems {
  DiagnosticLog& log;
  SourceSpan where;

  bool length(std::string_view what, double value, bool zero);
  bool fits(const Vec2& needed, const Vec2& sheet);
  bool vertices(double count);
  // height: of what has no room; room: the least there is
  void folded(std::size_t triangles, std::size_t all, double height, double room);
};

// Tube, Cone and Disc.
Result<geometry::Mesh> revolved(const Sheet& sheet, const Form& form, FormProblems& problems);

}  // namespace panwright::mli
