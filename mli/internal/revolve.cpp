// Forms around an axis: a profile that turns, heights along its normals.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "mli/internal/form.h"

namespace panwright::mli {
namespace {

// How the flat sheet is cut: rolled up, as a sector about the cone's apex, or as a disc.
enum class Cut { rolled, sector, disc };

struct Profile {
  std::vector<Vec2> corners;  // (r, z) of straight parts, outside on the right when going along
  Cut cut = Cut::rolled;
  double radius = 0;    // rolled: at which x counts metres
  double distance = 0;  // sector, disc: from the middle of the cut to the first corner, along it
  double sine = 1;      // sector: of the cone's half angle; the middle lies before (< 0) or behind
};

bool profile_of(const Tube& tube, const Vec2& sheet, FormProblems& problems, Profile& out) {
  const bool good =
      problems.length("radius", tube.radius, true) && problems.length("flange", tube.flange, true);
  const double length = tube.length == 0 ? sheet.y - 2 * tube.flange : tube.length;
  if (!good || !problems.length("length", length, false)) return false;
  const double r = tube.radius > 0 ? tube.radius : sheet.x / (2 * kPi);
  if (tube.flange > 0) out.corners.push_back({r + tube.flange, 0});
  out.corners.push_back({r, 0});
  out.corners.push_back({r, length});
  if (tube.flange > 0) out.corners.push_back({r + tube.flange, length});
  out.radius = r;
  return true;
}

bool profile_of(const Cone& cone, const Vec2&, FormProblems& problems, Profile& out) {
  if (!problems.length("radius", cone.radius, false) ||
      !problems.length("top_radius", cone.top_radius, true) ||
      !problems.length("length", cone.length, false) ||
      !problems.length("flange", cone.flange, true))
    return false;
  const double slope = cone.length / std::fabs(cone.radius - cone.top_radius);
  if (cone.flange > 0 && slope < 0.01) {
    problems.log.report(Code("E7001"), problems.where,
                        fmt::format("the cone is {} m long between radii of {} and {} m, expected "
                                    "at least a hundredth of their difference with flanges",
                                    cone.length, cone.radius, cone.top_radius));
    return false;
  }
  if (cone.flange > 0) out.corners.push_back({cone.radius + cone.flange, 0});
  out.corners.push_back({cone.radius, 0});
  out.corners.push_back({cone.top_radius, cone.length});
  if (cone.flange > 0 && cone.top_radius > 0)
    out.corners.push_back({cone.top_radius + cone.flange, cone.length});
  const double slant =
      std::sqrt(std::pow(cone.radius - cone.top_radius, 2) + cone.length * cone.length);
  out.sine = (cone.radius - cone.top_radius) / slant;
  out.radius = (cone.radius + cone.top_radius) / 2;
  // nearly a tube: the sector's middle is too far away to count from
  if (std::fabs(out.sine) < 1e-4) return true;
  out.cut = Cut::sector;
  out.distance = cone.radius / out.sine + cone.flange;
  return true;
}

bool profile_of(const Disc& disc, const Vec2&, FormProblems& problems, Profile& out) {
  if (!problems.length("radius", disc.radius, false) ||
      !problems.length("flange", disc.flange, true))
    return false;
  if (disc.flange > 0) out.corners.push_back({disc.radius, -disc.flange});
  out.corners.push_back({disc.radius, 0});
  out.corners.push_back({0, 0});
  out.cut = Cut::disc;
  out.distance = disc.radius + disc.flange;
  return true;
}

Vec2 right_of(const Vec2& along) { return {along.y, -along.x}; }

// A ring of vertices: all of one place on the profile.
struct Ring {
  double distance;  // along the profile from its first corner
  Vec2 place;       // (r, z)
  Vec2 lift;        // what a height of 1 moves it by
  double room[2];   // below, above: heights that stay on their side of the bisectors
};

// Rings about a cell apart, each corner one of them. Lifts lean linearly from the normal to the
// mitre over half of the shorter part beside a corner.
std::vector<Ring> rings_of(const Profile& profile, double cell) {
  const std::vector<Vec2>& p = profile.corners;
  const std::size_t parts = p.size() - 1;
  std::vector<Vec2> along, normal;
  std::vector<double> length;
  for (std::size_t k = 0; k < parts; ++k) {
    length.push_back(glm::length(p[k + 1] - p[k]));
    along.push_back((p[k + 1] - p[k]) / length[k]);
    normal.push_back(right_of(along[k]));
  }
  const auto mitre = [&](std::size_t corner) {
    if (corner == 0 || corner == parts) return normal[corner == 0 ? 0 : parts - 1];
    const Vec2& a = normal[corner - 1];
    const Vec2& b = normal[corner];
    return (a + b) / (1 + glm::dot(a, b));
  };
  const auto reach = [&](std::size_t corner) {
    const double before = corner > 0 ? length[corner - 1] : length[corner];
    return std::min(before, corner < parts ? length[corner] : before) / 2;
  };
  std::vector<Ring> rings;
  double start = 0;
  for (std::size_t k = 0; k < parts; ++k) {
    const double count = std::max(2.0, std::floor(length[k] / cell + 0.5));
    for (double n = k == 0 ? 0 : 1; n <= count; ++n) {
      const double here = n / count * length[k], left = length[k] - here;
      Ring ring{start + here,
                n == count ? p[k + 1] : p[k] + here * along[k],
                normal[k],
                {kMaxLength, kMaxLength}};
      for (const std::size_t corner : {k, k + 1}) {
        const double far = corner == k ? here : left;
        const Vec2 lean = mitre(corner) - normal[k];
        // where it leans into the part, lines of equal height get shorter, until they are points
        const double inwards = glm::dot(lean, along[k]) * (corner == k ? 1 : -1);
        double& room = ring.room[inwards > 0];
        if (inwards != 0) room = std::min(room, std::max(far, reach(corner)) / std::fabs(inwards));
        ring.lift += lean * std::max(0.0, 1 - far / reach(corner));
      }
      rings.push_back(ring);
    }
    start += length[k];
  }
  return rings;
}

// Where a ring's vertex lies on the flat cut. angle: around the axis
Vec2 cut_place(const Profile& profile, const Ring& ring, double angle) {
  if (profile.cut == Cut::rolled) return {angle * profile.radius, ring.distance};
  const double far = profile.distance - ring.distance;
  const auto turned = det::sincos(profile.cut == Cut::disc ? angle : (angle - kPi) * profile.sine);
  return {far * turned.sin, profile.cut == Cut::disc ? far * turned.cos : -far * turned.cos};
}

// Takes the step between both sides of a ring of heights from them, fading out.
void join(std::vector<double>& heights) {
  const std::size_t last = heights.size() - 1;
  const double step = heights[last] - heights[0];
  const std::size_t faded = std::max<std::size_t>(1, last / 20);
  for (std::size_t k = 0; k < faded; ++k) {
    const double part = 0.5 * (1 - static_cast<double>(k) / static_cast<double>(faded));
    heights[k] += part * step;
    heights[last - k] -= part * step;
  }
  heights[last] = heights[0];
}

class Revolver {
 public:
  Revolver(const Sheet& sheet, const Profile& profile)
      : sampler_{sheet}, profile_(profile), rings_(rings_of(profile, sheet.spacing.x)) {
    double widest = 0;
    for (const Vec2& corner : profile.corners) widest = std::max(widest, corner.x);
    around_ = std::max(3.0, std::floor(2 * kPi * widest / sheet.spacing.x + 0.5));
  }

  double vertices() const { return (around_ + 1) * static_cast<double>(rings_.size()); }

  Result<geometry::Mesh> mesh(FormProblems& problems) {
    const auto columns = static_cast<std::size_t>(around_) + 1;
    for (std::size_t i = 0; i < columns; ++i) {
      angles_.push_back(2 * kPi * static_cast<double>(i) / around_);
      turns_.push_back(det::sincos(i + 1 == columns ? 0.0 : angles_[i]));
    }
    geometry::Mesh mesh;
    lay_out(mesh);
    if (!problems.fits(high_ - low_, sampler_.size())) return failed;
    for (Vec2& place : mesh.texcoords) place += 0.5 * sampler_.size() - 0.5 * (low_ + high_);
    for (std::size_t j = 0; j < rings_.size(); ++j) add_ring(mesh, j);
    // rings go with the outside on their right, angles counter-clockwise: rows from the last
    Sampler::add_grid(mesh, 0, columns, rings_.size());
    std::erase_if(mesh.triangles, [&](const geometry::Triangle& t) {
      const auto apex = [&](std::uint32_t v) { return rings_[v / columns].place.x == 0; };
      return static_cast<int>(apex(t[0])) + apex(t[1]) + apex(t[2]) > 1;
    });
    problems.folded(2 * folded_, mesh.triangles.size(), height_, room_);
    return mesh;
  }

 private:
  void lay_out(geometry::Mesh& mesh) {
    low_ = Vec2(kMaxLength * 1e3);
    high_ = -low_;
    for (const Ring& ring : rings_)
      for (const double angle : angles_) {
        const Vec2 place = cut_place(profile_, ring, angle);
        low_ = glm::min(low_, place);
        high_ = glm::max(high_, place);
        mesh.texcoords.push_back(place);
      }
  }

  void add_ring(geometry::Mesh& mesh, std::size_t j) {
    const Ring& ring = rings_[j];
    std::vector<double> heights;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      const Vec2& place = mesh.texcoords[j * angles_.size() + i];
      heights.push_back(sampler_.at(place.x, place.y));
    }
    const bool apex = ring.place.x == 0;
    if (apex) {
      // one place; a cone's lift leans outwards there
      double sum = 0;
      for (const double h : heights) sum += h;
      std::fill(heights.begin(), heights.end(), sum / static_cast<double>(heights.size()));
    }
    join(heights);
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      Vec2 lift = ring.lift;
      if (apex) lift.x = 0;
      const Vec2 place = ring.place + heights[i] * lift;
      mesh.positions.push_back({place.x * turns_[i].cos, place.x * turns_[i].sin, place.y});
      if (i + 1 < angles_.size()) examine(ring, heights[i], apex);
    }
  }

  // Counts what crosses a bisector or the axis.
  void examine(const Ring& ring, double h, bool apex) {
    double room = ring.room[h > 0];
    if (!apex && ring.lift.x * h < 0) room = std::min(room, ring.place.x / std::fabs(ring.lift.x));
    if (std::fabs(h) < room) return;
    ++folded_;
    height_ = std::max(height_, std::fabs(h));
    room_ = std::min(room_, room);
  }

  Sampler sampler_;
  const Profile& profile_;
  std::vector<Ring> rings_;
  double around_ = 0;
  std::vector<double> angles_;
  std::vector<det::SinCos> turns_;
  Vec2 low_{0, 0}, high_{0, 0};  // of the cut
  std::size_t folded_ = 0;
  double height_ = 0, room_ = kMaxLength;
};

}  // namespace

Result<geometry::Mesh> revolved(const Sheet& sheet, const Form& form, FormProblems& problems) {
  Profile profile;
  const Vec2 size = Sampler{sheet}.size();
  const bool good = std::visit(
      [&](const auto& one) {
        if constexpr (requires { profile_of(one, size, problems, profile); })
          return profile_of(one, size, problems, profile);
        else
          return false;
      },
      form);
  if (!good) return failed;
  // what the form needs at least, before anything is made
  double length = 0, widest = 0;
  for (std::size_t k = 0; k < profile.corners.size(); ++k) {
    if (k > 0) length += glm::length(profile.corners[k] - profile.corners[k - 1]);
    widest = std::max(widest, profile.corners[k].x);
  }
  const double cell = sheet.spacing.x;
  if (!problems.vertices((2 * kPi * widest / cell + 1) * (length / cell + 1))) return failed;
  Revolver revolver(sheet, profile);
  return revolver.mesh(problems);
}

}  // namespace panwright::mli
