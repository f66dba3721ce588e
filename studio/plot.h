// Curves in the window.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"

namespace panwright::studio {

struct Curve {
  std::string name;  // empty: not in the legend
  const std::vector<Vec2>* points = nullptr;
  int color = 0;  // 0 to 3, suited to colour blindness
  bool faint = false;
};

struct Axes {
  std::string title;
  std::string x_name;
  double left = 0, right = 1;
  std::vector<double> x_ticks;
  double bottom = 0, top = 1;
  bool logarithmic = false;  // y: bottom and top above 0
};

// Draws curves over the full width of the open window; the mouse shows their values.
void plot(const Axes& axes, const std::vector<Curve>& curves);

}  // namespace panwright::studio
