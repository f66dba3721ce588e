#include "pxn/text/element_writer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>

#include "base/text.h"
#include "geometry/tessellate/shape_parameters.h"
#include "pxn/text/reference.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

namespace {

// The schema's entry of a shape: that of the newest level.
const schemas::Element& entry_of(std::string_view tag) {
  const schemas::Element* newest = nullptr;
  for (const schemas::Element& element : schemas::kPxn.elements)
    if (element.shape && element.name == tag &&
        (newest == nullptr || element.level > newest->level))
      newest = &element;
  assert(newest != nullptr);
  return *newest;
}

// Parameters as attributes, where the schema has one of this name; those that have their default
// are left out.
class AttributeWriter {
 public:
  AttributeWriter(const schemas::Element& element, ElementWriter& out)
      : element_(element), out_(out) {}

  void operator()(std::string_view name, const Vec3& v) { numbers(name, std::span(&v.x, 3)); }
  template <std::same_as<double>... More>
  void operator()(std::string_view name, const double& first, const More&... more) {
    numbers(name, std::array{first, more...});
  }
  void operator()(std::string_view name, const bool& choice) { word(name, choice); }
  void operator()(std::string_view name, const geometry::Caps& caps) {
    word(name, static_cast<std::size_t>(caps));
  }
  void operator()(std::string_view name, const std::uint32_t& count) {
    if (count != 0 && entry(name) != nullptr) out_.attribute(name, std::to_string(count));
  }
  template <class List>
  void operator()(std::string_view, const std::vector<List>&) {}

 private:
  const schemas::Attribute* entry(std::string_view name) const {
    const auto found = std::ranges::find(element_.attributes, name, &schemas::Attribute::name);
    return found == element_.attributes.end() ? nullptr : &*found;
  }
  void numbers(std::string_view name, std::span<const double> values) {
    const schemas::Attribute* attribute = entry(name);
    if (attribute == nullptr) return;
    // a default in the root's units is another one in another file
    if (!attribute->initial_in_units && std::ranges::equal(values, attribute->initial)) return;
    out_.numbers(name, values);
  }
  void word(std::string_view name, std::size_t index) {
    const schemas::Attribute* attribute = entry(name);
    if (attribute == nullptr) return;
    const std::string_view word = attribute->value.words[index];
    if (word != attribute->initial_word) out_.attribute(name, word);
  }

  const schemas::Element& element_;
  ElementWriter& out_;
};

// Lists as children.
class ChildWriter {
 public:
  explicit ChildWriter(ElementWriter& out) : out_(out) {}

  void operator()(const geometry::MeshShape& mesh) {
    vectors("positions", "vec3", mesh->positions);
    if (!mesh->normals.empty()) vectors("normals", "vec3", mesh->normals);
    if (!mesh->colors.empty()) vectors("colours", "rgb", mesh->colors);
    if (!mesh->texcoords.empty()) {
      out_.open("texcoords");
      for (const Vec2& t : mesh->texcoords) out_.element("vec3", std::array{t.x, t.y, 0.0});
      out_.close("texcoords");
    }
    strips(mesh->triangles);
  }
  template <class S>
  void operator()(const S& s) {
    geometry::visit_parameters(
        s, [&](std::string_view name, const auto&... members) { (list(name, members), ...); });
  }

 private:
  template <class Vectors>
  void vectors(std::string_view list, std::string_view tag, const Vectors& values) {
    out_.open(list);
    for (const Vec3& v : values) out_.element(tag, std::span(&v.x, 3));
    out_.close(list);
  }
  template <class Other>
  void list(std::string_view, const Other&) {}
  void list(std::string_view tag, const std::vector<Vec2>& values) {
    // texture coordinates of cages, where there are none
    if (!values.empty()) points(tag, values);
  }
  void list(std::string_view tag, const std::vector<Vec3>& values) { points(tag, values); }
  template <class Item>
  void list(std::string_view tag, const std::vector<std::vector<Item>>& values) {
    for (const auto& value : values) list(tag, value);
  }
  void list(std::string_view tag, const std::vector<geometry::Polygons::Face>& faces) {
    for (const geometry::Polygons::Face& face : faces) {
      out_.open(tag);
      indices("outline", face.outline);
      for (const auto& hole : face.holes) indices("hole", hole);
      out_.close(tag);
    }
  }
  void list(std::string_view tag, const std::vector<geometry::Subdiv::Face>& faces) {
    for (const geometry::Subdiv::Face& face : faces) {
      out_.open(tag);
      indices("outline", face.outline);
      if (!face.texcoords.empty()) indices("uv", face.texcoords);
      out_.close(tag);
    }
  }
  void list(std::string_view tag, const std::vector<geometry::Subdiv::Crease>& creases) {
    for (const auto& crease : creases) sharp(tag, crease.path, crease.sharpness);
  }
  void list(std::string_view tag, const std::vector<geometry::Subdiv::Corner>& corners) {
    for (const auto& corner : corners) sharp(tag, corner.vertices, corner.sharpness);
  }
  void sharp(std::string_view tag, const std::vector<std::uint32_t>& vertices, double sharpness) {
    out_.open(tag);
    if (sharpness != geometry::kInfinitelySharp) out_.attribute("sharpness", sharpness);
    for (const std::uint32_t index : vertices) out_.index(index);
    out_.close(tag);
  }
  template <class Vector>
  void points(std::string_view tag, const std::vector<Vector>& values) {
    out_.open(tag);
    for (const Vector& v : values)
      for (int k = 0; k < Vector::length(); ++k) out_.number(v[k]);
    out_.close(tag);
  }
  void indices(std::string_view tag, const std::vector<std::uint32_t>& values) {
    out_.open(tag);
    for (const std::uint32_t index : values) out_.index(index);
    out_.close(tag);
  }

  // Strips that give the same triangles in the same order, each begun by the same corner.
  void strips(const std::vector<geometry::Triangle>& triangles) {
    out_.open("tristrips");
    for (std::size_t i = 0; i < triangles.size();) {
      out_.open("tristrip");
      for (const std::uint32_t index : triangles[i]) out_.index(index);
      std::uint32_t a = triangles[i][1], b = triangles[i][2];
      bool odd = true;
      for (++i; i < triangles.size(); ++i, odd = !odd) {
        const geometry::Triangle& next = triangles[i];
        if (next[0] != (odd ? b : a) || next[1] != (odd ? a : b)) break;
        out_.index(next[2]);
        a = b;
        b = next[2];
      }
      out_.close("tristrip");
    }
    out_.close("tristrips");
  }

  ElementWriter& out_;
};

}  // namespace

void ElementWriter::attribute(std::string_view name, std::string_view value) {
  out_.push_back(' ');
  out_ += name;
  out_ += "=\"";
  out_ += markup_escaped(value);
  out_.push_back('"');
}

void ElementWriter::numbers(std::string_view name, std::span<const double> values) {
  out_.push_back(' ');
  out_ += name;
  out_ += "=\"";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out_.push_back(' ');
    out_ += format_double(values[i]);
  }
  out_.push_back('"');
}

void write_shape_attributes(const geometry::Shape& shape, ElementWriter& out) {
  AttributeWriter writer(entry_of(geometry::kind_name(shape)), out);
  std::visit(
      [&]<class S>(const S& s) {
        if constexpr (!std::same_as<S, geometry::MeshShape>) geometry::visit_parameters(s, writer);
      },
      shape);
}

void write_shape_children(const geometry::Shape& shape, ElementWriter& out) {
  std::visit([&](const auto& s) { ChildWriter{out}(s); }, shape);
}

}  // namespace panwright::pxn
