#include "instruments/lidar.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "instruments/internal/receiver.h"
#include "preview/reference/surfaces.h"

namespace panwright::instruments {

namespace {

constexpr double kPlanck = 6.62607015e-34, kSpeed = 299'792'458, kBoltzmann = 1.380649e-23;
constexpr std::size_t kPulsesAtOnce = 64;    // of a thread
constexpr std::size_t kMomentsAtOnce = 512;  // states that are held
constexpr std::size_t kStillAtOnce = 16384;  // pulses whose points wait for their place

// Of the Sun at 1 AU, W/m²/nm: of a black body of 5772 K, the effective temperature.
double solar_irradiance(double wavelength) {
  constexpr double kTemperature = 5772, kRadius = 6.957e8, kUnit = 1.495978707e11;
  const double x = kPlanck * kSpeed / (wavelength * kBoltzmann * kTemperature);
  const double square = wavelength * wavelength;
  const double radiance =
      2 * kPlanck * kSpeed * kSpeed / (square * square * wavelength) / (det::exp(x) - 1);
  return kPi * radiance * (kRadius / kUnit) * (kRadius / kUnit) * 1e-9;
}

// Places of sub-rays, each of the same light: of a Gaussian in units of its radius at 1/e², on
// Vogel's spiral; of a pixel in its sides, from 0 to 1.
std::vector<Vec2> footprint(const Lidar& lidar) {
  std::vector<Vec2> out;
  const std::uint32_t count = lidar.sub_rays;
  if (count == 1) return {Vec2(0)};
  const double golden = kPi * (3 - std::sqrt(5.0));
  for (std::uint32_t k = 0; k < count; ++k) {
    if (lidar.scan.pattern == ScanPattern::flash) {
      // M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018
      const double x = 0.5 + k * 0.7548776662466927, y = 0.5 + k * 0.5698402909980532;
      out.emplace_back(x - std::floor(x), y - std::floor(y));
    } else {
      const double share = (k + 0.5) / count;
      const double radius = std::sqrt(-0.5 * det::log(1 - share));
      const auto turn = det::sincos(k * golden);
      out.emplace_back(radius * turn.cos, radius * turn.sin);
    }
  }
  return out;
}

class Measurement {
 public:
  Measurement(const Lidar& lidar, const LidarOptions& options)
      : lidar_(resolved(lidar, options.ideal)),
        options_(options),
        random_{options.seed, options.frame},
        receiver_(lidar_, random_),
        footprint_(footprint(lidar_)) {
    electrons_per_joule_ = lidar_.quantum_efficiency * lidar_.wavelength / (kPlanck * kSpeed);
    collecting_ = 0.25 * kPi * lidar_.aperture * lidar_.aperture * lidar_.efficiency;
    const double pixels = double(lidar_.scan.columns) * lidar_.scan.rows;
    energy_ = lidar_.pulse_energy;
    if (lidar_.eye_safe_energy > 0) energy_ = std::min(energy_, lidar_.eye_safe_energy);
    beam_energy_ = is_flash() ? energy_ / pixels : energy_;
    focal_ = is_flash() ? 0.5 * lidar_.scan.columns / det::tan(0.5 * lidar_.scan.fov) : 1;
    const double field =
        is_flash() ? 1 / (focal_ * focal_) : 0.25 * kPi * lidar_.field * lidar_.field;
    const double sun =
        lidar_.sun_w_m2_nm > 0 ? lidar_.sun_w_m2_nm : solar_irradiance(lidar_.wavelength);
    sent_ =
        beam_energy_ / static_cast<double>(footprint_.size()) * electrons_per_joule_ * collecting_;
    background_ = sun * lidar_.filter_nm * field * collecting_ * electrons_per_joule_;
    with_sun_ = lidar_.sun && (lidar_.excess_noise > 0 || lidar_.photon_counting);
  }

  bool run(const world::World& world, const world::Pose& pose, LidarCloud& cloud,
           DiagnosticLog& log, const Job& job);

 private:
  struct Scratch {
    std::vector<trace::Ray> rays;  // of the footprint
    std::vector<trace::Hit> hits;
    std::vector<Returned> returned;
    Receiver::Scratch receiver;
  };
  // Points of some pulses.
  struct Block {
    std::vector<LidarPoint> points;
    std::vector<std::pair<std::uint32_t, Excess>> excess;
  };
  using Blooms = std::map<std::uint32_t, std::vector<Returned>>;  // by pulse

  bool is_flash() const { return lidar_.scan.pattern == ScanPattern::flash; }
  static Lidar resolved(Lidar lidar, bool ideal);
  struct Across;
  Across across(const Pulse& pulse, const Vec2& turn) const;
  geometry::Ray sub_ray(const Across& across, Vec2 place, const Vec2& turn) const;
  void gather(const preview::SurfaceScene& scene, const world::World& world, std::uint32_t number,
              Scratch& scratch, double& background) const;
  void add_surface(const preview::SurfaceScene& scene, const trace::Hit& hit,
                   std::vector<Returned>& returned) const;
  double sunlight(const preview::SurfaceScene& scene, const world::World& world,
                  const trace::Hit& hit) const;
  void measure_one(const preview::SurfaceScene& scene, const LidarMoment& moment,
                   std::uint32_t number, const Blooms& blooms, Scratch& scratch, Block& block);
  void add_points(const LidarMoment& moment, std::uint32_t number, const std::vector<Echo>& echoes,
                  Block& block) const;
  bool measure_all(const preview::SurfaceScene& scene, const LidarMoment& still, LidarCloud& cloud,
                   const Job& job);
  void bloom(const preview::SurfaceScene& scene, const LidarMoment& still, LidarCloud& cloud,
             const Job& job);

  const Lidar lidar_;
  const LidarOptions& options_;
  const LidarRandom random_;
  const Receiver receiver_;
  const std::vector<Vec2> footprint_;
  double electrons_per_joule_ = 0;
  double collecting_ = 0;   // m², with the optics' losses
  double energy_ = 0;       // joules of a pulse
  double beam_energy_ = 0;  // of a footprint
  double sent_ = 0;         // electrons of a sub-ray from 1/sr at one metre
  double focal_ = 1;        // pixels, of a flash
  double background_ = 0;   // electrons a second of radiance 1/sr of the Sun's irradiance
  bool with_sun_ = false;
  LidarCloud* cloud_ = nullptr;
  std::vector<std::pair<std::uint32_t, Excess>> excess_;
};

// The threshold where none is given, and what an ideal instrument leaves out.
Lidar Measurement::resolved(Lidar lidar, bool ideal) {
  if (ideal) lidar.sub_rays = 1;
  const double fwhm =
      std::sqrt(lidar.pulse_fwhm * lidar.pulse_fwhm + lidar.response_fwhm * lidar.response_fwhm);
  const double sample = lidar.sample > 0 ? lidar.sample : 0.5 * fwhm / 2.3548200450309493;
  if (!(lidar.threshold_e > 0)) {
    const double noise = std::sqrt(lidar.excess_noise * lidar.dark_e_per_s * sample +
                                   lidar.electronics_e * lidar.electronics_e);
    lidar.threshold_e = std::max(5 * noise, 1.0);
  }
  return lidar;
}

// Axes across a pulse, scaled so that places of the footprint are offsets of its direction; turned.
struct Measurement::Across {
  Vec3 axis{0}, u{0}, v{0};
};

Measurement::Across Measurement::across(const Pulse& pulse, const Vec2& turn) const {
  const Vec3& d = pulse.direction;
  if (is_flash()) return {d / d.z, Vec3(1 / focal_, 0, 0), Vec3(0, 1 / focal_, 0)};
  const Vec3 u = glm::normalize(std::fabs(d.y) < 0.9 ? Vec3(d.z, 0, -d.x) : Vec3(0, d.z, -d.y));
  const Vec3 v = glm::cross(d, u);
  const double radius = 0.5 * lidar_.divergence;
  return {d, radius * (turn.x * u + turn.y * v), radius * (turn.x * v - turn.y * u)};
}

geometry::Ray Measurement::sub_ray(const Across& across, Vec2 place, const Vec2& turn) const {
  if (is_flash()) {
    // shifted around, and back into the pixel
    place += turn;
    place -= glm::floor(place) + 0.5;
  }
  const Vec3 along = across.axis + place.x * across.u + place.y * across.v;
  return {Vec3(0), along * (1 / std::sqrt(glm::dot(along, along)))};
}

// Light of one sub-ray: from the surface, in a mirror that faces the instrument, and of what a
// mirror shows.
void Measurement::add_surface(const preview::SurfaceScene& scene, const trace::Hit& hit,
                              std::vector<Returned>& returned) const {
  const double square = std::max(hit.distance * hit.distance, 1e-12);
  preview::SurfaceScene::BandLight plain;
  if (scene.returned_from_table(hit, lidar_.band, plain)) {
    if (plain.returned > 0)
      returned.push_back(
          {hit.distance, sent_ * plain.returned / square, plain.cosine, scene.rays().ids(hit), 0});
    return;
  }
  const preview::ViewedSurface seen = scene.returned(hit);
  double factor = seen.returned[lidar_.band];
  for (std::size_t i = 0; i < static_cast<std::size_t>(seen.mirror_count); ++i) {
    const preview::SurfaceMirror& mirror = seen.mirrors[i];
    const double reflectance = mirror.reflectance[lidar_.band];
    if (!(reflectance > 0)) continue;
    // back into the aperture, whose disc the mirrored beam must meet
    const Vec3 apart = mirror.direction + hit.direction;
    const double disc = 0.25 * lidar_.aperture * lidar_.aperture / square;
    if (glm::dot(apart, apart) <= disc) factor += reflectance / (kPi * disc);
    const trace::Ray onward{{seen.start, mirror.direction}, hit.target};
    const trace::Hit behind = scene.rays().nearest(onward, trace::Insides::stop);
    if (!behind || scene.rays().is_inside(behind)) continue;
    const preview::ViewedSurface shown = scene.returned(behind);
    const double range = hit.distance + behind.distance;
    const double electrons =
        sent_ * reflectance * reflectance * shown.returned[lidar_.band] / (range * range);
    if (electrons > 0)
      returned.push_back({range, electrons, shown.cosine, scene.rays().ids(behind), kGhost});
  }
  if (factor > 0)
    returned.push_back(
        {hit.distance, sent_ * factor / square, seen.cosine, scene.rays().ids(hit), 0});
}

// Electrons a second of the Sun's light on the surface of a hit.
double Measurement::sunlight(const preview::SurfaceScene& scene, const world::World& world,
                             const trace::Hit& hit) const {
  const trace::RigidFrame& frame = scene.rays().targets()[hit.target].frame;
  const Vec3 to_sun = glm::normalize(world.sun().direction) * frame.world_from;
  Vec3 start(0);
  const double factor = scene.lit(hit, to_sun, start)[lidar_.band];
  if (!(factor > 0)) return 0;
  const trace::Ray shadow{{start, to_sun}, hit.target};
  if (scene.rays().any(shadow, trace::Insides::stop)) return 0;
  return factor * background_ / (world.sun().distance * world.sun().distance);
}

void Measurement::gather(const preview::SurfaceScene& scene, const world::World& world,
                         std::uint32_t number, Scratch& scratch, double& background) const {
  const Pulse& pulse = cloud_->pulses[number];
  Vec2 turn(0);
  if (footprint_.size() > 1) {
    const auto u = random_.uniform(LidarStage::turn, number, 0);
    const auto angle = det::sincos(2 * kPi * u[0]);
    turn = is_flash() ? Vec2(u[0], u[1]) : Vec2(angle.cos, angle.sin);
  }
  scratch.rays.clear();
  if (footprint_.size() == 1) {
    scratch.rays.push_back({{Vec3(0), pulse.direction}, trace::Ray::kObserver});
  } else {
    const Across sides = across(pulse, turn);
    for (const Vec2& place : footprint_)
      scratch.rays.push_back({sub_ray(sides, place, turn), trace::Ray::kObserver});
  }
  scratch.hits.resize(scratch.rays.size());
  scene.rays().nearest_bundle(scratch.rays, scratch.hits);
  for (std::size_t k = 0; k < scratch.hits.size(); ++k) {
    const trace::Hit& hit = scratch.hits[k];
    if (!hit) continue;
    if (k == 0 && with_sun_) background = sunlight(scene, world, hit);
    add_surface(scene, hit, scratch.returned);
  }
}

void Measurement::add_points(const LidarMoment& moment, std::uint32_t number,
                             const std::vector<Echo>& echoes, Block& block) const {
  const Pulse& pulse = cloud_->pulses[number];
  for (std::size_t k = 0; k < echoes.size(); ++k) {
    const Echo& echo = echoes[k];
    LidarPoint& out = block.points.emplace_back();
    out.pulse = number;
    out.echo = static_cast<std::uint8_t>(k);
    out.echoes = static_cast<std::uint8_t>(echoes.size());
    out.flags = echo.flags;
    out.time = pulse.time;
    out.range = echo.range;
    out.intensity = echo.intensity;
    const double at_one_metre = beam_energy_ * electrons_per_joule_ * collecting_ / kPi;
    if (!lidar_.photon_counting || options_.ideal)
      out.reflectance = echo.intensity * echo.range * echo.range / at_one_metre;
    out.position = echo.range * pulse.direction;
    if (options_.frame_of != LidarOptions::kInstrument)
      out.position = moment.pose.rotation * out.position + moment.pose.translation;
    if (options_.frame_of >= 0) {
      const world::Pose& target = moment.world[static_cast<std::size_t>(options_.frame_of)].pose();
      out.position = glm::conjugate(target.rotation) * (out.position - target.translation);
    }
    out.true_range = echo.true_range;
    out.share = echo.share;
    out.cosine = echo.cosine;
    out.ids = echo.ids;
  }
}

void Measurement::measure_one(const preview::SurfaceScene& scene, const LidarMoment& moment,
                              std::uint32_t number, const Blooms& blooms, Scratch& scratch,
                              Block& block) {
  std::vector<Returned>& returned = scratch.returned;
  std::vector<Echo>& echoes = scratch.receiver.echoes;
  returned.clear();
  double background = 0;
  gather(scene, moment.world, number, scratch, background);
  if (const auto more = blooms.find(number); more != blooms.end())
    returned.insert(returned.end(), more->second.begin(), more->second.end());
  PulseStatus& status = cloud_->status[number];
  if (options_.ideal) {
    echoes.clear();
    std::ranges::stable_sort(returned, {}, &Returned::range);
    for (const Returned& each : returned) {
      if ((each.flags & kGhost) != 0 || !echoes.empty()) continue;
      echoes.push_back({each.range, each.electrons, each.range, 1, each.cosine, each.ids, 0});
    }
    status = echoes.empty() ? PulseStatus::no_echo : PulseStatus::echo;
  } else {
    Excess excess;
    status = receiver_.receive(number, returned, background, scratch.receiver, excess);
    if (excess.electrons > 0) block.excess.emplace_back(number, excess);
  }
  add_points(moment, number, echoes, block);
}

bool Measurement::measure_all(const preview::SurfaceScene& scene, const LidarMoment& still,
                              LidarCloud& cloud, const Job& job) {
  const std::size_t count = cloud.pulses.size();
  const bool moves = options_.motion && !is_flash();
  const std::size_t at_once = moves ? kMomentsAtOnce : kStillAtOnce;
  // note: memory for all, of which untouched pages cost nothing
  if (!moves) cloud.points.reserve(count);
  Phase phase(job, "measure", count);
  const Blooms none;
  std::vector<Block> blocks;  // their memory serves all rounds
  for (std::size_t first = 0; first < count; first += at_once) {
    const std::size_t end = std::min(count, first + at_once);
    std::vector<LidarMoment> moments;  // of each pulse
    for (std::size_t i = first; moves && i < end; ++i) {
      job.poll();
      if (i > first && cloud.pulses[i].time == cloud.pulses[i - 1].time) {
        moments.push_back(moments.back());
      } else {
        moments.push_back(moments.empty() ? still : moments.back());
        if (!options_.motion(cloud.pulses[i].time, moments.back())) return false;
      }
      cloud.poses.push_back(moments.back().pose);
    }
    blocks.resize((end - first + kPulsesAtOnce - 1) / kPulsesAtOnce);
    for (Block& block : blocks) {
      block.points.clear();
      block.excess.clear();
    }
    parallel_for(
        blocks.size(),
        [&](std::size_t b) {
          const std::size_t from = first + b * kPulsesAtOnce;
          const std::size_t to = std::min(end, from + kPulsesAtOnce);
          Scratch scratch;
          std::optional<preview::SurfaceScene> own;
          if (moves) own.emplace(scene);
          for (std::size_t i = from; i < to; ++i) {
            const LidarMoment& moment = moves ? moments[i - first] : still;
            if (own && (i == from || cloud.pulses[i].time != cloud.pulses[i - 1].time)) {
              own->update(moment.world);
              own->place_observer(moment.pose);
            }
            measure_one(own ? *own : scene, moment, static_cast<std::uint32_t>(i), none, scratch,
                        blocks[b]);
          }
          phase.advance(to - from);
        },
        job);
    for (Block& block : blocks) {
      cloud.points.insert(cloud.points.end(), block.points.begin(), block.points.end());
      excess_.insert(excess_.end(), block.excess.begin(), block.excess.end());
    }
  }
  return true;
}

// Light beyond saturation, spread over the pixels around, which are measured anew with it.
void Measurement::bloom(const preview::SurfaceScene& scene, const LidarMoment& still,
                        LidarCloud& cloud, const Job& job) {
  if (!is_flash() || lidar_.bloom_pixels == 0 || !(lidar_.bloom_share > 0) || excess_.empty())
    return;
  const auto reach = static_cast<std::int64_t>(lidar_.bloom_pixels);
  const std::int64_t columns = lidar_.scan.columns, rows = lidar_.scan.rows;
  const double around = static_cast<double>((2 * reach + 1) * (2 * reach + 1) - 1);
  Blooms blooms;
  for (const auto& [number, excess] : excess_)
    for (std::int64_t dy = -reach; dy <= reach; ++dy)
      for (std::int64_t dx = -reach; dx <= reach; ++dx) {
        const std::int64_t x = number % columns + dx, y = number / columns + dy;
        if ((dx == 0 && dy == 0) || x < 0 || y < 0 || x >= columns || y >= rows) continue;
        blooms[static_cast<std::uint32_t>(y * columns + x)].push_back(
            {excess.range, lidar_.bloom_share * excess.electrons / around, 0, {}, kBloomed});
      }
  std::vector<std::uint32_t> numbers;
  for (const auto& [number, more] : blooms) numbers.push_back(number);
  std::vector<Block> blocks(numbers.size());
  parallel_for(
      numbers.size(),
      [&](std::size_t i) {
        Scratch scratch;
        measure_one(scene, still, numbers[i], blooms, scratch, blocks[i]);
      },
      job);
  std::vector<LidarPoint> points;
  std::size_t next = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    while (next < cloud.points.size() && cloud.points[next].pulse < numbers[i])
      points.push_back(cloud.points[next++]);
    while (next < cloud.points.size() && cloud.points[next].pulse == numbers[i]) ++next;
    points.insert(points.end(), blocks[i].points.begin(), blocks[i].points.end());
  }
  points.insert(points.end(), cloud.points.begin() + static_cast<std::ptrdiff_t>(next),
                cloud.points.end());
  cloud.points = std::move(points);
}

bool Measurement::run(const world::World& world, const world::Pose& pose, LidarCloud& cloud,
                      DiagnosticLog& log, const Job& job) {
  cloud_ = &cloud;
  cloud.pulses = pulses_of(lidar_.scan);
  cloud.status.resize(cloud.pulses.size());
  cloud.energy = energy_;
  if (is_flash() || lidar_.scan.pattern == ScanPattern::raster) {
    cloud.columns = lidar_.scan.columns;
    cloud.rows = lidar_.scan.rows;
  } else if (lidar_.scan.pattern == ScanPattern::rotating) {
    cloud.columns = lidar_.scan.columns;
    cloud.rows = static_cast<std::uint32_t>(lidar_.scan.channels.size());
  }
  const double span = cloud.pulses.empty() ? 0 : cloud.pulses.back().time;
  if (span > 0) cloud.power = energy_ * static_cast<double>(cloud.pulses.size() - 1) / span;
  LidarMoment still{world, pose};
  if (options_.motion && is_flash()) {
    if (!options_.motion(0, still)) return false;
  }
  preview::SurfaceScene scene;
  scene.update(still.world, job);
  scene.place_observer(still.pose);
  if (!options_.motion || is_flash()) cloud.poses.push_back(still.pose);
  if (!measure_all(scene, still, cloud, job)) return false;
  bloom(scene, still, cloud, job);
  scene.rays().report_damaged(log);
  return true;
}

}  // namespace

Result<LidarCloud> measure(const Lidar& lidar, const world::World& world, const world::Pose& pose,
                           const LidarOptions& options, DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&]() -> Result<LidarCloud> {
    LidarCloud cloud;
    if (!Measurement(lidar, options).run(world, pose, cloud, log, job)) return failed;
    return cloud;
  });
}

}  // namespace panwright::instruments
