// Shapes of the language, from their attributes and lists.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <utility>

#include "geometry/tessellate/shape_parameters.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

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
    for (const geometry::ShapeProblem& doubt : geometry::shape_warnings_of(*shape)) report(doubt);
    return shape;
  }

 private:
  std::optional<geometry::Shape> read() {
    auto shape = shape_called(element_entry().name);
    if (!shape) return std::nullopt;
    std::visit(
        [&]<class S>(S& s) {
          if constexpr (!std::same_as<S, geometry::MeshShape>)
            geometry::visit_parameters(
                s, [&](std::string_view name, auto&... members) { parameter(name, members...); });
        },
        *shape);
    return shape;
  }

  // A shape of a kind, as yet without its parameters.
  static std::optional<geometry::Shape> shape_called(std::string_view kind) {
    static const auto kAll = []<std::size_t... I>(std::index_sequence<I...>) {
      return std::array{geometry::Shape(std::in_place_index<I>)...};
    }
    (std::make_index_sequence<std::variant_size_v<geometry::Shape>>());
    for (const geometry::Shape& shape : kAll)
      if (geometry::kind_name(shape) == kind) return shape;
    return std::nullopt;
  }

  const schemas::Element& element_entry() const {
    return schemas::kPxn.elements[static_cast<std::size_t>(doc_.elements[element_].id)];
  }

  // ---- parameters: what is absent has its default by the schema. One that the element does not
  // have at the file's level stays as it is

  void parameter(std::string_view name, Vec3& v) { numbers(name, std::span(&v.x, 3)); }
  void parameter(std::string_view name, double& value) {
    const auto which = attribute_of(doc_, element_, name);
    if (!which) return;
    const schemas::Attribute& attribute = element_entry().attributes[*which];
    if (!attribute.initial.empty())
      value = attribute.initial[0] * (attribute.initial_in_units ? units_.length : 1);
    if (!present(*which)) return;
    const auto read = values_.real(element_, *which);
    if (read) value = *read;
    ok_ = ok_ && read.has_value();
  }
  void parameter(std::string_view name, double& first, double& second) {
    double both[] = {first, second};
    numbers(name, both);
    first = both[0];
    second = both[1];
  }
  void parameter(std::string_view name, bool& choice) {
    if (const auto index = word(name)) choice = *index != 0;
  }
  void parameter(std::string_view name, geometry::Caps& caps) {
    if (const auto index = word(name)) caps = static_cast<geometry::Caps>(*index);
  }
  void parameter(std::string_view name, std::uint32_t& count) {
    const auto which = attribute_of(doc_, element_, name);
    if (!which || !present(*which)) return;
    const auto value = values_.integer(element_, *which);
    ok_ = ok_ && value.has_value();
    count = static_cast<std::uint32_t>(value.value_or(0));
  }
  void parameter(std::string_view name, std::vector<Vec3>& points) {
    const std::vector<double> list = list_of(child_called(name));
    for (std::size_t i = 0; i + 2 < list.size(); i += 3)
      points.emplace_back(list[i], list[i + 1], list[i + 2]);
    points_ = points.size();
  }
  void parameter(std::string_view name, std::vector<Vec2>& points) {
    const std::uint32_t child = child_called(name);
    // those of cages need not be there
    if (child == 0 && name == "texcoords") return;
    points = points_2d(child);
    texcoords_ = points.size();
  }
  void parameter(std::string_view name, std::vector<std::vector<Vec2>>& lists) {
    each(element_, name, [&](std::uint32_t c) { lists.push_back(points_2d(c)); });
  }
  // Of indices of the points that were read before.
  void parameter(std::string_view name, std::vector<geometry::Polygons::Face>& faces) {
    each(element_, name, [&](std::uint32_t face) {
      geometry::Polygons::Face& f = faces.emplace_back();
      if (const std::uint32_t c = child_of(doc_, face, ElementId::face_outline))
        ok_ = indices(c, points_, f.outline) && ok_;
      else
        ok_ = false;
      each(face, ElementId::face_hole,
           [&](std::uint32_t c) { ok_ = indices(c, points_, f.holes.emplace_back()) && ok_; });
    });
    // note: none at all has been reported
    if (faces.empty()) ok_ = false;
  }
  void parameter(std::string_view name, std::vector<geometry::Subdiv::Face>& faces) {
    each(element_, name, [&](std::uint32_t face) {
      geometry::Subdiv::Face& f = faces.emplace_back();
      if (const std::uint32_t c = child_of(doc_, face, ElementId::face_outline))
        ok_ = indices(c, points_, f.outline) && ok_;
      else
        ok_ = false;
      if (const std::uint32_t c = child_of(doc_, face, ElementId::face_uv))
        ok_ = indices(c, texcoords_, f.texcoords, "texture coordinates") && ok_;
    });
    if (faces.empty()) ok_ = false;
  }
  void parameter(std::string_view name, std::vector<geometry::Subdiv::Crease>& creases) {
    each(element_, name, [&](std::uint32_t c) { sharp(c, creases.emplace_back()); });
  }
  void parameter(std::string_view name, std::vector<geometry::Subdiv::Corner>& corners) {
    each(element_, name, [&](std::uint32_t c) { sharp(c, corners.emplace_back()); });
  }
  // A crease or corner: vertices and their sharpness.
  template <class Sharp>
  void sharp(std::uint32_t child, Sharp& out) {
    auto& [vertices, sharpness] = out;
    ok_ = indices(child, points_, vertices) && ok_;
    const auto which = attribute_of(doc_, child, "sharpness");
    if (!which || !values_.has(child, *which)) return;
    const auto value = values_.real(child, *which);
    ok_ = ok_ && value.has_value();
    sharpness = value.value_or(sharpness);
  }

  std::optional<std::size_t> given(std::string_view name) {
    const auto which = attribute_of(doc_, element_, name);
    return which && values_.has(element_, *which) ? which : std::nullopt;
  }

  // Whether an attribute is there. One that must be and is not has been reported.
  bool present(std::size_t which) {
    const bool has = values_.has(element_, which);
    if (!has && element_entry().attributes[which].required) ok_ = false;
    return has;
  }

  void numbers(std::string_view name, std::span<double> out) {
    const auto which = attribute_of(doc_, element_, name);
    if (!which) return;
    std::ranges::copy(element_entry().attributes[*which].initial, out.begin());
    if (present(*which) && !values_.numbers(element_, *which, out)) ok_ = false;
  }

  // The index of a word; nothing where the element has no such attribute.
  std::optional<std::size_t> word(std::string_view name) {
    const auto which = attribute_of(doc_, element_, name);
    if (!which) return std::nullopt;
    const schemas::Attribute& attribute = element_entry().attributes[*which];
    std::string text(attribute.initial_word);
    if (present(*which)) {
      const auto read = values_.text(element_, *which);
      ok_ = ok_ && read.has_value();
      if (read) text = *read;
    }
    const auto found = std::ranges::find(attribute.value.words, text);
    if (found == attribute.value.words.end()) return std::nullopt;
    return static_cast<std::size_t>(found - attribute.value.words.begin());
  }

  // ---- lists

  template <class Read>
  void each(std::uint32_t holder, ElementId id, const Read& read) {
    const std::uint32_t end = doc_.elements[holder].next;
    for (std::uint32_t c = holder + 1; c < end; c = doc_.elements[c].next)
      if (doc_.elements[c].id == id) read(c);
  }

  // The children of a name, whatever their place in the tables.
  template <class Read>
  void each(std::uint32_t holder, std::string_view name, const Read& read) {
    const std::uint32_t end = doc_.elements[holder].next;
    for (std::uint32_t c = holder + 1; c < end; c = doc_.elements[c].next) {
      const ElementId id = doc_.elements[c].id;
      if (id != schemas::kNoElement &&
          schemas::kPxn.elements[static_cast<std::size_t>(id)].name == name)
        read(c);
    }
  }

  // The first of them, or 0.
  std::uint32_t child_called(std::string_view name) {
    std::uint32_t first = 0;
    each(element_, name, [&](std::uint32_t c) { first = first == 0 ? c : first; });
    return first;
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

  bool indices(std::uint32_t child, std::size_t limit, std::vector<std::uint32_t>& out,
               std::string_view of = "vertices") {
    if (!values_.integers(child, out)) return false;
    if (!ok_) return true;  // without the vertices nothing is known
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] < limit) continue;
      reporter_.report(Code("E2001"), values_.place_of(child, i), doc_, child, [&] {
        return Reporter::Text(limit == 0 ? fmt::format("index {} of no {}", out[i], of)
                                         : fmt::format("index {} of {} {}, expected at most {}",
                                                       out[i], limit, of, limit - 1));
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
    if (problem.part == "texcoords") place = list(ElementId::cage_texcoords, 2);
    static constexpr std::pair<std::string_view, std::string_view> kChildren[] = {
        {"holes", "hole"}, {"faces", "face"}, {"creases", "crease"}, {"corners", "corner"}};
    if (const std::string_view tag = alias(problem.part, kChildren); tag != problem.part) {
      std::size_t number = 0;
      each(element_, tag, [&](std::uint32_t c) {
        if (number++ != problem.item) return;
        place = tag == "hole"     ? values_.place_of(c, problem.sub_item * 2)
                : tag == "crease" ? values_.place_of(c, problem.sub_item)
                                  : doc_.tag_span(c);
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
  std::size_t points_ = 0;     // of the list that faces refer to
  std::size_t texcoords_ = 0;  // the same
  bool ok_ = true;
};

}  // namespace

std::optional<geometry::Shape> read_exact_shape(const xml::Document& document,
                                                std::uint32_t element, const Units& units,
                                                Values& values, Reporter& reporter) {
  return ShapeReader(document, element, units, values, reporter).run();
}

}  // namespace panwright::pxn
