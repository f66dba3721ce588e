#include "preview/frame/lens_splat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace panwright::preview {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Rows of texels of one piece of work, and pieces whose results are kept at once.
constexpr std::size_t kRows = 32;
constexpr std::size_t kPieces = 16;

// Sum of some rows of texels over a rectangle of cells.
struct Piece {
  std::size_t x = 0, y = 0, width = 0, height = 0;
  std::vector<double> light;  // 4*height*width
};

// Areas of cells under a quadrilateral, by sums along its edges: each edge adds to the cells of its
// rows the area between it and their right sides, and whole cells right of it follow from sums
// along rows. Source: the signed-area rasterisation of font renderers (R. Levien, "Inside the
// fastest font renderer in the world", 2016).
class Areas {
 public:
  // Places the corner of cell (0, 0), and clears `width` by `height` cells.
  void begin(std::size_t width, std::size_t height) {
    stride_ = width + 2;
    sums_.assign(stride_ * height, 0.0);
  }

  // From a to b; x and y at least 0.
  void add_edge(Vec2 a, Vec2 b) {
    if (a.y == b.y) return;
    const double sign = a.y < b.y ? 1 : -1;
    if (a.y > b.y) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y);
    double x = a.x;
    for (auto row = static_cast<std::size_t>(a.y); static_cast<double>(row) < b.y; ++row) {
      const double top = std::max(a.y, static_cast<double>(row));
      const double bottom = std::min(b.y, static_cast<double>(row + 1));
      const double next = bottom == b.y ? b.x : a.x + slope * (bottom - a.y);
      add_row(row, x, next, sign * (bottom - top));
      x = next;
    }
  }

  // Calls use(x, y, area) for the cells in order.
  template <class Use>
  void each(const Use& use) const {
    for (std::size_t y = 0; y * stride_ < sums_.size(); ++y) {
      double sum = 0;
      for (std::size_t x = 0; x + 2 < stride_; ++x) {
        sum += sums_[y * stride_ + x];
        if (sum != 0) use(x, y, sum);
      }
    }
  }

 private:
  void add_row(std::size_t row, double x0, double x1, double height) {
    if (x0 > x1) std::swap(x0, x1);
    double* at = sums_.data() + row * stride_;
    const auto first = static_cast<std::size_t>(x0);
    const double start = static_cast<double>(first);
    if (x1 <= start + 1) {
      const double left = 0.5 * (x0 + x1) - start;
      at[first] += height * (1 - left);
      at[first + 1] += height * left;
      return;
    }
    const double per_x = height / (x1 - x0);
    for (std::size_t x = first; static_cast<double>(x) < x1; ++x) {
      const double left = std::max(x0, static_cast<double>(x));
      const double right = std::min(x1, static_cast<double>(x + 1));
      const double crossed = per_x * (right - left);
      const double area = crossed * (static_cast<double>(x + 1) - 0.5 * (left + right));
      at[x] += area;
      at[x + 1] += crossed - area;
    }
  }

  std::size_t stride_ = 0;
  std::vector<double> sums_;
};

class Splat {
 public:
  Splat(const world::Camera& lens, const LensView& view, const image::Image& texels,
        LensLight& light)
      : lens_(lens), view_(view), texels_(texels), light_(light) {
    columns_ = std::size_t{light.part.width} * light.cells;
    rows_ = std::size_t{light.part.height} * light.cells;
  }

  Piece piece(std::size_t first) const {
    const std::size_t last = std::min<std::size_t>(first + kRows, texels_.height);
    const auto [begin, end] = lit_columns(first, last);
    Piece piece;
    if (begin >= end) return piece;
    const std::size_t stride = end - begin + 1;
    std::vector<Vec2> corners((last - first + 1) * stride);
    AxisRectangle bounds;
    for (std::size_t y = first; y <= last; ++y)
      for (std::size_t x = begin; x <= end; ++x) {
        const Vec2 at = corner(x, y);
        corners[(y - first) * stride + x - begin] = at;
        if (at.x == at.x) bounds.add(at);
      }
    const Vec2 size(static_cast<double>(columns_), static_cast<double>(rows_));
    const Vec2 low = glm::clamp(glm::floor(bounds.low), Vec2(0), size);
    const Vec2 high = glm::clamp(glm::ceil(bounds.high), Vec2(0), size);
    if (!(high.x > low.x && high.y > low.y)) return piece;
    piece.x = static_cast<std::size_t>(low.x);
    piece.y = static_cast<std::size_t>(low.y);
    piece.width = static_cast<std::size_t>(high.x) - piece.x;
    piece.height = static_cast<std::size_t>(high.y) - piece.y;
    piece.light.assign(4 * piece.width * piece.height, 0.0);
    Areas areas;
    for (std::size_t y = first; y < last; ++y)
      for (std::size_t x = begin; x < end; ++x) {
        const Vec2* at = corners.data() + (y - first) * stride + x - begin;
        add(y * texels_.width + x, {at[0], at[1], at[stride + 1], at[stride]}, areas, piece);
      }
    return piece;
  }

  void merge(const Piece& piece) const {
    for (std::size_t y = 0; y < piece.height; ++y) {
      const double* from = piece.light.data() + 4 * y * piece.width;
      double* to = light_.light.data() + 4 * ((piece.y + y) * columns_ + piece.x);
      for (std::size_t k = 0; k < 4 * piece.width; ++k) to[k] += from[k];
    }
  }

 private:
  // Columns of some rows that show a target.
  std::pair<std::size_t, std::size_t> lit_columns(std::size_t first, std::size_t last) const {
    std::size_t begin = texels_.width, end = 0;
    for (std::size_t y = first; y < last; ++y) {
      const float* row = texels_.coverage.data() + y * texels_.width;
      for (std::size_t x = 0; x < begin; ++x)
        if (row[x] != 0) begin = x;
      for (std::size_t x = texels_.width; x > end; --x)
        if (row[x - 1] != 0) {
          end = x;
          break;
        }
    }
    return {begin, end};
  }

  // Where the corner of a texel falls, in cells of the part.
  Vec2 corner(std::size_t x, std::size_t y) const {
    const world::Camera& from = view_.camera;
    const Vec2 tangents =
        (Vec2(static_cast<double>(x), static_cast<double>(y)) - from.principal) / from.focal;
    const auto place = lens_.distortion->place(view_.lens_from_view * Vec3(tangents, 1));
    if (!place) return Vec2(kNone);
    const Vec2 pixel = lens_.focal * *place + lens_.principal;
    return static_cast<double>(light_.cells) * (pixel - Vec2(light_.part.x, light_.part.y));
  }

  void add(std::size_t texel, const std::array<Vec2, 4>& quad, Areas& areas, Piece& piece) const {
    const float coverage = texels_.coverage[texel];
    if (coverage == 0) return;
    const float* radiance = texels_.radiance.data() + 3 * texel;
    const std::array<double, 4> value{radiance[0], radiance[1], radiance[2], coverage};
    const Vec2 low = glm::min(glm::min(quad[0], quad[1]), glm::min(quad[2], quad[3]));
    const Vec2 high = glm::max(glm::max(quad[0], quad[1]), glm::max(quad[2], quad[3]));
    const Vec2 a = quad[2] - quad[0], b = quad[3] - quad[1];
    const double area = 0.5 * (a.x * b.y - a.y * b.x);
    if (!(area > 0)) return;  // a corner outside the domain, too
    const Vec2 from = glm::floor(low);
    const auto put = [&](double column, double row, double share) {
      const double x = column - static_cast<double>(piece.x);
      const double y = row - static_cast<double>(piece.y);
      if (!(x >= 0 && y >= 0 && x < static_cast<double>(piece.width) &&
            y < static_cast<double>(piece.height)))
        return;
      double* to = piece.light.data() +
                   4 * (static_cast<std::size_t>(y) * piece.width + static_cast<std::size_t>(x));
      for (std::size_t k = 0; k < 4; ++k) to[k] += share * value[k];
    };
    if (high.x <= from.x + 1 && high.y <= from.y + 1) {
      put(from.x, from.y, area);
      return;
    }
    const Vec2 size = glm::ceil(high) - from;
    if (!(size.x <= kMostCells && size.y <= kMostCells)) return;  // at an end of the domain
    areas.begin(static_cast<std::size_t>(size.x), static_cast<std::size_t>(size.y));
    for (std::size_t k = 0; k < 4; ++k) areas.add_edge(quad[(k + 1) % 4] - from, quad[k] - from);
    areas.each([&](std::size_t x, std::size_t y, double share) {
      put(from.x + static_cast<double>(x), from.y + static_cast<double>(y), share);
    });
  }

  static constexpr double kMostCells = 4096;
  const world::Camera& lens_;
  const LensView& view_;
  const image::Image& texels_;
  LensLight& light_;
  std::size_t columns_ = 0, rows_ = 0;
};

// Integral of the normal distribution function.
double normal_integral(double z) {
  constexpr double kDensity = 0.39894228040143267794;
  return 0.5 * z * std::erfc(-z * 0.70710678118654752440) + kDensity * std::exp(-0.5 * z * z);
}

// PixelShares of the light of a cell [a, b] in the pixels from `first` on, after a Gaussian.
struct PixelShares {
  std::int64_t first = 0;
  std::vector<double> shares;
};
PixelShares shares_of(double a, double b, double sigma) {
  constexpr double kReach = 7;
  PixelShares result;
  result.first = static_cast<std::int64_t>(std::floor(a - kReach * sigma));
  const auto last = static_cast<std::int64_t>(std::ceil(b + kReach * sigma));
  const auto below = [&](std::int64_t edge) {
    const auto at = static_cast<double>(edge);
    return sigma / (b - a) *
           (normal_integral((at - a) / sigma) - normal_integral((at - b) / sigma));
  };
  double before = below(result.first);
  for (std::int64_t k = result.first; k < last; ++k) {
    const double next = below(k + 1);
    result.shares.push_back(next - before);
    before = next;
  }
  return result;
}

void put_blurred(const LensLight& light, double sigma, image::Image& image) {
  const Tile& part = light.part;
  const std::size_t columns = std::size_t{part.width} * light.cells;
  const std::size_t rows = std::size_t{part.height} * light.cells;
  const double side = 1.0 / light.cells;
  const auto shares = [&](std::uint32_t first, std::size_t count) {
    std::vector<PixelShares> all;
    for (std::size_t k = 0; k < count; ++k)
      all.push_back(shares_of(first + side * static_cast<double>(k),
                              first + side * static_cast<double>(k + 1), sigma));
    return all;
  };
  const std::vector<PixelShares> across = shares(part.x, columns), down = shares(part.y, rows);
  // along rows of cells, then along columns
  std::vector<double> half(4 * rows * image.width, 0.0);
  const auto width = static_cast<std::int64_t>(image.width);
  const auto height = static_cast<std::int64_t>(image.height);
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const double* from = light.light.data() + 4 * (y * columns + x);
      if (from[3] == 0) continue;
      for (std::size_t k = 0; k < across[x].shares.size(); ++k) {
        const std::int64_t at = across[x].first + static_cast<std::int64_t>(k);
        if (at < 0 || at >= width) continue;
        double* to = half.data() + 4 * (y * image.width + static_cast<std::size_t>(at));
        for (std::size_t c = 0; c < 4; ++c) to[c] += across[x].shares[k] * from[c];
      }
    }
  std::vector<double> sum;
  const std::int64_t top = down.front().first;
  const std::int64_t bottom =
      down.back().first + static_cast<std::int64_t>(down.back().shares.size());
  const double area = side * side;
  for (std::int64_t row = std::max<std::int64_t>(top, 0); row < std::min(bottom, height); ++row) {
    sum.assign(std::size_t{4} * image.width, 0.0);
    for (std::size_t y = 0; y < rows; ++y) {
      const std::int64_t k = row - down[y].first;
      if (k < 0 || k >= static_cast<std::int64_t>(down[y].shares.size())) continue;
      const double share = area * down[y].shares[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share * half[4 * y * image.width + i];
    }
    for (std::size_t x = 0; x < image.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(row) * image.width + x;
      for (std::size_t c = 0; c < 3; ++c)
        image.radiance[3 * pixel + c] += static_cast<float>(std::max(0.0, sum[4 * x + c]));
      image.coverage[pixel] = static_cast<float>(
          std::clamp(static_cast<double>(image.coverage[pixel]) + sum[4 * x + 3], 0.0, 1.0));
    }
  }
}

}  // namespace

void splat(const world::Camera& lens, const LensView& view, const image::Image& texels,
           LensLight& light) {
  light.light.resize(std::size_t{4} * light.part.width * light.part.height * light.cells *
                     light.cells);
  const Splat splat(lens, view, texels, light);
  std::vector<Piece> pieces(kPieces);
  for (std::size_t first = 0; first < texels.height; first += kRows * kPieces) {
    parallel_for(kPieces, [&](std::size_t k) {
      const std::size_t row = first + k * kRows;
      pieces[k] = row < texels.height ? splat.piece(row) : Piece{};
    });
    for (const Piece& piece : pieces) splat.merge(piece);
  }
}

void put(const LensLight& light, double sigma, image::Image& image) {
  if (sigma > 0) {
    put_blurred(light, sigma, image);
    return;
  }
  const Tile& part = light.part;
  const std::size_t columns = std::size_t{part.width} * light.cells;
  const double area = 1.0 / (static_cast<double>(light.cells) * light.cells);
  for (std::uint32_t y = 0; y < part.height; ++y)
    for (std::uint32_t x = 0; x < part.width; ++x) {
      std::array<double, 4> sum{};
      for (std::size_t j = 0; j < light.cells; ++j)
        for (std::size_t i = 0; i < light.cells; ++i)
          for (std::size_t c = 0; c < 4; ++c)
            sum[c] += light.light[4 * ((std::size_t{y} * light.cells + j) * columns +
                                       std::size_t{x} * light.cells + i) +
                                  c];
      const std::size_t pixel = std::size_t{part.y + y} * image.width + part.x + x;
      for (std::size_t c = 0; c < 3; ++c)
        image.radiance[3 * pixel + c] = static_cast<float>(std::max(0.0, area * sum[c]));
      image.coverage[pixel] = static_cast<float>(std::clamp(area * sum[3], 0.0, 1.0));
    }
}

void clear(const Tile& part, image::Image& image) {
  for (std::uint32_t y = part.y; y < part.y + part.height; ++y) {
    const std::size_t first = std::size_t{y} * image.width + part.x;
    std::fill_n(image.radiance.begin() + static_cast<std::ptrdiff_t>(3 * first), 3 * part.width,
                0.0f);
    std::fill_n(image.coverage.begin() + static_cast<std::ptrdiff_t>(first), part.width, 0.0f);
  }
}

}  // namespace panwright::preview
