// Shapes of the language, from their attributes and lists.

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "pxn/build/loader.h"
#include "pxn/build/shapes.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

class ShapeReader {
 public:
  ShapeReader(const xml::Document& document, std::uint32_t element, const Units& units,
              Values& values, Reporter& reporter)
      : doc_(document), element_(element), units_(units), values_(values), reporter_(reporter) {}

  std::optional<geometry::Shape> run() {
    auto shape = read();
    if (!shape || !ok_) return std::nullopt;
    const auto report = [&](const geometry::ShapeProblem& problem) {
      reporter_.report(problem.code, place_of(problem), doc_, element_,
                       [&] { return Reporter::Text(problem.message); });
    };
    if (const auto problem = geometry::problem_of(*shape)) {
      report(*problem);
      return std::nullopt;
    }
    for (const geometry::ShapeProblem& doubt : geometry::doubts_of(*shape)) report(doubt);
    return shape;
  }

 private:
  std::optional<geometry::Shape> read() {
    switch (doc_.elements[element_].id) {
      case ElementId::sphere:
        return level_0_sphere();
      case ElementId::sphere_1:
        return sphere();
      case ElementId::ellipsoid: {
        geometry::Ellipsoid s;
        numbers("radii", std::span(&s.radii.x, 3));
        s.counts = counts();
        return s;
      }
      case ElementId::box: {
        geometry::Box s;
        numbers("size", std::span(&s.size.x, 3));
        s.bevel = real("bevel");
        s.round = word("edges") == "round";
        return s;
      }
      case ElementId::cylinder:
        return geometry::Cylinder{real("radius"), real("height"), caps(), sector(), counts()};
      case ElementId::cone:
        return geometry::Cone{real("radius"), real("top_radius"), real("height"),
                              caps(),         sector(),           counts()};
      case ElementId::disc:
        return geometry::Disc{real("radius"), real("inner_radius"), sector(), counts()};
      case ElementId::torus:
        return geometry::Torus{real("radius"), real("tube_radius"), sector(), counts()};
      case ElementId::dish:
        return geometry::Dish{real("diameter"), real("focal_length"), real("thickness"), counts()};
      case ElementId::plane: {
        double size[2] = {0, 0};
        numbers("size", size);
        return geometry::Plane{size[0], size[1]};
      }
      case ElementId::tube:
        return tube();
      case ElementId::lathe:
        return geometry::Lathe{points_2d(child_of(doc_, element_, ElementId::profile)),
                               word("curve") == "spline", sector(), counts()};
      case ElementId::extrude:
        return extrude();
      case ElementId::polygons:
        return polygons();
      default:
        return std::nullopt;
    }
  }

  std::optional<geometry::Shape> level_0_sphere() {
    const auto rings = values_.integer(element_, attribute::sphere_rings);
    const auto quads = values_.integer(element_, attribute::sphere_quads);
    if (!rings || !quads) return std::nullopt;
    return geometry::Sphere{1, geometry::SphereCounts{static_cast<std::uint32_t>(*rings),
                                                      static_cast<std::uint32_t>(*quads)}};
  }

  geometry::Shape sphere() {
    geometry::Sphere s;
    s.radius = real("radius", units_.length);
    double latitude[2];
    numbers("latitude", latitude);
    s.latitude_min = latitude[0];
    s.latitude_max = latitude[1];
    s.sector = sector();
    const std::uint32_t rings = count("rings");
    const std::uint32_t quads = count("quads");
    if (rings > 0 && quads > 0) s.counts = geometry::SphereCounts{rings, quads};
    return s;
  }

  geometry::Shape tube() {
    geometry::Tube s;
    const std::vector<double> list = list_of(child_of(doc_, element_, ElementId::path));
    for (std::size_t i = 0; i + 2 < list.size(); i += 3)
      s.path.emplace_back(list[i], list[i + 1], list[i + 2]);
    s.radius = real("radius");
    s.inner_radius = real("inner_radius");
    s.spline = word("curve") == "spline";
    s.closed = word("closed") == "1";
    s.caps = caps();
    s.counts = counts();
    return s;
  }

  geometry::Shape extrude() {
    geometry::Extrude s;
    s.outline = points_2d(child_of(doc_, element_, ElementId::outline));
    each(element_, ElementId::hole, [&](std::uint32_t c) { s.holes.push_back(points_2d(c)); });
    s.height = real("height");
    s.smooth = real("smooth");
    s.caps = caps();
    return s;
  }

  geometry::Shape polygons() {
    geometry::Polygons s;
    const std::vector<double> list = list_of(child_of(doc_, element_, ElementId::vertices));
    for (std::size_t i = 0; i + 2 < list.size(); i += 3)
      s.positions.emplace_back(list[i], list[i + 1], list[i + 2]);
    s.smooth = real("smooth");
    each(element_, ElementId::face, [&](std::uint32_t face) {
      geometry::Polygons::Face& f = s.faces.emplace_back();
      if (const std::uint32_t c = child_of(doc_, face, ElementId::face_outline))
        ok_ = indices(c, s.positions.size(), f.outline) && ok_;
      else
        ok_ = false;
      each(face, ElementId::face_hole, [&](std::uint32_t c) {
        ok_ = indices(c, s.positions.size(), f.holes.emplace_back()) && ok_;
      });
    });
    // note: none at all has been reported
    if (s.faces.empty()) ok_ = false;
    return s;
  }

  // ---- attributes

  std::optional<std::size_t> given(std::string_view name) {
    const auto which = attribute_of(doc_, element_, name);
    return which && values_.has(element_, *which) ? which : std::nullopt;
  }

  void numbers(std::string_view name, std::span<double> out) {
    const auto which = given(name);
    std::ranges::copy(entry(name).initial, out.begin());
    if (which && !values_.numbers(element_, *which, out)) ok_ = false;
    // note: one that must be there and is not has been reported
    if (!which && attribute_is_required(name)) ok_ = false;
  }

  // The schema's entry of an attribute of this element.
  const schemas::Attribute& entry(std::string_view name) const {
    const auto which = attribute_of(doc_, element_, name);
    assert(which);
    return schemas::kPxn.elements[static_cast<std::size_t>(doc_.elements[element_].id)]
        .attributes[*which];
  }

  // One number; its default by the schema where it is absent.
  double real(std::string_view name) {
    const std::span<const double> initial = entry(name).initial;
    return real(name, initial.empty() ? 0 : initial[0]);
  }
  double real(std::string_view name, double otherwise) {
    double out = otherwise;
    const auto which = given(name);
    if (which) {
      const auto value = values_.real(element_, *which);
      if (value) out = *value;
      ok_ = ok_ && value.has_value();
    } else if (attribute_is_required(name)) {
      ok_ = false;
    }
    return out;
  }

  std::uint32_t count(std::string_view name) {
    const auto which = given(name);
    if (!which) return 0;
    const auto value = values_.integer(element_, *which);
    ok_ = ok_ && value.has_value();
    return static_cast<std::uint32_t>(value.value_or(0));
  }

  std::string word(std::string_view name) {
    const std::string_view otherwise = entry(name).initial_word;
    const auto which = given(name);
    if (!which) return std::string(otherwise);
    const auto value = values_.text(element_, *which);
    ok_ = ok_ && value.has_value();
    return value.value_or(std::string(otherwise));
  }

  bool attribute_is_required(std::string_view name) const {
    const auto which = attribute_of(doc_, element_, name);
    const auto id = static_cast<std::size_t>(doc_.elements[element_].id);
    return which && schemas::kPxn.elements[id].attributes[*which].required;
  }

  geometry::Caps caps() {
    const std::string text = word("caps");
    return text == "none"     ? geometry::Caps::none
           : text == "bottom" ? geometry::Caps::bottom
           : text == "top"    ? geometry::Caps::top
                              : geometry::Caps::both;
  }

  geometry::Sector sector() {
    double ends[2];
    numbers("sector", ends);
    return {ends[0], ends[1]};
  }

  geometry::Counts counts() { return {count("segments"), count("rings")}; }

  // ---- lists

  template <class Read>
  void each(std::uint32_t holder, ElementId id, const Read& read) {
    const std::uint32_t end = doc_.elements[holder].next;
    for (std::uint32_t c = holder + 1; c < end; c = doc_.elements[c].next)
      if (doc_.elements[c].id == id) read(c);
  }

  std::vector<double> list_of(std::uint32_t child) {
    std::vector<double> list;
    // one that is not there has been reported
    if (child == 0 || !values_.list(child, list)) ok_ = false;
    return list;
  }

  std::vector<Vec2> points_2d(std::uint32_t child) {
    const std::vector<double> list = list_of(child);
    std::vector<Vec2> points;
    for (std::size_t i = 0; i + 1 < list.size(); i += 2) points.emplace_back(list[i], list[i + 1]);
    return points;
  }

  bool indices(std::uint32_t child, std::size_t limit, std::vector<std::uint32_t>& out) {
    if (!values_.integers(child, out)) return false;
    if (!ok_) return true;  // without the vertices nothing can be said
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] < limit) continue;
      reporter_.report(Code::E2001, values_.place_of(child, i), doc_, child, [&] {
        return Reporter::Text(
            fmt::format("index {} of {} vertices; the last one is {}", out[i], limit, limit - 1));
      });
      return false;
    }
    return true;
  }

  // ---- problems

  // The place of what a problem is with.
  SourceSpan place_of(const geometry::ShapeProblem& problem) {
    const auto list = [&](ElementId id, std::size_t tuple) -> std::optional<SourceSpan> {
      const std::uint32_t child = child_of(doc_, element_, id);
      if (child == 0) return std::nullopt;
      return values_.place_of(child, problem.item * tuple);
    };
    std::optional<SourceSpan> place;
    if (problem.part == "path") place = list(ElementId::path, 3);
    if (problem.part == "profile") place = list(ElementId::profile, 2);
    if (problem.part == "outline") place = list(ElementId::outline, 2);
    if (problem.part == "positions") place = list(ElementId::vertices, 3);
    if (problem.part == "holes" || problem.part == "faces") {
      const ElementId id = problem.part == "holes" ? ElementId::hole : ElementId::face;
      std::size_t number = 0;
      each(element_, id, [&](std::uint32_t c) {
        if (number++ != problem.item) return;
        place =
            id == ElementId::hole ? values_.place_of(c, problem.sub_item * 2) : doc_.tag_span(c);
      });
    }
    if (place) return *place;
    static constexpr std::pair<std::string_view, std::string_view> kAttributes[] = {
        {"bottom_radius", "radius"},
        {"latitude_min", "latitude"},
        {"latitude_max", "latitude"},
        {"segments", "quads"},
        {"width", "size"},
        {"height", "size"}};
    for (const std::string_view name : {problem.part, alias(problem.part, kAttributes)})
      if (const auto which = given(name)) return values_.value_place(element_, *which);
    return doc_.name_span(element_);
  }

  static std::string_view alias(
      std::string_view part,
      std::span<const std::pair<std::string_view, std::string_view>> aliases) {
    for (const auto& [member, attribute] : aliases)
      if (member == part) return attribute;
    return part;
  }

  const xml::Document& doc_;
  std::uint32_t element_;
  const Units& units_;
  Values& values_;
  Reporter& reporter_;
  bool ok_ = true;
};

}  // namespace

std::optional<geometry::Shape> read_exact_shape(const xml::Document& document,
                                                std::uint32_t element, const Units& units,
                                                Values& values, Reporter& reporter) {
  return ShapeReader(document, element, units, values, reporter).run();
}

}  // namespace panwright::pxn
