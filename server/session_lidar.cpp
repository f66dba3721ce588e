// LiDAR and RADAR requests: ideal ranges along single rays.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/session.h"

namespace panwright::server {

namespace {

enum LidarFlag : std::uint32_t { kRange = 1, kAngles = 2, kCubes = 4, kTimes = 8 };
constexpr std::uint32_t kGeneralScan = 7;

struct Beam {
  Vec3 origin{0}, direction{0, 0, 1};  // world
  double azimuth = 0, elevation = 0;   // degrees
  double time = 0;                     // seconds
};

struct Echo {
  double range = 0, cosine = 0;  // 0: none
};

Vec3 direction_of(double azimuth, double elevation) {
  const det::SinCos a = det::sincos(azimuth * kDegree), e = det::sincos(elevation * kDegree);
  return {a.sin * e.cos, -e.sin, a.cos * e.cos};
}

std::vector<Echo> echoes_of(const trace::Scene& scene, std::span<const Beam> beams,
                            const Job& job) {
  std::vector<trace::Ray> rays(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i) {
    rays[i].origin = beams[i].origin - scene.observer().position;
    rays[i].direction = beams[i].direction;
  }
  std::vector<trace::Hit> hits(beams.size());
  scene.nearest(rays, hits, trace::Insides::pass, job);
  std::vector<Echo> out(beams.size());
  for (std::size_t i = 0; i < beams.size(); ++i)
    if (hits[i])
      out[i] = {hits[i].distance,
                std::abs(glm::dot(hits[i].direction, scene.surface(hits[i]).normal))};
  return out;
}

// The nearest corner cube that a beam meets before the surface.
Echo cube_echo(const State& state, const Beam& beam, const Echo& surface) {
  Echo nearest;
  const world::Pose lattice = state.cube_motion.at({Vec3(0), state.cube_attitude}, beam.time);
  for (const CornerCube& cube : state.cubes) {
    const Vec3 position = lattice.rotation * cube.position;
    const Vec3 normal = lattice.rotation * cube.normal;
    const double length = glm::length(normal);
    const double facing = -glm::dot(beam.direction, normal);
    if (!(facing > 0)) continue;
    const double range = glm::dot(position - beam.origin, normal) / -facing;
    if (!(range > 0) || (surface.range > 0 && range > surface.range + cube.radius)) continue;
    if (glm::length(beam.origin + range * beam.direction - position) > cube.radius) continue;
    if (nearest.range == 0 || range < nearest.range) nearest = {range, facing / length};
  }
  return nearest;
}

void check_direction(const Vec3& direction) {
  if (!(glm::length(direction) > 0 && is_finite(direction)))
    throw RequestError{WireError::number, "a direction is 0, or not finite"};
}

world::Pose read_pose(WireReader& in, bool doubles) {
  const auto next = [&] { return doubles ? in.real64() : in.real(); };
  world::Pose out;
  for (int k = 0; k < 3; ++k) out.translation[k] = next();
  const double w = next(), x = next(), y = next(), z = next();
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!in.finite() || !(length > 1e-6))
    throw RequestError{WireError::number, "a quaternion has no length, or a number is not finite"};
  out.rotation = Quat(w / length, x / length, y / length, z / length);
  return out;
}

}  // namespace

Bytes Session::pulse(WireReader& in, const Job& job) {
  Beam beam;
  for (Vec3* vector : {&beam.origin, &beam.direction})
    for (int k = 0; k < 3; ++k) (*vector)[k] = in.real();
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  check_direction(beam.direction);
  beam.direction = glm::normalize(beam.direction);
  const Echo echo = echoes_of(stage_.rays(state(), job), std::span(&beam, 1), job)[0];
  return WireWriter().word(reply::kLidarPulse).real(echo.range).real(echo.cosine).take();
}

Bytes Session::scan(bool doubles, WireReader& in, const Job& job) {
  const world::Pose start = read_pose(in, doubles);
  Motion motion;
  for (Vec3* vector : {&motion.velocity, &motion.turn, &motion.acceleration,
                       &motion.turn_acceleration, &motion.jerk, &motion.turn_jerk})
    for (int k = 0; k < 3; ++k) (*vector)[k] = doubles ? in.real64() : in.real();
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  const LidarParameters& lidar = state().lidar;
  const std::uint32_t flags = lidar.flags & 15;
  constexpr std::uint64_t kBeamBytes = 8;  // of a block
  const std::uint64_t columns = std::uint64_t{lidar.columns} * lidar.samples_x;
  const std::uint64_t rows = std::uint64_t{lidar.rows} * lidar.samples_y;
  const auto blocks = static_cast<std::uint64_t>(std::popcount(flags));
  check_reply(std::max(columns, rows), kBeamBytes * 4, options_.most_reply);
  check_reply(columns * rows, kBeamBytes * 4, options_.most_reply);

  const bool general = lidar.type == kGeneralScan;
  std::vector<Beam> beams(columns * rows);
  for (std::uint64_t j = 0; j < rows; ++j)
    for (std::uint64_t i = 0; i < columns; ++i) {
      Beam& beam = beams[j * columns + i];
      // results run from the top row down, or up with bit 17
      const std::uint64_t row = (lidar.flags >> 17 & 1) != 0 ? rows - 1 - j : j;
      beam.azimuth =
          lidar.others[0] +
          ((static_cast<double>(i) + 0.5) / static_cast<double>(columns) - 0.5) * lidar.width;
      beam.elevation =
          lidar.others[1] +
          (0.5 - (static_cast<double>(row) + 0.5) / static_cast<double>(rows)) * lidar.height;
      Vec3 local = direction_of(beam.azimuth, beam.elevation);
      if (general) {
        const std::uint64_t k = j * columns + i;
        if (k >= state().pulses.size()) continue;  // it stays without an echo
        const LidarPulse& sample = state().pulses[k];
        beam.time = sample.time;
        local = sample.direction * Vec3(0, 0, 1);
        beam.azimuth = det::atan2(local.x, local.z) / kDegree;
        beam.elevation = det::asin(std::clamp(-local.y, -1.0, 1.0)) / kDegree;
      }
      const world::Pose pose = motion.at(start, beam.time);
      beam.origin = pose.translation;
      beam.direction = glm::normalize(pose.rotation * local);
    }
  trace::Scene& scene = stage_.rays(state(), job);
  scene.place_observer({start.translation, Quat(1, 0, 0, 0)});
  std::vector<Echo> echoes = echoes_of(scene, beams, job);
  if (general)
    for (std::size_t k = state().pulses.size(); k < echoes.size(); ++k) echoes[k] = {};

  WireWriter out;
  out.word(reply::kLidarMeasurement);
  out.real(lidar.width).real(lidar.height).word(lidar.columns).word(lidar.rows);
  out.real(lidar.time_x).real(lidar.time_y).word(lidar.samples_x).word(lidar.samples_y);
  out.word(lidar.type).word(lidar.flags);
  for (const double other : lidar.others) out.real(other);
  for (int k = 0; k < 12; ++k) out.word(0);
  out.word(static_cast<std::uint32_t>(blocks * kBeamBytes * beams.size()));
  for (std::uint32_t flag = kRange; flag <= kTimes; flag <<= 1) {
    if ((flags & flag) == 0) continue;
    for (std::size_t k = 0; k < beams.size(); ++k) {
      const Echo echo = flag == kCubes ? cube_echo(state(), beams[k], echoes[k]) : echoes[k];
      if (flag == kAngles)
        out.real(beams[k].azimuth).real(beams[k].elevation);
      else if (flag == kTimes)
        out.real(beams[k].time).real(0);
      else
        out.real(echo.range).real(echo.cosine);
    }
  }
  return out.take();
}

Bytes Session::snapshot(WireReader& in, const Job& job) {
  const std::uint32_t number = in.word();
  const world::Pose pose = read_pose(in, true);
  auto camera = stage_.camera_of(state(), number);
  if (!camera) throw RequestError{WireError::number, "there is no camera of this number"};
  camera->position = pose.translation;
  camera->world_from_camera = pose.rotation;
  constexpr std::uint32_t kPixelBytes = 12;
  const std::uint64_t pixels = std::uint64_t{camera->width} * camera->height;
  check_reply(pixels, kPixelBytes, options_.most_reply);
  trace::Scene& scene = stage_.rays(state(), job);
  scene.place_observer({pose.translation, Quat(1, 0, 0, 0)});
  std::vector<Beam> beams(pixels);
  std::vector<std::uint8_t> valid(pixels, 1);
  for (std::uint64_t i = 0; i < pixels; ++i) {
    const auto ray =
        world::distorted_ray(*camera, Vec2(static_cast<double>(i % camera->width) + 0.5,
                                           static_cast<double>(i / camera->width) + 0.5));
    valid[i] = ray.has_value();
    if (ray) beams[i].origin = ray->origin, beams[i].direction = ray->direction;
  }
  const auto echoes = echoes_of(scene, beams, job);
  WireWriter out;
  out.word(reply::kRawImage).word(0).word(0).word(camera->width).word(camera->height);
  out.word(static_cast<std::uint32_t>(pixels * kPixelBytes));
  for (std::uint64_t i = 0; i < pixels; ++i) {
    const bool hit = valid[i] != 0 && echoes[i].range > 0;
    out.ieee(hit ? static_cast<float>(echoes[i].range) : 0)
        .ieee(hit ? static_cast<float>(echoes[i].cosine) : 0)
        .ieee(hit ? 1 : 0);
  }
  return out.take();
}

namespace {

// Bins of one axis of the histogram.
struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = -low;  // of the samples
  double offset = 0, size = 1;
  std::uint32_t count = 1;
  void add(double value) { low = std::min(low, value), high = std::max(high, value); }
  // flags: bit 0 from zero, 1 about the middle, 2 width to a power of ten, 3 a fixed size
  void divide(std::uint32_t flags, std::uint32_t bins, double middle, double fixed) {
    count = std::max(bins, 1u);
    if (!(low <= high)) low = high = 0;
    double width = std::max(high - low, 1e-9 * std::max(1.0, std::abs(high)));
    if ((flags & 1) != 0) width = std::max(high, 1e-9);
    if ((flags & 2) != 0)
      width = 2 * std::max({std::abs(high - middle), std::abs(low - middle), 1e-9});
    // the largest sample lies in the last bin
    width *= 1 + 1e-9;
    if ((flags & 4) != 0) width = det::pow(10, std::ceil(det::log10(width)));
    size = (flags & 8) != 0 && fixed > 0 ? fixed : width / count;
    offset = (flags & 1) != 0 ? 0 : (flags & 2) != 0 ? middle - 0.5 * size * count : low;
  }
  // count: outside
  std::uint32_t bin(double value) const {
    const double place = std::floor((value - offset) / size);
    return place >= 0 && place < count ? static_cast<std::uint32_t>(place) : count;
  }
};

}  // namespace

Bytes Session::radar(WireReader& in, const Job& job) {
  const std::uint32_t flags = in.word(), samples = in.word();
  const std::uint32_t range_bins = in.word(), speed_bins = in.word();
  const double range_size = in.real(), speed_size = in.real();
  const double range_middle = in.real(), speed_middle = in.real();
  Vec3 origin, velocity;
  for (Vec3* vector : {&origin, &velocity})
    for (int k = 0; k < 3; ++k) (*vector)[k] = in.real();
  const double w = in.real(), x = in.real(), y = in.real(), z = in.real();
  const double width = in.real();
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!in.finite() || !(length > 1e-6) || !(width >= 0 && width <= 180))
    throw RequestError{WireError::number,
                       "a quaternion has no length, a width is not within 0 and 180 degrees, or a "
                       "number is not finite"};
  check_reply(std::max(range_bins, speed_bins), 4, options_.most_reply);
  check_reply(std::uint64_t{range_bins} * speed_bins, 4, options_.most_reply);
  check_reply(samples, 64, options_.most_reply);
  const Quat axis(w / length, x / length, y / length, z / length);
  // even in solid angle, by the golden angle
  const double cap = 1 - det::cos(0.5 * width * kDegree);
  const double golden = kPi * (3 - std::sqrt(5.0));
  std::vector<Beam> beams(samples);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double c = 1 - cap * (i + 0.5) / samples, s = std::sqrt(std::max(0.0, 1 - c * c));
    const det::SinCos turn = det::sincos(golden * i);
    beams[i].origin = origin;
    beams[i].direction = axis * Vec3(s * turn.cos, s * turn.sin, c);
  }
  trace::Scene& scene = stage_.rays(state(), job);
  scene.place_observer({origin, Quat(1, 0, 0, 0)});
  const auto echoes = echoes_of(scene, beams, job);
  Axis ranges, speeds;
  std::uint32_t used = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    if (!(echoes[i].range > 0)) continue;
    ++used;
    ranges.add(echoes[i].range);
    speeds.add(glm::dot(velocity, beams[i].direction));
  }
  ranges.divide(flags, range_bins, range_middle, range_size);
  speeds.divide(flags >> 4, speed_bins, speed_middle, speed_size);
  std::vector<double> bins(std::size_t{ranges.count} * speeds.count);
  double total = 0, most = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    if (!(echoes[i].range > 0)) continue;
    const std::uint32_t r = ranges.bin(echoes[i].range);
    const std::uint32_t s = speeds.bin(glm::dot(velocity, beams[i].direction));
    if (r == ranges.count || s == speeds.count) continue;
    const double value =
        ((flags >> 8 & 1) != 0 ? 1 : echoes[i].cosine) / ((flags >> 9 & 1) != 0 ? 1.0 : samples);
    bins[std::size_t{s} * ranges.count + r] += value;
    total += value;
  }
  for (const double bin : bins) most = std::max(most, bin);
  WireWriter out;
  out.word(reply::kRadar).word(0);
  for (const double value : {most, total, ranges.offset, speeds.offset, ranges.size, speeds.size,
                             ranges.low, ranges.high, speeds.low, speeds.high})
    out.real(value);
  out.word(ranges.count).word(speeds.count).word(used);
  for (int k = 0; k < 10; ++k) out.word(0);
  for (const double bin : bins) out.real(bin);
  return out.take();
}

}  // namespace panwright::server
