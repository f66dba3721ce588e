#include "tools/plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/math.h"
#include "base/source.h"
#include "base/text.h"

namespace panwright::tools {
namespace {

// 1, 2 or 5 times a power of ten: the largest that fits `least` times and more into `range`.
double tick_step(double range, int least) {
  double step = det::exp(det::log(10.0) * std::floor(det::log10(range / least)));
  for (const double factor : {5.0, 2.0})
    if (factor * step * least <= range) return factor * step;
  return step;
}

}  // namespace

std::string svg_of(const Plot& plot) {
  constexpr double kLeft = 70, kRight = 620, kTop = 40, kBottom = 370;  // pixels
  const auto px = [&](double x) {
    return kLeft + (x - plot.left) / (plot.right - plot.left) * (kRight - kLeft);
  };
  const auto grid_py = [&](double y) {
    return kBottom - (y - plot.bottom) / (plot.top - plot.bottom) * (kBottom - kTop);
  };
  const auto py = [&](double y) {
    if (plot.logarithmic) y = y > 0 ? det::log10(y) : plot.bottom;
    return grid_py(std::clamp(y, plot.bottom, plot.top));
  };
  std::string out =
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="640" height="420" viewBox="0 0 640 420" )"
      "font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"640\" height=\"420\" fill=\"white\"/>\n";
  const auto line = [&](double xa, double ya, double xb, double yb, const char* color, int width) {
    out += fmt::format(
        R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}" stroke-width="{}"/>)",
        xa, ya, xb, yb, color, width);
    out += '\n';
  };
  const auto label = [&](const std::string& place, const char* anchor, const std::string& words) {
    out += fmt::format("<text {} text-anchor=\"{}\">{}</text>\n", place, anchor,
                       markup_escaped(to_utf8(words, Encoding::utf8)));
  };
  const auto at = [](double x, double y) { return fmt::format(R"(x="{:.1f}" y="{:.1f}")", x, y); };
  label(at(kLeft, 24) + " font-size=\"15\"", "start", plot.title);
  label(at((kLeft + kRight) / 2, 408), "middle", plot.x_name);
  label(fmt::format("transform=\"translate(16,{:.0f}) rotate(-90)\"", (kTop + kBottom) / 2),
        "middle", plot.y_name);
  const double x_step = plot.x_step > 0 ? plot.x_step : tick_step(plot.right - plot.left, 5);
  for (double k = std::ceil(plot.left / x_step); k * x_step <= plot.right; ++k) {
    const double x = px(k * x_step);
    line(x, kTop, x, kBottom, "#ddd", 1);
    label(at(x, kBottom + 16), "middle", fmt::format("{:.6g}", k * x_step));
  }
  const double y_step = plot.logarithmic ? 1 : tick_step(plot.top - plot.bottom, 4);
  for (double k = std::ceil(plot.bottom / y_step); k * y_step <= plot.top; ++k) {
    const double y = grid_py(k * y_step);
    line(kLeft, y, kRight, y, "#ddd", 1);
    label(at(kLeft - 6, y + 4), "end",
          plot.logarithmic ? fmt::format("1e{:.0f}", k) : fmt::format("{:.6g}", k * y_step));
  }
  double row = kTop + 16;  // of the legend
  for (const PlotCurve& curve : plot.curves) {
    for (const auto& [x, y] : curve.dots)
      out += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2\" fill=\"{}\"/>\n", px(x),
                         py(y), curve.color);
    out +=
        fmt::format(R"(<polyline fill="none" stroke-width="2" stroke="{}" points=")", curve.color);
    for (const auto& [x, y] : curve.points) out += fmt::format("{:.2f},{:.2f} ", px(x), py(y));
    out += "\"/>\n";
    line(kRight - 92, row - 4, kRight - 72, row - 4, curve.color, 2);
    label(at(kRight - 66, row), "start", curve.name);
    row += 16;
  }
  return out +
         fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="#444"/>)",
                     kLeft, kTop, kRight - kLeft, kBottom - kTop) +
         "\n</svg>\n";
}

}  // namespace panwright::tools
