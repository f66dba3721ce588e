// Look-ups: points under pixels and along directions, elevations, patches.
#include <algorithm>
#include <cmath>

#include "server/session.h"

namespace panwright::server {

namespace {

constexpr std::uint64_t kFloatBytes = 5;  // packed float, mark

// Rays of world axes about the observer, from positions in the world.
struct RayBatch {
  std::vector<trace::Ray> rays;
  void add(const trace::Scene& scene, const Vec3& position, const Vec3& direction) {
    trace::Ray ray;
    ray.origin = position - scene.observer().position;
    ray.direction = glm::normalize(direction);
    rays.push_back(ray);
  }
  std::vector<trace::Hit> cast(const trace::Scene& scene, const Job& job) const {
    std::vector<trace::Hit> hits(rays.size());
    scene.nearest(rays, hits, trace::Insides::pass, job);
    return hits;
  }
};

// A height above all targets, for rays down; nothing: there are none.
std::optional<double> above_all(const trace::Scene& scene) {
  std::optional<double> out;
  for (const std::uint32_t index : scene.visible()) {
    const trace::Scene::Placed& placed = scene.targets()[index];
    const AxisBox& box = placed.target->bounds();
    const double radius = glm::length(glm::max(glm::abs(box.low), glm::abs(box.high)));
    const double top = placed.frame.position.z + radius;
    out = std::max(out.value_or(top), top);
  }
  return out;
}

WireWriter array_reply(std::uint32_t code, std::size_t count) {
  WireWriter out;
  out.word(code).word(static_cast<std::uint32_t>(count));
  return out;
}

// Surface elevations: z of the highest surface over each point, with its mark.
//
//   points  x, y in world axes
std::vector<trace::Hit> looked_down(const trace::Scene& scene, std::span<const Vec2> points,
                                    std::vector<double>& elevations, const Job& job) {
  const double top = above_all(scene).value_or(0) + 1;
  RayBatch batch;
  for (const Vec2& point : points) batch.add(scene, Vec3(point, top), Vec3(0, 0, -1));
  std::vector<trace::Hit> hits = batch.cast(scene, job);
  elevations.clear();
  for (const trace::Hit& hit : hits) elevations.push_back(hit ? top - hit.distance : 0);
  return hits;
}

}  // namespace

Bytes Session::surface_request(Request kind, WireReader& in, const Job& job) {
  switch (kind) {
    case Request::get_surface_patch:
      return patch(in, job);
    case Request::get_view_as_dem:
      return dem(in, job);
    case Request::get_elevation:
    case Request::get_elevations: {
      std::vector<Vec3> positions;
      const bool one = kind == Request::get_elevation;
      if (one) {
        const auto camera = stage_.camera_of(state(), state().camera);
        positions.push_back(camera ? camera->position : state().viewpoint.translation);
      } else {
        const std::uint32_t count = in.word();
        check_reply(count, kFloatBytes, options_.most_reply);
        for (std::uint32_t i = 0; i < count; ++i) {
          const double x = in.real(), y = in.real();
          positions.emplace_back(x, y, in.real());
        }
      }
      if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
      const trace::Scene& scene = stage_.rays(state(), job);
      RayBatch batch;
      for (const Vec3& position : positions) batch.add(scene, position, Vec3(0, 0, -1));
      const auto hits = batch.cast(scene, job);
      WireWriter out = one ? std::move(WireWriter().word(reply::kFloat))
                           : array_reply(reply::kFloatArray, hits.size());
      for (const trace::Hit& hit : hits) out.real(hit ? hit.distance : 0).flag(bool(hit));
      return out.take();
    }
    default:
      break;
  }
  (void)in.flag();  // boulders
  const bool one = kind == Request::get_surface_elevation;
  const std::uint32_t count = one ? 1 : in.word();
  check_reply(count, kFloatBytes, options_.most_reply);
  std::vector<Vec2> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = in.real();
    points.emplace_back(x, in.real());
  }
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  std::vector<double> elevations;
  const auto hits = looked_down(stage_.rays(state(), job), points, elevations, job);
  WireWriter out =
      one ? std::move(WireWriter().word(reply::kFloat)) : array_reply(reply::kFloatArray, count);
  for (std::size_t i = 0; i < count; ++i) out.real(elevations[i]).flag(bool(hits[i]));
  return out.take();
}

Bytes Session::patch(WireReader& in, const Job& job) {
  (void)in.flag();  // boulders
  const double x = in.real(), y = in.real();
  const std::uint64_t columns = in.word(), rows = in.word();
  const double step = in.real(), turn = in.real();
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  check_reply(std::max(columns, rows), kFloatBytes, options_.most_reply);
  check_reply(columns * rows, kFloatBytes, options_.most_reply);
  const det::SinCos angle = det::sincos(turn);
  std::vector<Vec2> points;
  points.reserve(columns * rows);
  for (std::uint64_t j = 0; j < rows; ++j)
    for (std::uint64_t i = 0; i < columns; ++i) {
      const double u = (static_cast<double>(i) - 0.5 * static_cast<double>(columns - 1)) * step;
      const double v = (static_cast<double>(j) - 0.5 * static_cast<double>(rows - 1)) * step;
      points.emplace_back(x + angle.cos * u - angle.sin * v, y + angle.sin * u + angle.cos * v);
    }
  std::vector<double> elevations;
  const auto hits = looked_down(stage_.rays(state(), job), points, elevations, job);
  WireWriter out = array_reply(reply::kFloatArray, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out.real(elevations[i]).flag(bool(hits[i]));
  return out.take();
}

Bytes Session::dem(WireReader& in, const Job& job) {
  const std::uint32_t number = in.word();
  (void)in.flag();  // boulders
  const std::uint64_t columns = in.word(), rows = in.word();
  const double step_x = in.real(), step_y = in.real(), level = in.real();
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  check_reply(std::max(columns, rows), kFloatBytes, options_.most_reply);
  check_reply(columns * rows, kFloatBytes, options_.most_reply);
  const auto camera = stage_.camera_of(state(), number);
  if (!camera) throw RequestError{WireError::number, "there is no camera of this number"};
  const trace::Scene& scene = stage_.rays(state(), job);
  const Quat& q = camera->world_from_camera;
  RayBatch batch;
  for (std::uint64_t j = 0; j < rows; ++j)
    for (std::uint64_t i = 0; i < columns; ++i) {
      const double u = (static_cast<double>(i) - 0.5 * static_cast<double>(columns - 1)) * step_x;
      const double v = (static_cast<double>(j) - 0.5 * static_cast<double>(rows - 1)) * step_y;
      batch.add(scene, camera->position + q * Vec3(u, v, 0), q * Vec3(0, 0, 1));
    }
  const auto hits = batch.cast(scene, job);
  WireWriter out = array_reply(reply::kFloatArray, hits.size());
  for (const trace::Hit& hit : hits) out.real(hit ? level - hit.distance : 0).flag(bool(hit));
  return out.take();
}

Bytes Session::point_request(Request kind, WireReader& in, const Job& job) {
  const bool pixels = kind == Request::lookup_point || kind == Request::lookup_points;
  const bool one = kind == Request::lookup_point || kind == Request::get_point;
  constexpr std::uint64_t kPointBytes = 13;
  const std::uint32_t count = one ? 1 : in.word();
  check_reply(count, kPointBytes, options_.most_reply);
  const auto camera = stage_.camera_of(state(), state().camera);
  if (!camera) throw RequestError{WireError::number, "there is no camera of this number"};
  trace::Scene& scene = stage_.rays(state(), job);
  scene.place_observer({camera->position, Quat(1, 0, 0, 0)});
  RayBatch batch;
  std::vector<std::uint8_t> valid(count, 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = in.real(), y = in.real();
    if (pixels) {
      const Vec2 pixel(x * camera->width, (1 - y) * camera->height);
      const auto ray = in.finite() ? world::distorted_ray(*camera, pixel) : std::nullopt;
      valid[i] = ray.has_value();
      batch.add(scene, ray ? ray->origin : camera->position, ray ? ray->direction : Vec3(0, 0, 1));
    } else {
      const Vec3 direction(x, y, in.real());
      valid[i] = in.finite() && glm::length(direction) > 0;
      batch.add(scene, camera->position, valid[i] != 0 ? direction : Vec3(0, 0, 1));
    }
  }
  if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
  const auto hits = batch.cast(scene, job);
  WireWriter out =
      one ? std::move(WireWriter().word(reply::kPoint)) : array_reply(reply::kPointArray, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool hit = valid[i] != 0 && hits[i];
    const Vec3 point =
        hit ? camera->position + batch.rays[i].origin + batch.rays[i].direction * hits[i].distance
            : Vec3(0);
    for (int k = 0; k < 3; ++k) out.real(point[k]);
    out.flag(hit);
  }
  return out.take();
}

}  // namespace panwright::server
