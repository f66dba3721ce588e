#include "tools/dataset_card.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/plot.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using workspace::PlannedFrame;

constexpr std::size_t kBins = 24;
struct Quantity {
  const char* name;
  const char* title;
  const char* unit;
  double PlannedFrame::*value;
  bool logarithmic;
};
constexpr Quantity kQuantities[] = {
    {"range", "Range", "m", &PlannedFrame::range, true},
    {"phase", "Phase angle", "deg", &PlannedFrame::phase, false},
    {"pixels", "Pixels on the target (convex outline)", "pixels", &PlannedFrame::pixels, true}};

// The decades that hold a value, in eighths of a decade, or tens of degrees.
Json histogram(const Quantity& of, std::vector<double> values) {
  std::ranges::sort(values);
  Json out{{"unit", of.unit},
           {"least", values.front()},
           {"median", values[values.size() / 2]},
           {"most", values.back()}};
  const double floor = of.logarithmic ? 1e-3 : 0;
  const auto scale = [&](double v) { return of.logarithmic ? det::log10(std::max(v, floor)) : v; };
  double low = of.logarithmic ? scale(values.front()) : 0;
  double high = of.logarithmic ? scale(values.back()) : 180;
  if (!(high - low > 1e-6)) low -= 0.05, high += 0.05;
  std::vector<double> edges;
  for (std::size_t k = 0; k <= kBins; ++k) {
    const double at = low + (high - low) * static_cast<double>(k) / kBins;
    edges.push_back(of.logarithmic ? det::pow(10, at) : at);
  }
  std::vector<std::size_t> counts(kBins, 0);
  for (const double v : values) {
    const double place = (scale(v) - low) / (high - low) * kBins;
    ++counts[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))];
  }
  out["edges"] = edges;
  out["counts"] = counts;
  return out;
}

std::string summary_row(const Quantity& of, const Json& one) {
  return fmt::format("| {} | {:.4g} | {:.4g} | {:.4g} | {} |\n", of.title,
                     one["least"].get<double>(), one["median"].get<double>(),
                     one["most"].get<double>(), of.unit);
}

}  // namespace

Json dataset_coverage(std::span<const PlannedFrame> frames) {
  Json out;
  for (const Quantity& of : kQuantities) {
    std::vector<double> values;
    for (const PlannedFrame& frame : frames) values.push_back(frame.*of.value);
    out[of.name] = histogram(of, std::move(values));
  }
  return out;
}

std::string dataset_plots(const Json& coverage) {
  constexpr int kWidth = 640, kHeight = 420;
  std::string out =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\">\n", kWidth,
                  kHeight * std::size(kQuantities));
  int row = 0;
  for (const Quantity& of : kQuantities) {
    const Json& one = coverage[of.name];
    Plot plot{.title = of.title, .y_name = "frames"};
    plot.x_name = of.logarithmic ? fmt::format("log10 of {}", of.unit) : std::string(of.unit);
    PlotPoints steps;
    const auto x = [&](std::size_t k) {
      const double edge = one["edges"][k].get<double>();
      return of.logarithmic ? det::log10(edge) : edge;
    };
    for (std::size_t k = 0; k < kBins; ++k) {
      const double count = one["counts"][k].get<double>();
      steps.insert(steps.end(), {{x(k), 0}, {x(k), count}, {x(k + 1), count}, {x(k + 1), 0}});
      plot.top = std::max(plot.top, 1.05 * count);
    }
    plot.left = x(0), plot.right = x(kBins);
    plot.curves.push_back({std::move(steps), "#1f5fa8", "planned"});
    const std::string svg = svg_of(plot);
    out += fmt::format("<g transform=\"translate(0 {})\">\n{}</g>\n", kHeight * row++,
                       svg.substr(svg.find("<svg")));
  }
  return out + "</svg>\n";
}

std::string dataset_table(std::span<const PlannedFrame> frames) {
  std::string out = "number,range[m],phase[deg],place.x[px],place.y[px],pixels\n";
  std::size_t number = 0;
  for (const PlannedFrame& frame : frames)
    out += fmt::format("{},{:.6g},{:.7g},{:.6g},{:.6g},{:.5g}\n", number++, frame.range,
                       frame.phase, frame.place.x, frame.place.y, frame.pixels);
  return out;
}

std::string dataset_card(const workspace::DatasetPlan& plan, const DatasetSettings& settings,
                         const std::string& plan_text, const Json& coverage) {
  const auto licence = [&](const std::string& name) {
    for (const auto& [of, text] : plan.licences)
      if (of == name) return text;
    return std::string("not stated in the plan");
  };
  std::string out = fmt::format("# {}\n\n", plan.title.empty() ? "Data set" : plan.title);
  out += fmt::format(
      "{} frames, rendered by {}; seed {}. Licence of the set: {}.\n\n"
      "`frames.jsonl` has a frame on each line, as a view that `panwright render --views` takes; "
      "`coverage.csv` its range, phase and pixels; `set.json` models and settings. Images, labels "
      "and `NAME.frame.json`, which has the row and hashes, are in `frames/`.\n\n",
      plan.frames, settings.program, plan.seed, licence("set"));
  out += "## Models\n\n| target | file | build | licence |\n|---|---|---|---|\n";
  for (std::size_t k = 0; k < settings.targets.size(); ++k) {
    const auto& [name, file] = settings.targets[k];
    out += fmt::format("| {} | {} | {} | {} |\n", name, file, settings.build_ids[k].second,
                       licence(name));
  }
  out += "\n## Coverage\n\n| | least | median | most | |\n|---|---|---|---|---|\n";
  for (const Quantity& of : kQuantities) out += summary_row(of, coverage[of.name]);
  out +=
      "\n![Range, phase angle and pixels.](coverage.svg)\n\n## Conventions\n\n"
      "Quaternions w x y z, world_from_camera (`quat`) and world_from_model (`pose`); metres. "
      "Camera axes: x right, y down, z along the boresight. Pixel (0, 0) is the upper left "
      "corner of the image, the centre of the first pixel (0.5, 0.5).\n\n## Known limits\n\n";
  for (const std::string& limit : plan.limits) out += "- " + limit + "\n";
  const bool traced = Json::parse(settings.view).value("engine", "gl") == "reference";
  if (!traced) out += "- Images have no light between surfaces of targets (engine gl).\n";
  if (Json::parse(settings.view).value("camera_file", "").empty() &&
      !Json::parse(settings.view).contains("detector"))
    out += "- Images have no noise: the camera has no detector.\n";
  out +=
      "- All images are synthetic. The models differ from real spacecraft in shape, materials "
      "and wear; expect a gap to real images, and measure it.\n"
      "- Pixels of the coverage are the area of the target's convex outline, before anything "
      "hides it. The labels have the true areas.\n\n## Plan\n\n```toml\n";
  return out + plan_text + (plan_text.ends_with('\n') ? "" : "\n") + "```\n";
}

}  // namespace panwright::tools
