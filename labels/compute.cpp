#include "labels/compute.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "labels/internal/coverage.h"
#include "labels/internal/image_plane.h"
#include "labels/internal/keypoint_views.h"
#include "labels/internal/surfaces.h"
#include "trace/placement.h"
#include "trace/scene.h"

namespace panwright::labels {

namespace {

// Returns a rotation, w >= 0. Axes that scales stretch are of unit length; in a mirrored frame y
// and z keep their directions, and x follows.
Quat rotation_of(const Mat3& linear) {
  const auto unit = [](const Vec3& v, const Vec3& otherwise) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
  };
  const Vec3 z = unit(linear[2], Vec3(0, 0, 1));
  const Vec3 y = unit(linear[1] - glm::dot(linear[1], z) * z, Vec3(0, 1, 0));
  const Quat q = glm::normalize(glm::quat_cast(Mat3(glm::cross(y, z), y, z)));
  return q.w < 0 ? -q : q;
}

std::optional<Box> box_of(const AxisRectangle& rectangle) {
  if (rectangle.empty()) return std::nullopt;
  return Box{rectangle.low.x, rectangle.low.y, rectangle.high.x, rectangle.high.y};
}

bool has_layers(const image::Image* image, const world::Camera& camera) {
  return image != nullptr && image->has_ground_truth() && image->width == camera.width &&
         image->height == camera.height;
}

}  // namespace

struct Labeller::Impl {
  LabelOptions options;
  trace::Scene scene{{0, true}};

  FrameLabels label(const world::World& world, const world::Camera& camera,
                    const FrameContext& context, const Things& things, const Job& job);
  void add_thing(const world::World& world, const Things& things, std::uint32_t number,
                 Coverage& coverage, const std::vector<Keypoint>& keypoints,
                 const trace::PlacedNodes& nodes, FrameLabels& out) const;
};

Labeller::Labeller(LabelOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
}
Labeller::~Labeller() = default;
Labeller::Labeller(Labeller&&) noexcept = default;
Labeller& Labeller::operator=(Labeller&&) noexcept = default;

void Labeller::Impl::add_thing(const world::World& world, const Things& things,
                               std::uint32_t number, Coverage& coverage,
                               const std::vector<Keypoint>& keypoints,
                               const trace::PlacedNodes& nodes, FrameLabels& out) const {
  const NamedThing& named = things.things[number];
  Thing& thing = out.things.emplace_back();
  thing.id = number + 1;
  thing.target = world[named.target].name();
  thing.label = named.label;
  trace::Affine camera_from = scene.observer_from(named.target);
  if (!named.label.empty()) camera_from = camera_from * nodes.model_from_node[named.nodes[0]];
  thing.camera_from_thing = {camera_from.offset, rotation_of(camera_from.linear)};
  thing.amodal = std::move(coverage.amodal);
  thing.visible = std::move(coverage.visible);
  thing.amodal_box = box_of(coverage.box);
  thing.visible_box = box_of(coverage.visible_box);
  thing.amodal_pixels = coverage.amodal_pixels;
  thing.visible_pixels = coverage.visible_pixels;
  const auto points = world[named.target].model()->keypoints();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::uint32_t leaf = things.leaf_of[named.target][points[k].node];
    if (std::ranges::binary_search(things.of_leaf[leaf], number))
      thing.keypoints.push_back(keypoints[k]);
  }
}

FrameLabels Labeller::Impl::label(const world::World& world, const world::Camera& camera,
                                  const FrameContext& context, const Things& things,
                                  const Job& job) {
  scene.update(world, job);
  scene.place_observer({camera.position, camera.world_from_camera}, trace::half_pixel(camera));
  const ImagePlane plane(camera);
  const image::Image* layers = has_layers(context.layers, camera) ? context.layers : nullptr;
  FrameLabels out;
  out.camera = camera;
  out.sun_in_camera =
      glm::normalize(glm::conjugate(camera.world_from_camera) * world.sun().direction);
  std::vector<Coverage> coverage;
  {
    const Vec2 size(camera.width, camera.height);
    AxisRectangle canvas{-size, 2.0 * size};
    Surfaces surfaces = placed_surfaces(scene, plane, things, job);
    if (context.rows) {
      const auto [first, end, beyond] = *context.rows;
      const bool above = beyond && first == 0 && end > 0, below = beyond && end == camera.height;
      if (!above) canvas.low.y = first;
      if (!below) canvas.high.y = end;
      cut_boxes(surfaces, above ? -std::numeric_limits<double>::infinity() : first,
                below ? std::numeric_limits<double>::infinity() : end);
      // an edge may touch the line of no rows
      if (end == 0) std::ranges::fill(surfaces.boxes, AxisRectangle{});
    }
    coverage = covered({scene, plane, things, layers, canvas}, surfaces, job);
  }
  std::vector<Keypoint> keypoints;
  trace::PlacedNodes nodes;
  for (std::uint32_t number = 0; number < things.things.size(); ++number) {
    const NamedThing& named = things.things[number];
    if (named.label.empty()) {
      job.poll();
      nodes = trace::placed_nodes(world[named.target]);
      keypoints = keypoints_of(world, named.target, nodes, scene, plane, options.keypoint_slack);
    }
    add_thing(world, things, number, coverage[number], keypoints, nodes, out);
  }
  const Moment now{world, camera};
  if (context.next) out.forward = flow_to(now, *context.next, scene, layers, job);
  if (context.previous) out.backward = flow_to(now, *context.previous, scene, layers, job);
  return out;
}

std::vector<std::vector<Keypoint>> keypoints_in_view(const world::World& world,
                                                     const trace::Scene& scene,
                                                     const world::Camera& camera, double slack) {
  const ImagePlane plane(camera);
  std::vector<std::vector<Keypoint>> out;
  for (std::uint32_t target = 0; target < world.size(); ++target)
    out.push_back(
        keypoints_of(world, target, trace::placed_nodes(world[target]), scene, plane, slack));
  return out;
}

Result<FrameLabels> Labeller::label(const world::World& world, const world::Camera& camera,
                                    const FrameContext& context, DiagnosticLog& log,
                                    const Job& job) {
  return run_job(job, log, [&]() -> Result<FrameLabels> {
    const auto things = named_things(world, impl_->options.parts, log);
    if (!things) return failed;
    FrameLabels out = impl_->label(world, camera, context, *things, job);
    impl_->scene.report_damaged(log);
    return out;
  });
}

}  // namespace panwright::labels
