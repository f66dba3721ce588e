#include "geometry/tessellate/shape.h"

#include <span>
#include <type_traits>

#include "geometry/tessellate/internal/tessellators.h"
#include "geometry/tessellate/shape_parameters.h"

namespace panwright::geometry {

namespace {

// Feeds the numbers of a shape, in a fixed order, to a hash.
class Sink {
 public:
  void operator()(double x) { bytes(x + 0.0); }  // note: −0 is 0
  void operator()(bool x) { (*this)(std::uint64_t{x}); }
  void operator()(std::uint32_t x) { (*this)(std::uint64_t{x}); }
  void operator()(std::uint64_t x) { bytes(x); }
  void operator()(Caps x) { (*this)(static_cast<std::uint64_t>(x)); }
  void operator()(const Vec2& v) { all(v.x, v.y); }
  void operator()(const Vec3& v) { all(v.x, v.y, v.z); }
  void operator()(const Polygons::Face& f) { all(f.outline, f.holes); }
  void operator()(const Subdiv::Face& f) { all(f.outline, f.texcoords); }
  void operator()(const Subdiv::Crease& c) { all(c.path, c.sharpness); }
  void operator()(const Subdiv::Corner& c) { all(c.vertices, c.sharpness); }
  template <class T>
  void operator()(const std::vector<T>& list) {
    (*this)(std::uint64_t{list.size()});
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, Vec2> || std::is_same_v<T, Vec3> ||
                  std::is_same_v<T, Triangle>)
      hasher_.update(std::as_bytes(std::span(list)));
    else
      for (const T& item : list) (*this)(item);
  }
  template <class... T>
  void all(const T&... values) {
    ((*this)(values), ...);
  }
  Hash128 digest() const { return hasher_.digest128(); }

 private:
  template <class T>
  void bytes(const T& value) {
    hasher_.update(std::as_bytes(std::span(&value, 1)));
  }
  Hasher hasher_;
};

void feed(const MeshShape& s, Sink& to) {
  to.all(s->positions, s->normals, s->texcoords, s->colors, s->triangles);
}
template <class S>
void feed(const S& s, Sink& to) {
  visit_parameters(s, [&](std::string_view, const auto&... values) { to.all(values...); });
}

bool touches_axis(const Vec2& p) { return p.x == 0; }

bool closed(const Sphere& s) { return s.whole(); }
bool closed(const MeshShape& s) { return s->closed; }
bool closed(const Ellipsoid&) { return true; }
bool closed(const Box&) { return true; }
bool closed(const Cylinder& s) { return s.caps == Caps::both; }
bool closed(const Cone& s) {
  // an end of radius 0 needs no cap
  const bool bottom = s.bottom_radius == 0 || s.caps == Caps::both || s.caps == Caps::bottom;
  const bool top = s.top_radius == 0 || s.caps == Caps::both || s.caps == Caps::top;
  return bottom && top && (s.sector.whole() || s.caps == Caps::both);
}
bool closed(const Disc&) { return false; }
bool closed(const Torus& s) { return s.sector.whole(); }
bool closed(const Dish& s) { return s.thickness > 0; }
bool closed(const Plane&) { return false; }
bool closed(const Tube& s) { return s.closed || s.caps == Caps::both; }
bool closed(const Lathe& s) {
  const bool ends_meet = s.profile.front() == s.profile.back();
  return s.sector.whole() &&
         (ends_meet || (touches_axis(s.profile.front()) && touches_axis(s.profile.back())));
}
bool closed(const Extrude& s) { return s.caps == Caps::both; }
bool closed(const Polygons&) { return false; }
bool closed(const Subdiv& s) { return internal::has_no_border(s); }

}  // namespace

std::string_view kind_name(const Shape& shape) {
  static constexpr std::string_view kNames[] = {
      "sphere", "mesh",  "ellipsoid", "box",   "cylinder", "cone",     "disc",  "torus",
      "dish",   "plane", "tube",      "lathe", "extrude",  "polygons", "subdiv"};
  static_assert(std::size(kNames) == std::variant_size_v<Shape>);
  return kNames[shape.index()];
}

std::optional<ShapeProblem> problem_of(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> std::optional<ShapeProblem> {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>)
          return std::nullopt;
        else
          return internal::problem(s);
      },
      shape);
}

bool is_closed(const Shape& shape) {
  return std::visit([](const auto& s) { return closed(s); }, shape);
}

Hash128 hash_of(const Shape& shape) {
  Sink sink;
  sink(std::uint64_t{shape.index()});
  std::visit([&](const auto& s) { feed(s, sink); }, shape);
  return sink.digest();
}

}  // namespace panwright::geometry
