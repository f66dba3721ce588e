#include "mli/trim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/axis_box.h"
#include "mli/internal/piece.h"

namespace panwright::mli {
namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr double kTapeShare = 0.125;  // of the root of the area: the widest tape
constexpr double kSamePlace = 1e-6;   // of the flat sheet's size
constexpr double kSmooth = 0.866;     // cosine: edges that turn by less are round

// Where a sheet ends: directed as its triangles go around, by the mesh's vertices.
struct Lines {
  Edges open, joints;
};

using Place = std::array<double, 3>;

class Finder {
 public:
  // points: of the surface, per vertex
  Finder(const Mesh& mesh, const std::vector<Vec3>& points) : mesh_(mesh), points_(points) {}

  Lines run() {
    AxisRectangle bounds;
    for (const Vec2& place : mesh_.texcoords) bounds.add(place);
    same_ = kSamePlace * bounds.diagonal();
    std::map<std::pair<std::uint32_t, std::uint32_t>, Edges> by_place;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
    for (const auto& [a, b] : border_of({points_, mesh_.triangles})) {
      const std::uint32_t first = unique(a), second = unique(b);
      if (first == second) continue;  // an apex
      const auto key = std::minmax(first, second);
      Edges& there = by_place[key];
      if (there.empty()) order.push_back(key);
      there.push_back({a, b});
    }
    Lines out;
    for (const auto& key : order) {
      const Edges& there = by_place[key];
      if (there.size() == 1) out.open.push_back(there[0]);
      if (there.size() > 1 && is_joint(there[0], there[1])) out.joints.push_back(there[0]);
    }
    return out;
  }

  // Of equal places the first.
  std::uint32_t unique(std::uint32_t v) {
    const Vec3 p = points_[v] + 0.0;  // note: −0 is 0
    return first_.try_emplace({p.x, p.y, p.z}, v).first->second;
  }

 private:
  // Two sides of one line, which go along it in opposite directions.
  bool is_joint(const std::array<std::uint32_t, 2>& one,
                const std::array<std::uint32_t, 2>& other) {
    const auto apart = [&](std::uint32_t a, std::uint32_t b) {
      return glm::length(mesh_.texcoords[a] - mesh_.texcoords[b]) > same_;
    };
    const bool turned = unique(one[0]) != unique(other[0]);
    return apart(one[0], other[turned ? 1 : 0]) || apart(one[1], other[turned ? 0 : 1]);
  }

  const Mesh& mesh_;
  const std::vector<Vec3>& points_;
  std::map<Place, std::uint32_t> first_;
  double same_ = 0;
};

// Cuts triangles at the tape's border. points: as the mesh's vertices.
std::vector<char> cut(Mesh& mesh, std::vector<Vec3> points, const Lines& lines, double width) {
  Piece piece{std::move(points), mesh.triangles};
  Edges all = lines.open;
  all.insert(all.end(), lines.joints.begin(), lines.joints.end());
  double longest = 0;
  for (const auto& [a, b] : all)
    longest = std::max(longest, glm::length(piece.points[a] - piece.points[b]));
  const BorderDistance border(piece, all, 2 * width, longest);
  std::vector<double> distances;
  for (const Vec3& p : piece.points) distances.push_back(border.at(p));
  std::vector<Cut> cuts;
  std::vector<char> within = cut_at(piece, distances, width, &cuts);
  for (const Cut& one : cuts) {
    const auto between = [&](auto& of) {
      const auto low = of[one.low], high = of[one.high];
      of.push_back(low + one.part * (high - low));
    };
    between(mesh.positions);
    between(mesh.normals);
    between(mesh.texcoords);
    mesh.normals.back() = glm::normalize(mesh.normals.back());
  }
  mesh.triangles = std::move(piece.triangles);
  return within;
}

// Down from open borders. up: unit normals of the surface, per vertex.
void add_edges(Mesh& mesh, const std::vector<Vec3>& up, const Edges& open, Finder& finder,
               double thickness) {
  std::vector<Vec3> outwards;
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> at;  // edges by unique vertex
  for (std::size_t k = 0; k < open.size(); ++k) {
    const auto& [a, b] = open[k];
    const Vec3 out = glm::cross(mesh.positions[b] - mesh.positions[a], up[a] + up[b]);
    const double length = glm::length(out);
    outwards.push_back(length > 0 ? out / length : up[a]);
    at[finder.unique(a)].push_back(k);
    at[finder.unique(b)].push_back(k);
  }
  for (std::size_t k = 0; k < open.size(); ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec2 along = mesh.texcoords[open[k][1]] - mesh.texcoords[open[k][0]];
    const double length = glm::length(along);
    const Vec2 beyond = length > 0 ? thickness / length * Vec2(along.y, -along.x) : Vec2(0);
    for (const std::uint32_t v : open[k]) {
      Vec3 normal(0);
      for (const std::size_t beside : at[finder.unique(v)])
        if (glm::dot(outwards[beside], outwards[k]) > kSmooth) normal += outwards[beside];
      for (const bool low : {false, true}) {
        mesh.positions.push_back(mesh.positions[v] - (low ? thickness : 0.0) * up[v]);
        mesh.normals.push_back(glm::normalize(normal));
        mesh.texcoords.push_back(mesh.texcoords[v] + (low ? beyond : Vec2(0)));
      }
    }
    // a above and below, b above and below
    mesh.triangles.push_back({first + 1, first + 3, first + 2});
    mesh.triangles.push_back({first + 1, first + 2, first});
  }
}

}  // namespace

std::vector<Cover> trimmed(Mesh& mesh, const Mesh& surface, const Trim& trim) {
  std::vector<Cover> covers(mesh.triangles.size(), Cover::foil);
  if (!(trim.tape > 0) && !(trim.thickness > 0)) return covers;
  std::vector<Vec3> points(mesh.positions.size()), up(mesh.positions.size(), Vec3(0, 0, 1));
  double area = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Triangle& t = surface.triangles[k];
    for (std::size_t i = 0; i < 3; ++i) {
      points[mesh.triangles[k][i]] = surface.positions[t[i]];
      up[mesh.triangles[k][i]] = surface.normals[t[i]];
    }
    area += glm::length(glm::cross(surface.positions[t[1]] - surface.positions[t[0]],
                                   surface.positions[t[2]] - surface.positions[t[0]])) /
            2;
  }
  Finder finder(mesh, points);
  const Lines lines = finder.run();
  if (trim.tape > 0 && lines.open.size() + lines.joints.size() > 0) {
    const std::vector<char> taped =
        cut(mesh, points, lines, std::min(trim.tape, kTapeShare * std::sqrt(area)));
    covers.clear();
    for (const char one : taped) covers.push_back(one != 0 ? Cover::tape : Cover::foil);
  }
  if (trim.thickness > 0) add_edges(mesh, up, lines.open, finder, trim.thickness);
  covers.resize(mesh.triangles.size(), Cover::edge);
  return covers;
}

Mesh part_of(const Mesh& mesh, std::span<const Cover> covers, Cover cover) {
  constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
  Mesh out;
  std::vector<std::uint32_t> place(mesh.positions.size(), kNowhere);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (covers[t] != cover) continue;
    Triangle corners = mesh.triangles[t];
    for (std::uint32_t& v : corners) {
      std::uint32_t& at = place[v];
      if (at == kNowhere) {
        at = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[v]);
        out.normals.push_back(mesh.normals[v]);
        out.texcoords.push_back(mesh.texcoords[v]);
      }
      v = at;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace panwright::mli
