#include "geometry/tessellate/internal/revolution_problem.h"

#include <fmt/core.h>

#include <cmath>

#include "base/text.h"
#include "geometry/tessellate/internal/circle.h"

namespace panwright::geometry::internal {

namespace {

// angles this far out have lost their digits
constexpr double kLargestAngle = 1e6;

}  // namespace

Problem size_problem(double size, std::string_view part, std::string_view what) {
  if (size <= 0)
    return ShapeProblem{Code("E2011"),
                        fmt::format("{} of {} m, expected above 0", what, format_double(size)),
                        part};
  if (!(size >= kMinRadius && size <= kMaxCoordinate))
    return ShapeProblem{Code("E2010"),
                        fmt::format("{} of {} m, expected {} to {} m", what, format_double(size),
                                    format_double(kMinRadius), format_double(kMaxCoordinate)),
                        part};
  return std::nullopt;
}

Problem zero_or_size_problem(double size, std::string_view part, std::string_view what) {
  if (size == 0) return std::nullopt;
  if (size < 0)
    return ShapeProblem{Code("E2011"),
                        fmt::format("{} of {} m, expected at least 0", what, format_double(size)),
                        part};
  return size_problem(size, part, what);
}

Problem sector_problem(const Sector& sector) {
  if (!(std::fabs(sector.begin) <= kLargestAngle && std::fabs(sector.end) <= kLargestAngle))
    return ShapeProblem{
        Code("E2017"),
        fmt::format("a sector from {:.12g} to {:.12g} deg, expected angles of at most {:.3g} deg",
                    sector.begin / kDegree, sector.end / kDegree, kLargestAngle / kDegree),
        "sector"};
  const double span = sector.end - sector.begin;
  // note: a whole turn from an angle may be a few ulps more
  if (!(span > 1e-12 && span <= 2 * kPi * (1 + 1e-9)))
    return ShapeProblem{Code("E2017"),
                        fmt::format("a sector from {:.12g} to {:.12g} deg, expected an end after "
                                    "the beginning, by at most 360 deg",
                                    sector.begin / kDegree, sector.end / kDegree),
                        "sector"};
  return std::nullopt;
}

Problem counts_problem(const Counts& counts, const Sector& sector, std::uint32_t least_along) {
  const std::uint32_t least_around = fewest_segments(sector);
  if (counts.around != 0 && counts.around < least_around)
    return ShapeProblem{Code("E2018"),
                        fmt::format("{} about the axis, expected at least {} for this sector",
                                    counted(counts.around, "segment"), least_around),
                        "segments"};
  if (counts.along != 0 && counts.along < least_along)
    return ShapeProblem{Code("E2018"),
                        fmt::format("{} along the profile, expected at least {}",
                                    counted(counts.along, "segment"), least_along),
                        "rings"};
  return std::nullopt;
}

}  // namespace panwright::geometry::internal
