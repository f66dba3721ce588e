// Rays of a RADAR through a scene.
#include "instruments/radar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>

#include "base/parallel.h"
#include "base/text.h"
#include "instruments/internal/radar_grid.h"
#include "trace/scene.h"

namespace panwright::instruments {

namespace {

constexpr double kLeastCosine = 1e-3;   // of incidence: grazing hits weigh no more than at it
constexpr double kMostTangent = 5.7;    // of the grid of rays: 80 degrees off the boresight
constexpr std::size_t kBand = 1 << 15;  // rays between two additions

// Rays through squares of a plane at z = 1.
struct RayGrid {
  double left = 0, top = 0, step = 0;
  std::size_t columns = 0, rows = 0;
};

// Velocities of points of a node: of places in the observer's frame, against it.
struct NodeMotion {
  Mat3 linear{0};
  Vec3 offset{0};
  Vec3 operator()(const Vec3& p) const { return linear * p + offset; }
};

double lobe(double sine_argument) {
  if (std::fabs(sine_argument) < 1e-9) return 1;
  const double ratio = det::sin(sine_argument) / sine_argument;
  return ratio * ratio;
}

double sinc(double x) {
  if (std::fabs(x) < 1e-4) return 1 - x * x / 6;
  return det::sin(x) / x;
}

Vec2 half_extent(const Radar& radar) {  // radians, beyond which nothing is sent
  const double factor = radar.pattern == BeamPattern::gaussian   ? 2
                        : radar.pattern == BeamPattern::aperture ? 3
                                                                 : 0.5;
  return factor * radar.beam;
}

// Tangents of the beam's edge.
Vec2 edge_of(const Radar& radar) {
  Vec2 edge = half_extent(radar);
  for (int k = 0; k < 2; ++k) {
    const double angle = std::min(edge[k], 80 * kDegree);
    edge[k] = det::sin(angle) / det::cos(angle);
  }
  return edge;
}

// A ray on its way, and what its tube of neighbours carries.
struct Tube {
  Vec3 from{0}, along{0};
  Vec3 across_x{0}, across_y{0};  // changes of `along` by a step of the grid
  Vec3 field{0};                  // unit, of the wave
  double length = 0;              // metres so far
  double root = 1;                // root of the power left
  double rate = 0;                // m/s, of the length
  Vec3 velocity{0};               // of where it was last
};

Vec3 mirrored(const Vec3& v, const Vec3& n) { return v - 2.0 * glm::dot(n, v) * n; }

class RadarTracer {
 public:
  RadarTracer(const Radar& radar, const RadarMoment& moment, DiagnosticLog& log, const Job& job)
      : radar_(radar), world_(moment.world), wave_(2 * kPi / radar.wavelength()) {
    scene_.update(moment.world, job);
    scene_.place_observer(moment.pose);
    gain_ = peak_gain(radar);
    sent_ = radar.power / radar.loss * gain_ * gain_;
    choose_surfaces(log);
    place_grid();
  }

  void report_damaged(DiagnosticLog& log) const { scene_.report_damaged(log); }

  void set_motion(const RadarMotion& motion) {
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const auto now = trace::placed_nodes(world_[i]);
      const trace::Affine here = scene_.observer_from(static_cast<std::uint32_t>(i));
      const auto at = [&](const RadarMoment& moment, std::size_t node) {
        const auto placed = trace::placed_nodes(moment.world[i]);
        return trace::between(trace::frame_of(moment.pose),
                              trace::frame_of(moment.world[i].pose())) *
               placed.model_from_node[node];
      };
      auto& nodes = motions_.emplace_back();
      for (std::size_t node = 0; node < now.model_from_node.size(); ++node) {
        const trace::Affine begin = at(motion.begin, node), end = at(motion.end, node);
        const trace::Affine mid = here * now.model_from_node[node];
        const Mat3 inverse = glm::inverse(mid.linear);
        const Mat3 linear = (end.linear - begin.linear) / radar_.dwell * inverse;
        nodes.push_back({linear, (end.offset - begin.offset) / radar_.dwell - linear * mid.offset});
      }
    }
  }

  const RayGrid& grid() const { return grid_; }
  std::size_t rays() const { return grid_.columns * grid_.rows; }
  double gain() const { return gain_; }

  // Appends the echoes of a ray; returns whether it hits anything.
  bool trace(std::size_t number, std::vector<RadarEcho>& out) const;

 private:
  void choose_surfaces(DiagnosticLog& log);
  void place_grid();
  std::optional<RadarEcho> reflected(const Tube& tube, const Vec3& at, const Vec3& normal,
                                     const Vec3& velocity, double solid, int bounce) const;
  Vec3 polarised(const Vec3& along) const {
    const Vec3 axis = radar_.vertical ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    return glm::normalize(axis - along * glm::dot(along, axis));
  }

  const Radar& radar_;
  const world::World& world_;
  trace::Scene scene_{{0, true}};
  double wave_ = 0, gain_ = 0, sent_ = 0;
  RayGrid grid_;
  RadarSurface guessed_;
  // by target and material id, which is 0 of terrain
  std::vector<std::vector<const RadarSurface*>> surfaces_;
  std::vector<std::vector<NodeMotion>> motions_;  // by target and node; empty: nothing moves
};

void RadarTracer::choose_surfaces(DiagnosticLog& log) {
  guessed_ = {"", ScatterLaw::lambert, 0.1};
  std::vector<std::string> missing;
  const auto surface_of = [&](const std::string& name) -> const RadarSurface* {
    const RadarSurface* found = nullptr;
    for (const RadarSurface& each : radar_.surfaces)
      if (each.material == name || (each.material == "*" && found == nullptr)) found = &each;
    if (found != nullptr) return found;
    if (std::ranges::find(missing, name) == missing.end()) missing.push_back(name);
    return &guessed_;
  };
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const pan::Model& model = *world_[i].model();
    const bool ground = scene_.targets()[i].target->ground() != nullptr;
    auto& list = surfaces_.emplace_back(1, ground ? surface_of("terrain") : nullptr);
    for (std::uint32_t m = 0; m < model.materials().size(); ++m)
      list.push_back(surface_of(std::string(model.material_name(m))));
  }
  if (missing.empty()) return;
  const std::size_t count = missing.size();
  if (count > 5) missing.resize(5);
  for (std::string& each : missing) each = in_quotes(each);
  log.report(
      Code("W0264"), {},
      fmt::format("{} without a surface, taken as Lambert of 0.1: {}{}", counted(count, "material"),
                  fmt::join(missing, ", "), count > 5 ? ", …" : ""));
}

void RadarTracer::place_grid() {
  const Vec2 edge = edge_of(radar_);
  AxisAligned<Vec2> seen;
  for (const std::uint32_t target : scene_.visible()) {
    const auto& placed = scene_.targets()[target];
    const auto& box = placed.target->bounds();
    if (box.empty()) continue;
    const trace::Affine map = scene_.observer_from(target);
    AxisAligned<Vec2> own;
    int behind = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p =
          map(Vec3(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                   corner & 4 ? box.high.z : box.low.z));
      if (p.z <= 0.1 * kLeastCosine * glm::length(p))
        ++behind;
      else
        own.add(Vec2(p.x / p.z, p.y / p.z));
    }
    if (behind == 8) continue;
    if (behind > 0) {
      own.add(-edge);
      own.add(edge);
    }
    seen.add(own);
  }
  if (seen.empty()) return;
  const Vec2 low = glm::max(seen.low, -edge), high = glm::min(seen.high, edge);
  const Vec2 size = high - low;
  if (!(size.x > 0 || size.y > 0) || !(size.x >= 0 && size.y >= 0)) return;
  grid_.step = std::max(size.x, size.y) / radar_.rays;
  grid_.columns =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(size.x / grid_.step - 1e-9)));
  grid_.rows =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(size.y / grid_.step - 1e-9)));
  grid_.left = 0.5 * (low.x + high.x) - 0.5 * grid_.step * static_cast<double>(grid_.columns);
  grid_.top = 0.5 * (low.y + high.y) - 0.5 * grid_.step * static_cast<double>(grid_.rows);
}

// Physical optics of one tube: the surface's currents 2 n × H sent back to the antenna, with the
// phase linear over the tube. (W. B. Gordon, "Far-field approximations to the Kirchhoff-Helmholtz
// representations of scattered fields", 1975, has the same integral over polygons.)
std::optional<RadarEcho> RadarTracer::reflected(const Tube& tube, const Vec3& at,
                                                const Vec3& normal, const Vec3& velocity,
                                                double solid, int bounce) const {
  const double facing = -glm::dot(normal, tube.along);
  const double back = glm::length(at);
  const Vec3 home = at / -back;
  if (!(facing > 1e-9) || !(glm::dot(home, normal) > 0)) return std::nullopt;
  double coupling = 1;
  if (bounce > 0) {
    trace::Ray ray{{at, home}};
    ray.min_distance = 1e-6;
    ray.max_distance = back - 1e-6;
    if (scene_.any(ray)) return std::nullopt;
    const Vec3 current = tube.along * glm::dot(normal, tube.field) + tube.field * facing;
    coupling = glm::dot(polarised(-home), current) / facing;
  }
  const auto slope = [&](const Vec3& across) {  // of the path, by half a step of the grid
    const double longer = tube.length * glm::dot(normal, across) / facing;
    const Vec3 moved = tube.length * across + tube.along * longer;
    return 0.5 * grid_.step * (longer - glm::dot(home, moved));
  };
  RadarEcho echo;
  const double path = tube.length + back;
  echo.range = 0.5 * path;
  echo.speed = 0.5 * (tube.rate - glm::dot(home, velocity));
  echo.phase = wave_ * path;
  const double share = tube.root * coupling * solid * tube.length / back *
                       sinc(wave_ * slope(tube.across_x)) * sinc(wave_ * slope(tube.across_y));
  echo.section = share * echo.range * echo.range * std::sqrt(4 * kPi) / radar_.wavelength();
  echo.amplitude = share * std::sqrt(sent_) / (4 * kPi);
  return echo;
}

bool RadarTracer::trace(std::size_t number, std::vector<RadarEcho>& out) const {
  const double x = grid_.left + grid_.step * (static_cast<double>(number % grid_.columns) + 0.5);
  const double y = grid_.top + grid_.step * (static_cast<double>(number / grid_.columns) + 0.5);
  const double norm = std::sqrt(1 + x * x + y * y);
  const Vec3 sent = Vec3(x, y, 1) / norm;
  const double pattern = pattern_gain(radar_, sent);
  if (!(pattern > 0)) return false;
  const double solid = grid_.step * grid_.step / (norm * norm * norm);
  const Vec3 across_x = (Vec3(1, 0, 0) - sent * sent.x) / norm;
  const Vec3 across_y = (Vec3(0, 1, 0) - sent * sent.y) / norm;
  Tube tube{Vec3(0), sent, across_x, across_y, polarised(sent)};
  const double azimuth = det::atan2(x, 1), elevation = det::asin(-sent.y);
  bool met = false;
  for (int bounce = 0; bounce < static_cast<int>(radar_.bounces); ++bounce) {
    trace::Ray ray{{tube.from, tube.along}};
    if (bounce > 0) ray.min_distance = 1e-6;
    const trace::Hit hit = scene_.nearest(ray);
    if (!hit) break;
    met = true;
    const trace::Ids ids = scene_.ids(hit);
    const RadarSurface& surface = *surfaces_[hit.target][ids.material];
    const Vec3 at = tube.from + hit.distance * tube.along;
    Vec3 normal = scene_.observer_from(hit.target).linear * scene_.surface(hit).facet;
    if (glm::dot(normal, tube.along) > 0) normal = -normal;
    tube.length += hit.distance;
    Vec3 velocity(0);
    if (!motions_.empty()) {
      velocity = motions_[hit.target][ids.node - 1](at);
      tube.rate += glm::dot(tube.along, velocity - tube.velocity);
    }
    const auto put = [&](RadarEcho echo) {
      echo.azimuth = azimuth;
      echo.elevation = elevation;
      echo.target = hit.target;
      out.push_back(echo);
    };
    if (surface.law != ScatterLaw::metal) {  // and back by the same way
      const double cosine = std::max(-glm::dot(normal, tube.along), kLeastCosine);
      RadarEcho echo;
      echo.range = tube.length;
      echo.speed = tube.rate;
      const double left = tube.root * tube.root;  // of the power, one way
      echo.section =
          left * left * sigma_nought(surface, cosine) / cosine * solid * tube.length * tube.length;
      const double spread = 4 * kPi * tube.length * tube.length;
      echo.power = sent_ * pattern * pattern * radar_.wavelength() * radar_.wavelength() *
                   echo.section / (spread * spread * 4 * kPi);
      put(echo);
      break;
    }
    tube.root *= std::sqrt(surface.level);
    if (auto echo = reflected(tube, at, normal, velocity, solid, bounce)) {
      echo->amplitude *=
          bounce == 0 ? pattern : std::sqrt(pattern * pattern_gain(radar_, glm::normalize(at)));
      put(*echo);
    }
    tube.from = at;
    tube.velocity = velocity;
    tube.along = mirrored(tube.along, normal);
    tube.across_x = mirrored(tube.across_x, normal);
    tube.across_y = mirrored(tube.across_y, normal);
    tube.field = -mirrored(tube.field, normal);
  }
  return met;
}

// Sums of echoes: fields of metal, powers of the rest, and moments of both.
struct TargetSums {
  std::complex<double> section, field, field_range, field_speed;  // section: its root, m
  double sections = 0, power = 0, range = 0, speed = 0;

  void add(const RadarEcho& echo) {
    if (echo.amplitude != 0) {
      const std::complex<double> turn(det::cos(echo.phase), det::sin(echo.phase));
      section += echo.section * turn;
      field += echo.amplitude * turn;
      field_range += echo.amplitude * echo.range * turn;
      field_speed += echo.amplitude * echo.speed * turn;
      return;
    }
    sections += echo.section;
    power += echo.power;
    range += echo.power * echo.range;
    speed += echo.power * echo.speed;
  }
  double watts() const { return std::norm(field) + power; }
};

// Distance at which the first surface is: where the profile rises through a share of its largest
// value over the noise.
std::optional<double> altitude_of(const RadarHistogram& histogram, double share) {
  std::vector<double> profile(histogram.ranges);
  for (std::size_t i = 0; i < histogram.power.size(); ++i)
    profile[i % histogram.ranges] += histogram.power[i];
  const double floor = histogram.noise * histogram.speeds;
  const double most = *std::ranges::max_element(profile) - floor;
  const double spread = histogram.noise * std::sqrt(static_cast<double>(histogram.speeds));
  if (!(most > 5 * spread)) return std::nullopt;
  const double level = floor + share * most;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    if (profile[i] < level) continue;
    const double before = i > 0 ? profile[i - 1] : 0;
    const double part = i > 0 ? (profile[i] - level) / (profile[i] - before) : 0;
    return histogram.first_range + (static_cast<double>(i) - part) * histogram.range_step;
  }
  return std::nullopt;
}

void name_targets(const world::World& world, const std::vector<TargetSums>& sums,
                  RadarHistogram& out) {
  for (std::size_t i = 0; i < world.size(); ++i) {
    RadarTarget& target = out.targets.emplace_back();
    target.name = world[i].name();
    const TargetSums& sum = sums[i];
    target.cross_section = std::norm(sum.section) + sum.sections;
    if (!(sum.watts() > 0)) continue;
    const std::complex<double> back = std::conj(sum.field);
    target.range = ((back * sum.field_range).real() + sum.range) / sum.watts();
    target.speed = ((back * sum.field_speed).real() + sum.speed) / sum.watts();
  }
}

}  // namespace

double sigma_nought(const RadarSurface& surface, double cosine) {
  switch (surface.law) {
    case ScatterLaw::metal:
      return 0;
    case ScatterLaw::lambert:
      return 4 * surface.level * cosine * cosine;
    case ScatterLaw::cosine:
      return surface.level * det::pow(cosine, surface.exponent);
    case ScatterLaw::hagfors:
      break;
  }
  const double c = 1 / (surface.slope * surface.slope), square = cosine * cosine;
  const double base = square * square + c * (1 - square);
  return 0.5 * c * surface.level / (base * std::sqrt(base));
}

double pattern_gain(const Radar& radar, const Vec3& direction) {
  if (!(direction.z > 0)) return 0;
  const double azimuth = det::atan2(direction.x, direction.z);
  const double elevation = det::asin(std::clamp(-direction.y, -1.0, 1.0));
  const double x = azimuth / radar.beam.x, y = elevation / radar.beam.y;
  const Vec2 edge = half_extent(radar) / radar.beam;
  switch (radar.pattern) {
    case BeamPattern::gaussian:
      return x * x + y * y > edge.x * edge.x ? 0
                                             : det::exp(-4 * std::numbers::ln2 * (x * x + y * y));
    case BeamPattern::aperture: {
      if (std::fabs(x) > edge.x || std::fabs(y) > edge.y) return 0;
      constexpr double kHalfPower = 2 * 1.39155737825151;  // sinc² is 1/2 at 1.3916
      return lobe(kHalfPower * det::sin(azimuth) / radar.beam.x) *
             lobe(kHalfPower * det::sin(elevation) / radar.beam.y);
    }
    case BeamPattern::uniform:
      break;
  }
  return x * x + y * y <= 0.25 ? 1 : 0;
}

double peak_gain(const Radar& radar) {
  if (radar.gain > 0) return radar.gain;
  const double area = radar.beam.x * radar.beam.y;
  switch (radar.pattern) {
    case BeamPattern::gaussian:
      return 16 * std::numbers::ln2 / area;
    case BeamPattern::aperture:  // 4 pi A / lambda²
      return 4 * kPi * (2 * 1.39155737825151 / kPi) * (2 * 1.39155737825151 / kPi) / area;
    case BeamPattern::uniform:
      break;
  }
  return 16 / area;
}

Result<RadarHistogram> measure(const Radar& radar, const RadarMoment& moment,
                               const RadarMotion* motion, const RadarOptions& options,
                               DiagnosticLog& log, const Job& job) {
  try {
    RadarTracer tracer(radar, moment, log, job);
    if (motion != nullptr) tracer.set_motion(*motion);
    RadarHistogram out;
    out.rays = tracer.rays();
    out.spacing = tracer.grid().step;
    out.gain = tracer.gain();
    RadarGrid grid(radar);
    std::vector<TargetSums> sums(moment.world.size());
    TargetSums inside, outside;
    const std::size_t chunk = 512;
    Phase phase(job, "tracing rays", tracer.rays() / kBand + 1);
    for (std::size_t begin = 0; begin < tracer.rays(); begin += kBand) {
      const std::size_t end = std::min(tracer.rays(), begin + kBand);
      const std::size_t chunks = (end - begin + chunk - 1) / chunk;
      std::vector<std::vector<RadarEcho>> echoes(chunks);
      std::vector<std::uint64_t> hits(chunks);
      parallel_for(
          chunks,
          [&](std::size_t i) {
            const std::size_t last = std::min(end, begin + (i + 1) * chunk);
            for (std::size_t ray = begin + i * chunk; ray < last; ++ray)
              hits[i] += tracer.trace(ray, echoes[i]);
          },
          job);
      for (std::size_t i = 0; i < chunks; ++i) {
        out.hits += hits[i];
        for (const RadarEcho& echo : echoes[i]) {
          grid.add(echo);
          sums[echo.target].add(echo);
          (grid.holds(echo) ? inside : outside).add(echo);
        }
      }
      phase.advance();
    }
    grid.finish(options, out, job);
    name_targets(moment.world, sums, out);
    out.echo_power = inside.watts() + outside.watts();
    out.outside = out.echo_power > 0 ? outside.watts() / out.echo_power : 0;
    if (radar.altimeter > 0) out.altitude = altitude_of(out, radar.altimeter);
    tracer.report_damaged(log);
    return out;
  } catch (const Cancelled&) {
    report_cancelled(log);
    return failed;
  }
}

}  // namespace panwright::instruments
