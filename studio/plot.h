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
  int color = 0;    // of four that colour-blind people tell apart
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

// Draws them in the window that is open, as wide as there is room. Under the mouse: the values there.
void plot(const Axes& axes, const std::vector<Curve>& curves);

}  // namespace panwright::studio
