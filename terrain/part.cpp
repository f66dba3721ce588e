#include "terrain/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/text.h"

namespace panwright::terrain {

namespace {

std::string at_place(const std::string& place, const std::string& message) {
  return place.empty() ? message : place + ": " + message;
}

// Columns or rows whose centres lie between two places of them; count 0: none.
std::pair<std::uint32_t, std::uint32_t> within(double low, double high, std::uint32_t count) {
  // a post on the border is within, whatever its place is rounded by
  constexpr double kSlack = 1e-6;
  const double first = std::max(0.0, std::ceil(low - 0.5 - kSlack)),
               last = std::min(count - 1.0, std::floor(high - 0.5 + kSlack));
  if (!(first <= last)) return {0, 0};
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first) + 1};
}

struct Pixels {
  std::array<std::uint32_t, 4> pixels{};
  std::string problem;
};

Pixels pixels_within(const DemInfo& info, const std::array<double, 4>& bounds) {
  const auto& [south, west, north, east] = bounds;
  const Map& map = info.map;
  Vec2 low, high;
  if (map.is_placed()) {
    if (map.kind == Map::Kind::polar)
      return {{}, "bounds of a polar map are no rectangle of its pixels; pixels= takes one"};
    const Vec2 corner = map.pixel({north, west}, info.width);
    const double along = map.radius * det::cos(map.standard_latitude * kDegree) * kDegree;
    low = corner;
    high = {corner.x + (east - west) * along / map.dx, map.pixel({south, west}, info.width).y};
    if (low.x < -0.5 && high.x > info.width + 0.5) low.x = 0;
  } else {
    const double dx = map.dx > 0 ? map.dx : 1, dy = map.dy > 0 ? map.dy : 1;
    low = {(west - map.left) / dx, (map.top - north) / dy};
    high = {(east - map.left) / dx, (map.top - south) / dy};
  }
  const auto [x, columns] = within(low.x, high.x, info.width);
  const auto [y, rows] = within(low.y, high.y, info.height);
  if (columns == 0 || rows == 0)
    return {{},
            fmt::format("no post of the file lies within {} {} {} {}", south, west, north, east)};
  return {{x, y, columns, rows}, {}};
}

}  // namespace

DemPart::DemPart(Dem dem) : dem_(std::move(dem)), info_(dem_.info()) {
  pixels_ = {0, 0, info_.width, info_.height};
}

Result<DemPart> DemPart::of(Dem dem, const PartChoice& choice, const std::string& place,
                            DiagnosticLog& log) {
  DemPart part(std::move(dem));
  part.choice_ = choice;
  part.place_ = place;
  DemInfo& info = part.info_;
  const auto refuse = [&](const std::string& problem, std::string hint = {}) -> Result<DemPart> {
    log.report(Code("E9613"), {}, at_place(place, in_quotes(info.files.front()) + ": " + problem),
               std::move(hint));
    return failed;
  };
  const std::string size = fmt::format("it has {} x {} posts", info.width, info.height);
  if (choice.bounds) {
    const Pixels found = pixels_within(info, *choice.bounds);
    if (!found.problem.empty()) return refuse(found.problem, size);
    part.pixels_ = found.pixels;
  } else if (choice.pixels) {
    const auto& [x, y, columns, rows] = *choice.pixels;
    if (columns == 0 || rows == 0 || std::uint64_t{x} + columns > info.width ||
        std::uint64_t{y} + rows > info.height)
      return refuse(
          fmt::format("there are no {} x {} pixels from column {}, row {} on", columns, rows, x, y),
          size);
    part.pixels_ = *choice.pixels;
  }
  const std::uint32_t n = choice.reduce;
  info.width = part.pixels_[2] / n;
  info.height = part.pixels_[3] / n;
  if (info.width < 2 || info.height < 2)
    return refuse(fmt::format("{} x {} pixels, reduced by {}, leave {} x {} posts", part.pixels_[2],
                              part.pixels_[3], n, info.width, info.height),
                  "two posts along each side are the least");
  Map& map = info.map;
  map.left += part.pixels_[0] * map.dx;
  map.top -= part.pixels_[1] * map.dy;
  map.dx *= n;
  map.dy *= n;
  return part;
}

std::string DemPart::words() const {
  const DemInfo& all = dem_.info();
  std::string out;
  if (pixels_ != std::array<std::uint32_t, 4>{0, 0, all.width, all.height})
    out += fmt::format(" pixels={}", fmt::join(pixels_, ","));
  if (choice_.reduce != 1) out += fmt::format(" reduce={}", choice_.reduce);
  if (choice_.raise != 0) out += fmt::format(" raise={}", choice_.raise);
  if (choice_.blend != 0) out += fmt::format(" blend={}", choice_.blend);
  return out;
}

bool DemPart::read(const RowsReceiver& to, DiagnosticLog& log, const Job& job) const {
  const std::uint32_t n = choice_.reduce, from = dem_.info().width;
  const std::uint32_t x = pixels_[0], y = pixels_[1], rows = pixels_[3];
  if (n == 1 && choice_.raise == 0 && pixels_[2] == from) {
    const auto counted_from_part = [&](Rows band) {
      band.first -= pixels_[1];
      return to(band);
    };
    return dem_.read(y, rows, counted_from_part, log, job);
  }
  const std::size_t width = info_.width;
  std::vector<double> heights(width), sums(width);
  std::vector<VoidKind> voids(width);
  std::vector<std::uint32_t> counts(width);
  std::uint32_t held = 0, made = 0;
  const auto take = [&](std::span<const double> row, std::span<const VoidKind> kinds) {
    if (held == 0) {
      std::ranges::fill(sums, 0.0);
      std::ranges::fill(counts, 0u);
      std::ranges::fill(voids, VoidKind::none);
    }
    for (std::size_t i = 0; i < width * n; ++i) {
      const std::size_t out = i / n;
      if (kinds[x + i] != VoidKind::none || !std::isfinite(row[x + i])) {
        if (voids[out] == VoidKind::none) voids[out] = kinds[x + i];
        continue;
      }
      sums[out] += row[x + i];
      ++counts[out];
    }
    if (++held < n) return true;
    held = 0;
    for (std::size_t i = 0; i < width; ++i) {
      heights[i] = counts[i] == 0 ? std::numeric_limits<double>::quiet_NaN()
                                  : sums[i] / counts[i] + choice_.raise;
      if (counts[i] > 0)
        voids[i] = VoidKind::none;
      else if (voids[i] == VoidKind::none)
        voids[i] = VoidKind::not_finite;
    }
    return to(Rows{made++, 1, heights, voids});
  };
  return dem_.read(
      y, info_.height * n,
      [&](const Rows& band) {
        for (std::uint32_t r = 0; r < band.count; ++r)
          if (!take(band.heights.subspan(std::size_t{r} * from, from),
                    band.voids.subspan(std::size_t{r} * from, from)))
            return false;
        return true;
      },
      log, job);
}

}  // namespace panwright::terrain
