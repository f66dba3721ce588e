#include "mli/wrap.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "geometry/mesh/strip.h"
#include "mli/corners.h"
#include "mli/internal/drape.h"
#include "mli/internal/groups.h"
#include "mli/internal/surface.h"
#include "mli/internal/tilts.h"
#include "mli/sheet.h"

namespace panwright::mli {
namespace {

using geometry::Triangle;

// radians: folds of foil that are sharper stay sharp; smooth ones read as stone
constexpr double kSharp = 8 * kDegree;
constexpr std::size_t kLeastTriangles = 2000;                // of a level: a sample of slopes
constexpr double kPays = 0.6;                                // of the triangles of the one before
constexpr double kMostSpreadOff = 0.03, kMostMirror = 0.05;  // of TiltSpread

struct Wrapper {
  const Faces& faces;
  const RecipeFor& recipe;
  const WrapOptions& options;
  DiagnosticLog& log;
  const SourceSpan& where;
  const Job& job;
  Wrap out = {};
  bool stop = false;
  // groups and their surfaces, as found; those without a surface wear nothing
  struct Found {
    Group members;
    std::optional<Surface> surface;
    WrapGroup group;
  };
  std::vector<Found> found = {};
  Corners corners = {};
  Cloth finest = {};
  std::vector<Cloth> levels = {};  // of cells of 2, 4, …; longest of 0: too many triangles
  double cell = 0;                 // of the first sheet

  void find(const Group& members, bool split);
  void drape_all();
  void drape(const Group& members, const Surface& surface, WrapGroup& group);
  void finish();
};

void Wrapper::drape(const Group& members, const Surface& surface, WrapGroup& group) {
  const Vec2 size = surface.high - surface.low;
  const Recipe made_of = recipe(size.x, size.y, static_cast<std::uint32_t>(out.groups.size()));
  DiagnosticLog apart = log.apart();
  const auto no_sheet = [&] {
    group.kind = GroupKind::no_sheet;
    group.reason = apart.entries().empty() ? "no sheet" : apart.entries()[0].message;
  };
  if (!check(made_of, apart)) return no_sheet();
  const double left = options.max_triangles - static_cast<double>(finest.mesh.triangles.size()),
               longest = 1.5 * made_of.cell();
  const auto too_many = [&] {
    log.report(
        Code("E7001"), where,
        fmt::format("the blankets have more than {:.0f} triangles with cells of {:.3g} m; use "
                    "larger cells (<mli_settings> of <mli type=\"wrap\">) or fewer faces",
                    options.max_triangles, made_of.cell()));
    stop = true;
  };
  if (2 * group.area / (longest * longest) > left) return too_many();
  const auto sheet = made(made_of, {}, apart, {}, job);
  if (!sheet) return no_sheet();
  const Draper draper(faces, options, corners, static_cast<std::uint32_t>(out.groups.size()), job);
  if (!draper.add(members, surface, *sheet, left, group, finest)) return too_many();
  if (cell == 0) {
    cell = made_of.cell();
    levels.resize(options.normals > 0 ? options.levels : 0);
    for (std::size_t k = 0; k < levels.size(); ++k)
      levels[k].longest = longest * static_cast<double>(std::size_t{2} << k);
  }
  for (Cloth& level : levels)
    if (level.longest > 0 &&
        !draper.add_level(members, surface, *sheet, options.max_triangles, group, level))
      level = {};
  group.statistics = group.scale < 1 ? scaled(sheet->statistics, group.scale) : sheet->statistics;
  group.recipe = made_of;
  group.accepted = true;
}

double highest(const Cloth& cloth) {
  double square = 0;
  for (std::size_t v = 0; v < cloth.roots.size(); ++v) {
    const Vec3 up = cloth.mesh.positions[v] - cloth.roots[v];
    square = std::max(square, glm::dot(up, up));
  }
  return std::sqrt(square);
}

// What compute_normals() gave copies to.
void copy_places(const std::vector<Triangle>& before, Cloth& cloth) {
  for (auto* const places : {&cloth.roots, &cloth.below})
    places->resize(cloth.mesh.positions.size());
  for (std::size_t k = 0; k < before.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      for (auto* const places : {&cloth.roots, &cloth.below})
        (*places)[cloth.mesh.triangles[k][i]] = (*places)[before[k][i]];
    }
}

// Normals, and levels that reflect alike.
void Wrapper::finish() {
  if (options.normals > 0 && !finest.mesh.triangles.empty()) {
    const std::vector<Triangle> before = finest.mesh.triangles;
    geometry::compute_normals(finest.mesh, std::min(options.normals, kSharp));
    copy_places(before, finest);
    const TiltSpread wanted = Tilts(finest.mesh, finest.below).spread();
    const double top = highest(finest);
    std::size_t last = finest.mesh.triangles.size();
    for (std::size_t k = 0; k < levels.size(); ++k) {
      job.poll();
      Cloth& level = levels[k];
      const auto count = static_cast<double>(level.mesh.triangles.size());
      if (level.longest > 0 && level.mesh.triangles.size() < kLeastTriangles) break;
      if (level.longest == 0 || count > kPays * static_cast<double>(last)) continue;
      TiltSpread reached;
      const TiltMap map = Tilts(level.mesh, level.below).towards(wanted, reached);
      if (wanted.variance > 0 &&
          std::max({std::fabs(reached.variance / wanted.variance - 1) / kMostSpreadOff,
                    std::fabs(reached.level / wanted.level - 1) / kMostSpreadOff,
                    std::fabs(reached.mirror / wanted.mirror - 1) / kMostMirror}) > 1)
        break;
      tilt(level.mesh.normals, level.below, {}, map);
      last = level.mesh.triangles.size();
      const double error = std::max(top, highest(level));
      out.levels.push_back({std::move(level.mesh), std::move(level.covers),
                            cell * static_cast<double>(std::size_t{2} << k), error});
    }
  }
  out.blanket = std::move(finest.mesh);
  out.roots = std::move(finest.roots);
  out.covers = std::move(finest.covers);
}

void Wrapper::find(const Group& members, bool split) {
  job.poll();
  const double tolerance =
      options.tolerance > 0 ? options.tolerance : 1e-3 * diagonal_of(faces, members);
  Found one{members, {}, {}};
  WrapGroup& group = one.group;
  group.area = area_of(faces, members);
  for (const std::uint32_t t : members) {
    group.faces.push_back(faces.source[t]);
    for (const std::uint32_t v : faces.triangles[t])
      group.middle += faces.areas[t] / (3 * group.area) * faces.points[v];
  }
  if (std::ranges::any_of(members, [&](std::uint32_t t) { return faces.non_manifold[t]; })) {
    group.kind = GroupKind::non_manifold;
    group.reason = "an edge is shared by three faces, or by two that are wound differently";
  } else if (auto surface = surface_through(faces, members, tolerance)) {
    group.kind = surface->kind == Surface::Kind::plane      ? GroupKind::planar
                 : surface->kind == Surface::Kind::cylinder ? GroupKind::cylinder
                                                            : GroupKind::cone;
    if (surface->outwards < 0 && surface->narrowest < 2 * options.stand_off)
      group.reason =
          fmt::format("it is hollow and too narrow for the stand-off, {:.3g} m", options.stand_off);
    else
      one.surface = std::move(surface);
  } else if (split) {
    Group rest = members;
    for (const Group& part : flat_parts(faces, members, 0.05, tolerance)) {
      find(part, false);
      Group less;
      std::ranges::set_difference(rest, part, std::back_inserter(less));
      rest = std::move(less);
    }
    for (const Group& part : connected(faces, rest, -1)) find(part, false);
    return;
  } else {
    group.reason = "its vertices lie on no plane, cylinder or cone";
  }
  found.push_back(std::move(one));
}

void Wrapper::drape_all() {
  for (std::uint32_t k = 0; k < found.size(); ++k)
    if (found[k].surface)
      for (const std::uint32_t t : found[k].members) {
        const auto& [a, b, c] = faces.triangles[t];
        corners.add(faces.points[a], faces.points[b], faces.points[c], k);
      }
  corners.build();
  for (Found& one : found) {
    job.poll();
    if (one.surface) drape(one.members, *one.surface, one.group);
    if (stop) return;
    (one.group.accepted ? out.area_accepted : out.area_refused) += one.group.area;
    out.groups.push_back(std::move(one.group));
  }
}

bool usable(const geometry::Mesh& mesh, std::span<const std::uint32_t> chosen, const WrapOptions& o,
            DiagnosticLog& log, const SourceSpan& where) {
  const auto bad = [&](std::string text) {
    log.report(Code("E7001"), where, std::move(text));
    return false;
  };
  if (!(o.stand_off >= kMinLength && o.stand_off <= kMaxLength))
    return bad(fmt::format("the stand-off is {}, expected {} to {} m", o.stand_off, kMinLength,
                           kMaxLength));
  for (const double v : {o.border, o.margin, o.tolerance, o.weld, o.tape})
    if (!(v >= 0 && v <= kMaxLength))
      return bad(fmt::format("a length of the wrap is {}, expected 0 to {} m", v, kMaxLength));
  if (o.margin >= o.stand_off)
    return bad(fmt::format("the margin is {} m, expected less than the stand-off, {} m", o.margin,
                           o.stand_off));
  if (!(o.crease_angle > 0 && o.crease_angle < kPi / 2))
    return bad(fmt::format("the crease angle is {}, expected between 0 and π/2", o.crease_angle));
  if (!(o.max_triangles > 0 && o.max_triangles <= kMaxVertices))
    return bad(fmt::format("max_triangles is {}, expected above 0 and at most {:.0f}",
                           o.max_triangles, kMaxVertices));
  if (chosen.empty()) return bad("no face is chosen for a blanket, expected at least one");
  for (const std::uint32_t t : chosen) {
    if (t >= mesh.triangles.size())
      return bad(fmt::format("face {} does not exist; the mesh has {}", t, mesh.triangles.size()));
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
  Wrapper wrapper{picked, recipe, options, log, where, job};
  wrapper.out.without_area = picked.without_area;
  for (const Group& group : connected(picked, all, det::cos(options.crease_angle) - 1e-9))
    wrapper.find(group, true);
  wrapper.drape_all();
  if (wrapper.stop) return failed;
  wrapper.finish();
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
      "{} of {} groups of faces have no blanket, {:.4g} of {:.4g} m²{}; expected planes, cylinders "
      "and cones",
      refused, groups, area_refused, area, why);
}

std::string WrapTally::scalings(double enough) const {
  if (scaled == 0) return {};
  // rounded up to two digits
  const double unit = std::pow(10, std::floor(std::log10(enough)) - 1);
  return fmt::format(
      "heights meet the base in {} of {} groups: they are scaled, by {:.3g} at least; a stand-off "
      "of {:.3g} m keeps them",
      scaled, groups, least, unit * std::ceil(enough / unit));
}

std::string WrapTally::holds() const {
  if (!(held > 0)) return {};
  return fmt::format("{:.3g} of {:.3g} m² lie lower than the stand-off: other parts are nearer",
                     held, area - area_refused);
}

double enough_stand_off(const WrapOptions& options, double scale) {
  const double below = options.margin > 0 ? options.margin : 0.1 * options.stand_off;
  const double lowest = (options.stand_off - below) / scale;
  return options.margin > 0 ? lowest + below : lowest / 0.9;
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
      log.report(bare ? Code("E7001") : Code("W7002"), where, tally.refusals());
    if (tally.scaled > 0)
      log.report(Code("W7002"), where, tally.scalings(enough_stand_off(options, tally.least)));
    if (tally.held > 0) log.report(Code("W7002"), where, tally.holds());
    if (bare) return failed;
    return out;
  });
}

}  // namespace panwright::mli
