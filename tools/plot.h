// Plots as SVG. The same bytes for the same numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace panwright::tools {

// Plot with axes and curves. Data coordinates x0..x1, y0..y1 over a fixed area of 640 by 420
// pixels; values above or below are clamped to the frame.
class Plot {
 public:
  using Points = std::vector<std::pair<double, double>>;

  Plot(const std::string& title, const std::string& x_label, const std::string& y_label, double x0,
       double x1, double y0, double y1);

  void x_tick(double x, const std::string& words);
  void y_tick(double y, const std::string& words);
  void curve(const Points& points, const char* color, const std::string& name);
  void dots(const Points& points, const char* color);
  // Returns the finished text.
  std::string finish();

 private:
  static constexpr double kLeft = 70, kRight = 620, kTop = 40, kBottom = 370;

  double px(double x) const { return kLeft + (x - x0_) / (x1_ - x0_) * (kRight - kLeft); }
  double py(double y) const { return kBottom - (y - y0_) / (y1_ - y0_) * (kBottom - kTop); }
  void line(double xa, double ya, double xb, double yb, const char* color, int width);
  void label(double x, double y, const char* anchor, const std::string& words, int size = 12);

  double x0_, x1_, y0_, y1_;
  int names_ = 0;
  std::string text_;
};

}  // namespace panwright::tools
