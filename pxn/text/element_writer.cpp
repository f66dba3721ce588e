#include "pxn/text/element_writer.h"

#include <array>

#include "pxn/text/reference.h"

namespace panwright::pxn {

namespace {

using geometry::Caps;
using geometry::Counts;
using geometry::Sector;

class AttributeWriter {
 public:
  explicit AttributeWriter(ElementWriter& out) : out_(out) {}

  void operator()(const geometry::Sphere& s) {
    out_.attribute("radius", s.radius);
    if (s.latitude_min != -kPi / 2 || s.latitude_max != kPi / 2)
      pair("latitude", s.latitude_min, s.latitude_max);
    sector(s.sector);
    if (!s.counts) return;
    out_.attribute("rings", std::to_string(s.counts->rings));
    out_.attribute("quads", std::to_string(s.counts->quads));
  }
  void operator()(const geometry::MeshShape&) {}
  void operator()(const geometry::Ellipsoid& s) {
    out_.attribute("radii", s.radii);
    counts(s.counts);
  }
  void operator()(const geometry::Box& s) {
    out_.attribute("size", s.size);
    optional("bevel", s.bevel);
    if (s.round) out_.attribute("edges", "round");
  }
  void operator()(const geometry::Cylinder& s) {
    out_.attribute("radius", s.radius);
    out_.attribute("height", s.height);
    caps(s.caps);
    sector(s.sector);
    segments(s.counts);
  }
  void operator()(const geometry::Cone& s) {
    out_.attribute("radius", s.bottom_radius);
    optional("top_radius", s.top_radius);
    out_.attribute("height", s.height);
    caps(s.caps);
    sector(s.sector);
    segments(s.counts);
  }
  void operator()(const geometry::Disc& s) {
    out_.attribute("radius", s.radius);
    optional("inner_radius", s.inner_radius);
    sector(s.sector);
    segments(s.counts);
  }
  void operator()(const geometry::Torus& s) {
    out_.attribute("radius", s.radius);
    out_.attribute("tube_radius", s.tube_radius);
    sector(s.sector);
    counts(s.counts);
  }
  void operator()(const geometry::Dish& s) {
    out_.attribute("diameter", s.diameter);
    out_.attribute("focal_length", s.focal_length);
    optional("thickness", s.thickness);
    counts(s.counts);
  }
  void operator()(const geometry::Plane& s) { pair("size", s.width, s.height); }
  void operator()(const geometry::Tube& s) {
    out_.attribute("radius", s.radius);
    optional("inner_radius", s.inner_radius);
    if (s.spline) out_.attribute("curve", "spline");
    if (s.closed) out_.attribute("closed", "1");
    caps(s.caps);
    counts(s.counts);
  }
  void operator()(const geometry::Lathe& s) {
    if (s.spline) out_.attribute("curve", "spline");
    sector(s.sector);
    counts(s.counts);
  }
  void operator()(const geometry::Extrude& s) {
    out_.attribute("height", s.height);
    optional("smooth", s.smooth);
    caps(s.caps);
  }
  void operator()(const geometry::Polygons& s) { optional("smooth", s.smooth); }

 private:
  void pair(std::string_view name, double a, double b) {
    const double both[] = {a, b};
    out_.numbers(name, both);
  }
  void optional(std::string_view name, double value) {
    if (value != 0) out_.attribute(name, value);
  }
  void sector(const Sector& s) {
    if (!(s == Sector{})) pair("sector", s.begin, s.end);
  }
  void caps(Caps caps) {
    constexpr std::string_view kWords[] = {"both", "none", "bottom", "top"};
    if (caps != Caps::both) out_.attribute("caps", kWords[static_cast<std::size_t>(caps)]);
  }
  void segments(const Counts& c) {
    if (c.around != 0) out_.attribute("segments", std::to_string(c.around));
  }
  void counts(const Counts& c) {
    segments(c);
    if (c.along != 0) out_.attribute("rings", std::to_string(c.along));
  }

  ElementWriter& out_;
};

class ChildWriter {
 public:
  explicit ChildWriter(ElementWriter& out) : out_(out) {}

  void operator()(const geometry::MeshShape& mesh) {
    vectors("positions", "vec3", mesh->positions);
    if (!mesh->normals.empty()) vectors("normals", "vec3", mesh->normals);
    if (!mesh->colours.empty()) vectors("colours", "rgb", mesh->colours);
    if (!mesh->texcoords.empty()) {
      out_.open("texcoords");
      for (const Vec2& t : mesh->texcoords) out_.element("vec3", std::array{t.x, t.y, 0.0});
      out_.close("texcoords");
    }
    strips(mesh->triangles);
  }
  void operator()(const geometry::Tube& s) { points("path", s.path); }
  void operator()(const geometry::Lathe& s) { points("profile", s.profile); }
  void operator()(const geometry::Extrude& s) {
    points("outline", s.outline);
    for (const auto& hole : s.holes) points("hole", hole);
  }
  void operator()(const geometry::Polygons& s) {
    points("vertices", s.positions);
    for (const geometry::Polygons::Face& face : s.faces) {
      out_.open("face");
      indices("outline", face.outline);
      for (const auto& hole : face.holes) indices("hole", hole);
      out_.close("face");
    }
  }
  template <class Other>
  void operator()(const Other&) {}

 private:
  template <class Vectors>
  void vectors(std::string_view list, std::string_view tag, const Vectors& values) {
    out_.open(list);
    for (const Vec3& v : values) out_.element(tag, std::span(&v.x, 3));
    out_.close(list);
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
  out_ += xml::escaped(value);
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
  std::visit([&](const auto& s) { AttributeWriter{out}(s); }, shape);
}

void write_shape_children(const geometry::Shape& shape, ElementWriter& out) {
  std::visit([&](const auto& s) { ChildWriter{out}(s); }, shape);
}

}  // namespace panwright::pxn
