#include "compiler/tolerance.h"

#include <algorithm>
#include <cmath>

namespace panwright::compiler {

namespace {

using pan::layout::ToleranceReason;

double clamped_cosine(const Vec2& a, const Vec2& b) {
  return std::clamp(glm::dot(a, b) / (glm::length(a) * glm::length(b)), -1.0, 1.0);
}

// Of walls whose radius changes along the axis: light along them leaves slivers that it does not
// leave on a cylinder, with up to twice the relative error (measured,
// tests/compiler/tolerance_test.cpp).
constexpr double kSlanted = 0.5;

struct CurvatureOf {
  using Answer = std::optional<double>;

  Answer operator()(const geometry::Sphere& s) const { return s.radius; }
  Answer operator()(const geometry::Ellipsoid& s) const {
    const double low = std::min({s.radii.x, s.radii.y, s.radii.z});
    const double high = std::max({s.radii.x, s.radii.y, s.radii.z});
    return low * (low / high);
  }
  Answer operator()(const geometry::Box& s) const {
    if (!s.round || !(s.bevel > 0)) return std::nullopt;
    return 0.5 * std::min({s.size.x, s.size.y, s.size.z});
  }
  Answer operator()(const geometry::Cylinder& s) const { return s.radius; }
  Answer operator()(const geometry::Cone& s) const {
    return kSlanted * (0.5 * s.bottom_radius + 0.5 * s.top_radius);
  }
  Answer operator()(const geometry::Disc& s) const { return s.radius - s.inner_radius; }
  Answer operator()(const geometry::Torus& s) const { return s.tube_radius; }
  Answer operator()(const geometry::Dish& s) const {
    return std::min(2 * s.focal_length, 0.5 * s.diameter);
  }
  Answer operator()(const geometry::Tube& s) const { return s.radius; }
  Answer operator()(const geometry::Lathe& s) const {
    double length = 0, moment = 0, turned = 0;
    for (std::size_t i = 1; i < s.profile.size(); ++i) {
      const Vec2 step = s.profile[i] - s.profile[i - 1];
      length += glm::length(step);
      moment += glm::length(step) * 0.5 * (s.profile[i].x + s.profile[i - 1].x);
      if (i > 1) turned += det::acos(clamped_cosine(step, s.profile[i - 1] - s.profile[i - 2]));
    }
    if (!(length > 0) || !(moment > 0)) return std::nullopt;
    const double around = kSlanted * (moment / length);
    return s.spline && turned > 0 ? std::min(around, length / turned) : around;
  }
  Answer operator()(const geometry::Plane&) const { return std::nullopt; }
  Answer operator()(const geometry::Extrude&) const { return std::nullopt; }
  Answer operator()(const geometry::Polygons&) const { return std::nullopt; }
  // Of what the cage's planes turn by at its edges: half the area over the total mean curvature is
  // the radius of a cylinder, and half that of a sphere.
  Answer operator()(const geometry::Subdiv& s) const {
    const geometry::CageTurn turn = geometry::turn_of(s);
    if (!(turn.mean_curvature > 1e-9 * std::sqrt(turn.area))) return std::nullopt;
    return 0.5 * turn.area / turn.mean_curvature;
  }
  Answer operator()(const geometry::MeshShape&) const { return std::nullopt; }
};

void lower(Tolerance& best, double metres, ToleranceReason reason) {
  if (metres < best.metres) best = {metres, reason};
}

// The radius of curvature in the world: a stretched sphere is an ellipsoid, c²/a.
double radius_in_world(const geometry::Shape& shape, const Stretch& stretch) {
  const auto radius = radius_of_curvature(shape);
  if (!radius || !(stretch.largest > 0)) return 0;
  return *radius * stretch.smallest * (stretch.smallest / stretch.largest);
}

// That of the default: thin lenses do not get the millions of triangles that their rims would ask
// for.
double default_radius(const geometry::Shape& shape, const Stretch& stretch) {
  constexpr double kThinnest = 1.0 / 30;
  const double stretched = std::max(stretch.smallest, kThinnest * stretch.largest);
  if (const auto* ellipsoid = std::get_if<geometry::Ellipsoid>(&shape)) {
    const Vec3& r = ellipsoid->radii;
    return stretched * std::max(std::min({r.x, r.y, r.z}), kThinnest * std::max({r.x, r.y, r.z}));
  }
  return stretched * radius_of_curvature(shape).value_or(0);
}

void lower_for_normals(Tolerance& best, const scene::Budget& budget, const geometry::Shape& shape,
                       const Stretch& stretch, const std::optional<double>& slope) {
  const double radius = radius_in_world(shape, stretch);
  if (!slope || !(radius > 0) || budget.tolerance || !budget.nearest || !budget.ifov) return;
  const double angle = det::pow(*slope / 4 / kNormalFactor, 1.0 / 3);
  lower(best, radius * angle * angle / 8, ToleranceReason::tolerance);
}

}  // namespace

std::optional<double> microfacet_slope(const materials::Material& material) {
  const auto slope = materials::narrowest_slope(material, materials::Lobes::about_normal);
  return slope ? std::optional(std::max(*slope, kLeastSlope)) : std::nullopt;
}

std::optional<double> microfacet_slope(const scene::Scene& scene, const scene::Instance& instance) {
  const auto of_side = [&](std::int32_t material) {
    return microfacet_slope(scene.materials[static_cast<std::size_t>(material)]);
  };
  const auto front = of_side(instance.material);
  const auto back = instance.back == scene::kNone ? std::nullopt : of_side(instance.back);
  return front && back ? std::min(*front, *back) : front ? front : back;
}

double tolerance_of_pixels(double pixels, double ifov, double nearest) {
  return pixels * ifov * nearest;
}

double tolerance_of_centroid(double pixels, double ifov, double nearest) {
  return pixels * ifov * nearest / kCentroidFactor;
}

std::optional<double> radius_of_curvature(const geometry::Shape& shape) {
  return std::visit(CurvatureOf{}, shape);
}

bool has_explicit_counts(const geometry::Shape& shape) {
  return std::visit(
      [](const auto& s) {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, geometry::MeshShape>)
          return true;
        else if constexpr (requires { s.counts->rings; })
          return s.counts.has_value();
        else if constexpr (requires { s.counts.around; })
          return s.counts.around > 0 || s.counts.along > 0;
        else if constexpr (requires { s.levels; })
          return s.levels > 0;
        else
          return false;
      },
      shape);
}

Tolerance tolerance_for(const scene::Budget& budget, const geometry::Shape& shape,
                        const Stretch& world_from_shape, const ToleranceOverrides& asked) {
  Tolerance best{HUGE_VAL, ToleranceReason::tolerance};
  if (asked.by_command_line) {
    best = {*asked.by_command_line, ToleranceReason::command_line};
  } else if (asked.by_instance) {
    best = {*asked.by_instance, ToleranceReason::shape};
  } else {
    if (budget.tolerance) best.metres = *budget.tolerance;
    if (budget.ifov && budget.nearest) {
      if (budget.pixels)
        lower(best, tolerance_of_pixels(*budget.pixels, *budget.ifov, *budget.nearest),
              ToleranceReason::pixels);
      if (budget.centroid)
        lower(best, tolerance_of_centroid(*budget.centroid, *budget.ifov, *budget.nearest),
              ToleranceReason::centroid);
    }
    if (const double radius = radius_in_world(shape, world_from_shape); radius > 0 && budget.flux)
      lower(best, *budget.flux * radius / kFluxFactor, ToleranceReason::flux);
    lower_for_normals(best, budget, shape, world_from_shape, asked.slope);
    if (best.metres == HUGE_VAL) {
      best = Tolerance{};
      if (const double radius = default_radius(shape, world_from_shape); radius > 0)
        lower(best, kDefaultFlux * radius / kFluxFactor, ToleranceReason::flux);
    }
  }
  if (has_explicit_counts(shape)) best.reason = ToleranceReason::explicit_counts;
  return best;
}

}  // namespace panwright::compiler
