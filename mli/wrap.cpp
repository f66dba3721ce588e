#include "mli/wrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <queue>

#include "base/parallel.h"
#include "mli/internal/form.h"
#include "mli/internal/grid.h"
#include "mli/internal/groups.h"
#include "mli/internal/piece.h"
#include "mli/internal/surface.h"
#include "mli/sheet.h"

namespace panwright::mli {
namespace {

using geometry::Triangle;

// metres per metre: how steeply foil rises from where a part holds it down
constexpr double kRise = 0.5;
// of the stand-off: chords that are no deeper are rounded
constexpr double kRound = 0.05;

// A group of faces that is being draped.
struct Draped {
  const Surface& surface;
  Piece piece;
  Edges border;
  std::vector<double> heights;
};

struct Wrapper {
  const Faces& faces;
  const RecipeFor& recipe;
  const WrapOptions& options;
  DiagnosticLog& log;
  const SourceSpan& where;
  const Job& job;
  Wrap out;
  bool stop = false;

  bool cut(Draped& draped, const Group& members, double cell, double area);
  void set_heights(Draped& draped, const Sheet& sheet, double longest, WrapGroup& group) const;
  double hold(const Draped& draped, std::vector<double>& heights) const;
  void add(const Draped& draped, WrapGroup& group);
  void drape(const Group& members, const Surface& surface, WrapGroup& group);
  void take(const Group& members, bool split);
};

// False: too many triangles, which has been reported.
bool Wrapper::cut(Draped& draped, const Group& members, double cell, double area) {
  const double longest = 1.5 * cell;
  const double left = options.max_triangles - static_cast<double>(out.blanket.triangles.size());
  draped.piece = piece_of(faces, members);
  const bool fits =
      2 * area / (longest * longest) <= left && refine(draped.piece, longest, left, job);
  draped.border = border_of(draped.piece);
  if (fits && static_cast<double>(draped.piece.triangles.size() + 2 * draped.border.size()) <= left)
    return true;
  log.report(
      Code::E7001, where,
      fmt::format("the blankets have more than {:.0f} triangles with cells of {:.3g} m; "
                  "larger cells (<mli_settings> of <mli type=\"wrap\">), or fewer faces, are "
                  "accepted",
                  options.max_triangles, cell));
  stop = true;
  return false;
}

// The sheet over the unrolled surface. Where that closes, sheet before its begin and after its end
// are mixed, so that they meet; with weights that keep the variance.
double height_at(const Surface& surface, const Sampler& sampler, const Vec3& p, double mixed) {
  const Vec2 place = surface.flat(p) - surface.low;
  const double height = sampler.at(place.x, place.y);
  if (!surface.around) return height;
  const double t = surface.angle(p) * surface.across(p) / mixed;
  if (t >= 1) return height;
  const Vec2 after = surface.flat(p, 1) - surface.low;
  return det::sin(kPi / 2 * t) * height + det::cos(kPi / 2 * t) * sampler.at(after.x, after.y);
}

void Wrapper::set_heights(Draped& draped, const Sheet& sheet, double longest,
                          WrapGroup& group) const {
  const Piece& piece = draped.piece;
  const double reach = options.border > 0
                           ? options.border
                           : std::min(3 * options.stand_off, std::sqrt(group.area) / 4);
  const std::vector<double> fade = tapers(piece, draped.border, reach, longest, job);
  const Sampler sampler{sheet};
  std::vector<double>& heights = draped.heights;
  for (const Vec3& p : piece.points)
    heights.push_back(height_at(draped.surface, sampler, p, std::max(reach, 8 * longest)));
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
}

// Lets bounds of heights grow from those that there are by no more than kRise along the faces, as
// foil does that is held down: where they end at once, it would stand in teeth.
void spread(const Piece& piece, const std::vector<double>& heights, std::vector<double>& bounds) {
  std::vector<std::uint32_t> begin(piece.points.size() + 1, 0);
  for (const Triangle& t : piece.triangles)
    for (const std::uint32_t v : t) begin[v + 1] += 2;
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> near(begin.back()), at(begin.begin(), begin.end() - 1);
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      near[at[t[k]]++] = t[(k + 1) % 3];
      near[at[t[k]]++] = t[(k + 2) % 3];
    }
  using Step = std::pair<double, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> next;
  for (std::uint32_t v = 0; v < bounds.size(); ++v)
    if (bounds[v] < HUGE_VAL) next.emplace(bounds[v], v);
  while (!next.empty()) {
    const auto [bound, v] = next.top();
    next.pop();
    if (bound > bounds[v]) continue;
    for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
      const std::uint32_t to = near[i];
      const double there = bound + kRise * glm::length(piece.points[to] - piece.points[v]);
      if (there >= bounds[to] || there >= heights[to]) continue;
      bounds[to] = there;
      next.emplace(there, to);
    }
  }
}

// Lowers what other parts are nearer than. Returns the area of the triangles that it changes.
double Wrapper::hold(const Draped& draped, std::vector<double>& heights) const {
  if (!options.room) return 0;
  const Piece& piece = draped.piece;
  std::vector<double> most(heights.size());
  constexpr std::size_t kBlock = 1024;
  parallel_for((heights.size() + kBlock - 1) / kBlock,
               [&](std::size_t block) {
                 for (std::size_t v = block * kBlock;
                      v < std::min(heights.size(), (block + 1) * kBlock); ++v) {
                   const Vec3& p = piece.points[v];
                   const double far = heights[v] / kWrapReach;
                   const double free = options.room(p, draped.surface.normal(p), far);
                   most[v] = free < far ? kWrapReach * free : HUGE_VAL;
                 }
               },
               job);
  // an edge from below a part to its outside would cut its border
  std::vector<double> least = most;
  double area = 0;
  for (const Triangle& t : piece.triangles) {
    const double low = std::min({most[t[0]], most[t[1]], most[t[2]]});
    if (low == HUGE_VAL) continue;
    for (const std::uint32_t v : t) least[v] = std::min(least[v], low);
    area += glm::length(glm::cross(piece.points[t[1]] - piece.points[t[0]],
                                   piece.points[t[2]] - piece.points[t[0]])) /
            2;
  }
  if (area > 0) spread(piece, heights, least);
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] = std::min(heights[v], least[v]);
  return area;
}

void Wrapper::add(const Draped& draped, WrapGroup& group) {
  geometry::Mesh& mesh = out.blanket;
  // note: lambdas of clang 14 take no structured bindings
  const Surface& surface = draped.surface;
  const Piece& piece = draped.piece;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  const auto place = [&](const Vec3& p) { return surface.flat(p) - surface.low; };
  // where facets are fine the blanket is as round as what they stand for
  double chord = 0;
  for (const Vec3& p : piece.points) chord = std::max(chord, std::fabs(surface.above(p)));
  const double round = chord <= kRound * options.stand_off ? 1 : 0;
  std::vector<double> heights(piece.points.size());
  for (std::size_t v = 0; v < heights.size(); ++v)
    heights[v] = options.stand_off + group.scale * draped.heights[v] +
                 round * surface.above(piece.points[v]);
  group.held = hold(draped, heights);
  for (std::size_t v = 0; v < heights.size(); ++v) {
    const Vec3& p = piece.points[v];
    mesh.positions.push_back(p + heights[v] * surface.normal(p));
    mesh.texcoords.push_back(place(p));
    out.roots.push_back(p);
  }
  // a vertex again: where the unrolled surface closes its places are those behind the end
  std::map<std::uint32_t, std::uint32_t> behind;
  const auto behind_end = [&](std::uint32_t v) {
    const auto [at, fresh] =
        behind.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      mesh.positions.push_back(Vec3(mesh.positions[base + v]));
      out.roots.push_back(piece.points[v]);
      mesh.texcoords.push_back(surface.flat(piece.points[v], 1) - surface.low);
    }
    return at->second;
  };
  for (const Triangle& t : piece.triangles) {
    Triangle corners{base + t[0], base + t[1], base + t[2]};
    if (surface.around) {
      double angles[3];
      for (std::size_t k = 0; k < 3; ++k) angles[k] = surface.angle(piece.points[t[k]]);
      const double most = std::max({angles[0], angles[1], angles[2]});
      for (std::size_t k = 0; k < 3; ++k)
        if (angles[k] < most - kPi) corners[k] = behind_end(t[k]);
    }
    mesh.triangles.push_back(corners);
  }
  std::map<std::uint32_t, std::uint32_t> foot;
  const auto foot_of = [&](std::uint32_t v) {
    const auto [at, fresh] = foot.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      mesh.positions.push_back(piece.points[v]);
      out.roots.push_back(piece.points[v]);
      mesh.texcoords.push_back(place(piece.points[v]));
    }
    return at->second;
  };
  for (const auto& [a, b] : draped.border) {
    const std::uint32_t c = foot_of(a), d = foot_of(b);
    mesh.triangles.push_back({base + b, base + a, c});
    mesh.triangles.push_back({base + b, c, d});
  }
}

void Wrapper::drape(const Group& members, const Surface& surface, WrapGroup& group) {
  const Vec2 size = surface.high - surface.low;
  const Recipe made_of = recipe(size.x, size.y, static_cast<std::uint32_t>(out.groups.size()));
  DiagnosticLog apart = log.apart();
  const auto no_sheet = [&] {
    group.kind = GroupKind::no_sheet;
    group.reason = apart.entries().empty() ? "no sheet" : apart.entries()[0].message;
  };
  if (!check(made_of, apart)) return no_sheet();
  Draped draped{surface, {}, {}, {}};
  if (!cut(draped, members, made_of.cell(), group.area)) return;
  const auto sheet = made(made_of, {}, apart, {}, job);
  if (!sheet) return no_sheet();
  set_heights(draped, *sheet, 1.5 * made_of.cell(), group);
  group.statistics = group.scale < 1 ? scaled(sheet->statistics, group.scale) : sheet->statistics;
  group.recipe = made_of;
  group.first = out.blanket.triangles.size();
  add(draped, group);
  group.count = out.blanket.triangles.size() - group.first;
  group.accepted = true;
}

void Wrapper::take(const Group& members, bool split) {
  if (stop) return;
  job.poll();
  const double tolerance =
      options.tolerance > 0 ? options.tolerance : 1e-3 * diagonal_of(faces, members);
  WrapGroup group;
  group.area = area_of(faces, members);
  for (const std::uint32_t t : members) {
    group.faces.push_back(faces.source[t]);
    for (const std::uint32_t v : faces.triangles[t])
      group.middle += faces.areas[t] / (3 * group.area) * faces.points[v];
  }
  if (std::ranges::any_of(members, [&](std::uint32_t t) { return faces.non_manifold[t]; })) {
    group.kind = GroupKind::non_manifold;
    group.reason = "an edge is shared by three faces, or by two that are wound differently";
  } else if (const auto surface = surface_through(faces, members, tolerance)) {
    group.kind = surface->kind == Surface::Kind::plane      ? GroupKind::planar
                 : surface->kind == Surface::Kind::cylinder ? GroupKind::cylinder
                                                            : GroupKind::cone;
    if (surface->outwards < 0 && surface->narrowest < 2 * options.stand_off)
      group.reason =
          fmt::format("it is hollow and too narrow for the stand-off, {:.3g} m", options.stand_off);
    else
      drape(members, *surface, group);
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
    group.reason = "its vertices lie on no plane, cylinder or cone";
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

Result<Wrap> draped_over(const geometry::Mesh& mesh, std::span<const std::uint32_t> faces,
                         const RecipeFor& recipe, const WrapOptions& options, DiagnosticLog& log,
                         const SourceSpan& where, const Job& job) {
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
  return std::move(wrapper.out);
}

}  // namespace

std::string_view name_of(GroupKind kind) {
  switch (kind) {
    case GroupKind::planar:
      return "planar";
    case GroupKind::cylinder:
      return "cylinder";
    case GroupKind::cone:
      return "cone";
    case GroupKind::curved:
      return "curved";
    case GroupKind::non_manifold:
      return "non-manifold";
    case GroupKind::no_sheet:
      return "without a sheet";
  }
  return "";
}

void WrapTally::add(const Wrap& wrap) {
  groups += wrap.groups.size();
  area += wrap.area_accepted + wrap.area_refused;
  area_refused += wrap.area_refused;
  for (const WrapGroup& g : wrap.groups) {
    if (!g.accepted) ++refused, ++reasons[fmt::format("{} ({})", name_of(g.kind), g.reason)];
    held += g.held;
    if (g.scale < 1) ++scaled, least = std::min(least, g.scale);
  }
}

void WrapTally::add(const WrapTally& other) {
  groups += other.groups, refused += other.refused, scaled += other.scaled;
  area += other.area, area_refused += other.area_refused, held += other.held;
  least = std::min(least, other.least);
  for (const auto& [reason, count] : other.reasons) reasons[reason] += count;
}

std::string WrapTally::refusals() const {
  if (refused == 0) return {};
  // those of most groups first
  std::vector<std::pair<std::size_t, std::string_view>> ordered;
  for (const auto& [reason, count] : reasons) ordered.emplace_back(count, reason);
  std::ranges::stable_sort(ordered, std::greater(),
                           &std::pair<std::size_t, std::string_view>::first);
  std::string why;
  std::size_t left = refused;
  for (const auto& [count, reason] : ordered) {
    if (why.size() > 400) break;
    why += fmt::format("; {} {}", count, reason);
    left -= count;
  }
  if (left > 0) why += fmt::format("; {} for other reasons", left);
  return fmt::format(
      "{} of {} groups of faces wear no blanket, {:.4g} of {:.4g} m²{}; planes, cylinders and "
      "cones are accepted",
      refused, groups, area_refused, area, why);
}

std::string WrapTally::scalings() const {
  if (scaled == 0) return {};
  return fmt::format(
      "heights meet the base in {} of {} groups: they are scaled, by {:.3g} at least; a larger "
      "stand-off keeps them",
      scaled, groups, least);
}

std::string WrapTally::holds() const {
  if (!(held > 0)) return {};
  return fmt::format(
      "{:.3g} of {:.3g} m² lie lower than asked: other parts are nearer than the blanket is high",
      held, area - area_refused);
}

RecipeFor fitted(Recipe recipe) {
  return [recipe = std::move(recipe)](double width, double height, std::uint32_t seed_offset) {
    Recipe out = recipe;
    const double cell = recipe.cell();
    const double across = std::max(32.0, std::ceil(width / cell - 1e-6)),
                 up = std::max(32.0, std::ceil(height / cell - 1e-6));
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
  return run_job(job, log, [&]() -> Result<Wrap> {
    auto out = draped_over(mesh, faces, recipe, options, log, where, job);
    if (!out || !options.tell) return out;
    WrapTally tally;
    tally.add(*out);
    const bool bare = !(out->area_accepted > 0);
    if (tally.refused > 0 || bare)
      log.report(bare ? Code::E7001 : Code::W7002, where, tally.refusals());
    if (tally.scaled > 0) log.report(Code::W7002, where, tally.scalings());
    if (tally.held > 0) log.report(Code::W7002, where, tally.holds());
    if (bare) return failed;
    return out;
  });
}

}  // namespace panwright::mli
