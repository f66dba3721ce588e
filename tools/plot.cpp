#include "tools/plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/source.h"
#include "base/text.h"

namespace panwright::tools {
namespace {

constexpr double kPlotLeft = 70, kPlotRight = 620, kPlotTop = 40, kPlotBottom = 370;  // pixels

std::string svg_text(const std::string& words) {
  return markup_escaped(to_utf8(words, Encoding::utf8));
}

// 1, 2 or 5 times a power of ten: the largest that fits `least` times and more into `range`.
double tick_step(double range, int least) {
  double step = det::exp(det::log(10.0) * std::floor(det::log10(range / least)));
  for (const double factor : {5.0, 2.0})
    if (factor * step * least <= range) return factor * step;
  return step;
}

}  // namespace

Plot::Plot(PlotAxes axes) : axes_(std::move(axes)) {
  text_ =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"420\" "
      "viewBox=\"0 0 640 420\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"640\" height=\"420\" fill=\"white\"/>\n";
  label(kPlotLeft, 24, "start", axes_.title, 15);
  label((kPlotLeft + kPlotRight) / 2, 408, "middle", axes_.x_name);
  text_ += fmt::format(
      "<text transform=\"translate(16,{:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kPlotTop + kPlotBottom) / 2, svg_text(axes_.y_name));
  const double x_step = axes_.x_step > 0 ? axes_.x_step : tick_step(axes_.right - axes_.left, 5);
  for (double k = std::ceil(axes_.left / x_step); k * x_step <= axes_.right; ++k) {
    const double x = px(k * x_step);
    line(x, kPlotTop, x, kPlotBottom, "#ddd", 1);
    label(x, kPlotBottom + 16, "middle", fmt::format("{:.6g}", k * x_step));
  }
  const double y_step = axes_.logarithmic ? 1 : tick_step(axes_.top - axes_.bottom, 4);
  for (double k = std::ceil(axes_.bottom / y_step); k * y_step <= axes_.top; ++k) {
    const double y = py(k * y_step);
    line(kPlotLeft, y, kPlotRight, y, "#ddd", 1);
    label(kPlotLeft - 6, y + 4, "end",
          fmt::format(fmt::runtime(axes_.logarithmic ? "1e{:.0f}" : "{:.6g}"), k * y_step));
  }
}

void Plot::curve(const Points& points, const char* color, const std::string& name) {
  text_ += fmt::format("<polyline fill=\"none\" stroke-width=\"2\" stroke=\"{}\" points=\"", color);
  for (const auto& [x, y] : points) text_ += fmt::format("{:.2f},{:.2f} ", px(x), py(scaled(y)));
  text_ += "\"/>\n";
  const double at = kPlotTop + 16 + 16 * names_++;
  line(kPlotRight - 92, at - 4, kPlotRight - 72, at - 4, color, 2);
  label(kPlotRight - 66, at, "start", name);
}

void Plot::dots(const Points& points, const char* color) {
  for (const auto& [x, y] : points)
    text_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2\" fill=\"{}\"/>\n", px(x),
                         py(scaled(y)), color);
}

std::string Plot::finish() {
  text_ += fmt::format(
      "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" fill=\"none\" "
      "stroke=\"#444\"/>\n</svg>\n",
      kPlotLeft, kPlotTop, kPlotRight - kPlotLeft, kPlotBottom - kPlotTop);
  return std::move(text_);
}

double Plot::px(double x) const {
  return kPlotLeft + (x - axes_.left) / (axes_.right - axes_.left) * (kPlotRight - kPlotLeft);
}

double Plot::py(double y) const {
  return kPlotBottom - (y - axes_.bottom) / (axes_.top - axes_.bottom) * (kPlotBottom - kPlotTop);
}

double Plot::scaled(double y) const {
  if (axes_.logarithmic) y = y > 0 ? det::log10(y) : axes_.bottom;
  return std::clamp(y, axes_.bottom, axes_.top);
}

void Plot::line(double xa, double ya, double xb, double yb, const char* color, int width) {
  text_ += fmt::format(
      "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" "
      "stroke-width=\"{}\"/>\n",
      xa, ya, xb, yb, color, width);
}

void Plot::label(double x, double y, const char* anchor, const std::string& words, int size) {
  text_ +=
      fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{}\">{}</text>\n",
                  x, y, anchor, size, svg_text(words));
}

}  // namespace panwright::tools
