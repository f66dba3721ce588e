// Which solids are shapes of ours.

#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "importers/step/internal/bodies.h"

namespace panwright::importers::step {

namespace {

// Surfaces that differ by less are one: parts of the size, and radians. Files hold 15 digits, some
// 7 and those are meshed.
constexpr double kSame = 1e-9;
// Area and volume tell a whole shape from a part of it, which is missing a face's worth.
// note: OpenCASCADE integrates discs good to about 1e-5
constexpr double kWhole = 1e-4;

Vec3 xyz(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

struct Line {
  Vec3 at{0};
  Vec3 along{0, 0, 1};  // unit
};

struct Round {  // cylinder, cone, sphere or torus
  Line axis;
  Vec3 x{1, 0, 0};
  double radius = 0;  // at axis.at
  double other = 0;   // cone: growth along the axis; torus: of the section
};

struct Surfaces {
  std::vector<Line> planes;
  std::vector<Round> cylinders, cones, spheres, tori;
  double size = 0;    // millimetres
  double area = 0;    // mm²
  double volume = 0;  // mm³
};

Round round_of(const gp_Ax3& frame, double radius, double other = 0) {
  return {{xyz(frame.Location().XYZ()), xyz(frame.Direction().XYZ())},
          xyz(frame.XDirection().XYZ()),
          radius,
          other};
}

std::optional<Surfaces> surfaces_of(const TopoDS_Shape& body) {
  constexpr int kMostFaces = 64;
  Surfaces out;
  int shells = 0;
  for (TopExp_Explorer at(body, TopAbs_SHELL); at.More(); at.Next()) ++shells;
  if (body.ShapeType() != TopAbs_SOLID || shells != 1) return std::nullopt;
  int faces = 0;
  for (TopExp_Explorer at(body, TopAbs_FACE); at.More(); at.Next()) {
    if (++faces > kMostFaces) return std::nullopt;
    const BRepAdaptor_Surface surface(TopoDS::Face(at.Current()), Standard_False);
    switch (surface.GetType()) {
      case GeomAbs_Plane:
        out.planes.push_back(
            {xyz(surface.Plane().Location().XYZ()), xyz(surface.Plane().Axis().Direction().XYZ())});
        break;
      case GeomAbs_Cylinder:
        out.cylinders.push_back(
            round_of(surface.Cylinder().Position(), surface.Cylinder().Radius()));
        break;
      case GeomAbs_Cone:
        out.cones.push_back(round_of(surface.Cone().Position(), surface.Cone().RefRadius(),
                                     std::tan(surface.Cone().SemiAngle())));
        break;
      case GeomAbs_Sphere:
        out.spheres.push_back(round_of(surface.Sphere().Position(), surface.Sphere().Radius()));
        break;
      case GeomAbs_Torus:
        out.tori.push_back(round_of(surface.Torus().Position(), surface.Torus().MajorRadius(),
                                    surface.Torus().MinorRadius()));
        break;
      default:
        return std::nullopt;
    }
  }
  GProp_GProps area;
  BRepGProp::SurfaceProperties(body, area);
  out.area = area.Mass();
  GProp_GProps volume;
  BRepGProp::VolumeProperties(body, volume);
  out.volume = volume.Mass();
  out.size = std::sqrt(std::abs(out.area));
  if (!std::isfinite(out.size) || !(out.volume > 0)) return std::nullopt;
  return out;
}

bool close(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

bool parallel(const Vec3& a, const Vec3& b) { return glm::length(glm::cross(a, b)) <= kSame; }

double off_line(const Line& line, const Vec3& point) {
  return glm::length(glm::cross(point - line.at, line.along));
}

// Whether all turn about the axis of the first.
bool coaxial(const std::vector<Round>& all, double tolerance) {
  return std::all_of(all.begin(), all.end(), [&](const Round& each) {
    return parallel(each.axis.along, all[0].axis.along) &&
           off_line(all[0].axis, each.axis.at) <= tolerance;
  });
}

// Numbers that differ by more than the tolerance, ascending.
std::vector<double> distinct(std::vector<double> values, double tolerance) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end(),
                           [&](double a, double b) { return b - a <= tolerance; }),
               values.end());
  return values;
}

// Where planes across an axis cut it; nothing when one is not across.
std::optional<std::vector<double>> heights_of(const Surfaces& s, const Line& axis) {
  std::vector<double> out;
  for (const Line& plane : s.planes) {
    if (!parallel(plane.along, axis.along)) return std::nullopt;
    out.push_back(glm::dot(plane.at - axis.at, axis.along));
  }
  return distinct(std::move(out), kSame * s.size);
}

Mat4 frame(const Vec3& origin, const Vec3& z, const Vec3& x) {
  const Vec3 e2 = glm::normalize(z);
  const Vec3 e0 = glm::normalize(x - glm::dot(x, e2) * e2);
  return {Vec4(e0, 0), Vec4(glm::cross(e2, e0), 0), Vec4(e2, 0), Vec4(origin / kMetre, 1)};
}

// Whether a body has the area and volume that the shape would have.
bool whole(const Surfaces& s, double area, double volume) {
  return close(s.area, area, kWhole * area) && close(s.volume, volume, kWhole * volume);
}

std::optional<Exact> sphere_of(const Surfaces& s) {
  const Round& first = s.spheres[0];
  for (const Round& each : s.spheres)
    if (!close(each.radius, first.radius, kSame * s.size) ||
        glm::length(each.axis.at - first.axis.at) > kSame * s.size)
      return std::nullopt;
  const double r = first.radius;
  if (!whole(s, 4 * kPi * r * r, 4 * kPi / 3 * r * r * r)) return std::nullopt;
  geometry::Sphere sphere;
  sphere.radius = r / kMetre;
  return Exact{sphere, frame(first.axis.at, first.axis.along, first.x)};
}

std::optional<Exact> torus_of(const Surfaces& s) {
  const Round& first = s.tori[0];
  if (!coaxial(s.tori, kSame * s.size) || !(first.radius > first.other)) return std::nullopt;
  for (const Round& each : s.tori)
    if (!close(each.radius, first.radius, kSame * s.size) ||
        !close(each.other, first.other, kSame * s.size) ||
        glm::length(each.axis.at - first.axis.at) > kSame * s.size)
      return std::nullopt;
  const double big = first.radius;
  const double small = first.other;
  if (!whole(s, 4 * kPi * kPi * big * small, 2 * kPi * kPi * big * small * small))
    return std::nullopt;
  geometry::Torus torus;
  torus.radius = big / kMetre;
  torus.tube_radius = small / kMetre;
  return Exact{torus, frame(first.axis.at, first.axis.along, first.x)};
}

std::optional<Exact> cylinder_of(const Surfaces& s) {
  const Round& first = s.cylinders[0];
  const auto heights = heights_of(s, first.axis);
  if (!heights || heights->size() != 2 || !coaxial(s.cylinders, kSame * s.size))
    return std::nullopt;
  std::vector<double> all;
  for (const Round& each : s.cylinders) all.push_back(each.radius);
  const auto radii = distinct(std::move(all), kSame * s.size);
  if (radii.size() > 2) return std::nullopt;
  const double height = (*heights)[1] - (*heights)[0];
  const double outer = radii.back();
  const double inner = radii.size() == 2 ? radii[0] : 0;
  const double section = kPi * (outer * outer - inner * inner);
  if (!whole(s, 2 * section + 2 * kPi * (outer + inner) * height, section * height))
    return std::nullopt;
  const Vec3 middle = first.axis.at + 0.5 * ((*heights)[0] + (*heights)[1]) * first.axis.along;
  Exact out{{}, frame(middle, first.axis.along, first.x)};
  if (inner > 0) {
    geometry::Tube tube;
    tube.path = {Vec3(0, 0, -0.5 * height / kMetre), Vec3(0, 0, 0.5 * height / kMetre)};
    tube.radius = outer / kMetre;
    tube.inner_radius = inner / kMetre;
    out.shape = tube;
  } else {
    geometry::Cylinder cylinder;
    cylinder.radius = outer / kMetre;
    cylinder.height = height / kMetre;
    out.shape = cylinder;
  }
  return out;
}

std::optional<Exact> cone_of(const Surfaces& s) {
  const Round& first = s.cones[0];
  auto heights = heights_of(s, first.axis);
  if (!heights || heights->empty() || heights->size() > 2 || !coaxial(s.cones, kSame * s.size))
    return std::nullopt;
  if (heights->size() == 1) {  // the tip is the other end
    heights->push_back(-first.radius / first.other);
    std::sort(heights->begin(), heights->end());
  }
  const double low = (*heights)[0];
  const double high = (*heights)[1];
  const auto radius_at = [&](const Round& cone, double height) {
    const Vec3 point = first.axis.at + height * first.axis.along;
    return cone.radius + cone.other * glm::dot(point - cone.axis.at, cone.axis.along);
  };
  for (const Round& each : s.cones)
    for (const double height : {low, high})
      if (!close(radius_at(each, height), radius_at(first, height), kSame * s.size))
        return std::nullopt;
  double bottom = radius_at(first, low);
  double top = radius_at(first, high);
  if (std::abs(bottom) <= kSame * s.size) bottom = 0;
  if (std::abs(top) <= kSame * s.size) top = 0;
  const double length = high - low;
  if (bottom < 0 || top < 0 || !(bottom + top > 0) || !(length > kSame * s.size))
    return std::nullopt;
  const double slant = std::sqrt(length * length + (top - bottom) * (top - bottom));
  if (!whole(s, kPi * (bottom * bottom + top * top + (bottom + top) * slant),
             kPi / 3 * length * (bottom * bottom + bottom * top + top * top)))
    return std::nullopt;
  geometry::Cone cone;
  cone.bottom_radius = bottom / kMetre;
  cone.top_radius = top / kMetre;
  cone.height = length / kMetre;
  const Vec3 middle = first.axis.at + 0.5 * (low + high) * first.axis.along;
  return Exact{cone, frame(middle, first.axis.along, first.x)};
}

std::optional<Exact> box_of(const Surfaces& s) {
  // three directions, each with two planes across
  std::vector<Vec3> directions;
  for (const Line& plane : s.planes) {
    const bool known =
        std::any_of(directions.begin(), directions.end(),
                    [&](const Vec3& direction) { return parallel(direction, plane.along); });
    if (!known) directions.push_back(plane.along);
  }
  if (directions.size() != 3) return std::nullopt;
  for (int i = 0; i < 3; ++i)
    if (std::abs(glm::dot(directions[static_cast<std::size_t>(i)],
                          directions[static_cast<std::size_t>((i + 1) % 3)])) > kSame)
      return std::nullopt;
  // named after the axis that each is nearest to
  for (int axis = 2; axis > 0; --axis) {
    const auto end = directions.begin() + axis + 1;
    const auto nearest = std::max_element(
        directions.begin(), end,
        [&](const Vec3& a, const Vec3& b) { return std::abs(a[axis]) < std::abs(b[axis]); });
    std::iter_swap(nearest, directions.begin() + axis);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (directions[static_cast<std::size_t>(axis)][axis] < 0)
      directions[static_cast<std::size_t>(axis)] *= -1.0;
  Vec3 size(0);
  Vec3 middle(0);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& along = directions[static_cast<std::size_t>(axis)];
    std::vector<double> all;
    for (const Line& plane : s.planes)
      if (parallel(plane.along, along)) all.push_back(glm::dot(plane.at, along));
    const auto offsets = distinct(std::move(all), kSame * s.size);
    if (offsets.size() != 2) return std::nullopt;
    size[axis] = offsets[1] - offsets[0];
    middle += 0.5 * (offsets[0] + offsets[1]) * along;
  }
  if (!whole(s, 2 * (size.x * size.y + size.y * size.z + size.z * size.x),
             size.x * size.y * size.z))
    return std::nullopt;
  geometry::Box box;
  box.size = size / kMetre;
  return Exact{box, frame(middle, directions[2], directions[0])};
}

}  // namespace

std::optional<Exact> exact_of(const TopoDS_Shape& body) {
  const auto s = surfaces_of(body);
  if (!s) return std::nullopt;
  const bool flat = !s->planes.empty();
  const int kinds =
      !s->cylinders.empty() + !s->cones.empty() + !s->spheres.empty() + !s->tori.empty();
  if (kinds > 1) return std::nullopt;
  std::optional<Exact> out;
  if (kinds == 0)
    out = box_of(*s);
  else if (!s->spheres.empty() && !flat)
    out = sphere_of(*s);
  else if (!s->tori.empty() && !flat)
    out = torus_of(*s);
  else if (!s->cylinders.empty())
    out = cylinder_of(*s);
  else if (!s->cones.empty())
    out = cone_of(*s);
  if (out && geometry::problem_of(out->shape)) return std::nullopt;
  return out;
}

}  // namespace panwright::importers::step
