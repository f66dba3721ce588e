#include "importers/vrml/internal/faces.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "geometry/mesh/strip.h"
#include "geometry/tessellate/polygon.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::importers::vrml {

namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kLongestSearch =
    32;  // vertices of one point that are compared before one more is made
constexpr std::size_t kManyNumbers = 100'000;  // are worth a pass over the faces to free

Vec3 point_at(std::span<const double> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

std::string others(std::uint64_t count, std::string_view what) {
  return count == 0 ? std::string() : fmt::format("; so do {} more {}", count, what);
}

// Normals, colours or texture coordinates: which of them a corner has.
struct Attribute {
  enum class By : std::uint8_t { none, point, corner, face, face_index };
  By by = By::none;
  std::span<const double> values;  // width*N
  std::span<const std::int32_t> index;
  std::size_t width = 3;

  bool is_there() const { return by != By::none; }
  bool splits_points() const { return by > By::point; }
  std::size_t size() const { return values.size() / width; }
  std::uint32_t at(std::uint32_t point, std::size_t corner, std::size_t face) const {
    switch (by) {
      case By::none:
        return 0;
      case By::point:
        return point;
      case By::corner:
        return static_cast<std::uint32_t>(index[corner]);
      case By::face:
        return static_cast<std::uint32_t>(face);
      case By::face_index:
        return static_cast<std::uint32_t>(index[face]);
    }
    return 0;
  }
};

// Calls body(face, begin, end) for each face, whatever its corners.
template <class Body>
void for_each_face(std::span<const std::int32_t> index, const Body& body) {
  std::size_t face = 0;
  for (std::size_t begin = 0; begin < index.size(); ++begin, ++face) {
    std::size_t end = begin;
    while (end < index.size() && index[end] >= 0) ++end;
    body(face, begin, end);
    begin = end;
  }
}

class FaceMesher {
 public:
  FaceMesher(const FaceSet& in, const FaceOptions& options, ListProblems& problems)
      : in_(in), options_(options), problems_(problems), points_(in.points.size() / 3) {}

  Mesh run() {
    if (!count()) return {};
    normals_ = attribute(in_.normals, 3, in_.normal_index, in_.normal_per_vertex, List::normals,
                         List::normal_index);
    colors_ = attribute(in_.colors, 3, in_.color_index, in_.color_per_vertex, List::colors,
                        List::color_index);
    texcoords_ = attribute(in_.texcoords, 2, in_.texcoord_index, true, List::texcoords,
                           List::texcoord_index);
    if (normals_.splits_points() || colors_.splits_points() || texcoords_.splits_points())
      make_faces<true>();
    else
      make_faces<false>();
    finish_normals();
    if (!texcoords_.is_there() && options_.texcoords) make_texcoords();
    return std::move(out_);
  }

 private:
  void report(Code code, List list, std::size_t item, std::string message) {
    problems_.push_back({code, list, item, std::move(message)});
  }

  bool is_usable(std::int32_t point) const {
    return static_cast<std::size_t>(point) < points_ &&
           (all_finite_ || is_usable(point_at(in_.points, static_cast<std::size_t>(point))));
  }
  static bool is_usable(const Vec3& p) {
    const double most = geometry::kMaxCoordinate;
    return std::fabs(p.x) <= most && std::fabs(p.y) <= most && std::fabs(p.z) <= most;
  }

  // Counts triangles and says what is wrong with points and their index.
  bool count() {
    for (std::size_t i = 0; i < points_; ++i)
      all_finite_ = all_finite_ && is_usable(point_at(in_.points, i));
    std::uint64_t past_end = 0, beyond = 0, short_faces = 0;
    std::size_t first_past_end = 0, first_beyond = 0, first_short = 0;
    for_each_face(in_.coord_index, [&](std::size_t, std::size_t begin, std::size_t end) {
      if (begin == end) return;
      bool whole = true;
      for (std::size_t i = begin; i < end && whole; ++i) {
        const auto point = static_cast<std::size_t>(in_.coord_index[i]);
        whole = is_usable(in_.coord_index[i]);
        if (whole) continue;
        if (point >= points_ && past_end++ == 0) first_past_end = i;
        if (point < points_ && beyond++ == 0) first_beyond = i;
      }
      all_whole_ = all_whole_ && whole;
      if (!whole) return;
      if (end - begin < 3 && short_faces++ == 0) first_short = begin;
      triangles_ += end - begin < 3 ? 0 : end - begin - 2;
    });
    if (past_end > 0)
      report(Code("E6113"), List::coord_index, first_past_end,
             fmt::format("the face names point {} of {}, and is left out{}",
                         in_.coord_index[first_past_end], points_, others(past_end - 1, "faces")));
    if (beyond > 0)
      report(Code("E6107"), List::points, static_cast<std::size_t>(in_.coord_index[first_beyond]),
             fmt::format("a face names this point, which lies beyond {:g} m, and is left out{}",
                         geometry::kMaxCoordinate, others(beyond - 1, "faces")));
    if (short_faces > 0)
      report(Code("W6114"), List::coord_index, first_short,
             fmt::format("the face has fewer than three corners, and is left out{}",
                         others(short_faces - 1, "faces")));
    if (triangles_ <= options_.max_triangles) return true;
    report(Code("E6002"), List::coord_index, 0,
           fmt::format("{} triangles are needed, and the limit is {}", triangles_,
                       options_.max_triangles));
    return false;
  }

  // Settles how an attribute is found, and drops it whole when it cannot be.
  Attribute attribute(std::span<const double> values, std::size_t width,
                      std::span<const std::int32_t> index, bool per_vertex, List list,
                      List index_list) {
    using By = Attribute::By;
    Attribute a{By::none, values, index, width};
    if (a.size() == 0 || triangles_ == 0) return {};
    if (!per_vertex)
      a.by = index.empty() ? By::face : By::face_index;
    else
      a.by = index.empty() || is_coord_index(index) ? By::point : By::corner;
    const auto bad_value = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
    if (bad_value != values.end()) {
      report(Code("E6107"), list, static_cast<std::size_t>(bad_value - values.begin()) / width,
             "a number that is not finite; the whole list is not used");
      return {};
    }
    if (list == List::colors) report_bright(values);
    bool sound = true;
    for_each_face(in_.coord_index, [&](std::size_t face, std::size_t begin, std::size_t end) {
      if (!sound || end - begin < 3) return;
      const std::size_t corners = a.by == By::face || a.by == By::face_index ? 1 : end - begin;
      for (std::size_t i = begin; i < begin + corners && sound; ++i)
        if (is_usable(in_.coord_index[i])) sound = can_find(a, i, face, list, index_list);
    });
    return sound ? a : Attribute{};
  }

  void report_bright(std::span<const double> colors) {
    const auto outside = [](double v) { return v < 0 || v > 1; };
    const auto first = std::ranges::find_if(colors, outside);
    if (first == colors.end()) return;
    report(Code("W6114"), List::colors, static_cast<std::size_t>(first - colors.begin()) / 3,
           fmt::format("{} numbers of the list are outside 0 to 1 and are clamped",
                       std::ranges::count_if(colors, outside)));
  }

  bool is_coord_index(std::span<const std::int32_t> index) const {
    return index.size() == in_.coord_index.size() && std::ranges::equal(index, in_.coord_index);
  }

  bool can_find(const Attribute& a, std::size_t corner, std::size_t face, List list,
                List index_list) {
    using By = Attribute::By;
    const bool indexed = a.by == By::corner || a.by == By::face_index;
    const std::size_t item = a.by == By::corner ? corner : face;
    if (indexed && (item >= a.index.size() || a.index[item] < 0)) {
      const bool ended = item >= a.index.size();
      report(Code("W6114"), index_list, ended ? a.index.size() - 1 : item,
             fmt::format("{} it does not follow the faces of coordIndex, and is not used",
                         ended ? "the list ends too early:" : "a face ends here too early:"));
      return false;
    }
    const std::size_t wanted =
        a.at(static_cast<std::uint32_t>(in_.coord_index[corner]), corner, face);
    if (wanted < a.size()) return true;
    if (indexed)
      report(Code("E6113"), index_list, item,
             fmt::format("the index names item {} of {}; the whole list is not used", wanted,
                         a.size()));
    else
      report(Code("W6114"), list, a.size() - 1,
             fmt::format("the list has {} items where {} are needed, and is not used", a.size(),
                         wanted + 1));
    return false;
  }

  template <bool kSplit>
  void make_faces() {
    first_.assign(points_, kNone);
    const std::size_t guess = std::min(points_, in_.coord_index.size());
    out_.positions.reserve(guess);
    if (normals_.is_there()) out_.normals.reserve(guess);
    if (colors_.is_there()) out_.colors.reserve(guess);
    if (texcoords_.is_there()) out_.texcoords.reserve(guess);
    const bool many = in_.points.size() >= kManyNumbers && options_.served;
    if (!kSplit && many && all_finite_ && all_whole_) {
      // all vertices first: then the points make room for the triangles
      for_each_face(in_.coord_index, [&](std::size_t face, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && end - begin >= 3; ++i) vertex<kSplit>(i, face);
      });
      options_.served(List::points);
    }
    out_.triangles.reserve(triangles_);
    std::vector<std::uint32_t> corners;
    for_each_face(in_.coord_index, [&](std::size_t face, std::size_t begin, std::size_t end) {
      if (end - begin < 3) return;
      if (!all_whole_)
        for (std::size_t i = begin; i < end; ++i)
          if (!is_usable(in_.coord_index[i])) return;
      corners.clear();
      for (std::size_t i = begin; i < end; ++i) corners.push_back(vertex<kSplit>(i, face));
      cut(corners);
    });
  }

  template <bool kSplit>
  std::uint32_t vertex(std::size_t corner, std::size_t face) {
    const auto point = static_cast<std::uint32_t>(in_.coord_index[corner]);
    std::uint32_t v = first_[point];
    if constexpr (!kSplit) {
      if (v == kNone) v = first_[point] = new_vertex({point, point, point, point});
      return v;
    } else {
      const Key key{point, normals_.at(point, corner, face), colors_.at(point, corner, face),
                    texcoords_.at(point, corner, face)};
      for (int i = 0; v != kNone && i < kLongestSearch; ++i, v = keys_[v].next)
        if (keys_[v].key == key) return v;
      v = new_vertex(key);
      keys_.push_back({key, first_[point]});
      return first_[point] = v;
    }
  }

  struct Key {
    std::uint32_t point;
    std::uint32_t normal;
    std::uint32_t color;
    std::uint32_t texcoord;
    bool operator==(const Key&) const = default;
  };

  std::uint32_t new_vertex(const Key& key) {
    out_.positions.push_back(point_at(in_.points, key.point));
    if (normals_.is_there()) out_.normals.push_back(point_at(normals_.values, key.normal));
    if (colors_.is_there())
      out_.colors.push_back(glm::clamp(point_at(colors_.values, key.color), 0.0, 1.0));
    if (texcoords_.is_there())
      out_.texcoords.push_back(
          {texcoords_.values[2 * key.texcoord], texcoords_.values[2 * key.texcoord + 1]});
    return static_cast<std::uint32_t>(out_.positions.size() - 1);
  }

  void cut(const std::vector<std::uint32_t>& v) {
    if (v.size() == 3) return add(v[0], v[1], v[2]);
    const std::vector<Vec3>& p = out_.positions;
    if (v.size() == 4) {
      const bool second = geometry::cuts_better_from_second(p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
      add(v[0], v[1], v[second ? 3 : 2]);
      return second ? add(v[1], v[2], v[3]) : add(v[0], v[2], v[3]);
    }
    outline_.clear();
    for (const std::uint32_t i : v) outline_.push_back(p[i]);
    cut_.clear();
    cutter_.cut(outline_, cut_);
    for (const Triangle& t : cut_) add(v[t[0]], v[t[1]], v[t[2]]);
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (in_.ccw)
      out_.triangles.push_back({a, b, c});
    else
      out_.triangles.push_back({a, c, b});
  }

  void finish_normals() {
    // what the mesh was made from makes room for the lists that its normals need
    first_ = std::vector<std::uint32_t>();
    keys_ = std::vector<Keyed>();
    if (!normals_.is_there()) {
      if (options_.served) options_.served(List::points);
      if (options_.served) options_.served(List::coord_index);
      geometry::compute_normals(out_, in_.crease_angle.value_or(options_.crease_angle));
      for (Vec3& n : out_.normals)
        if (!is_finite(n)) n = Vec3(0, 0, 1);
      return;
    }
    std::uint64_t without = 0;
    for (Vec3& n : out_.normals) {
      const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
      without += largest == 0;
      // note: in two steps, so that no square gets lost
      if (largest > 0) n = glm::normalize(n / largest);
    }
    if (without == 0) return;
    std::size_t first = 0;
    while (first + 1 < normals_.size() && point_at(normals_.values, first) != Vec3(0)) ++first;
    report(Code("W6114"), List::normals, first,
           fmt::format("{} vertices have a normal without length, and take that of their faces",
                       without));
    take_normals_of_faces();
  }

  void take_normals_of_faces() {
    std::vector<Vec3> sums(out_.positions.size(), Vec3(0));
    for (const Triangle& t : out_.triangles) {
      const std::vector<Vec3>& p = out_.positions;
      const Vec3 cross = glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
      for (const std::uint32_t v : t) sums[v] += cross;
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
      if (out_.normals[v] != Vec3(0)) continue;
      const double length = glm::length(sums[v]);
      out_.normals[v] = length > 0 && std::isfinite(length) ? sums[v] / length : Vec3(0, 0, 1);
    }
  }

  // The standard's default: s along the longest side of the bounds from 0 to 1, t along the second
  // longest, to the same measure.
  void make_texcoords() {
    if (out_.positions.empty()) return;
    AxisBox box{out_.positions[0], out_.positions[0]};
    for (const Vec3& p : out_.positions) box.add(p);
    const Vec3& low = box.low;
    const Vec3 size = box.extent();
    const int s = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int one = s == 0 ? 1 : 0;
    const int two = s == 2 ? 1 : 2;
    const int t = size[one] >= size[two] ? one : two;
    const double scale = size[s] > 0 ? size[s] : 1;
    for (const Vec3& p : out_.positions)
      out_.texcoords.push_back(Vec2(p[s] - low[s], p[t] - low[t]) / scale);
  }

  struct Keyed {
    Key key;
    std::uint32_t next;  // of the same point
  };

  const FaceSet& in_;
  const FaceOptions& options_;
  ListProblems& problems_;
  std::size_t points_;
  std::uint64_t triangles_ = 0;
  bool all_finite_ = true;  // points
  bool all_whole_ = true;   // faces
  Attribute normals_;
  Attribute colors_;
  Attribute texcoords_;
  std::vector<std::uint32_t> first_;  // of each point, its newest vertex
  std::vector<Keyed> keys_;           // of each vertex
  geometry::PolygonCutter cutter_;
  std::vector<Vec3> outline_;
  std::vector<Triangle> cut_;
  Mesh out_;
};

}  // namespace

Mesh mesh_of(const FaceSet& faces, const FaceOptions& options, ListProblems& problems) {
  return FaceMesher(faces, options, problems).run();
}

}  // namespace panwright::importers::vrml
