#include "materials/measured.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <variant>

#include "base/file.h"
#include "base/parallel.h"
#include "base/text.h"
#include "materials/brdf.h"

namespace panwright::materials {
namespace {

constexpr std::uint64_t kMostBytes = 64u << 20;
constexpr std::size_t kFewestReadings = 8;
constexpr std::size_t kMostReadings = 100'000;
constexpr std::size_t kFewSearched = 1'000;
constexpr double kBrightest = 1e9;  // 1/sr; a flat mirror shows the Sun with 1.5e4
// closer to the horizon instruments measure the edge of the sample
constexpr double kLowest = 0.03;  // cosine

Vec3 direction_at(double zenith_deg, double azimuth_deg) {
  const auto z = det::sincos(zenith_deg * kDegree);
  const auto a = det::sincos(azimuth_deg * kDegree);
  return {z.sin * a.cos, z.sin * a.sin, z.cos};
}

bool is_gap(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

// One line of a table: what is wrong with it, or its numbers.
struct Line {
  enum class Problem { none, number, count, below_horizon, bright, negative };
  Problem problem = Problem::none;
  std::string words;
  std::array<double, 7> numbers{};
  std::size_t count = 0;
  std::size_t at = 0, length = 0;  // of an invalid number, in the line
};

// Reads the five or seven numbers of a line.
Line read_line(std::string_view line) {
  Line out;
  const auto wrong = [&](Line::Problem problem, std::string words) {
    out.problem = problem;
    out.words = std::move(words);
    return out;
  };
  for (std::size_t at = 0;;) {
    while (at < line.size() && is_gap(line[at])) ++at;
    if (at == line.size()) break;
    if (out.count == out.numbers.size())
      return wrong(Line::Problem::count, "more than 7 numbers, expected 5, or 7 with three bands");
    double& number = out.numbers[out.count];
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + line.size(), number);
    const std::size_t past = static_cast<std::size_t>(end - line.data());
    const bool whole = past == line.size() || is_gap(line[past]);
    if (error != std::errc() || !std::isfinite(number) || !whole) {
      std::size_t last = at;
      while (last < line.size() && !is_gap(line[last])) ++last;
      out.at = at;
      out.length = last - at;
      const std::string_view token = line.substr(at, last - at);
      const bool percent = error == std::errc() && token.substr(past - at) == "%";
      return wrong(Line::Problem::number,
                   fmt::format("number {} is {}, expected a finite number{}", out.count + 1,
                               in_quotes(token),
                               percent ? ": a reflectance is in 1/sr, not in percent" : ""));
    }
    at = past;
    ++out.count;
  }
  if (out.count != 5 && out.count != 7)
    return wrong(Line::Problem::count, fmt::format("{}, expected 5, or 7 with three bands",
                                                   counted(out.count, "number")));
  const auto& n = out.numbers;
  if (std::fabs(n[0]) > 90 || std::fabs(n[2]) > 90)
    return wrong(
        Line::Problem::below_horizon,
        fmt::format("a zenith angle of {} degrees is below the horizon, expected at most 90",
                    format_double(std::fabs(n[0]) > 90 ? n[0] : n[2])));
  for (std::size_t i = 4; i < out.count; ++i) {
    if (n[i] > kBrightest)
      return wrong(Line::Problem::bright,
                   fmt::format("a reflectance of {} 1/sr, expected at most {}", format_double(n[i]),
                               format_double(kBrightest)));
    if (n[i] < 0)
      return wrong(
          Line::Problem::negative,
          fmt::format("a reflectance of {} 1/sr, expected at least 0", format_double(n[i])));
  }
  return out;
}

// The invalid lines of a table: the first of each kind, and how many there are.
class Complaints {
 public:
  void add(const Line& line, SourceSpan where) {
    for (Kind& kind : kinds_)
      if (kind.problem == line.problem) {
        ++kind.count;
        return;
      }
    kinds_.push_back({line.problem, line.words, where, 1});
  }
  bool report(DiagnosticLog& log) const {
    for (const Kind& kind : kinds_)
      log.report(Code("E1409"), kind.where,
                 kind.words + (kind.count > 1 ? fmt::format(", and {} like it",
                                                            counted(kind.count - 1, "line"))
                                              : std::string()),
                 "columns: zenith and azimuth of the light, zenith and azimuth of the viewer "
                 "(degrees), reflectance (1/sr; one number or RGB)");
    return !kinds_.empty();
  }

 private:
  struct Kind {
    Line::Problem problem;
    std::string words;
    SourceSpan where;
    std::size_t count;
  };
  std::vector<Kind> kinds_;
};

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
    if (worst.cost - simplex.front().cost < 1e-7 * (1e-3 + simplex.front().cost)) break;
    if (simplex.front().cost < 1e-6) break;  // decades: nothing is left to find
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

// A BRDF as a function of parameters in (0, 1), the same in all channels.
struct Model {
  const char* brdf;
  std::vector<Point> starts;
  std::function<Material(const Point&)> material;
};

Material diffuse(double albedo) {
  Material m;
  m.diffuse = Vec3(albedo);
  return m;
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

std::vector<Model> models() {
  std::vector<Model> all;
  all.push_back({"Lambert", {{0.3}}, [](const Point& p) { return diffuse(p[0]); }});
  all.push_back({"EON", {{0.3, 0.5}}, [](const Point& p) {
                   Material m = diffuse(p[0]);
                   m.diffuse_brdf = Eon{p[1]};
                   return m;
                 }});
  const std::vector<Point> starts{{0.3, 0.1, 0.1}, {0.3, 0.1, 0.3}, {0.05, 0.3, 0.03}};
  all.push_back({"GGX microfacets over Lambert", starts,
                 [](const Point& p) { return microfacets(SpecularModel::ggx, p); }});
  all.push_back({"Beckmann microfacets over Lambert", starts,
                 [](const Point& p) { return microfacets(SpecularModel::beckmann, p); }});
  // parameters: albedo, slope, and the index from 1 to 2.5
  all.push_back({"Lambert under a coat",
                 {{0.3, 0.2, 0.33}, {0.3, 0.05, 0.33}, {0.03, 0.05, 0.33}},
                 [](const Point& p) {
                   Material m = diffuse(p[0]);
                   m.coat = Coat{1 + 1.5 * p[2], p[1], Vec3(0)};
                   return m;
                 }});
  return all;
}

bool has_specular_model(const Material& m) { return m.specular_model() != SpecularModel::none; }

// The fields of a material of models() as pxn.
std::string text_of(const Material& m) {
  const auto rgb = [](const Vec3& v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z); };
  std::string text = fmt::format("<diffuse> {} </diffuse>", rgb(m.diffuse));
  if (const auto* eon = std::get_if<Eon>(&m.diffuse_brdf))
    text += fmt::format("\n<eon> {:.4g} </eon>", eon->roughness);
  if (has_specular_model(m)) {
    const char* const tag = m.specular_model() == SpecularModel::ggx ? "ggx" : "beckmann";
    text += fmt::format(
        "\n<specular> {} </specular>\n<reflect> {:.4g} {:.4g} 0 </reflect>\n"
        "<{} energy=\"single\"> {:.4g} </{}>",
        rgb(m.specular), m.weights.x, m.weights.y, tag, slopes_of(m).value_or(Vec2(0)).x, tag);
  }
  if (m.coat)
    text += fmt::format("\n<coat n=\"{:.4g}\" slope=\"{:.4g}\"/>", m.coat->index, m.coat->alpha);
  return text;
}

// ---- residuals

// A channel of a reading and of a BRDF; kMean: the mean of a reading, and a BRDF without colour.
constexpr int kMean = -1;
double channel_of(const Reading& r, int channel) {
  return channel == kMean ? r.reflectance : r.rgb[channel];
}
double channel_of(const Vec3& f, int channel) { return channel == kMean ? f.y : f[channel]; }

struct Residuals {
  double rms_decades = 0;
  double max_decades = 0;
  double rms = 0;
};

Residuals residuals(const Material& material, const std::vector<Reading>& readings, double floor,
                    std::initializer_list<int> channels) {
  Residuals out;
  double logs = 0, squares = 0;
  std::size_t count = 0;
  for (const Reading& r : readings) {
    if (r.to_light.z < kLowest || r.to_viewer.z < kLowest) continue;
    const Vec3 rgb = f64::brdf(material, r.to_light, r.to_viewer, Vec3(0, 0, 1));
    for (const int channel : channels) {
      const double f = channel_of(rgb, channel);
      const double read = channel_of(r, channel);
      const double decades = det::log10(std::max(f, floor) / std::max(read, floor));
      logs += decades * decades;
      squares += (f - read) * (f - read);
      out.max_decades = std::max(out.max_decades, std::fabs(decades));
      ++count;
    }
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

// About `most` readings, spread over a table of more: every so many of it in an order of golden
// steps, which no grid of angles is in step with.
std::vector<Reading> spread(const std::vector<Reading>& readings, std::size_t most) {
  if (readings.size() <= most) return readings;
  std::vector<Reading> some;
  some.reserve(most);
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;
  const std::uint64_t bound = ~std::uint64_t{0} / readings.size() * most;
  for (std::size_t i = 0; i < readings.size(); ++i)
    if (i * kGolden < bound) some.push_back(readings[i]);
  return some;
}

// A search from one start.
struct Search {
  const Model* model = nullptr;
  const Point* start = nullptr;
  Point found;      // without bounds
  double cost = 0;  // there
};

// note: every table that is searched has readings that count, as read_measured() says
void run(Search& search, const std::vector<Reading>& few, const std::vector<Reading>& many,
         double floor) {
  const auto cost_of = [&](const std::vector<Reading>& readings) -> Cost {
    return [&readings, floor, &search](const Point& x) {
      Material material = search.model->material(all_bounded(x));
      fit(material);
      return residuals(material, readings, floor, {kMean}).rms_decades;
    };
  };
  Point x(search.start->size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = unbounded((*search.start)[i]);
  search.found = minimised(cost_of(many), minimised(cost_of(few), x, 1.0), 0.1);
  search.cost = cost_of(many)(search.found);
}

// A material of models() with colours of its own in each channel: how much of it is diffuse, and of
// microfacets; slopes, roughness and index stay. Their two weights add up to 1, so that no channel
// returns more than came.
Material tinted(const Material& grey, const std::vector<Reading>& readings, double floor) {
  Material base = grey;
  Point start{std::clamp(grey.diffuse.x, 1e-3, 0.999)};
  if (has_specular_model(grey)) {
    const double sum = grey.weights.x + grey.weights.y;
    base.weights = {grey.weights.x / sum, grey.weights.y / sum, 0};
    start = Point(2, std::clamp(sum, 1e-3, 0.999));
  }
  const auto with = [&](const Point& shares) {
    Material m = base;
    m.diffuse = Vec3(shares[0]);
    if (shares.size() > 1) m.specular = Vec3(shares[1]);
    fit(m);
    return m;
  };
  for (const int channel : {0, 1, 2}) {
    const Cost cost = [&](const Point& x) {
      return residuals(with(all_bounded(x)), readings, floor, {channel}).rms_decades;
    };
    Point x(start.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = unbounded(start[i]);
    const Point shares = all_bounded(minimised(cost, x, 0.3));
    base.diffuse[channel] = shares[0];
    if (shares.size() > 1) base.specular[channel] = shares[1];
  }
  return base;
}

}  // namespace

Result<std::vector<Reading>> read_measured(const std::filesystem::path& path, DiagnosticLog& log) {
  auto bytes = read_file(path, kMostBytes, log);
  if (!bytes) return failed;
  const auto text = std::make_shared<const std::string>(*std::move(bytes));
  const FileId file = log.sources().add({path.string(), text, Encoding::utf8, {}});
  Complaints complaints;
  std::vector<Reading> readings;
  std::size_t usable = 0, numbers = 0;
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    const SourceSpan where{file, static_cast<std::uint32_t>(begin),
                           static_cast<std::uint32_t>(end)};
    std::string_view line(text->data() + begin, end - begin);
    std::size_t skip = 0;
    // a byte-order mark
    if (begin == 0 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    while (skip < line.size() && is_gap(line[skip])) ++skip;
    begin = end + 1;
    const char first = skip < line.size() ? line[skip] : '#';
    const bool number =
        (first >= '0' && first <= '9') || first == '-' || first == '+' || first == '.';
    const bool word = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z');
    if (!number && (word || first == '#')) continue;
    Line read = read_line(line);
    if (read.problem == Line::Problem::none && numbers != 0 && read.count != numbers) {
      read.problem = Line::Problem::count;
      read.words = fmt::format("{} numbers, {} in the lines above", read.count, numbers);
    }
    if (read.problem != Line::Problem::none) {
      SourceSpan place = where;
      if (read.length > 0) {
        place.begin = static_cast<std::uint32_t>(line.data() - text->data() + read.at);
        place.end = place.begin + static_cast<std::uint32_t>(read.length);
      }
      complaints.add(read, place);
      continue;
    }
    numbers = read.count;
    const auto& n = read.numbers;
    const Vec3 rgb = numbers == 7 ? Vec3(n[4], n[5], n[6]) : Vec3(n[4]);
    const double mean = numbers == 7 ? (rgb.x + rgb.y + rgb.z) / 3 : n[4];
    readings.push_back({direction_at(n[0], n[1]), direction_at(n[2], n[3]), mean, rgb});
    usable += readings.back().to_light.z >= kLowest && readings.back().to_viewer.z >= kLowest;
  }
  if (complaints.report(log)) return failed;
  if (readings.size() > kMostReadings) {
    log.report_file(
        Code("E1409"), path.string(),
        fmt::format("{}, expected at most {}", counted(readings.size(), "reading"), kMostReadings));
    return failed;
  }
  if (usable < kFewestReadings) {
    log.report_file(Code("E1409"), path.string(),
                    fmt::format("{} with light and viewer above the horizon, expected at least {}",
                                counted(usable, "reading"), kFewestReadings));
    return failed;
  }
  return readings;
}

bool has_color(const std::vector<Reading>& readings) {
  return std::any_of(readings.begin(), readings.end(),
                     [](const Reading& r) { return r.rgb.x != r.rgb.y || r.rgb.y != r.rgb.z; });
}

std::vector<Fit> fitted_brdfs(const std::vector<Reading>& readings, double floor, const Job& job) {
  const bool color = has_color(readings);
  std::vector<Reading> seen;
  for (const Reading& r : readings)
    if (r.to_light.z >= kLowest && r.to_viewer.z >= kLowest) seen.push_back(r);
  const std::vector<Reading> many = spread(seen, kMostSearched);
  const std::vector<Reading> few = spread(many, kFewSearched);
  const std::vector<Model> all = models();
  std::vector<Search> searches;
  for (const Model& model : all)
    for (const Point& start : model.starts) searches.push_back({&model, &start, {}, 0});
  Phase phase(job, "fitting", searches.size());
  // the slow ones, of coats, first
  parallel_for(
      searches.size(),
      [&](std::size_t i) {
        run(searches[searches.size() - 1 - i], few, many, floor);
        phase.advance();
      },
      job);
  std::vector<Fit> fits;
  for (const Model& model : all) {
    const Search* best = nullptr;
    for (const Search& search : searches)
      if (search.model == &model && (!best || search.cost < best->cost)) best = &search;
    Fit one;
    one.brdf = model.brdf;
    one.material = model.material(all_bounded(best->found));
    if (color) one.material = tinted(one.material, many, floor);
    one.text = text_of(one.material);
    one.material.name = model.brdf;
    fit(one.material);
    const Residuals r = color ? residuals(one.material, readings, floor, {0, 1, 2})
                              : residuals(one.material, readings, floor, {kMean});
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
