// Shared parts of forms.
#pragma once

#include <string_view>

#include "mli/form.h"

namespace panwright::mli {

struct Sampler {
  const Sheet& sheet;

  // Returns the height at a place, linear along x, then y; at the nearest edge outside.
  double at(double x, double y) const;
  Vec2 size() const;  // metres

  // Adds two triangles for each cell of a grid of vertices, counter-clockwise if y is left of x.
  static void add_grid(geometry::Mesh& mesh, std::size_t first, std::size_t columns,
                       std::size_t rows);
};

// Reporter of a form's problems; true: none.
struct FormProblems {
  DiagnosticLog& log;
  SourceSpan where;

  bool length(std::string_view what, double value, bool zero);
  bool fits(const Vec2& needed, const Vec2& sheet);
  bool vertices(double count);
  // height: of the part without room; room: the least available
  void folded(std::size_t triangles, std::size_t all, double height, double room);
};

// Makes Tube, Cone and Disc.
Result<geometry::Mesh> revolved(const Sheet& sheet, const Form& form, FormProblems& problems);

}  // namespace panwright::mli
