#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/mesh/check.h"
#include "geometry/mesh/strip.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

namespace {

using schemas::ElementId;
using schemas::kNoElement;

// as in geometry::MeshReport: thinner than this a triangle has no normal to speak of
constexpr double kThinnest = 1e-7;

// what normalising leaves of a length of 1
constexpr double kNormalRounding = 1e-15;

class MeshReader {
 public:
  MeshReader(const xml::Document& document, std::uint32_t element, double crease_angle,
             Values& values, Reporter& reporter)
      : doc_(document),
        element_(element),
        crease_angle_(crease_angle),
        values_(values),
        reporter_(reporter) {}

  std::shared_ptr<const geometry::Mesh> run() {
    const std::uint32_t positions = child_of(doc_, element_, ElementId::positions);
    const std::uint32_t strips = child_of(doc_, element_, ElementId::tristrips);
    if (positions == 0 || strips == 0) return nullptr;
    const bool positions_ok = read_list(positions, mesh_.positions);
    read_optional(ElementId::normals, mesh_.normals);
    read_optional(ElementId::colours, mesh_.colors);
    std::vector<Vec3> texcoords;
    read_optional(ElementId::texcoords, texcoords);
    for (const Vec3& t : texcoords) mesh_.texcoords.push_back(Vec2(t));
    // indices mean nothing when a position could not be read
    if (!positions_ok) return nullptr;
    read_strips(strips);
    drop_flat_triangles();
    if (mesh_.triangles.empty()) {
      if (!strips_failed_)
        report(Code("E2004"), element_, [&] {
          return Reporter::Text(
              "the mesh has no triangle with area; a strip takes three indices or more");
        });
      return nullptr;
    }
    make_normals();
    look_at_edges();
    return std::make_shared<const geometry::Mesh>(std::move(mesh_));
  }

 private:
  template <class Compose>
  void report(Code code, std::uint32_t element, const Compose& compose) {
    reporter_.report(code, doc_.name_span(element), doc_, element, compose);
  }

  // ---- lists

  bool read_list(std::uint32_t list, std::vector<Vec3>& out) {
    const std::uint32_t end = doc_.elements[list].next;
    out.reserve(end - list - 1);
    bool ok = true;
    for (std::uint32_t c = list + 1; c < end; c = doc_.elements[c].next) {
      Vec3 v(0);
      ok = doc_.elements[c].id != kNoElement && values_.numbers(c, std::span(&v.x, 3)) && ok;
      out.push_back(v);
    }
    return ok;
  }

  // A list that is wrong is left out, and the mesh does without it.
  void read_optional(ElementId id, std::vector<Vec3>& out) {
    const std::uint32_t list = child_of(doc_, element_, id);
    if (list == 0) return;
    const bool ok = read_list(list, out);
    if (ok && out.size() != mesh_.positions.size()) {
      report(Code("E2002"), list, [&] {
        return Reporter::Text(
            fmt::format("<{}> has {}, and there are {}; expected one per position", doc_.name(list),
                        counted(out.size(), "entry"), counted(mesh_.positions.size(), "position")));
      });
    }
    if (!ok || out.size() != mesh_.positions.size()) out.clear();
  }

  // ---- triangles

  void read_strips(std::uint32_t strips) {
    const std::uint32_t end = doc_.elements[strips].next;
    std::uint64_t joins = 0;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t c = strips + 1; c < end; c = doc_.elements[c].next) {
      if (doc_.elements[c].id == kNoElement) continue;
      const bool ok = values_.integers(c, indices);
      check_count(c, indices.size());
      if (!ok || !in_range(c, indices)) {
        strips_failed_ = true;
        continue;
      }
      joins += geometry::append_strip(indices, mesh_.triangles);
    }
    if (joins > 0)
      report(Code("N2005"), strips, [&] {
        return Reporter::Text(fmt::format("{} that repeat{} an index {} left out",
                                          counted(joins, "triangle"), joins == 1 ? "s" : "",
                                          joins == 1 ? "is" : "are"));
      });
  }

  void check_count(std::uint32_t strip, std::size_t there) {
    const auto count = values_.integer(strip, schemas::attribute::tristrip_count);
    if (!count || *count == there) return;
    reporter_.report(Code("W1205"), values_.value_place(strip, schemas::attribute::tristrip_count),
                     doc_, strip, [&] {
                       return Reporter::Text(
                           fmt::format("count is {}, and there are {} indices", *count, there));
                     });
  }

  bool in_range(std::uint32_t strip, const std::vector<std::uint32_t>& indices) {
    const std::size_t vertices = mesh_.positions.size();
    const auto past = [&](std::uint32_t index) { return index >= vertices; };
    const auto bad = std::find_if(indices.begin(), indices.end(), past);
    if (bad == indices.end()) return true;
    const auto others = std::count_if(bad + 1, indices.end(), past);
    const SourceSpan where =
        values_.place_of(strip, static_cast<std::size_t>(bad - indices.begin()));
    reporter_.report(Code("E2001"), where, doc_, strip, [&] {
      const std::string accepted =
          vertices == 0
              ? "no positions"
              : fmt::format("there are {} positions, expected 0 to {}", vertices, vertices - 1);
      return Reporter::Text(fmt::format(
          "the index {} is past the last position; {}{}; the strip is left out", *bad, accepted,
          others > 0 ? fmt::format("; {} more of this strip are", others) : ""));
    });
    return false;
  }

  void drop_flat_triangles() {
    const std::vector<Vec3>& p = mesh_.positions;
    const auto is_flat = [&](const geometry::Triangle& t) {
      const Vec3 sides[] = {p[t[1]] - p[t[0]], p[t[2]] - p[t[1]], p[t[0]] - p[t[2]]};
      double scale = 0;
      for (const Vec3& side : sides)
        for (int k = 0; k < 3; ++k) scale = std::max(scale, std::abs(side[k]));
      if (scale == 0) return true;
      // scaled, so that neither tiny nor huge triangles leave the range of double
      const Vec3 a = sides[0] / scale;
      const Vec3 b = sides[1] / scale;
      const Vec3 c = sides[2] / scale;
      const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
      // the two shorter sides: their cross product loses least to rounding
      const Vec3 cross = longest == glm::dot(a, a)   ? glm::cross(b, c)
                         : longest == glm::dot(b, b) ? glm::cross(c, a)
                                                     : glm::cross(a, b);
      return !(glm::length(cross) >= kThinnest * longest);
    };
    const std::size_t dropped = std::erase_if(mesh_.triangles, is_flat);
    if (dropped > 0)
      report(Code("W2006"), element_, [&] {
        return Reporter::Text(fmt::format("{} without area {} left out",
                                          counted(dropped, "triangle"),
                                          dropped == 1 ? "is" : "are"));
      });
  }

  // ---- normals

  void make_normals() {
    if (mesh_.normals.empty()) {
      geometry::compute_normals(mesh_, crease_angle_);
      return;
    }
    std::vector<std::size_t> zero;
    for (std::size_t i = 0; i < mesh_.normals.size(); ++i) {
      Vec3& n = mesh_.normals[i];
      const double scale = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
      if (scale == 0) {
        zero.push_back(i);
        continue;
      }
      // note: a normal written with all its digits comes back bit for bit
      if (!(std::abs(glm::length(n) - 1) <= kNormalRounding)) n = glm::normalize(n / scale);
    }
    if (zero.empty()) return;
    // without creases every vertex keeps its index
    geometry::Mesh smooth = mesh_;
    geometry::compute_normals(smooth, kPi);
    for (const std::size_t i : zero) mesh_.normals[i] = smooth.normals[i];
    const std::uint32_t list = child_of(doc_, element_, ElementId::normals);
    std::uint32_t first = list + 1;
    for (std::size_t i = 0; i < zero[0]; ++i) first = doc_.elements[first].next;
    report(Code("W2008"), first, [&] {
      return Reporter::Text(fmt::format(
          "the normal has length zero{}; the computed one is used",
          zero.size() > 1 ? fmt::format(", and so have {} more of this mesh", zero.size() - 1)
                          : ""));
    });
  }

  void look_at_edges() {
    const geometry::MeshReport found = geometry::check(mesh_);
    mesh_.closed = found.closed;
    if (found.misoriented_edges > 0)
      report(Code("W2007"), element_, [&] {
        return Reporter::Text(fmt::format(
            "at {} neighbouring triangles face opposite ways; strips alternate, beginning "
            "counter-clockwise from outside",
            counted(found.misoriented_edges, "edge")));
      });
    if (found.closed && found.volume < 0)
      report(Code("W2009"), element_, [&] {
        return Reporter::Text(fmt::format(
            "the mesh is closed and inside out: its triangles enclose {:.4g} m³", found.volume));
      });
  }

  const xml::Document& doc_;
  std::uint32_t element_;
  double crease_angle_;
  Values& values_;
  Reporter& reporter_;
  geometry::Mesh mesh_;
  bool strips_failed_ = false;
};

}  // namespace

std::shared_ptr<const geometry::Mesh> read_mesh_shape(const xml::Document& document,
                                                      std::uint32_t element, double crease_angle,
                                                      Values& values, Reporter& reporter) {
  return MeshReader(document, element, crease_angle, values, reporter).run();
}

}  // namespace panwright::pxn
