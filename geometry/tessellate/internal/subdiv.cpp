// Subdivision surfaces: from a cage to triangles within an error.
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/axis_box.h"
#include "base/text.h"
#include "geometry/tessellate/internal/flat.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/subdiv_mesh.h"
#include "geometry/tessellate/internal/subdiv_rates.h"
#include "geometry/tessellate/mapping.h"

namespace panwright::geometry::internal {

namespace {

// bends of cells this small, of cages of size 1, are rounding
constexpr double kFlat = 1e-11;
// refined faces along semi-sharp creases
constexpr double kMostSharpFaces = 1 << 22;
// rounds of measuring and correcting; sharp bends in coarse cells take most
constexpr int kRounds = 12;
// cells that are measured this far below the tolerance are made coarser
constexpr double kWasteful = 0.7;
// cells that miss it ask for so much more than what was measured
constexpr double kMore = 1.05;
// triangles that are made to see how many it takes
constexpr double kQuick = 20000;
// of valence 5 a hundredth of the error takes 1.8 times what the square says
constexpr double kSlower = 0.13;

// A cage about the origin, of size about 1: products neither overflow nor vanish.
struct Centred {
  explicit Centred(const Subdiv& shape) {
    AxisBox box;
    for (const Subdiv::Face& face : shape.faces)
      for (const std::uint32_t v : face.outline) box.add(shape.positions[v]);
    centre = box.centre();
    const Vec3 half = 0.5 * box.extent();
    scale = std::ldexp(1.0, std::ilogb(std::max({half.x, half.y, half.z})));
    reach = glm::length(half);
    positions.reserve(shape.positions.size());
    for (const Vec3& p : shape.positions) positions.push_back((p - centre) / scale);
  }

  Vec3 centre{0};
  double scale = 1;  // a power of two
  double reach = 0;  // metres
  std::vector<Vec3> positions;
};

// All that stays while rates are tried.
struct Prepared {
  explicit Prepared(const Subdiv& shape) : centred(shape) {
    read_cage(shape, cage);
    cells = cells_of(shape, cage);
  }

  int depth_for(std::uint32_t segments) const {
    // note: errors are sampled down to an eighth of a segment from the corners, and nearest points
    // are looked for nearer than that; quarters are half a patch
    const int halvings =
        static_cast<int>(std::bit_width(segments - 1)) + 4 + (cage.all_quads ? 0 : 1);
    return std::clamp(std::max(halvings, sharp_levels(cage)), 2, LimitSurface::kMaxDepth);
  }
  LimitSurface limit(const Subdiv& shape, std::uint32_t segments) const {
    return LimitSurface(shape, cage, centred.positions, depth_for(segments));
  }
  // too many for the memory: a crease is refined to as many faces as it has levels of halving
  double sharp_faces() const {
    double sum = 0;
    for (const Cage::Edge& e : cage.edges)
      if (!e.splits() && e.sharpness > 0)
        sum += std::ldexp(4.0, static_cast<int>(std::ceil(e.sharpness)));
    return sum;
  }

  Centred centred;
  Cage cage;
  Cells cells;
};

struct RatePlan {
  std::vector<std::uint32_t> rates;
  std::vector<CellBend> bends;
  double tolerance = 0;  // for the centred cage
  bool too_fine = false;
};

RatePlan explicit_plan(const Subdiv& shape, const Prepared& cage) {
  RatePlan plan;
  const std::uint32_t levels = shape.levels - (cage.cage.all_quads ? 0 : 1);
  plan.rates.assign(cage.cells.rails.size(), 1u << levels);
  return plan;
}

RatePlan plan_of(const Subdiv& shape, const Prepared& cage, const TessellationOptions& options) {
  if (shape.levels > 0) return explicit_plan(shape, cage);
  RatePlan plan;
  // samples are an eighth of a cell apart
  const LimitSurface limit = cage.limit(shape, 8);
  plan.bends = bends_of(CellSurface(limit, cage.cells));
  bool flat = true;
  for (CellBend& b : plan.bends)
    for (double* x : {&b.u, &b.v, &b.twist})
      if (*x < kFlat)
        *x = 0;
      else
        flat = false;
  const double left = options.max_error - rounding_bound(cage.centred.reach);
  plan.tolerance = left / cage.centred.scale;
  plan.too_fine = !flat && !(left > 0.1 * options.max_error && plan.tolerance > 10 * kFlat);
  if (flat) plan.tolerance = 1;
  if (plan.too_fine) return plan;
  plan.rates = rates_for(cage.cells, plan.bends, std::vector<double>(plan.bends.size(), 1.0),
                         plan.tolerance);
  return plan;
}

std::uint32_t most_of(const std::vector<std::uint32_t>& rates) {
  return *std::max_element(rates.begin(), rates.end());
}

// Corrects what each cell needs by what is measured of it, until all keep the tolerance.
class Fitter {
 public:
  Fitter(const Subdiv& shape, const Prepared& cage, RatePlan& plan, bool texcoords)
      : shape_(shape),
        cage_(cage),
        plan_(plan),
        texcoords_(texcoords),
        factors_(plan.bends.size(), 1.0) {}

  // allowed(rates): whether so many may be made.
  template <class Allowed>
  std::optional<CellMesh> run(const Allowed& allowed) {
    for (int round = 0; round < kRounds; ++round) {
      if (!allowed(plan_.rates)) return std::nullopt;
      const LimitSurface limit = cage_.limit(shape_, most_of(plan_.rates));
      CellMesh made = mesh_of(CellSurface(limit, cage_.cells), plan_.rates, texcoords_);
      if (shape_.levels > 0 || !correct(made.errors, round)) return made;
    }
    return std::nullopt;
  }

 private:
  // False: nothing to do.
  bool correct(const std::vector<double>& errors, int round) {
    const double worst = *std::max_element(errors.begin(), errors.end());
    const bool over = worst > plan_.tolerance;
    const bool wasteful =
        round == 0 && worst < kWasteful * plan_.tolerance && most_of(plan_.rates) > 1;
    if (!over && !wasteful) return false;
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (errors[i] > plan_.tolerance || !over)
        // note: at these rates the bends, times the factor, are then just what was measured
        factors_[i] = (over ? kMore : 1.0) * errors[i] / expected(i);
    std::vector<std::uint32_t> rates =
        rates_for(cage_.cells, plan_.bends, factors_, plan_.tolerance);
    if (over)
      for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = std::max(rates[i], plan_.rates[i]);
    const bool changed = rates != plan_.rates;
    plan_.rates = std::move(rates);
    return changed;
  }

  // What the bends of a cell say of its error at its rates.
  double expected(std::size_t index) {
    CellBend& b = plan_.bends[index];
    const auto& rail = cage_.cells.cells[index].rail;
    const double u = std::max(plan_.rates[rail[0]], plan_.rates[rail[2]]);
    const double v = std::max(plan_.rates[rail[1]], plan_.rates[rail[3]]);
    const double sum = b.u / (u * u) + b.v / (v * v) + b.twist / (u * v);
    if (sum > 0) return sum;
    // what was not seen to bend and does
    b.u = u * u * plan_.tolerance / 2;
    b.v = v * v * plan_.tolerance / 2;
    return plan_.tolerance;
  }

  const Subdiv& shape_;
  const Prepared& cage_;
  RatePlan& plan_;
  bool texcoords_;
  std::vector<double> factors_;  // of the bends of each cell
};

void report_too_fine(const TessellationOptions& options, SourceSpan where, DiagnosticLog& log) {
  log.report(Code("E2003"), where,
             fmt::format("an error of {} m cannot be achieved on a subdivision surface with "
                         "single-precision vertices and {} segments along a side of its cage",
                         format_double(options.max_error), kMostSegments));
}

}  // namespace

Result<Mesh> make(const Subdiv& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  const Prepared cage(shape);
  if (const double faces = cage.sharp_faces(); faces > kMostSharpFaces) {
    log.report(Code("E2003"), where,
               fmt::format("semi-sharp creases of {} refined faces, expected at most {}; sharpness "
                           "{} keeps them sharp without refinement",
                           format_double(faces), format_double(kMostSharpFaces),
                           format_double(kInfinitelySharp)));
    return failed;
  }
  RatePlan plan = plan_of(shape, cage, options);
  bool reported = false;
  const auto allowed = [&](const std::vector<std::uint32_t>& rates) {
    if (!plan.too_fine && most_of(rates) <= kMostSegments) {
      const CellCounts counts = counts_of(cage.cells, rates);
      reported = !within_counts(counts.triangles, counts.vertices, "a subdivision surface", options,
                                where, log);
      return !reported;
    }
    return false;
  };
  std::optional<CellMesh> made;
  if (!plan.too_fine) made = Fitter(shape, cage, plan, options.texcoords).run(allowed);
  if (!made) {
    if (!reported) report_too_fine(options, where, log);
    return failed;
  }
  Mesh mesh = std::move(made->mesh);
  for (Vec3& p : mesh.positions) p = cage.centred.centre + cage.centred.scale * p;
  if (options.texcoords && mesh.texcoords.empty()) apply_box_mapping(mesh);
  const double worst = *std::max_element(made->errors.begin(), made->errors.end());
  set_error(mesh, worst < kFlat ? 0 : cage.centred.scale * worst);
  return mesh;
}

double planned(const Subdiv& shape, const TessellationOptions& options) {
  const Prepared cage(shape);
  if (cage.sharp_faces() > kMostSharpFaces) return HUGE_VAL;
  const RatePlan plan = plan_of(shape, cage, options);
  if (plan.too_fine || most_of(plan.rates) > kMostSegments) return HUGE_VAL;
  const double expected = counts_of(cage.cells, plan.rates).triangles;
  if (shape.levels > 0) return expected;
  // measured where that is quick, and at a coarser error where it is not
  RatePlan quick = plan;
  quick.tolerance *= std::max(1.0, expected / kQuick);
  const std::vector<double> ones(plan.bends.size(), 1.0);
  quick.rates = rates_for(cage.cells, plan.bends, ones, quick.tolerance);
  const double quickly_expected = counts_of(cage.cells, quick.rates).triangles;
  const auto allowed = [](const std::vector<std::uint32_t>& rates) {
    return most_of(rates) <= kMostSegments;
  };
  if (!Fitter(shape, cage, quick, false).run(allowed)) return HUGE_VAL;
  // next to vertices of high valence errors fall more slowly than the square of the segments
  const double more = det::pow(quick.tolerance / plan.tolerance, kSlower);
  return more * expected * counts_of(cage.cells, quick.rates).triangles / quickly_expected;
}

}  // namespace panwright::geometry::internal
