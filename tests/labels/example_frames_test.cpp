// Labels of random frames of the servicer and the client against a search of their own triangles,
// written apart: each triangle's pixels are tested one by one, with the rays of their centres.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensor/lens.h"
#include "tests/labels/label_worlds.h"
#include "tests/support/paths.h"
#include "workspace/targets.h"
#include "world/evaluation.h"

namespace panwright::labels::example_frames_test {
namespace {

using testing_support::coverage_at;
using testing_support::Numbers;

constexpr std::uint32_t kWide = 128, kHigh = 96;
constexpr double kTerms[] = {-0.2, 0.05, 1e-3, -5e-4};  // k1 k2 p1 p2

// One triangle of a target, world axes relative to the camera.
struct Facet {
  Vec3 a, b, c;
  std::uint32_t target = 0, node = 0;
  bool closed = false;
};

// Placed triangles, those of one mesh in a row.
struct Placed {
  std::vector<Facet> facets;
  struct Group {
    std::size_t begin, end;
    Vec3 centre;
    double radius;
  };
  std::vector<Group> groups;

  // Whether a ray meets something at a distance between two. insides: backs of closed meshes too.
  bool meets(const Vec3& origin, const Vec3& way, double from, double to, bool insides) const {
    for (const Group& group : groups) {
      const Vec3 off = group.centre - origin;
      const double along = glm::dot(off, way);
      if (along < from - group.radius || along > to + group.radius ||
          glm::dot(off, off) - along * along > group.radius * group.radius)
        continue;
      for (std::size_t k = group.begin; k < group.end; ++k) {
        const double at = distance(facets[k], origin, way, insides);
        if (at > from && at < to) return true;
      }
    }
    return false;
  }
  static double distance(const Facet& f, const Vec3& origin, const Vec3& way, bool insides) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const Vec3 ab = f.b - f.a, ac = f.c - f.a, across = glm::cross(way, ac);
    const double volume = glm::dot(ab, across);
    if (volume == 0 || (f.closed && !insides && volume < 0)) return kNone;
    const Vec3 from = origin - f.a, q = glm::cross(from, ab);
    const double u = glm::dot(from, across) / volume, v = glm::dot(way, q) / volume;
    return u < 0 || v < 0 || u + v > 1 ? kNone : glm::dot(ac, q) / volume;
  }
};

Placed placed(const world::World& world, const Vec3& eye) {
  world::Evaluation evaluation;
  evaluation.update(world);
  Placed out;
  for (std::uint32_t t = 0; t < world.size(); ++t) {
    const pan::Model& model = *world[t].model();
    const world::Pose& pose = world[t].pose();
    for (const auto& instance : model.instances()) {
      const auto& record = model.meshes()[instance.mesh];
      const pan::MeshView mesh = model.mesh(instance.mesh);
      const Mat4& model_from_node = evaluation[t].model_from_nodes[instance.node];
      const bool mirrored = glm::determinant(Mat3(model_from_node)) < 0;
      const bool closed = (record.flags & pan::layout::kMeshClosed) != 0 &&
                          model.materials()[instance.material].cutout_map < 0;
      std::vector<Vec3> points;
      AxisBox box;
      for (const auto& p : mesh.positions) {
        const Vec3 in_node(double{record.origin[0]} + p.x, double{record.origin[1]} + p.y,
                           double{record.origin[2]} + p.z);
        points.push_back(pose.translation - eye +
                         pose.rotation * Vec3(model_from_node * Vec4(in_node, 1)));
        box.add(points.back());
      }
      const std::size_t begin = out.facets.size();
      for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
        Facet facet{points[mesh.indices[k]],
                    points[mesh.indices[k + 1]],
                    points[mesh.indices[k + 2]],
                    t,
                    instance.node,
                    closed};
        if (mirrored) std::swap(facet.b, facet.c);
        out.facets.push_back(facet);
      }
      if (out.facets.size() > begin)
        out.groups.push_back(
            {begin, out.facets.size(), box.centre(), 0.5 * box.diagonal() * (1 + 1e-9)});
    }
  }
  return out;
}

Vec2 bent(const Vec2& at, bool distorted) {
  if (!distorted) return at;
  const double r2 = glm::dot(at, at), radial = 1 + kTerms[0] * r2 + kTerms[1] * r2 * r2;
  return radial * at + Vec2(2 * kTerms[2] * at.x * at.y + kTerms[3] * (r2 + 2 * at.x * at.x),
                            kTerms[2] * (r2 + 2 * at.y * at.y) + 2 * kTerms[3] * at.x * at.y);
}

// Camera at the origin of Placed.
struct Pinhole {
  Quat world_from_camera;
  double focal = 0;
  bool distorted = false;

  Vec2 pixel(const Vec3& at) const {
    const Vec3 local = glm::conjugate(world_from_camera) * at;
    return focal * bent(Vec2(local) / local.z, distorted) + 0.5 * Vec2(kWide, kHigh);
  }
  Vec3 ray(const Vec2& place) const {
    const Vec2 at = (place - 0.5 * Vec2(kWide, kHigh)) / focal;
    Vec2 straight = at;
    for (int k = 0; distorted && k < 60; ++k) straight += at - bent(straight, true);
    return world_from_camera * glm::normalize(Vec3(straight, 1));
  }
};

// What the pixels' centres show.
struct Centres {
  std::vector<double> distance;
  std::vector<std::int32_t> thing;               // target that is nearest; -1: none
  std::vector<std::uint32_t> node;               // its node
  std::vector<std::size_t> facet;                // that is nearest
  std::vector<std::vector<std::uint8_t>> alone;  // of each thing: something of it is there
};

struct Parts {
  // by target and node: things that a surface belongs to, as bits
  std::vector<std::vector<std::uint32_t>> of;
  std::size_t things = 0;
};

Centres centres_of(const Placed& scene, const Pinhole& camera, const Parts& parts,
                   std::vector<AxisRectangle>& boxes) {
  constexpr double kReach = 3;  // pixels: curvature of an edge
  std::vector<Vec3> rays;
  for (std::uint32_t y = 0; y < kHigh; ++y)
    for (std::uint32_t x = 0; x < kWide; ++x) rays.push_back(camera.ray(Vec2(x + 0.5, y + 0.5)));
  Centres out;
  out.distance.assign(rays.size(), std::numeric_limits<double>::infinity());
  out.thing.assign(rays.size(), -1);
  out.node.assign(rays.size(), 0);
  out.facet.assign(rays.size(), 0);
  out.alone.assign(parts.things, std::vector<std::uint8_t>(rays.size()));
  boxes.assign(parts.things, {});
  for (std::size_t number = 0; number < scene.facets.size(); ++number) {
    const Facet& facet = scene.facets[number];
    const Vec2 a = camera.pixel(facet.a), b = camera.pixel(facet.b), c = camera.pixel(facet.c);
    const std::uint32_t things = parts.of[facet.target][facet.node];
    for (std::size_t t = 0; t < parts.things; ++t)
      if (things >> t & 1u)
        for (const Vec2& each : {a, b, c}) boxes[t].add(each);
    const Vec2 low = glm::min(glm::min(a, b), c) - kReach,
               high = glm::max(glm::max(a, b), c) + kReach;
    const auto from = [](double v, std::uint32_t most) {
      return static_cast<std::uint32_t>(std::clamp(v, 0.0, static_cast<double>(most)));
    };
    for (std::uint32_t y = from(low.y, kHigh), bottom = from(high.y, kHigh); y < bottom; ++y)
      for (std::uint32_t x = from(low.x, kWide), right = from(high.x, kWide); x < right; ++x) {
        const std::size_t at = std::size_t{y} * kWide + x;
        const double distance = Placed::distance(facet, Vec3(0), rays[at], false);
        if (!(distance > 0 && distance < 1e9)) continue;
        for (std::size_t t = 0; t < parts.things; ++t)
          if (things >> t & 1u) out.alone[t][at] = 1;
        if (distance >= out.distance[at]) continue;
        out.distance[at] = distance;
        out.thing[at] = static_cast<std::int32_t>(facet.target);
        out.node[at] = facet.node;
        out.facet[at] = number;
      }
  }
  return out;
}

class ExampleFrames : public testing::Test {
 protected:
  world::World world_;
  LabelOptions options_;
  Parts parts_;
  std::size_t pixels_ = 0, different_ = 0, interior_ = 0;  // of all masks
  std::size_t compared_ = 0, borders_ = 0;                 // keypoints
  double box_ = 0, pixel_ = 0;                             // largest differences
  std::size_t flow_pixels_ = 0, flow_others_ = 0;          // and those of another surface
  double flow_ = 0;                                        // largest difference of the former

  void SetUp() override {
    const std::string examples = PANWRIGHT_SOURCE_DIR "/examples/";
    const workspace::TargetFile files[] = {{"servicer", examples + "servicer/servicer.pxn"},
                                           {"client", examples + "client/client.pxn"}};
    DiagnosticLog log;
    auto world = workspace::open_world(files, {}, log);
    ASSERT_TRUE(world) << to_text(log);
    world_ = *std::move(world);
    options_.parts = {{"tanks", "hydrogen_tank"}, {"tanks", "oxygen_tank"}, {"engine", "engine"}};
  }

  // Nodes of the things, from the models' own trees.
  void find_parts(const FrameLabels& frame) {
    parts_.things = frame.things.size();
    for (std::uint32_t t = 0; t < world_.size(); ++t) {
      const pan::Model& model = *world_[t].model();
      std::vector<std::uint32_t> of(model.nodes().size());
      for (std::size_t k = 0; k < of.size(); ++k) {
        const std::int32_t parent = model.nodes()[k].parent;
        if (parent >= 0) of[k] = of[static_cast<std::size_t>(parent)];
        const std::string_view name = model.string(model.nodes()[k].name);
        for (std::size_t thing = 0; thing < frame.things.size(); ++thing) {
          const Thing& each = frame.things[thing];
          if (each.target != world_[t].name()) continue;
          bool is = each.label.empty();
          for (const ChosenPart& part : options_.parts)
            is = is || (part.label == each.label && part.node == name);
          if (is) of[k] |= 1u << thing;
        }
      }
      parts_.of.push_back(std::move(of));
    }
  }

  void move(Numbers& numbers) {
    world_.set_pose(0, {numbers.vector(1.5), numbers.rotation()});
    world_.set_pose(1,
                    {numbers.rotation() * Vec3(numbers.between(6, 12), 0, 0), numbers.rotation()});
    for (std::size_t t = 0; t < world_.size(); ++t) {
      const auto set = world_[t].model()->joint_set();
      for (std::uint32_t j = 0; j < set.joints().size(); ++j) {
        const auto& joint = set.joints()[j];
        if (joint.kind != geometry::JointKind::revolute || joint.mimic >= 0) continue;
        const double low = joint.limited ? joint.lower[0] : -1,
                     high = joint.limited ? joint.upper[0] : 1;
        geometry::JointValues values{};
        values[0] = numbers.between(low, high);
        world_.set_joint(t, j, values);
      }
    }
    world::Sun sun;
    sun.direction = numbers.rotation() * Vec3(0, 0, 1);
    world_.set_sun(sun);
  }

  void compare_mask(const Mask& mask, const std::vector<std::uint8_t>& centres,
                    const std::string& where) {
    for (std::uint32_t y = 0; y < kHigh; ++y)
      for (std::uint32_t x = 0; x < kWide; ++x) {
        const auto at = [&](std::uint32_t i, std::uint32_t j) {
          return centres[std::size_t{j} * kWide + i];
        };
        const bool expected = at(x, y) != 0, found = coverage_at(mask, x, y) > 127;
        pixels_ += expected;
        if (expected == found) continue;
        ++different_;
        bool border = false;
        for (std::uint32_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, kHigh - 1); ++j)
          for (std::uint32_t i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, kWide - 1); ++i)
            border = border || at(i, j) != at(x, y);
        // edges of the image are borders
        border = border || x == 0 || y == 0 || x + 1 == kWide || y + 1 == kHigh;
        interior_ += !border;
        if (!border && interior_ <= 5)
          std::printf("%s: pixel %u %u is %d, rays say %d\n", where.c_str(), x, y,
                      coverage_at(mask, x, y), expected);
      }
  }

  void compare_keypoints(const Thing& thing, const Placed& scene, const Pinhole& camera,
                         const Vec3& eye, const std::string& where) {
    // facets lie beside the round shapes that they stand for; on edges either answer is right
    const auto& model = *world_[*world_.find(thing.target)].model();
    double reach = 1e-4;
    for (const auto& mesh : model.meshes()) reach = std::max(reach, 2 * double{mesh.error});
    const Vec3 sun = glm::normalize(world_.sun().direction);
    for (const Keypoint& each : thing.keypoints) {
      const auto& pose = world_[*world_.find(thing.target)].pose();
      const Vec3 at = pose.translation + pose.rotation * each.position - eye;
      ASSERT_TRUE(each.pixel) << where;
      pixel_ = std::max(pixel_, glm::length(*each.pixel - camera.pixel(at)));
      const auto answer = [&](bool lit, bool found) {
        const auto blocked = [&](const Vec3& off, double near) {
          if (lit) return scene.meets(at + off, sun, near, 1e9, true);
          const double length = glm::length(at + off);
          return scene.meets(Vec3(0), (at + off) / length, 0, length - near, false);
        };
        ++compared_;
        if (blocked(Vec3(0), reach) == found) return true;
        int yes = 0, no = 0;
        for (const double near : {1e-5, 1e-4, reach})
          for (const double side : {reach, 1e-2})
            for (int k = 0; k < 7; ++k) {
              Vec3 off(0);
              if (k > 0) off[(k - 1) / 2] = k % 2 == 0 ? side : -side;
              ++(blocked(off, near) ? yes : no);
            }
        if (yes == 0 || no == 0)
          std::printf("%s %s: %d, rays say %d\n", where.c_str(), each.name.c_str(), found, yes > 0);
        borders_ += yes > 0 && no > 0;
        return yes > 0 && no > 0;
      };
      EXPECT_TRUE(answer(false, each.occluded)) << where << " " << each.name << " occluded";
      EXPECT_TRUE(answer(true, !each.lit)) << where << " " << each.name << " lit";
    }
  }

  // By the same point of the same facet in the frame before.
  void compare_flow(const Flow& flow, const Centres& centres, const Placed& now,
                    const Pinhole& camera, const Placed& then, const Pinhole& other) {
    ASSERT_EQ(now.facets.size(), then.facets.size());
    for (std::uint32_t y = 0; y < kHigh; ++y)
      for (std::uint32_t x = 0; x < kWide; ++x) {
        const std::size_t at = std::size_t{y} * kWide + x;
        const Vec2 centre(x + 0.5, y + 0.5),
            found(double{flow.motion[2 * at]}, double{flow.motion[2 * at + 1]});
        if (centres.thing[at] < 0) continue;
        ++flow_pixels_;
        const Facet &f = now.facets[centres.facet[at]], &g = then.facets[centres.facet[at]];
        const Vec3 point = camera.ray(centre) * centres.distance[at] - f.a;
        const Vec3 ab = f.b - f.a, ac = f.c - f.a, normal = glm::cross(ab, ac);
        const double area = glm::dot(normal, normal);
        const double u = glm::dot(glm::cross(point, ac), normal) / area,
                     v = glm::dot(glm::cross(ab, point), normal) / area;
        const double off =
            glm::length(other.pixel(g.a + u * (g.b - g.a) + v * (g.c - g.a)) - centre - found);
        constexpr double kAnother = 0.05;  // pixels
        if (!(off < kAnother))
          ++flow_others_;
        else
          flow_ = std::max(flow_, off);
      }
  }

  void run(std::size_t frames) {
    Numbers numbers(41);
    Labeller labeller(options_);
    struct Before {
      world::World world;
      world::Camera camera;
      Placed scene;
      Pinhole pinhole;
    };
    std::optional<Before> before;
    for (std::size_t k = 0; k < frames; ++k) {
      move(numbers);
      Pinhole pinhole{numbers.rotation(), numbers.between(150, 260), k % 2 == 1};
      world::Camera camera;
      camera.width = kWide;
      camera.height = kHigh;
      camera.focal = Vec2(pinhole.focal);
      camera.principal = Vec2(kWide, kHigh) / 2.0;
      camera.world_from_camera = pinhole.world_from_camera;
      camera.position = 0.5 * world_[1].pose().translation -
                        pinhole.world_from_camera * Vec3(0, 0, numbers.between(30, 60));
      if (pinhole.distorted) {
        sensor::Brown brown;
        brown.k = {kTerms[0], kTerms[1], kTerms[2], kTerms[3]};
        camera.distortion = std::make_shared<const sensor::DistortionMap>(brown);
      }
      DiagnosticLog log;
      std::optional<Moment> previous;
      FrameContext context;
      if (before) context.previous = &previous.emplace(Moment{before->world, before->camera});
      const auto frame = labeller.label(world_, camera, context, log);
      ASSERT_TRUE(frame) << to_text(log);
      if (parts_.of.empty()) find_parts(*frame);
      const Placed scene = placed(world_, camera.position);
      std::vector<AxisRectangle> boxes;
      const Centres centres = centres_of(scene, pinhole, parts_, boxes);
      if (before)
        compare_flow(*frame->backward, centres, scene, pinhole, before->scene, before->pinhole);
      for (std::size_t t = 0; t < parts_.things; ++t) {
        const Thing& thing = frame->things[t];
        const std::string where = fmt::format("frame {}, {} {}", k, thing.target, thing.label);
        compare_mask(thing.amodal, centres.alone[t], where + " amodal");
        std::vector<std::uint8_t> visible(centres.thing.size());
        for (std::size_t i = 0; i < visible.size(); ++i)
          visible[i] =
              centres.thing[i] >= 0 &&
              (parts_.of[static_cast<std::size_t>(centres.thing[i])][centres.node[i]] >> t & 1u);
        compare_mask(thing.visible, visible, where + " visible");
        ASSERT_TRUE(thing.amodal_box) << where;
        const Box& box = *thing.amodal_box;
        for (const double off : {box.left - boxes[t].low.x, box.top - boxes[t].low.y,
                                 box.right - boxes[t].high.x, box.bottom - boxes[t].high.y})
          box_ = std::max(box_, std::fabs(off));
        if (thing.label.empty()) compare_keypoints(thing, scene, pinhole, camera.position, where);
      }
      before = Before{world_, camera, scene, pinhole};
    }
    std::printf(
        "%zu frames: %zu pixels of masks, %zu differ, %zu off borders; boxes %.2g px, "
        "keypoints %.2g px; %zu answers of rays, %zu at borders; flow of %zu pixels %.2g px, %zu "
        "of "
        "another surface\n",
        frames, pixels_, different_, interior_, box_, pixel_, compared_, borders_, flow_pixels_,
        flow_, flow_others_);
    EXPECT_GT(pixels_, 500 * frames);
    EXPECT_LE(static_cast<double>(interior_), 1e-3 * static_cast<double>(pixels_));
    EXPECT_LT(box_, 0.5);
    EXPECT_LT(pixel_, 1e-3);
    EXPECT_GT(compared_, 20 * frames);
    EXPECT_LT(static_cast<double>(borders_), 0.02 * static_cast<double>(compared_));
    EXPECT_GT(flow_pixels_, 100 * frames);
    EXPECT_LT(flow_, 1e-3);
    EXPECT_LE(static_cast<double>(flow_others_), 1e-3 * static_cast<double>(flow_pixels_));
  }
};

TEST_F(ExampleFrames, AreThoseOfTheTriangles) { run(8); }
TEST_F(ExampleFrames, AThousandAreThoseOfTheTriangles) {
  const char* const asked = std::getenv("PANWRIGHT_FRAMES");  // fewer
  run(asked != nullptr ? std::strtoul(asked, nullptr, 10) : 1000);
}

}  // namespace
}  // namespace panwright::labels::example_frames_test
