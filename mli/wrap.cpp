#include "mli/wrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "mli/internal/form.h"
#include "mli/internal/grid.h"
#include "mli/internal/groups.h"
#include "mli/sheet.h"

namespace panwright::mli {
namespace {

using geometry::Triangle;

struct Plane {
  Vec3 x, y, normal, origin;
  Vec2 low{0}, high{0};
  Vec2 flat(const Vec3& p) const { return {glm::dot(p - origin, x), glm::dot(p - origin, y)}; }
};

bool lies_flat(const Faces& faces, const Group& group, double tolerance, Plane& plane) {
  Vec3 normal(0), longest(0);
  for (const std::uint32_t t : group) normal += faces.areas[t] * faces.normals[t];
  if (!(glm::length(normal) > 0)) return false;
  plane.normal = glm::normalize(normal);
  plane.origin = faces.points[faces.triangles[group[0]][0]];
  for (const std::uint32_t t : group)
    for (std::size_t k = 0; k < 3; ++k) {
      if (glm::dot(faces.normals[t], plane.normal) < 0.9) return false;
      const Vec3 p = faces.points[faces.triangles[t][k]];
      if (std::fabs(glm::dot(p - plane.origin, plane.normal)) > tolerance) return false;
      const Vec3 edge = faces.points[faces.triangles[t][(k + 1) % 3]] - p;
      if (glm::length(edge) > glm::length(longest)) longest = edge;
    }
  plane.x = glm::normalize(longest - glm::dot(longest, plane.normal) * plane.normal);
  plane.y = glm::cross(plane.normal, plane.x);
  for (const std::uint32_t t : group)
    for (const std::uint32_t v : faces.triangles[t]) {
      plane.low = glm::min(plane.low, plane.flat(faces.points[v]));
      plane.high = glm::max(plane.high, plane.flat(faces.points[v]));
    }
  return true;
}

struct Piece {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
};

std::uint64_t key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

// Halves every edge above `longest`, in rounds; false: more triangles than the limit.
bool refine(Piece& piece, double longest, double limit) {
  for (bool again = true; again;) {
    again = false;
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    std::vector<Triangle> next;
    for (const Triangle& t : piece.triangles) {
      std::uint32_t m[3];
      int cuts = 0, uncut = 0, cut = 0;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        m[k] = kNone;
        if (glm::length(piece.points[a] - piece.points[b]) > longest) {
          const auto [at, fresh] =
              middles.try_emplace(key(a, b), static_cast<std::uint32_t>(piece.points.size()));
          if (fresh) piece.points.push_back(0.5 * (piece.points[a] + piece.points[b]));
          m[k] = at->second;
          ++cuts, cut = k;
        } else {
          uncut = k;
        }
      }
      again = again || cuts > 0;
      if (cuts == 0) {
        next.push_back(t);
      } else if (cuts == 1) {
        const std::uint32_t a = t[cut], b = t[(cut + 1) % 3], c = t[(cut + 2) % 3];
        next.push_back({a, m[cut], c});
        next.push_back({m[cut], b, c});
      } else if (cuts == 2) {
        const std::uint32_t a = t[uncut], b = t[(uncut + 1) % 3], c = t[(uncut + 2) % 3];
        const std::uint32_t p = m[(uncut + 1) % 3], q = m[(uncut + 2) % 3];
        next.push_back({p, c, q});
        const bool first = glm::length(piece.points[a] - piece.points[p]) <=
                           glm::length(piece.points[b] - piece.points[q]);
        next.push_back(first ? Triangle{a, b, p} : Triangle{a, b, q});
        next.push_back(first ? Triangle{a, p, q} : Triangle{b, p, q});
      } else {
        next.push_back({t[0], m[0], m[2]});
        next.push_back({m[0], t[1], m[1]});
        next.push_back({m[2], m[1], t[2]});
        next.push_back({m[0], m[1], m[2]});
      }
      if (static_cast<double>(next.size()) > limit) return false;
    }
    piece.triangles = std::move(next);
  }
  return true;
}

std::vector<std::array<std::uint32_t, 2>> border_of(const Piece& piece) {
  std::unordered_map<std::uint64_t, int> uses;
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[key(t[k], t[(k + 1) % 3])];
  std::vector<std::array<std::uint32_t, 2>> out;
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (uses[key(t[k], t[(k + 1) % 3])] == 1) out.push_back({t[k], t[(k + 1) % 3]});
  return out;
}

// 0 at the border to 1 from `reach` on.
std::vector<double> tapers(const Piece& piece, const Plane& plane,
                           std::span<const std::array<std::uint32_t, 2>> border, double reach,
                           double longest) {
  const double size = reach + longest;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells;
  const auto cell = [&](const Vec2& p) {
    return std::pair{static_cast<std::int64_t>(std::floor(p.x / size)),
                     static_cast<std::int64_t>(std::floor(p.y / size))};
  };
  std::vector<Vec2> flat;
  for (const Vec3& p : piece.points) flat.push_back(plane.flat(p));
  for (std::size_t e = 0; e < border.size(); ++e)
    cells[cell(0.5 * (flat[border[e][0]] + flat[border[e][1]]))].push_back(e);
  std::vector<double> out(flat.size(), 1.0);
  for (std::size_t v = 0; v < flat.size(); ++v) {
    double nearest = reach;
    const auto [i, j] = cell(flat[v]);
    for (int k = 0; k < 9; ++k) {
      const auto found = cells.find({i + k % 3 - 1, j + k / 3 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t e : found->second) {
        const Vec2 a = flat[border[e][0]], d = flat[border[e][1]] - a;
        const double t = std::clamp(glm::dot(flat[v] - a, d) / glm::dot(d, d), 0.0, 1.0);
        nearest = std::min(nearest, glm::length(flat[v] - a - t * d));
      }
    }
    out[v] = smooth_step(nearest / reach);
  }
  return out;
}

struct Wrapper {
  const Faces& faces;
  const RecipeFor& recipe;
  const WrapOptions& options;
  DiagnosticLog& log;
  const SourceSpan& where;
  const Job& job;
  Wrap out;
  bool stop = false;

  void drape(const Group& faces_of, const Plane& plane, WrapGroup& group);
  void take(const Group& members, bool split);
};

void Wrapper::drape(const Group& members, const Plane& plane, WrapGroup& group) {
  const Vec2 size = plane.high - plane.low;
  const Recipe made_of = recipe(size.x, size.y, static_cast<std::uint32_t>(out.groups.size()));
  DiagnosticLog apart = log.apart();
  if (!check(made_of, apart)) {
    group.kind = GroupKind::no_sheet;
    group.reason = apart.entries().empty() ? "no sheet" : apart.entries()[0].message;
    return;
  }
  const double longest = 1.5 * made_of.cell();
  Piece piece;
  std::map<std::uint32_t, std::uint32_t> local;
  for (const std::uint32_t t : members) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = faces.triangles[t][k];
      const auto [at, fresh] =
          local.try_emplace(v, static_cast<std::uint32_t>(piece.points.size()));
      if (fresh) piece.points.push_back(faces.points[v]);
      corners[k] = at->second;
    }
    piece.triangles.push_back(corners);
  }
  const double left = options.max_triangles - static_cast<double>(out.blanket.triangles.size());
  const bool fits = 2 * group.area / (longest * longest) <= left && refine(piece, longest, left);
  const auto border = border_of(piece);
  if (!fits || static_cast<double>(piece.triangles.size() + 2 * border.size()) > left) {
    log.report(Code::E7001, where,
               fmt::format("the blankets have more than {:.0f} triangles with cells of {:.3g} m; "
                           "larger cells, or fewer faces, are accepted",
                           options.max_triangles, made_of.cell()));
    stop = true;
    return;
  }
  const auto sheet = made(made_of, {}, apart, {}, job);
  if (!sheet) {
    group.kind = GroupKind::no_sheet;
    group.reason = apart.entries().empty() ? "no sheet" : apart.entries()[0].message;
    return;
  }
  const double reach = options.border > 0
                           ? options.border
                           : std::min(3 * options.stand_off, std::sqrt(group.area) / 4);
  const std::vector<double> fade = tapers(piece, plane, border, reach, longest);
  const Sampler sampler{*sheet};
  std::vector<double> heights;
  for (const Vec3& p : piece.points) {
    const Vec2 place = plane.flat(p) - plane.low;
    heights.push_back(sampler.at(place.x, place.y));
  }
  double sum = 0, weight = 0;
  for (const Triangle& t : piece.triangles) {
    const double area = glm::length(glm::cross(piece.points[t[1]] - piece.points[t[0]],
                                               piece.points[t[2]] - piece.points[t[0]]));
    for (const std::uint32_t v : t) {
      sum += area * fade[v] * heights[v];
      weight += area * fade[v];
    }
  }
  const double mean = weight > 0 ? sum / weight : 0,
               below = options.margin > 0 ? options.margin : 0.1 * options.stand_off;
  double lowest = 0;
  for (std::size_t v = 0; v < heights.size(); ++v) {
    heights[v] = fade[v] * (heights[v] - mean);
    lowest = std::min(lowest, heights[v]);
  }
  if (options.stand_off + lowest < below) group.scale = (options.stand_off - below) / -lowest;
  geometry::Mesh& mesh = out.blanket;
  group.first = mesh.triangles.size();
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t v = 0; v < heights.size(); ++v) {
    mesh.positions.push_back(piece.points[v] +
                             (options.stand_off + group.scale * heights[v]) * plane.normal);
    mesh.texcoords.push_back(plane.flat(piece.points[v]) - plane.low);
  }
  for (const Triangle& t : piece.triangles)
    mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  std::map<std::uint32_t, std::uint32_t> foot;
  const auto foot_of = [&](std::uint32_t v) {
    const auto [at, fresh] = foot.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      mesh.positions.push_back(piece.points[v]);
      mesh.texcoords.push_back(plane.flat(piece.points[v]) - plane.low);
    }
    return at->second;
  };
  for (const auto& [a, b] : border) {
    const std::uint32_t c = foot_of(a), d = foot_of(b);
    mesh.triangles.push_back({base + b, base + a, c});
    mesh.triangles.push_back({base + b, c, d});
  }
  group.count = mesh.triangles.size() - group.first;
  group.accepted = true;
}

void Wrapper::take(const Group& members, bool split) {
  if (stop) return;
  const double tolerance =
      options.tolerance > 0 ? options.tolerance : 1e-3 * diagonal_of(faces, members);
  WrapGroup group;
  group.area = area_of(faces, members);
  for (const std::uint32_t t : members) {
    group.faces.push_back(faces.source[t]);
    for (const std::uint32_t v : faces.triangles[t])
      group.middle += faces.areas[t] / (3 * group.area) * faces.points[v];
  }
  Plane plane;
  if (std::ranges::any_of(members, [&](std::uint32_t t) { return faces.non_manifold[t]; })) {
    group.kind = GroupKind::non_manifold;
    group.reason = "an edge is shared by three faces, or by two that are wound differently";
  } else if (lies_flat(faces, members, tolerance, plane)) {
    group.kind = GroupKind::planar;
    drape(members, plane, group);
  } else if (split) {
    Group rest = members;
    for (const Group& part : flat_parts(faces, members, 0.05, tolerance)) {
      take(part, false);
      Group less;
      std::ranges::set_difference(rest, part, std::back_inserter(less));
      rest = std::move(less);
    }
    for (const Group& part : connected(faces, rest, -1)) take(part, false);
    return;
  } else {
    group.reason = "its vertices lie on no plane";
  }
  (group.accepted ? out.area_accepted : out.area_refused) += group.area;
  out.groups.push_back(std::move(group));
}

bool usable(const geometry::Mesh& mesh, std::span<const std::uint32_t> chosen, const WrapOptions& o,
            DiagnosticLog& log, const SourceSpan& where) {
  const auto bad = [&](std::string text) {
    log.report(Code::E7001, where, std::move(text));
    return false;
  };
  if (!(o.stand_off >= kMinLength && o.stand_off <= kMaxLength))
    return bad(fmt::format("the stand-off is {}; it is a number from {} to {} m", o.stand_off,
                           kMinLength, kMaxLength));
  for (const double v : {o.border, o.margin, o.tolerance, o.weld})
    if (!(v >= 0 && v <= kMaxLength))
      return bad(
          fmt::format("a length of the wrap is {}; it is a number from 0 to {} m", v, kMaxLength));
  if (o.margin >= o.stand_off)
    return bad(fmt::format("the margin is {} m; it is less than the stand-off, {} m", o.margin,
                           o.stand_off));
  if (!(o.crease_angle > 0 && o.crease_angle < kPi / 2))
    return bad(fmt::format("the crease angle is {}; it is between 0 and π/2", o.crease_angle));
  if (!(o.max_triangles > 0 && o.max_triangles <= kMaxVertices))
    return bad(fmt::format("max_triangles is {}; it is above 0 and at most {:.0f}", o.max_triangles,
                           kMaxVertices));
  if (chosen.empty()) return bad("no face is chosen for a blanket; at least one is needed");
  for (const std::uint32_t t : chosen) {
    if (t >= mesh.triangles.size())
      return bad(fmt::format("face {} is chosen; the mesh has {}", t, mesh.triangles.size()));
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.positions.size() || !is_finite(mesh.positions[v]) ||
          glm::length(mesh.positions[v]) > kMaxLength)
        return bad(fmt::format("face {} has a corner that does not exist or is not within {} m", t,
                               kMaxLength));
  }
  return true;
}

void tell(const Wrap& out, DiagnosticLog& log, const SourceSpan& where) {
  std::size_t refused = 0, scaled = 0;
  double least = 1;
  std::map<std::string, std::size_t> reasons;
  for (const WrapGroup& g : out.groups) {
    if (!g.accepted) ++refused, ++reasons[fmt::format("{} ({})", name_of(g.kind), g.reason)];
    if (g.scale < 1) ++scaled, least = std::min(least, g.scale);
  }
  std::string why;
  for (const auto& [reason, count] : reasons)
    if (why.size() < 400) why += fmt::format("; {} {}", count, reason);
  const bool none = refused == out.groups.size();
  if (none || refused > 0)
    log.report(none ? Code::E7001 : Code::W7002, where,
               fmt::format("{} of {} groups of faces wear no blanket, {:.4g} of {:.4g} m²{}; plane "
                           "groups are accepted",
                           refused, out.groups.size(), out.area_refused,
                           out.area_accepted + out.area_refused, why));
  if (scaled > 0)
    log.report(Code::W7002, where,
               fmt::format("heights meet the base in {} groups: they are scaled, by {:.3g} at "
                           "least; a larger stand-off keeps them",
                           scaled, least));
}

}  // namespace

std::string_view name_of(GroupKind kind) {
  switch (kind) {
    case GroupKind::planar:
      return "planar";
    case GroupKind::curved:
      return "curved";
    case GroupKind::non_manifold:
      return "non-manifold";
    case GroupKind::no_sheet:
      return "without a sheet";
  }
  return "";
}

RecipeFor fitted(Recipe recipe) {
  return [recipe = std::move(recipe)](double width, double height, std::uint32_t seed_offset) {
    Recipe out = recipe;
    const double cell = recipe.cell();
    const double across = std::max(32.0, std::ceil(width / cell)),
                 up = std::max(32.0, std::ceil(height / cell));
    out.xgrid = across <= kMaxCells ? static_cast<std::uint32_t>(across) : kMaxCells + 1;
    out.width = out.xgrid * cell;
    out.height = up * cell;
    out.seed += seed_offset;
    return out;
  };
}

Result<Wrap> wrapped(const geometry::Mesh& mesh, std::span<const std::uint32_t> faces,
                     const RecipeFor& recipe, const WrapOptions& options, DiagnosticLog& log,
                     const SourceSpan& where, const Job& job) {
  if (!usable(mesh, faces, options, log, where)) return failed;
  std::vector<std::uint32_t> chosen(faces.begin(), faces.end());
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  const Faces picked = chosen_faces(mesh, chosen, options.weld);
  Group all(picked.triangles.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  Wrapper wrapper{picked, recipe, options, log, where, job, {}, false};
  wrapper.out.without_area = picked.without_area;
  for (const Group& group : connected(picked, all, det::cos(options.crease_angle) - 1e-9))
    wrapper.take(group, true);
  if (wrapper.stop) return failed;
  tell(wrapper.out, log, where);
  if (!(wrapper.out.area_accepted > 0)) return failed;
  return std::move(wrapper.out);
}

}  // namespace panwright::mli
