#include "tools/plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

namespace panwright::tools {
namespace {

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

}  // namespace

Plot::Plot(const std::string& title, const std::string& x_label, const std::string& y_label,
           double x0, double x1, double y0, double y1)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1) {
  text_ =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"420\" "
      "viewBox=\"0 0 640 420\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"640\" height=\"420\" fill=\"white\"/>\n";
  label(kLeft, 24, "start", title, 15);
  label((kLeft + kRight) / 2, 408, "middle", x_label);
  text_ += fmt::format(
      "<text transform=\"translate(16,{:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      (kTop + kBottom) / 2, xml_text(y_label));
}

void Plot::x_tick(double x, const std::string& words) {
  line(px(x), kTop, px(x), kBottom, "#ddd", 1);
  label(px(x), kBottom + 16, "middle", words);
}

void Plot::y_tick(double y, const std::string& words) {
  line(kLeft, py(y), kRight, py(y), "#ddd", 1);
  label(kLeft - 6, py(y) + 4, "end", words);
}

void Plot::curve(const Points& points, const char* color, const std::string& name) {
  text_ +=
      "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + std::string(color) + "\" points=\"";
  for (const auto& [x, y] : points)
    text_ += fmt::format("{:.2f},{:.2f} ", px(x), py(std::clamp(y, y0_, y1_)));
  text_ += "\"/>\n";
  const double at = kTop + 16 + 16 * names_++;
  line(kRight - 92, at - 4, kRight - 72, at - 4, color, 2);
  label(kRight - 66, at, "start", name);
}

void Plot::dots(const Points& points, const char* color) {
  for (const auto& [x, y] : points)
    text_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2\" fill=\"{}\"/>\n", px(x),
                         py(std::clamp(y, y0_, y1_)), color);
}

std::string Plot::finish() {
  text_ += fmt::format(
      "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" fill=\"none\" "
      "stroke=\"#444\"/>\n</svg>\n",
      kLeft, kTop, kRight - kLeft, kBottom - kTop);
  return std::move(text_);
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
                  x, y, anchor, size, xml_text(words));
}

}  // namespace panwright::tools
