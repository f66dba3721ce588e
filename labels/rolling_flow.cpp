#include "labels/rolling_flow.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "labels/internal/flow_parts.h"

namespace panwright::labels {

namespace {

constexpr std::size_t kRowsOfChunk = 8;

// Point of a node.
struct NodePoint {
  std::uint32_t target = 0, node = 0;
  Vec3 in_node{0};
};

}  // namespace

struct RollingPlaces::Impl {
  struct Of {
    double seconds = 0;
    std::vector<NodesInCamera> targets;
  };
  struct Seen {
    Vec2 place{0};
    double late = 0;  // seconds from the exposure of the place; positive: it is over
  };

  const world::Camera& camera;
  ImagePlane plane;
  double line_time;
  std::vector<Of> moments;

  std::optional<Seen> seen(const NodePoint& point, std::size_t moment) const {
    const NodesInCamera& nodes = moments[moment].targets[point.target];
    if (nodes.visible[point.node] == 0) return std::nullopt;
    const auto place = plane.place(nodes.camera_from_node[point.node](point.in_node));
    if (!place) return std::nullopt;
    const double row = place->y - 0.5;
    const double rows = line_time > 0 ? row : camera.height - 1 - row;
    return Seen{*place, moments[moment].seconds - rows * std::fabs(line_time)};
  }

  // Place where the point's row shows it; none: hidden by its model, or behind the camera. The
  // search begins at the moment `near`: nothing moves far while the shutter passes it.
  std::optional<Vec2> place(const NodePoint& point, std::size_t near) const {
    std::size_t low = std::min(near, moments.size() - 1), high = low;
    auto before = seen(point, low), after = before;
    if (!before) return std::nullopt;
    for (std::size_t step = 1; before->late >= 0 && low > 0; step *= 2) {
      high = low, after = before;
      low -= std::min(step, low);
      if (before = seen(point, low); !before) return std::nullopt;
    }
    for (std::size_t step = 1; after->late < 0 && high + 1 < moments.size(); step *= 2) {
      low = high, before = after;
      high = std::min(high + step, moments.size() - 1);
      if (after = seen(point, high); !after) return std::nullopt;
    }
    if (before->late >= 0) return before->place;
    if (after->late < 0) return after->place;
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      const auto at = seen(point, middle);
      if (!at) return std::nullopt;
      (at->late < 0 ? low : high) = middle;
      (at->late < 0 ? before : after) = at;
    }
    return glm::mix(before->place, after->place, before->late / (before->late - after->late));
  }
};

RollingPlaces::RollingPlaces(const world::Camera& camera, double line_time)
    : impl_(new Impl{camera, ImagePlane(camera), line_time, {}}) {}
RollingPlaces::~RollingPlaces() = default;
RollingPlaces::RollingPlaces(RollingPlaces&&) noexcept = default;
RollingPlaces& RollingPlaces::operator=(RollingPlaces&&) noexcept = default;

void RollingPlaces::add(const Moment& moment, double seconds) {
  impl_->moments.push_back({seconds, nodes_in_camera(moment)});
}

Flow flow_of_rows(const RollingPlaces& now, const RollingPlaces& other,
                  std::span<const std::uint32_t> moment_of_row, const image::Image& layers,
                  const Job& job) {
  const RollingPlaces::Impl &from = now.impl(), &to = other.impl();
  assert(!from.moments.empty() && !to.moments.empty());
  const std::size_t width = from.camera.width, height = from.camera.height;
  assert(moment_of_row.size() == height && layers.has_ground_truth());
  Flow flow;
  flow.width = from.camera.width;
  flow.height = from.camera.height;
  flow.motion.assign(2 * width * height, std::numeric_limits<float>::quiet_NaN());
  std::vector<std::vector<std::vector<trace::Affine>>> node_from_camera(from.moments.size());
  for (const std::uint32_t moment : moment_of_row) {
    auto& targets = node_from_camera[moment];
    if (!targets.empty()) continue;
    for (const NodesInCamera& nodes : from.moments[moment].targets) {
      auto& maps = targets.emplace_back();
      for (const trace::Affine& node : nodes.camera_from_node) maps.push_back(inverse_of(node));
    }
  }
  const auto motion_at = [&](std::size_t x, std::size_t y) -> std::optional<Vec2> {
    const std::size_t pixel = y * width + x;
    if (layers.target_id[pixel] == 0) return std::nullopt;
    const auto ray =
        from.plane.view_ray(Vec2(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
    const auto surface = ray ? surface_of_layers(layers, from.plane, pixel, *ray) : std::nullopt;
    if (!surface) return std::nullopt;
    const std::uint32_t moment = moment_of_row[y];
    const Vec3 in_node = node_from_camera[moment][surface->target][surface->node](surface->point);
    if (!is_finite(in_node)) return std::nullopt;
    const NodePoint point{surface->target, surface->node, in_node};
    // its own place too: the moment is not quite that of the row
    const auto here = from.place(point, moment), there = to.place(point, moment);
    if (!here || !there) return std::nullopt;
    return *there - *here;
  };
  const auto rows = [&](std::size_t chunk) {
    const std::size_t end = std::min(height, (chunk + 1) * kRowsOfChunk);
    for (std::size_t y = chunk * kRowsOfChunk; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x)
        if (const auto motion = motion_at(x, y)) {
          flow.motion[2 * (y * width + x)] = static_cast<float>(motion->x);
          flow.motion[2 * (y * width + x) + 1] = static_cast<float>(motion->y);
        }
  };
  parallel_for((height + kRowsOfChunk - 1) / kRowsOfChunk, rows, job);
  return flow;
}

}  // namespace panwright::labels
