// Plots as SVG. The same bytes for the same numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace panwright::tools {

// Axes of a plot. A logarithmic y axis goes from 10^bottom to 10^top.
struct PlotAxes {
  std::string title, x_name, y_name;
  double left = 0, right = 1;
  double bottom = 0, top = 1;
  bool logarithmic = false;  // y
  double x_step = 0;         // between grid lines; 0: 1, 2 or 5 times a power of ten
};

// Plot with axes and curves, 640 by 420 pixels; values above or below are clamped to the frame.
class Plot {
 public:
  using Points = std::vector<std::pair<double, double>>;

  explicit Plot(PlotAxes axes);

  void curve(const Points& points, const char* color, const std::string& name);
  void dots(const Points& points, const char* color);
  // Returns the finished text.
  std::string finish();

 private:
  double px(double x) const;
  double py(double y) const;      // of a value as scaled() returns it
  double scaled(double y) const;  // decades on a logarithmic axis; within the frame
  void line(double xa, double ya, double xb, double yb, const char* color, int width);
  void label(double x, double y, const char* anchor, const std::string& words, int size = 12);

  PlotAxes axes_;
  int names_ = 0;
  std::string text_;
};

}  // namespace panwright::tools
