#include "materials/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "base/file.h"
#include "base/text.h"
#include "materials/brdf.h"

namespace panwright::materials {
namespace {

constexpr std::uint64_t kMostBytes = 64u << 20;
constexpr std::size_t kFewestReadings = 8;
constexpr std::size_t kMostReadings = 100'000;
constexpr double kBrightest = 1e9;  // 1/sr; a flat mirror shows the Sun with 1.5e4
// closer to the horizon instruments measure the edge of the sample
constexpr double kLowest = 0.03;  // cosine

Vec3 direction(double zenith_deg, double azimuth_deg) {
  const auto z = det::sincos(zenith_deg * kDegree);
  const auto a = det::sincos(azimuth_deg * kDegree);
  return {z.sin * a.cos, z.sin * a.sin, z.cos};
}

bool is_gap(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

// Reads the five numbers of a line. Returns the problem, if any.
std::string read_line(std::string_view line, std::array<double, 5>& out) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    while (at < line.size() && is_gap(line[at])) ++at;
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + line.size(), out[i]);
    if (error != std::errc() || !std::isfinite(out[i]))
      return fmt::format("number {} of 5 is missing or invalid", i + 1);
    at = static_cast<std::size_t>(end - line.data());
  }
  while (at < line.size() && is_gap(line[at])) ++at;
  if (at != line.size()) return "more than 5 numbers, expected 5";
  if (std::fabs(out[0]) > 90 || std::fabs(out[2]) > 90)
    return fmt::format("a zenith angle of {} degrees is below the horizon, expected at most 90",
                       format_double(std::fabs(out[0]) > 90 ? out[0] : out[2]));
  if (out[4] > kBrightest)
    return fmt::format("a reflectance of {} 1/sr, expected at most {}", format_double(out[4]),
                       format_double(kBrightest));
  if (out[4] < 0)
    return fmt::format("a reflectance of {} 1/sr, expected at least 0", format_double(out[4]));
  return {};
}

// ---- minimisation

using Point = std::vector<double>;
using Cost = std::function<double(const Point&)>;

// The least cost near a start, by a simplex with sides of `step`.
Point minimised(const Cost& cost, const Point& start, double step) {
  struct Corner {
    Point at;
    double cost;
  };
  std::vector<Corner> simplex{{start, cost(start)}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    Point at = start;
    at[i] += step;
    simplex.push_back({at, cost(at)});
  }
  const auto towards = [&](const Point& from, const Point& to, double t) {
    Point at(from.size());
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = from[i] + t * (to[i] - from[i]);
    return Corner{at, cost(at)};
  };
  for (int iteration = 0; iteration < 400; ++iteration) {
    std::stable_sort(simplex.begin(), simplex.end(),
                     [](const Corner& a, const Corner& b) { return a.cost < b.cost; });
    Corner& worst = simplex.back();
    if (worst.cost - simplex.front().cost < 1e-12 * (1 + simplex.front().cost)) break;
    Point middle(start.size(), 0.0);
    for (std::size_t c = 0; c + 1 < simplex.size(); ++c)
      for (std::size_t i = 0; i < middle.size(); ++i)
        middle[i] += simplex[c].at[i] / static_cast<double>(simplex.size() - 1);
    const Corner reflected = towards(middle, worst.at, -1);
    if (reflected.cost < simplex.front().cost) {
      const Corner further = towards(middle, worst.at, -2);
      worst = further.cost < reflected.cost ? further : reflected;
    } else if (reflected.cost < simplex[simplex.size() - 2].cost) {
      worst = reflected;
    } else {
      const Corner inside = towards(middle, worst.at, reflected.cost < worst.cost ? -0.5 : 0.5);
      if (inside.cost < worst.cost) {
        worst = inside;
      } else {
        for (std::size_t c = 1; c < simplex.size(); ++c)
          simplex[c] = towards(simplex.front().at, simplex[c].at, 0.5);
      }
    }
  }
  return std::min_element(simplex.begin(), simplex.end(),
                          [](const Corner& a, const Corner& b) { return a.cost < b.cost; })
      ->at;
}

// ---- BRDFs

// A number in (0, 1) from one without bounds, and back.
double bounded(double x) { return 1 / (1 + det::exp(-x)); }
double unbounded(double p) { return det::log(p / (1 - p)); }

// A BRDF as a function of parameters in (0, 1).
struct Model {
  const char* brdf;
  std::vector<Point> starts;
  std::function<Material(const Point&)> material;
  std::function<std::string(const Point&)> text;
};

Material diffuse(double albedo) {
  Material m;
  m.diffuse = Vec3(albedo);
  return m;
}

std::string diffuse_text(double albedo) {
  return fmt::format("<diffuse> {0:.4g} {0:.4g} {0:.4g} </diffuse>", albedo);
}

// Microfacets in place of part of a diffuse surface, without the Fresnel term.
Material microfacets(SpecularModel brdf, const Point& p) {
  Material m = diffuse(1);
  m.specular = Vec3(1);
  m.specular_brdf = with_slopes(brdf, Vec2(p[2]));
  m.compensation = Compensation::off;
  // the two weights never add up to more than 1
  m.weights = {p[0] * (1 - p[1]), p[1], 0};
  return m;
}

std::string microfacets_text(const char* tag, const Point& p) {
  return fmt::format(
      "<diffuse> 1 1 1 </diffuse>\n<specular> 1 1 1 </specular>\n<reflect> {:.4g} {:.4g} 0 "
      "</reflect>\n<{} energy=\"single\"> {:.4g} </{}>",
      p[0] * (1 - p[1]), p[1], tag, p[2], tag);
}

std::vector<Model> models() {
  std::vector<Model> all;
  all.push_back({"Lambert",
                 {{0.3}},
                 [](const Point& p) { return diffuse(p[0]); },
                 [](const Point& p) { return diffuse_text(p[0]); }});
  all.push_back({"EON",
                 {{0.3, 0.5}},
                 [](const Point& p) {
                   Material m = diffuse(p[0]);
                   m.diffuse_brdf = Eon{p[1]};
                   return m;
                 },
                 [](const Point& p) {
                   return diffuse_text(p[0]) + fmt::format("\n<eon> {:.4g} </eon>", p[1]);
                 }});
  const std::vector<Point> starts{{0.3, 0.1, 0.1}, {0.3, 0.1, 0.3}, {0.05, 0.3, 0.03}};
  all.push_back({"GGX microfacets over Lambert", starts,
                 [](const Point& p) { return microfacets(SpecularModel::ggx, p); },
                 [](const Point& p) { return microfacets_text("ggx", p); }});
  all.push_back({"Beckmann microfacets over Lambert", starts,
                 [](const Point& p) { return microfacets(SpecularModel::beckmann, p); },
                 [](const Point& p) { return microfacets_text("beckmann", p); }});
  // parameters: albedo, slope, and the index from 1 to 2.5
  all.push_back({"Lambert under a coat",
                 {{0.3, 0.2, 0.33}, {0.3, 0.05, 0.33}, {0.03, 0.05, 0.33}},
                 [](const Point& p) {
                   Material m = diffuse(p[0]);
                   m.coat = Coat{1 + 1.5 * p[2], p[1], Vec3(0)};
                   return m;
                 },
                 [](const Point& p) {
                   return diffuse_text(p[0]) +
                          fmt::format("\n<coat n=\"{:.4g}\" slope=\"{:.4g}\"/>", 1 + 1.5 * p[2],
                                      p[1]);
                 }});
  return all;
}

struct Residuals {
  double rms_decades = 0;
  double max_decades = 0;
  double rms = 0;
};

Residuals residuals(const Material& material, const std::vector<Reading>& readings, double floor) {
  Residuals out;
  double logs = 0, squares = 0;
  std::size_t count = 0;
  for (const Reading& r : readings) {
    if (r.to_light.z < kLowest || r.to_viewer.z < kLowest) continue;
    const double f = f64::brdf(material, r.to_light, r.to_viewer, Vec3(0, 0, 1)).y;
    const double decades = det::log10(std::max(f, floor) / std::max(r.reflectance, floor));
    logs += decades * decades;
    squares += (f - r.reflectance) * (f - r.reflectance);
    out.max_decades = std::max(out.max_decades, std::fabs(decades));
    ++count;
  }
  out.rms_decades = std::sqrt(logs / static_cast<double>(count));
  out.rms = std::sqrt(squares / static_cast<double>(count));
  return out;
}

Point all_bounded(const Point& x) {
  Point p(x.size());
  // note: away from 0, where slopes have no BRDF
  for (std::size_t i = 0; i < x.size(); ++i) p[i] = std::max(bounded(x[i]), 1e-4);
  return p;
}

}  // namespace

Result<std::vector<Reading>> read_measured(const std::filesystem::path& path, DiagnosticLog& log) {
  auto bytes = read_file(path, kMostBytes, log);
  if (!bytes) return failed;
  const auto text = std::make_shared<const std::string>(*std::move(bytes));
  const FileId file = log.sources().add({path.string(), text, Encoding::utf8, {}});
  const std::size_t errors = log.errors();
  std::vector<Reading> readings;
  std::size_t usable = 0;
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    std::string_view line(text->data() + begin, end - begin);
    std::size_t skip = 0;
    // a byte-order mark
    if (begin == 0 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    while (skip < line.size() && is_gap(line[skip])) ++skip;
    const char first = skip < line.size() ? line[skip] : '#';
    const bool number =
        (first >= '0' && first <= '9') || first == '-' || first == '+' || first == '.';
    const bool word = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
    std::array<double, 5> five{};
    const bool read = number || (!word && first != '#');
    if (read) {
      const std::string problem = read_line(line, five);
      if (!problem.empty()) {
        log.report(Code::E1409,
                   {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)},
                   problem,
                   "a reading is zenith and azimuth of the light, zenith and azimuth of the "
                   "viewer, in degrees, and the reflectance in 1/sr");
      } else {
        readings.push_back({direction(five[0], five[1]), direction(five[2], five[3]), five[4]});
        usable += readings.back().to_light.z >= kLowest && readings.back().to_viewer.z >= kLowest;
      }
    }
    begin = end + 1;
  }
  if (log.errors() != errors) return failed;
  if (readings.size() > kMostReadings) {
    log.report_file(
        Code::E1409, path.string(),
        fmt::format("{}, expected at most {}", counted(readings.size(), "reading"), kMostReadings));
    return failed;
  }
  if (usable < kFewestReadings) {
    log.report_file(Code::E1409, path.string(),
                    fmt::format("{} with light and viewer above the horizon, expected at least {}",
                                counted(usable, "reading"), kFewestReadings));
    return failed;
  }
  return readings;
}

std::vector<Fit> fitted_brdfs(const std::vector<Reading>& readings, double floor) {
  std::vector<Fit> fits;
  for (const Model& model : models()) {
    const Cost cost = [&](const Point& x) {
      Material material = model.material(all_bounded(x));
      fit(material);
      return residuals(material, readings, floor).rms_decades;
    };
    Point best;
    double least = 0;
    for (const Point& start : model.starts) {
      Point x(start.size());
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = unbounded(start[i]);
      x = minimised(cost, minimised(cost, x, 1.0), 0.1);
      const double found = cost(x);
      if (!best.empty() && found >= least) continue;
      best = x;
      least = found;
    }
    const Point p = all_bounded(best);
    Fit one;
    one.brdf = model.brdf;
    one.text = model.text(p);
    one.material = model.material(p);
    one.material.name = model.brdf;
    fit(one.material);
    const Residuals r = residuals(one.material, readings, floor);
    one.rms_decades = r.rms_decades;
    one.max_decades = r.max_decades;
    one.rms = r.rms;
    fits.push_back(std::move(one));
  }
  std::stable_sort(fits.begin(), fits.end(),
                   [](const Fit& a, const Fit& b) { return a.rms_decades < b.rms_decades; });
  return fits;
}

}  // namespace panwright::materials
