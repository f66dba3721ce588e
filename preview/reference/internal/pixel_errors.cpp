#include "preview/reference/internal/pixel_errors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"

namespace panwright::preview::reference {
namespace {

// Variances of RGB, and 1 where there is light.
using Counted = Vec4;

constexpr int kErrorReach = 3;
constexpr std::size_t kRows = 2 * kErrorReach + 1;

constexpr double kOwn = 0.35;
constexpr double kLine = 0.2;
constexpr double kRing = 0.02;
constexpr double kSide = 0.42;
constexpr double kNear = 0.09;
constexpr double kWide = 0.02;
// samples for which near and wide count in full
constexpr double kFewSamples = 9;
// how much more near and wide count where a pixel's samples do not agree, to this part of their
// mean
constexpr double kDiscord = 3;
constexpr double kAgreement = 0.3;
// and how much more with few samples (share of kFewSamples' root beyond this) where what is around
// varies by much more than the pixel's mean: glints that most samples miss
constexpr double kGlints = 0.9;
constexpr double kGlintScarcity = 0.75;
constexpr double kGlintMean = 5;
constexpr double kRounding = 0x1p-24;

double cell_area(const Cell& cell) {
  return (cell.high.x - cell.low.x) * (cell.high.y - cell.low.y);
}

// The variances of seven rows of an image, as sums over columns.
class Band {
 public:
  Band(std::uint32_t left, std::uint32_t right) : left_(left) {
    const std::size_t columns = right - left + 1 + 2 * kErrorReach;
    for (auto& row : rows_) row.resize(columns);
    for (auto* sums : {&above_, &below_, &all_}) sums->resize(columns);
  }

  // the cells of the rows from −3 to 3
  void set(const std::array<std::span<const Cell>, kRows>& cells,
           const std::array<const Counted*, kRows>& variances) {
    for (std::size_t r = 0; r < kRows; ++r)
      for (std::size_t i = 0; i < cells[r].size(); ++i)
        rows_[r][cells[r][i].column - left_ + kErrorReach] = variances[r][i];
    for (std::size_t x = 0; x < all_.size(); ++x) {
      const Counted above = rows_[0][x] + rows_[1][x] + rows_[2][x];
      const Counted below = rows_[4][x] + rows_[5][x] + rows_[6][x];
      above_[x] = above + rows_[3][x];
      below_[x] = rows_[3][x] + below;
      all_[x] = above + rows_[3][x] + below;
    }
  }

  // of the neighbour of a column
  Vec3 at(std::uint32_t column, int dx, int dy) const {
    return Vec3(rows_[static_cast<std::size_t>(kErrorReach + dy)][place(column, dx)]);
  }

  struct Means {
    Vec3 wide{0};         // 7 × 7 pixels
    Vec3 side{INFINITY};  // the least of the four halves, with the pixel's own row or column
  };
  // Over the pixels that have light, the one in the middle apart.
  Means means(std::uint32_t column) const {
    const Counted own = rows_[kErrorReach][place(column, 0)];
    Counted above = -own, below = -own, before = -own, behind = -own;
    for (int dx = -kErrorReach; dx <= kErrorReach; ++dx) {
      const std::size_t x = place(column, dx);
      above += above_[x];
      below += below_[x];
      if (dx <= 0) before += all_[x];
      if (dx >= 0) behind += all_[x];
    }
    Means means;
    for (const Counted& half : {above, below, before, behind})
      means.side = glm::min(means.side, mean_of(half));
    means.wide = mean_of(before + behind - (all_[place(column, 0)] - own));
    return means;
  }

 private:
  static Vec3 mean_of(const Counted& sum) {
    // what rounding leaves of differences may be below 0
    return glm::max(Vec3(sum), Vec3(0)) / std::max(sum.w, 1.0);
  }
  std::size_t place(std::uint32_t column, int dx) const {
    return static_cast<std::size_t>(std::int64_t{column} - left_ + kErrorReach + dx);
  }

  std::int64_t left_;
  std::array<std::vector<Counted>, kRows> rows_;
  std::vector<Counted> above_, below_, all_;  // sums of rows −3 to 0, 0 to 3, −3 to 3
};

// The neighbours of a pixel, once around.
std::array<Vec3, 8> around(const Band& band, std::uint32_t column) {
  return {band.at(column, 1, 0),  band.at(column, 1, 1),  band.at(column, 0, 1),
          band.at(column, -1, 1), band.at(column, -1, 0), band.at(column, -1, -1),
          band.at(column, 0, -1), band.at(column, 1, -1)};
}

// What is around a pixel tells of the variance of its mean.
struct Borrowed {
  Vec3 shown{0};   // by what goes on around it
  Vec3 scarce{0};  // what shows nowhere else
};
Borrowed borrowed(const Band& band, std::uint32_t column) {
  const std::array<Vec3, 8> ring = around(band, column);
  Vec3 line(0);
  Vec3 sum(0);
  Vec3 least(INFINITY);
  for (std::size_t k = 0; k < 8; ++k) {
    if (k < 4) line = glm::max(line, glm::min(ring[k], ring[k + 4]));
    sum += ring[k];
    Vec3 most(0);
    for (std::size_t j = 0; j < 5; ++j) most = glm::max(most, ring[(k + j) % 8]);
    least = glm::min(least, most);
  }
  const auto [wide, side] = band.means(column);
  return {kLine * line + kRing * least + kSide * glm::sqrt(side * wide),
          kNear / 8 * sum + kWide * wide};
}

}  // namespace

std::vector<Vec3> pixel_errors(std::span<const Cell> cells, const RunningStatistics& statistics,
                               std::uint32_t batches, std::uint32_t batch_samples, const Job& job) {
  assert(batches >= 4 && statistics.size() == cells.size());
  if (cells.empty()) return {};
  const double n = batches;
  // of a cell's own area, so that cells of any size compare
  std::vector<Counted> variances(cells.size());
  const std::uint32_t top = cells.front().row;
  std::vector<std::size_t> first(cells.back().row - top + 2, cells.size());
  std::uint32_t left = cells.front().column, right = left;
  for (std::size_t i = cells.size(); i-- > 0;) {
    const double area = cell_area(cells[i]);
    const Vec3 mean(statistics.mean(i));
    variances[i] = Counted(glm::max(statistics.squares(i), Vec3(0)) / (n * (n - 1) * area * area),
                           mean.x > 0 || mean.y > 0 || mean.z > 0 ? 1 : 0);
    first[cells[i].row - top] = i;
    left = std::min(left, cells[i].column);
    right = std::max(right, cells[i].column);
  }
  // rows without cells begin where the next does
  for (std::size_t row = first.size() - 1; row-- > 0;)
    first[row] = std::min(first[row], first[row + 1]);

  const double samples = n * batch_samples;
  const double scarcity = std::sqrt(kFewSamples / samples);
  std::vector<Vec3> errors(cells.size());
  const auto fill_row = [&](std::size_t row) {
    if (first[row] == first[row + 1]) return;
    std::array<std::span<const Cell>, kRows> near;
    std::array<const Counted*, kRows> values{};
    for (std::size_t r = 0; r < kRows; ++r) {
      const std::size_t at = row + r;  // kErrorReach too many
      if (at < kErrorReach || at - kErrorReach + 1 >= first.size()) continue;
      const std::size_t begin = first[at - kErrorReach];
      near[r] = cells.subspan(begin, first[at - kErrorReach + 1] - begin);
      values[r] = variances.data() + begin;
    }
    Band band(left, right);
    band.set(near, values);
    for (std::size_t i = first[row]; i < first[row + 1]; ++i) {
      const Cell& cell = cells[i];
      const Vec3 own(variances[i]);
      const auto [shown, scarce] = borrowed(band, cell.column);
      const Vec3 mean(statistics.mean(i));
      for (int k = 0; k < 3; ++k) {
        const double agreed = kAgreement * mean[k] / cell_area(cell);
        const double spread = own[k] * samples;
        const double discord = mean[k] == 0 ? 1 : spread / (spread + agreed * agreed);
        const double bright = kGlintMean * mean[k] / cell_area(cell);
        const double beside = scarce[k] * samples;
        const double glints = beside > 0 ? beside / (beside + bright * bright) : 0;
        const double weight =
            1 + kDiscord * discord + kGlints * std::max(scarcity - kGlintScarcity, 0.0) * glints;
        const double others = shown[k] + scarcity * weight * scarce[k];
        double variance = std::max(own[k], kOwn * own[k] + others);
        // nothing around: of few batches, alone
        if (others == 0) variance *= (n - 1) / (n - 3);
        errors[i][k] =
            std::max(cell_area(cell) * std::sqrt(variance), kRounding * std::fabs(mean[k]));
      }
    }
  };
  parallel_for(first.size() - 1, fill_row, job);
  return errors;
}

}  // namespace panwright::preview::reference
