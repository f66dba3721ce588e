#include "preview/reference/internal/pixel_errors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"

namespace panwright::preview::reference {
namespace {

constexpr std::int64_t kReach = 3;
constexpr std::size_t kRows = 2 * kReach + 1;

constexpr double kOwn = 0.35;
constexpr double kLine = 0.22;
constexpr double kRing = 0.05;
constexpr double kSide = 0.45;
constexpr double kNear = 0.1;
constexpr double kWide = 0.02;
// samples for which near and wide count in full
constexpr double kFewSamples = 9;
constexpr double kBlack = 4;
constexpr double kRounding = 0x1p-24;

double area_of(const Cell& cell) { return (cell.high.x - cell.low.x) * (cell.high.y - cell.low.y); }

// The variances of seven rows of an image, as sums over columns.
class Band {
 public:
  Band(std::uint32_t left, std::uint32_t right, std::uint32_t width, std::uint32_t height)
      : left_(left), columns_(right - left + 1), width_(width), height_(height) {
    for (auto& row : rows_) row.resize(columns_ + 2 * kReach);
    for (auto* sums : {&above_, &below_, &all_}) sums->resize(columns_ + 2 * kReach);
  }

  // cells of row y + dy, for dy from −3 to 3
  void set(std::int64_t y, const std::array<std::span<const Cell>, kRows>& cells,
           const std::array<const Vec3*, kRows>& variances) {
    y_ = y;
    for (std::size_t r = 0; r < kRows; ++r)
      for (std::size_t i = 0; i < cells[r].size(); ++i)
        rows_[r][cells[r][i].column - left_ + kReach] = variances[r][i];
    for (std::size_t x = 0; x < above_.size(); ++x) {
      above_[x] = rows_[0][x] + rows_[1][x] + rows_[2][x] + rows_[3][x];
      below_[x] = rows_[3][x] + rows_[4][x] + rows_[5][x] + rows_[6][x];
      all_[x] = above_[x] + below_[x] - rows_[3][x];
    }
  }

  // of the column itself and one of its neighbours
  const Vec3& at(std::uint32_t column, int dx, int dy) const {
    return rows_[static_cast<std::size_t>(kReach + dy)][place(column, dx)];
  }
  // Means over all pixels of the image from (column + x0, row + y0) to (column + x1, row + y1) but
  // the pixel itself; the rows begin or end at 0 or 3 away.
  Vec3 mean(std::uint32_t column, int x0, int x1, int y0, int y1) const {
    const std::vector<Vec3>& sums = y0 == 0 ? below_ : y1 == 0 ? above_ : all_;
    Vec3 sum = -at(column, 0, 0);
    for (int dx = x0; dx <= x1; ++dx) sum += sums[place(column, dx)];
    const std::int64_t count = inside(column, x0, x1, width_) * inside(y_, y0, y1, height_) - 1;
    return glm::max(sum, Vec3(0)) / static_cast<double>(std::max<std::int64_t>(count, 1));
  }

 private:
  std::size_t place(std::uint32_t column, int dx) const {
    return static_cast<std::size_t>(std::int64_t{column} - left_ + kReach + dx);
  }
  static std::int64_t inside(std::int64_t at, int from, int to, std::int64_t size) {
    return std::min(at + to, size - 1) - std::max<std::int64_t>(at + from, 0) + 1;
  }

  std::int64_t left_;
  std::size_t columns_;
  std::int64_t width_, height_;
  std::int64_t y_ = 0;
  std::array<std::vector<Vec3>, kRows> rows_;
  std::vector<Vec3> above_, below_, all_;  // rows −3 to 0, 0 to 3, −3 to 3
};

// The neighbours of a pixel, once around.
std::array<Vec3, 8> around(const Band& band, std::uint32_t column) {
  return {band.at(column, 1, 0),  band.at(column, 1, 1),  band.at(column, 0, 1),
          band.at(column, -1, 1), band.at(column, -1, 0), band.at(column, -1, -1),
          band.at(column, 0, -1), band.at(column, 1, -1)};
}

// What is around a pixel tells of the variance of its mean.
Vec3 borrowed(const Band& band, std::uint32_t column, double scarcity) {
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
  const Vec3 wide = band.mean(column, -3, 3, -3, 3);
  const Vec3 side =
      glm::min(glm::min(band.mean(column, -3, 3, -3, 0), band.mean(column, -3, 3, 0, 3)),
               glm::min(band.mean(column, -3, 0, -3, 3), band.mean(column, 0, 3, -3, 3)));
  return kLine * line + kRing * least + kSide * glm::sqrt(side * wide) +
         scarcity * (kNear / 8 * sum + kWide * wide);
}

}  // namespace

std::vector<Vec3> pixel_errors(std::span<const Cell> cells, const RunningStatistics& statistics,
                               std::uint32_t width, std::uint32_t height, std::uint32_t batches,
                               std::uint32_t batch_samples, const Job& job) {
  assert(batches >= 4 && statistics.size() == cells.size());
  if (cells.empty()) return {};
  const double n = batches;
  // of a cell's own area, so that cells of any size compare
  std::vector<Vec3> variances(cells.size());
  const std::uint32_t top = cells.front().row;
  std::vector<std::size_t> first(cells.back().row - top + 2, cells.size());
  std::uint32_t left = width, right = 0;
  for (std::size_t i = cells.size(); i-- > 0;) {
    const double area = area_of(cells[i]);
    variances[i] = glm::max(statistics.squares(i), Vec3(0)) / (n * (n - 1) * area * area);
    first[cells[i].row - top] = i;
    left = std::min(left, cells[i].column);
    right = std::max(right, cells[i].column);
  }
  // rows without cells begin where the next does
  for (std::size_t row = first.size() - 1; row-- > 0;)
    first[row] = std::min(first[row], first[row + 1]);

  const double scarcity = std::sqrt(kFewSamples / (n * batch_samples));
  std::vector<Vec3> errors(cells.size());
  const auto fill_row = [&](std::size_t row) {
    if (first[row] == first[row + 1]) return;
    std::array<std::span<const Cell>, kRows> near;
    std::array<const Vec3*, kRows> values{};
    for (std::size_t r = 0; r < kRows; ++r) {
      const std::size_t at = row + r;  // kReach too many
      if (at < kReach || at - kReach + 1 >= first.size()) continue;
      const std::size_t begin = first[at - kReach];
      near[r] = cells.subspan(begin, first[at - kReach + 1] - begin);
      values[r] = variances.data() + begin;
    }
    Band band(left, right, width, height);
    band.set(std::int64_t{top} + static_cast<std::int64_t>(row), near, values);
    for (std::size_t i = first[row]; i < first[row + 1]; ++i) {
      const Cell& cell = cells[i];
      const Vec3 own = variances[i];
      const Vec3 others = borrowed(band, cell.column, scarcity);
      const Vec3 mean(statistics.mean(i));
      for (int k = 0; k < 3; ++k) {
        double variance = std::max(own[k], kOwn * own[k] + (mean[k] == 0 ? kBlack : 1) * others[k]);
        // nothing around: of few batches, alone
        if (others[k] == 0) variance *= (n - 1) / (n - 3);
        errors[i][k] =
            std::max(area_of(cell) * std::sqrt(variance), kRounding * std::fabs(mean[k]));
      }
    }
  };
  parallel_for(first.size() - 1, fill_row, job);
  return errors;
}

}  // namespace panwright::preview::reference
