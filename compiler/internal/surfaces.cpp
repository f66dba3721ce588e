#include "compiler/internal/surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "base/parallel.h"
#include "compiler/tolerance.h"
#include "geometry/tessellate/tessellate.h"
#include "image/srgb.h"
#include "materials/energy.h"

namespace panwright::compiler::internal {
namespace {

using geometry::MeshShape;

constexpr double kCoarse = 0.02;  // of the radius of curvature
constexpr double kAny = 1e30;     // metres: shapes without one
constexpr std::uint64_t kMostTriangles = 1u << 20;

constexpr std::size_t kDirections = 32;
constexpr std::size_t kSide = 192;  // pixels of a depth buffer

// Spread evenly over the sphere: a Fibonacci lattice.
std::array<Vec3, kDirections> directions() {
  std::array<Vec3, kDirections> out;
  const double golden = kPi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kDirections;
    const double r = std::sqrt(1 - z * z), a = golden * static_cast<double>(i);
    out[i] = Vec3(r * det::cos(a), r * det::sin(a), z);
  }
  return out;
}

// One direction's image: the number of what is in front.
class DepthBuffer {
 public:
  DepthBuffer(const Vec3& direction, const Vec3& middle, double radius)
      : z_(direction),
        middle_(middle),
        scale_(kSide / (2 * radius)),
        depth_(kSide * kSide, -HUGE_VAL),
        value_(kSide * kSide, -1) {
    x_ = glm::normalize(glm::cross(std::fabs(z_.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0), z_));
    y_ = glm::cross(z_, x_);
  }

  void draw(const geometry::Mesh& mesh, const Mat4& world, std::int32_t value) {
    std::vector<Vec3> seen;
    seen.reserve(mesh.positions.size());
    for (const Vec3& position : mesh.positions) {
      const Vec3 p = Vec3(world * Vec4(position, 1)) - middle_;
      seen.emplace_back(glm::dot(p, x_) * scale_ + kSide / 2.0,
                        glm::dot(p, y_) * scale_ + kSide / 2.0, glm::dot(p, z_));
    }
    for (const geometry::Triangle& t : mesh.triangles)
      draw(seen[t[0]], seen[t[1]], seen[t[2]], value);
  }

  // The area that each of `count` numbers shows, m².
  std::vector<double> areas(std::size_t count) const {
    std::vector<double> out(count);
    for (const std::int32_t value : value_)
      if (value >= 0) out[static_cast<std::size_t>(value)] += 1;
    for (double& area : out) area *= pixel();
    return out;
  }
  double pixel() const { return 1 / (scale_ * scale_); }
  // Of what is shown, the sum of reflectance times place, world, and of reflectance.
  std::pair<Vec3, double> moment(const std::vector<double>& reflectance) const {
    Vec3 sum(0);
    double weight = 0;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      if (value_[i] < 0) continue;
      const double share = reflectance[static_cast<std::size_t>(value_[i])];
      const double x = (static_cast<double>(i % kSide) + 0.5 - kSide / 2.0) / scale_;
      const double y = (static_cast<double>(i / kSide) + 0.5 - kSide / 2.0) / scale_;
      sum += share * (middle_ + x * x_ + y * y_ + depth_[i] * z_);
      weight += share;
    }
    return {sum, weight};
  }

 private:
  void draw(const Vec3& a, const Vec3& b, const Vec3& c, std::int32_t value) {
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(std::fabs(area) > 0)) return;
    const auto first = [](double low) {
      return static_cast<std::size_t>(std::clamp(std::ceil(low - 0.5), 0.0, double{kSide}));
    };
    const std::size_t x0 = first(std::min({a.x, b.x, c.x})), x1 = first(std::max({a.x, b.x, c.x}));
    const std::size_t y0 = first(std::min({a.y, b.y, c.y})), y1 = first(std::max({a.y, b.y, c.y}));
    for (std::size_t y = y0; y < y1; ++y)
      for (std::size_t x = x0; x < x1; ++x) {
        const double px = static_cast<double>(x) + 0.5, py = static_cast<double>(y) + 0.5;
        const double u = ((c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x)) / area;
        const double v = ((a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x)) / area;
        const double w = 1 - u - v;
        if (!(u >= 0 && v >= 0 && w >= 0)) continue;
        const double depth = u * a.z + v * b.z + w * c.z;
        double& nearest = depth_[y * kSide + x];
        if (depth <= nearest) continue;
        nearest = depth;
        value_[y * kSide + x] = value;
      }
  }

  Vec3 x_, y_, z_, middle_;
  double scale_;
  std::vector<double> depth_;
  std::vector<std::int32_t> value_;
};

double mean_of(const scene::Texture& texture) {
  constexpr std::size_t kMost = 1u << 14;  // texels
  const std::size_t texels = std::size_t{texture.width} * texture.height;
  const std::size_t step = std::max<std::size_t>(1, texels / kMost);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < texels; i += step, count += 1)
    for (std::size_t k = 0; k < 3; ++k) {
      const double code = texture.rgba[4 * i + k] / 255.0;
      sum += (texture.linear ? code : image::linear_from_srgb(code)) / 3;
    }
  return count > 0 ? sum / count : 1;
}

}  // namespace

std::vector<MeshShape> coarse_surfaces(const scene::Scene& scene, const Job& job) {
  std::vector<MeshShape> out(scene.shapes.size());
  parallel_for(
      out.size(),
      [&](std::size_t i) {
        const geometry::Shape& shape = scene.shapes[i];
        if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
          out[i] = *mesh;
          return;
        }
        geometry::TessellationOptions options;
        options.max_error = kAny;
        if (const auto radius = radius_of_curvature(shape); radius && *radius > 0)
          options.max_error = kCoarse * *radius;
        options.max_triangles = kMostTriangles;
        DiagnosticLog ignored;  // the compilation reports the same
        if (geometry::planned_triangles(shape, options) > static_cast<double>(kMostTriangles))
          return;
        if (auto mesh = geometry::tessellated(shape, options, {}, ignored))
          out[i] = std::make_shared<const geometry::Mesh>(*std::move(mesh));
      },
      job);
  return out;
}

double PlacedBox::largest_projection() const {
  const Vec3 a = glm::cross(edges[0], edges[1]), b = glm::cross(edges[1], edges[2]),
             c = glm::cross(edges[2], edges[0]);
  double largest = 0;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-1.0, 1.0}) largest = std::max(largest, glm::length(a + s * b + t * c));
  return largest;
}

double PlacedBox::width() const {
  double lengths[] = {glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])};
  std::sort(std::begin(lengths), std::end(lengths));
  return std::sqrt(lengths[0] * lengths[0] + lengths[1] * lengths[1]);
}

double PlacedBox::diagonal() const {
  double largest = 0;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-1.0, 1.0})
      largest = std::max(largest, glm::length(edges[0] + s * edges[1] + t * edges[2]));
  return largest;
}

PlacedBox placed(const AxisBox& box, const Mat4& world_from_mesh) {
  PlacedBox out;
  for (int k = 0; k < 3; ++k) out.edges[k] = Vec3(world_from_mesh[k]) * (box.high[k] - box.low[k]);
  return out;
}

std::vector<double> reflectances(const scene::Scene& scene, const Job& job) {
  std::vector<double> of_material(scene.materials.size());
  std::vector<char> used(scene.materials.size());
  for (const scene::Instance& instance : scene.instances)
    for (const std::int32_t side : {instance.material, instance.back})
      if (side != scene::kNone) used[static_cast<std::size_t>(side)] = 1;
  parallel_for(
      of_material.size(),
      [&](std::size_t i) {
        if (!used[i]) return;
        const Vec3 albedo = materials::hemispherical_albedo(scene.materials[i]);
        of_material[i] = std::clamp((albedo.x + albedo.y + albedo.z) / 3, 0.0, 1.0);
      },
      job);
  std::vector<double> of_texture(scene.textures.size());
  parallel_for(
      of_texture.size(), [&](std::size_t i) { of_texture[i] = mean_of(scene.textures[i]); }, job);
  std::vector<double> out;
  for (const scene::Instance& instance : scene.instances) {
    const auto of_side = [&](std::int32_t side) {
      const auto material = static_cast<std::size_t>(side);
      const std::int32_t map = scene.materials[material].maps.albedo;
      return map < 0 ? of_material[material]
                     : of_material[material] * of_texture[static_cast<std::size_t>(map)];
    };
    double value = of_side(instance.material);
    if (instance.texture != scene::kNone)
      value *= of_texture[static_cast<std::size_t>(instance.texture)];
    // the side that shows more
    if (instance.back != scene::kNone) value = std::max(value, of_side(instance.back));
    out.push_back(value);
  }
  return out;
}

ShownArea shown_area(const std::vector<MeshShape>& surfaces, const std::vector<Mat4>& world,
                     const std::vector<double>& reflectance, const Job& job) {
  AxisBox bounds;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (surfaces[i])
      for (const Vec3& p : surfaces[i]->positions) bounds.add(Vec3(world[i] * Vec4(p, 1)));
  const double radius = bounds.empty() ? 0 : bounds.diagonal() / 2;
  ShownArea out;
  if (!(radius > 0 && radius < HUGE_VAL)) return out;
  const Vec3 middle = bounds.centre();
  const std::array<Vec3, kDirections> all = directions();
  std::array<std::vector<double>, kDirections> areas;
  std::array<std::pair<Vec3, double>, kDirections> moments;
  parallel_for(
      kDirections,
      [&](std::size_t k) {
        DepthBuffer buffer(all[k], middle, radius);
        for (std::size_t i = 0; i < surfaces.size(); ++i)
          if (surfaces[i]) buffer.draw(*surfaces[i], world[i], static_cast<std::int32_t>(i));
        areas[k] = buffer.areas(surfaces.size());
        moments[k] = buffer.moment(reflectance);
      },
      job);
  out.pixel = DepthBuffer(all[0], middle, radius).pixel();
  out.middle = middle;
  std::pair<Vec3, double> whole{Vec3(0), 0};
  for (const auto& [place, weight] : moments) {
    whole.first += place;
    whole.second += weight;
  }
  if (whole.second > 0) out.middle = whole.first / whole.second;
  std::array<double, kDirections> sums{};
  out.least = HUGE_VAL;
  double weighted = 0;
  for (std::size_t k = 0; k < kDirections; ++k) {
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      sums[k] += areas[k][i] * reflectance[i];
      out.mean += areas[k][i] / kDirections;
    }
    out.least = std::min(out.least, sums[k]);
    out.largest = std::max(out.largest, sums[k]);
    weighted += sums[k] / kDirections;
  }
  out.mean_reflectance = out.mean > 0 ? weighted / out.mean : 0;
  out.shares.resize(surfaces.size());
  for (std::size_t k = 0; k < kDirections && out.largest > 0; ++k)
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      out.shares[i] +=
          areas[k][i] * reflectance[i] / kDirections / std::max(sums[k], kLeastShown * out.largest);
  return out;
}

}  // namespace panwright::compiler::internal
