// Plots as SVG. The same bytes for the same numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace panwright::tools {

using PlotPoints = std::vector<std::pair<double, double>>;

struct PlotCurve {
  PlotPoints points;
  const char* color = "";
  std::string name;  // in the legend
  PlotPoints dots = {};
};

struct Plot {
  std::string title = {}, x_name = {}, y_name = {};
  double left = 0, right = 1;
  double bottom = 0, top = 1;
  bool logarithmic = false;  // y: from 10^bottom to 10^top
  double x_step = 0;         // between grid lines; 0: 1, 2 or 5 times a power of ten
  std::vector<PlotCurve> curves = {};
};

// Returns an image of 640 by 420 pixels; values above or below are clamped to the frame.
std::string svg_of(const Plot& plot);

}  // namespace panwright::tools
