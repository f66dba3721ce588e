// Cross-sections along a spine → faces.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "importers/vrml/internal/faces.h"

namespace panwright::importers::vrml {

namespace {

// Bends of less are rounding, radians, or the like share of a length: a spine that was straight
// before it was written with seven digits gets no axis from them.
constexpr double kNoBend = 1e-5;

// Peak while a mesh is made, with its arrays, as measured with textures
// (docs/accuracy/importing.md).
constexpr double kBytesPerTriangle = 110;

Vec2 vec2_at(std::span<const double> values, std::size_t i) {
  return {values[2 * i], values[2 * i + 1]};
}
Vec3 vec3_at(std::span<const double> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

// a×b/|a×b|; 0 where a and b have one direction.
Vec3 across(const Vec3& a, const Vec3& b) {
  const double lengths = glm::length(a) * glm::length(b);
  const Vec3 cross = glm::cross(a, b);
  const double length = glm::length(cross);
  return length > kNoBend * lengths ? cross / length : Vec3(0);
}

// The planes that hold the cross-section at each point of a spine: ISO/IEC 14772-1:1997, 6.18.3.
class SpinePlanes {
 public:
  explicit SpinePlanes(std::span<const double> spine) {
    for (std::size_t i = 0; i < spine.size() / 3; ++i) spine_.push_back(vec3_at(spine, i));
    closed_ = spine_.size() > 2 && spine_.front() == spine_.back();
    thin_out();
    wraps_ = closed_ && kept_.size() > 2;
    find_y();
    find_z();
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const Vec3 x = glm::normalize(glm::cross(y_[i], z_[i]));
      planes_.push_back(Mat3(x, y_[i], glm::cross(x, y_[i])));
    }
  }

  bool closed() const { return closed_; }
  // Columns: the axes of the plane at a point, y along the spine.
  const Mat3& at(std::size_t point) const { return planes_[slot_[point]]; }

 private:
  // Neighbours at one place share a plane.
  void thin_out() {
    for (const Vec3& p : spine_) {
      if (kept_.empty() || p != kept_.back()) kept_.push_back(p);
      slot_.push_back(kept_.size() - 1);
    }
  }

  Vec3 before(std::size_t i) const {
    return i > 0 ? kept_[i - 1] : wraps_ ? kept_[kept_.size() - 2] : kept_[i];
  }
  Vec3 after(std::size_t i) const {
    return i + 1 < kept_.size() ? kept_[i + 1] : wraps_ ? kept_[1] : kept_[i];
  }

  void find_y() {
    const std::size_t n = kept_.size();
    y_.assign(n, Vec3(0));
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 along = after(i) - before(i);
      const double length = glm::length(along);
      const double lengths = glm::length(after(i) - kept_[i]) + glm::length(kept_[i] - before(i));
      if (length > kNoBend * lengths) y_[i] = along / length;
    }
    fill_gaps(y_);
    if (n == 0 || y_[0] == Vec3(0)) y_.assign(n, Vec3(0, 1, 0));
  }

  void find_z() {
    const std::size_t n = kept_.size();
    z_.assign(n, Vec3(0));
    for (std::size_t i = 0; i < n; ++i)
      if (wraps_ || (i > 0 && i + 1 < n)) z_[i] = across(after(i) - kept_[i], before(i) - kept_[i]);
    fill_gaps(z_);
    if (n == 0 || z_[0] == Vec3(0)) return turn_from_y();
    for (std::size_t i = 1; i < n; ++i)
      if (glm::dot(z_[i], z_[i - 1]) < 0) z_[i] = -z_[i];
    for (std::size_t i = 0; i < n; ++i) {
      // a plane taken over from a neighbour need not hold this y
      const Vec3 x = across(y_[i], z_[i]);
      z_[i] = x == Vec3(0) ? glm::cross(any_across(y_[i]), y_[i]) : glm::cross(x, y_[i]);
    }
  }

  // What has no direction takes that of the point before it, the first ones that of the first that
  // has one.
  static void fill_gaps(std::vector<Vec3>& directions) {
    const auto first = std::ranges::find_if(directions, [](const Vec3& d) { return d != Vec3(0); });
    if (first == directions.end()) return;
    Vec3 last = *first;
    for (Vec3& d : directions) last = d = d == Vec3(0) ? last : d;
  }

  static Vec3 any_across(const Vec3& y) {
    return glm::normalize(glm::cross(y, std::fabs(y.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, 1)));
  }

  // Without a bend: z as the shortest turn of +y to the spine leaves it, for all of a straight
  // spine, else carried on from point to point.
  void turn_from_y() {
    if (kept_.empty()) return;
    if (is_straight()) {
      const Vec3 whole = kept_.back() - kept_.front();
      if (glm::length(whole) > 0) y_.assign(kept_.size(), glm::normalize(whole));
      y_.assign(kept_.size(), y_[0]);
    }
    Vec3 z = turned_z(y_[0]);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const Vec3 x = glm::cross(y_[i], z);
      z_[i] = z =
          glm::normalize(glm::cross(glm::length(x) > kNoBend ? x : any_across(y_[i]), y_[i]));
    }
  }

  bool is_straight() const {
    Vec3 furthest(0);
    for (const Vec3& p : kept_)
      if (glm::length(p - kept_[0]) > glm::length(furthest)) furthest = p - kept_[0];
    const double length = glm::length(furthest);
    for (const Vec3& p : kept_)
      if (glm::length(glm::cross(p - kept_[0], furthest)) > kNoBend * length * length) return false;
    return true;
  }

  static Vec3 turned_z(const Vec3& y) {
    const Vec3 z(0, 0, 1);
    const Vec3 axis_sine = glm::cross(Vec3(0, 1, 0), y);
    const double sine = glm::length(axis_sine);
    // note: half a turn, of a spine that runs down, has no axis of its own; z is what others take
    if (sine == 0) return z;
    const Vec3 axis = axis_sine / sine;
    // Rodrigues
    return z * y.y + glm::cross(axis, z) * sine + axis * (glm::dot(axis, z) * (1 - y.y));
  }

  std::vector<Vec3> spine_;
  std::vector<Vec3> kept_;         // without neighbours at one place
  std::vector<std::size_t> slot_;  // of each spine point
  bool closed_ = false;
  bool wraps_ = false;  // the last point kept is the first again
  std::vector<Vec3> y_;
  std::vector<Vec3> z_;
  std::vector<Mat3> planes_;
};

Vec3 turned(const Vec3& p, std::span<const double> axis_angle) {
  const Vec3 axis(axis_angle[0], axis_angle[1], axis_angle[2]);
  const double length = glm::length(axis);
  if (!(length > 0) || axis_angle[3] == 0) return p;
  const Vec3 u = axis / length;
  const det::SinCos a = det::sincos(axis_angle[3]);
  return p * a.cos + glm::cross(u, p) * a.sin + u * (glm::dot(u, p) * (1 - a.cos));
}

class ExtrusionMesher {
 public:
  ExtrusionMesher(const Extrusion& in, const FaceOptions& options, ListProblems& problems)
      : in_(in),
        options_(options),
        problems_(problems),
        around_(in.cross_section.size() / 2),
        along_(in.spine.size() / 3),
        scales_(in.scales.size() / 2),
        turns_(in.orientations.size() / 4) {}

  geometry::Mesh run() {
    if (!is_sound()) return {};
    make_points();
    make_sides();
    make_caps();
    FaceSet faces;
    faces.points = points_;
    faces.coord_index = index_;
    faces.texcoords = texcoords_;
    faces.texcoord_index = texcoord_index_;
    faces.ccw = in_.ccw;
    faces.crease_angle = in_.crease_angle;
    FaceOptions options = options_;
    options.served = [this](List list) {
      if (list == List::points) points_ = std::vector<double>();
      if (list == List::coord_index) index_ = std::vector<std::int32_t>();
    };
    return mesh_of(faces, options, problems_);
  }

 private:
  void report(Code code, List list, std::size_t item, std::string message) {
    problems_.push_back({code, list, item, std::move(message)});
  }

  bool is_sound() {
    if (around_ < 2 || along_ < 2) {
      report(Code("W6114"), around_ < 2 ? List::cross_section : List::spine, 0,
             fmt::format("a cross-section of {} points along a spine of {} has no surface", around_,
                         along_));
      return false;
    }
    const double triangles =
        2.0 * static_cast<double>(around_ - 1) * static_cast<double>(along_ - 1);
    if (triangles + 2.0 * static_cast<double>(around_) >
        static_cast<double>(std::min<std::uint64_t>(options_.max_triangles, 0x7fffffff / 5))) {
      report(Code("E6002"), List::none, 0,
             fmt::format("about {:.0f} triangles are needed, and the limit is {}", triangles,
                         options_.max_triangles));
      return false;
    }
    if (triangles * kBytesPerTriangle > static_cast<double>(options_.max_memory)) {
      report(Code("E6002"), List::none, 0,
             fmt::format("about {:.0f} triangles are needed, which take {:.0f} MB, and the limit "
                         "leaves {:.0f}",
                         triangles, triangles * kBytesPerTriangle * 1e-6,
                         static_cast<double>(options_.max_memory) * 1e-6));
      return false;
    }
    check_count(scales_, "scale", List::scales);
    check_count(turns_, "orientation", List::orientations);
    return true;
  }

  void check_count(std::size_t count, std::string_view what, List list) {
    if (count <= 1 || count >= along_) return;
    report(Code("W6114"), list, count,
           fmt::format("{} has {} items for a spine of {} points; the last is used for the others",
                       what, count, along_));
  }

  void make_points() {
    const SpinePlanes planes(in_.spine);
    closed_spine_ = planes.closed();
    points_.reserve(3 * around_ * along_);
    for (std::size_t k = 0; k < along_; ++k) {
      const Vec2 scale = scales_ == 0 ? Vec2(1) : vec2_at(in_.scales, std::min(k, scales_ - 1));
      for (std::size_t j = 0; j < around_; ++j) {
        const Vec2 section = vec2_at(in_.cross_section, j) * scale;
        Vec3 p(section.x, 0, section.y);
        if (turns_ > 0) p = turned(p, in_.orientations.subspan(4 * std::min(k, turns_ - 1), 4));
        p = vec3_at(in_.spine, k) + planes.at(k) * p;
        points_.insert(points_.end(), {p.x, p.y, p.z});
      }
    }
  }

  // How far along a run of points each lies, from 0 to 1.
  template <class At>
  static std::vector<double> shares(std::size_t count, const At& at) {
    std::vector<double> share(count, 0);
    for (std::size_t i = 1; i < count; ++i)
      share[i] = share[i - 1] + glm::length(at(i) - at(i - 1));
    const double whole = share.back();
    for (std::size_t i = 0; i < count; ++i)
      share[i] =
          whole > 0 ? share[i] / whole : static_cast<double>(i) / static_cast<double>(count - 1);
    return share;
  }

  void make_sides() {
    const auto width = static_cast<std::int32_t>(around_);
    index_.reserve(5 * (around_ - 1) * (along_ - 1) + 2 * (around_ + 1));
    for (std::int32_t k = 0; k + 1 < static_cast<std::int32_t>(along_); ++k) {
      for (std::int32_t j = 0; j + 1 < width; ++j) {
        const std::int32_t at = k * width + j;
        index_.insert(index_.end(), {at, at + 1, at + width + 1, at + width, -1});
      }
    }
    if (!options_.texcoords) return;
    const auto u = shares(around_, [&](std::size_t i) { return vec2_at(in_.cross_section, i); });
    const auto v = shares(along_, [&](std::size_t i) { return vec3_at(in_.spine, i); });
    texcoords_.reserve(2 * around_ * (along_ + 1));
    for (std::size_t k = 0; k < along_; ++k)
      for (std::size_t j = 0; j < around_; ++j) texcoords_.insert(texcoords_.end(), {u[j], v[k]});
    texcoord_index_ = index_;
  }

  void make_caps() {
    const bool repeats =
        around_ > 2 && vec2_at(in_.cross_section, 0) == vec2_at(in_.cross_section, around_ - 1);
    const std::size_t corners = around_ - (repeats ? 1 : 0);
    if (corners < 3 || is_ring()) return;
    if (options_.texcoords) make_cap_texcoords();
    const auto first_texcoord = static_cast<std::int32_t>(around_ * along_);
    const auto add = [&](std::size_t section, bool reversed) {
      const auto first = static_cast<std::int32_t>(section * around_);
      for (std::size_t i = 0; i < corners; ++i) {
        const auto j = static_cast<std::int32_t>(reversed ? corners - 1 - i : i);
        index_.push_back(first + j);
        if (options_.texcoords) texcoord_index_.push_back(first_texcoord + j);
      }
      index_.push_back(-1);
      if (options_.texcoords) texcoord_index_.push_back(-1);
    };
    if (in_.begin_cap) add(0, true);
    if (in_.end_cap) add(along_ - 1, false);
  }

  // Whether the last section stands on the first: caps would be walls inside.
  bool is_ring() const {
    if (!closed_spine_) return false;
    const std::size_t last = 3 * around_ * (along_ - 1);
    double size = 0;
    double apart = 0;
    for (std::size_t i = 0; i < 3 * around_; ++i) {
      size = std::max(size, std::fabs(points_[i]));
      apart = std::max(apart, std::fabs(points_[last + i] - points_[i]));
    }
    return apart <= kNoBend * size;
  }

  // The larger side of the cross-section's bounds runs from 0 to 1.
  void make_cap_texcoords() {
    const Vec2 first = vec2_at(in_.cross_section, 0);
    AxisRectangle bounds{first, first};
    for (std::size_t j = 1; j < around_; ++j) bounds.add(vec2_at(in_.cross_section, j));
    const double size = bounds.longest();
    for (std::size_t j = 0; j < around_; ++j) {
      const Vec2 at = (vec2_at(in_.cross_section, j) - bounds.low) / (size > 0 ? size : 1);
      texcoords_.insert(texcoords_.end(), {at.x, at.y});
    }
  }

  const Extrusion& in_;
  const FaceOptions& options_;
  ListProblems& problems_;
  std::size_t around_;  // points of the cross-section
  std::size_t along_;   // points of the spine
  std::size_t scales_;
  std::size_t turns_;
  bool closed_spine_ = false;
  std::vector<double> points_;  // 3*around*along
  std::vector<std::int32_t> index_;
  std::vector<double> texcoords_;
  std::vector<std::int32_t> texcoord_index_;
};

}  // namespace

geometry::Mesh mesh_of(const Extrusion& extrusion, const FaceOptions& options,
                       ListProblems& problems) {
  return ExtrusionMesher(extrusion, options, problems).run();
}

}  // namespace panwright::importers::vrml
