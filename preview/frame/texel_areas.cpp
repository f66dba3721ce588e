#include "preview/frame/texel_areas.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace panwright::preview {
namespace {

constexpr double kReach = 6;   // of a PSF, in sigmas: 2e-9 lie beyond
constexpr double kWide = 4;    // sigma from which sampled Gaussians have their variance
constexpr double kCell = 1.5;  // of texels' sides: a texel lies on two cells a row at most

// A grid of squares along the axes of the image.
struct Grid {
  Vec2 origin{0};   // pixels
  double side = 1;  // pixels
  std::int64_t width = 0;
  std::int64_t height = 0;
};

// The share of a parallelogram on one side of a line along an axis of the image: the distribution
// of the sum of two uniform numbers.
class SideShare {
 public:
  // the extents of its sides across the line
  SideShare(double a, double b)
      : half_(0.5 * (std::fabs(a) + std::fabs(b))),
        level_(0.5 * std::fabs(std::fabs(a) - std::fabs(b))),
        wide_(std::max(std::fabs(a), std::fabs(b))),
        product_(std::fabs(a * b)) {}

  double half() const { return half_; }

  // Of what lies below, where the line is at `t` from the centre.
  double operator()(double t) const {
    if (t <= -half_) return 0;
    if (t >= half_) return 1;
    if (std::fabs(t) <= level_) return 0.5 + t / wide_;
    const double rest = half_ - std::fabs(t);
    const double tail = 0.5 * rest * rest / product_;
    return t < 0 ? tail : 1 - tail;
  }

 private:
  double half_, level_, wide_, product_;
};

// The share of a parallelogram where x < corner.x and y < corner.y, by clipping.
double quadrant_share(const Vec2& u, const Vec2& v, const Vec2& corner) {
  std::array<Vec2, 8> polygon{-0.5 * (u + v), 0.5 * (u - v), 0.5 * (u + v), 0.5 * (v - u)};
  std::size_t count = 4;
  for (int axis = 0; axis < 2; ++axis) {
    std::array<Vec2, 8> clipped;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2& p = polygon[i];
      const Vec2& q = polygon[(i + 1) % count];
      const double a = corner[axis] - p[axis];
      const double b = corner[axis] - q[axis];
      if (a > 0) clipped[kept++] = p;
      if ((a > 0) != (b > 0)) clipped[kept++] = p + a / (a - b) * (q - p);
    }
    polygon = clipped;
    count = kept;
  }
  double twice = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2& p = polygon[i];
    const Vec2& q = polygon[(i + 1) % count];
    twice += p.x * q.y - p.y * q.x;
  }
  return std::fabs(0.5 * twice) / std::fabs(u.x * v.y - u.y * v.x);
}

// Lays texels on the squares of a grid.
class TexelLayer {
 public:
  TexelLayer(const Imposter& imposter, const Grid& grid)
      : grid_(grid),
        first_((imposter.origin - grid.origin) / grid.side),
        u_(imposter.along / grid.side),
        v_(imposter.down / grid.side),
        x_(u_.x, v_.x),
        y_(u_.y, v_.y),
        area_(std::fabs(u_.x * v_.y - u_.y * v_.x)) {}

  // Calls add(index of a square, share of its area) for each square below a texel.
  template <class Add>
  void lay(std::uint32_t column, std::uint32_t row, const Add& add) const {
    const Vec2 centre = first_ + (column + 0.5) * u_ + (row + 0.5) * v_;
    const double left = std::floor(centre.x - x_.half());
    const double top = std::floor(centre.y - y_.half());
    const bool across = centre.x + x_.half() > left + 1;
    const bool below = centre.y + y_.half() > top + 1;
    const auto i = static_cast<std::int64_t>(left);
    const auto k = static_cast<std::int64_t>(top);
    const auto at = [&](std::int64_t x, std::int64_t y, double share) {
      if (x >= 0 && y >= 0 && x < grid_.width && y < grid_.height)
        add(static_cast<std::size_t>(y * grid_.width + x), area_ * share);
    };
    if (!across && !below) return at(i, k, 1);
    const Vec2 corner = Vec2(left + 1, top + 1) - centre;
    const double west = across ? x_(corner.x) : 1;
    const double north = below ? y_(corner.y) : 1;
    const double both = !across ? north : !below ? west : quadrant_share(u_, v_, corner);
    at(i, k, both);
    if (across) at(i + 1, k, north - both);
    if (below) at(i, k + 1, west - both);
    if (across && below) at(i + 1, k + 1, 1 - west - north + both);
  }

 private:
  Grid grid_;
  Vec2 first_, u_, v_;
  SideShare x_, y_;
  double area_;
};

// What of a rectangle lies outside of all others, an area.
double left_of(const PlaneRect& rect, std::span<const PlaneRect> others) {
  for (std::size_t i = 0; i < others.size(); ++i) {
    const PlaneRect& other = others[i];
    if (!overlap(rect, other)) continue;
    const auto rest = others.subspan(i + 1);
    const Vec2 low = glm::max(rect.low, other.low);
    const Vec2 high = glm::min(rect.high, other.high);
    double left = 0;
    const auto add = [&](double x0, double y0, double x1, double y1) {
      if (x1 > x0 && y1 > y0) left += left_of({{x0, y0}, {x1, y1}}, rest);
    };
    add(rect.low.x, rect.low.y, low.x, rect.high.y);
    add(high.x, rect.low.y, rect.high.x, rect.high.y);
    add(low.x, rect.low.y, high.x, low.y);
    add(low.x, high.y, high.x, rect.high.y);
    return left;
  }
  return (rect.high.x - rect.low.x) * (rect.high.y - rect.low.y);
}

// The share of each texel that counts: within its imposter's rectangle, and not of a finer one.
class Shares {
 public:
  Shares(const Imposter& imposter, std::span<const PlaneRect> finer)
      : rect_(imposter.rect),
        low_(imposter.plane.low),
        side_(1 / imposter.camera.focal.x),
        width_(imposter.camera.width),
        height_(imposter.camera.height),
        finer_(finer) {}

  double operator()(std::uint32_t column, std::uint32_t row) const {
    constexpr std::uint32_t kOutside = 2;
    const bool inside = column >= kOutside && row >= kOutside && column + kOutside < width_ &&
                        row + kOutside < height_;
    if (inside && finer_.empty()) return 1;
    const Vec2 low = low_ + side_ * Vec2(column, row);
    const PlaneRect texel{glm::max(low, rect_.low), glm::min(low + side_, rect_.high)};
    if (!(texel.low.x < texel.high.x && texel.low.y < texel.high.y)) return 0;
    return left_of(texel, finer_) / (side_ * side_);
  }

 private:
  PlaneRect rect_;  // what lies outside is others'
  Vec2 low_;
  double side_;
  std::uint32_t width_, height_;
  std::span<const PlaneRect> finer_;
};

// The part of the image that texels, widened by a border, fall on; pixels.
Tile part_of(const Imposter& imposter, double border, std::uint32_t width, std::uint32_t height) {
  const Vec2 u = static_cast<double>(imposter.camera.width) * imposter.along;
  const Vec2 v = static_cast<double>(imposter.camera.height) * imposter.down;
  const Vec2 size(width, height);
  const Vec2 low = glm::clamp(
      glm::floor(imposter.origin + glm::min(u, 0.0) + glm::min(v, 0.0) - border), Vec2(0), size);
  const Vec2 high = glm::clamp(
      glm::ceil(imposter.origin + glm::max(u, 0.0) + glm::max(v, 0.0) + border), Vec2(0), size);
  if (!(high.x > low.x && high.y > low.y)) return {};
  return {static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(low.y),
          static_cast<std::uint32_t>(high.x - low.x), static_cast<std::uint32_t>(high.y - low.y)};
}

// What texels show, and nothing of what others show.
struct Texels {
  const Imposter& imposter;
  const image::Image& all;
  const image::Image* others = nullptr;
  std::span<const PlaneRect> finer;

  // Radiance and coverage. False: nothing.
  bool at(std::size_t index, Vec4& light) const {
    const auto of = [&](const image::Image& image) {
      const float* radiance = image.radiance.data() + 3 * index;
      return Vec4(radiance[0], radiance[1], radiance[2], image.coverage[index]);
    };
    light = of(all);
    if (others) light -= of(*others);
    return light != Vec4(0);
  }
};

void lay_light(const Texels& texels, const Grid& grid, std::vector<double>& light) {
  const TexelLayer layer(texels.imposter, grid);
  const Shares shares(texels.imposter, texels.finer);
  light.assign(static_cast<std::size_t>(4 * grid.width * grid.height), 0);
  Vec4 here;
  for (std::uint32_t row = 0; row < texels.all.height; ++row)
    for (std::uint32_t column = 0; column < texels.all.width; ++column) {
      if (!texels.at(std::size_t{row} * texels.all.width + column, here)) continue;
      const double share = shares(column, row);
      if (share == 0) continue;
      layer.lay(column, row, [&](std::size_t square, double area) {
        double* sum = light.data() + 4 * square;
        for (int k = 0; k < 4; ++k) sum[k] += share * area * here[k];
      });
    }
}

// For each cell of a row, the integrals of a Gaussian at its centre over the pixels of a part.
struct Weights {
  std::vector<std::int64_t> first;  // pixel, of each cell; -1: none
  std::vector<double> weights;      // `reach` of each cell
  std::size_t reach = 0;
};
Weights weights_of(double first_centre, double step, std::int64_t cells, double sigma,
                   std::int64_t low, std::int64_t pixels) {
  Weights result;
  result.reach = static_cast<std::size_t>(std::ceil(2 * kReach * sigma)) + 2;
  result.weights.assign(static_cast<std::size_t>(cells) * result.reach, 0);
  const double scale = 1 / (sigma * std::sqrt(2.0));
  for (std::int64_t c = 0; c < cells; ++c) {
    const double centre = first_centre + static_cast<double>(c) * step - static_cast<double>(low);
    const auto begin = static_cast<std::int64_t>(std::floor(centre - kReach * sigma));
    result.first.push_back(begin);
    double before = std::erf((static_cast<double>(begin) - centre) * scale);
    for (std::size_t k = 0; k < result.reach; ++k) {
      const std::int64_t pixel = begin + static_cast<std::int64_t>(k);
      const double after = std::erf((static_cast<double>(pixel + 1) - centre) * scale);
      if (pixel >= 0 && pixel < pixels)
        result.weights[static_cast<std::size_t>(c) * result.reach + k] = 0.5 * (after - before);
      before = after;
    }
  }
  return result;
}

// Calls use(pixel, weight) for the pixels of a cell.
template <class Use>
void spread(const Weights& weights, std::size_t cell, std::int64_t pixels, const Use& use) {
  const double* weight = weights.weights.data() + cell * weights.reach;
  for (std::size_t k = 0; k < weights.reach; ++k) {
    const std::int64_t pixel = weights.first[cell] + static_cast<std::int64_t>(k);
    if (pixel >= 0 && pixel < pixels) use(static_cast<std::size_t>(pixel), weight[k]);
  }
}

// Texels on cells that are hardly larger, then rows and columns of cells on pixels.
void blur_light(const Texels& texels, double sigma, const Tile& part, std::vector<double>& light) {
  const Imposter& imposter = texels.imposter;
  const Vec2 u = static_cast<double>(imposter.camera.width) * imposter.along;
  const Vec2 v = static_cast<double>(imposter.camera.height) * imposter.down;
  const Vec2 centre = imposter.origin + 0.5 * (u + v);
  Grid grid;
  grid.side = kCell * std::max(glm::length(imposter.along), glm::length(imposter.down));
  const Vec2 half = glm::ceil(0.5 * (glm::abs(u) + glm::abs(v)) / grid.side) + 1.0;
  grid.origin = centre - grid.side * half;
  grid.width = static_cast<std::int64_t>(2 * half.x);
  grid.height = static_cast<std::int64_t>(2 * half.y);
  std::vector<double> cells;
  lay_light(texels, grid, cells);

  // texels are points, and cells are where they are told to be: squares of both widen the PSF
  const double area = grid.side * grid.side;
  const auto sigma_along = [&](double a, double b) {
    const double own = (a * a + b * b + area) / 12;
    return std::sqrt(std::max(sigma * sigma - own, 1e-4 * sigma * sigma));
  };
  const Vec2 first = grid.origin + 0.5 * grid.side;
  const Weights across =
      weights_of(first.x, grid.side, grid.width, sigma_along(imposter.along.x, imposter.down.x),
                 part.x, part.width);
  const Weights below =
      weights_of(first.y, grid.side, grid.height, sigma_along(imposter.along.y, imposter.down.y),
                 part.y, part.height);
  light.assign(std::size_t{4} * part.width * part.height, 0);
  std::vector<double> line(std::size_t{4} * part.width);
  for (std::size_t row = 0; row < static_cast<std::size_t>(grid.height); ++row) {
    std::fill(line.begin(), line.end(), 0.0);
    const double* cell = cells.data() + 4 * row * static_cast<std::size_t>(grid.width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(grid.width); ++i, cell += 4) {
      if (cell[0] == 0 && cell[1] == 0 && cell[2] == 0 && cell[3] == 0) continue;
      spread(across, i, part.width, [&](std::size_t pixel, double weight) {
        for (std::size_t k = 0; k < 4; ++k) line[4 * pixel + k] += area * weight * cell[k];
      });
    }
    spread(below, row, part.height, [&](std::size_t pixel, double weight) {
      double* to = light.data() + pixel * line.size();
      for (std::size_t i = 0; i < line.size(); ++i) to[i] += weight * line[i];
    });
  }
}

// Of the discrete Gaussian of a variance: exp(-t) I_n(t), by its series.
std::vector<double> kernel_of(double sigma) {
  // tails of narrow ones are wider than those of Gaussians
  const auto reach = static_cast<std::size_t>(std::ceil(kReach * sigma)) + 4;
  std::vector<double> kernel;
  const double t = sigma * sigma;
  double sum = 0;
  for (std::size_t n = 0; n <= reach; ++n) {
    const auto order = static_cast<double>(n);
    double value = 0;
    if (sigma > kWide) {
      value = std::exp(-0.5 * order * order / t);
    } else {
      double term = std::exp(-t);
      for (std::size_t k = 1; k <= n; ++k) term *= 0.5 * t / static_cast<double>(k);
      for (double k = 1; term > 1e-20; ++k) {
        value += term;
        term *= 0.25 * t * t / (k * (k + order));
      }
    }
    kernel.push_back(value);
    sum += n == 0 ? value : 2 * value;
  }
  for (double& value : kernel) value /= sum;
  return kernel;
}

// One layer of an image, rows then columns.
void convolve_layer(std::span<const double> kernel, std::size_t channels, std::size_t width,
                    std::size_t height, std::span<float> values) {
  std::vector<float> rows(values.size());
  const auto reach = static_cast<std::ptrdiff_t>(kernel.size()) - 1;
  const auto pass = [&](std::span<const float> from, std::span<float> to, std::size_t step,
                        std::size_t count, std::size_t line) {
    // `count` values `step` apart from `line` on
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) + k;
        if (at >= 0 && at < static_cast<std::ptrdiff_t>(count))
          sum += kernel[static_cast<std::size_t>(std::abs(k))] *
                 static_cast<double>(from[line + static_cast<std::size_t>(at) * step]);
      }
      to[line + i * step] = static_cast<float>(sum);
    }
  };
  parallel_for(height, [&](std::size_t y) {
    for (std::size_t c = 0; c < channels; ++c)
      pass(values, rows, channels, width, y * width * channels + c);
  });
  parallel_for(width, [&](std::size_t x) {
    for (std::size_t c = 0; c < channels; ++c)
      pass(rows, values, width * channels, height, x * channels + c);
  });
}

}  // namespace

ImposterPatch patch_of(const Imposter& imposter, const image::Image& texels,
                       const image::Image* others, std::span<const PlaneRect> finer, double sigma,
                       std::uint32_t width, std::uint32_t height) {
  ImposterPatch patch;
  patch.part = part_of(imposter, sigma > 0 ? kReach * sigma + 1 : 0, width, height);
  if (patch.part.width == 0) return patch;
  const Texels shown{imposter, texels, others, finer};
  if (sigma > 0)
    blur_light(shown, sigma, patch.part, patch.light);
  else
    lay_light(shown, {Vec2(patch.part.x, patch.part.y), 1, patch.part.width, patch.part.height},
              patch.light);
  return patch;
}

double flux_error_of(const image::Image& texels) {
  // what a disc of radius r has: 0.29 r^-3/2 of its area, and 8 r steps
  constexpr double kStep = 0.29 * kPi / 2.8284271247461903;
  constexpr double kAlone = 0.1;  // of a texel's light, what its neighbours have
  double sum = 0;
  double squares = 0;
  const auto light = [&](std::size_t at) {
    const float* c = texels.radiance.data() + 3 * at;
    return static_cast<double>(c[0]) + static_cast<double>(c[1]) + static_cast<double>(c[2]);
  };
  const std::size_t width = texels.width;
  const auto light_at = [&](std::size_t row, std::size_t column) {  // 0 beyond the border
    return row < texels.height && column < width ? light(row * width + column) : 0;
  };
  for (std::size_t row = 0; row < texels.height; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const double here = light(row * width + column);
      const double before = light_at(row, column - 1);
      const double above = light_at(row - 1, column);
      sum += here;
      squares += (here - before) * (here - before) + (here - above) * (here - above);
      // a glint or a boom that is hit by chance: as many more may be, as Poisson says
      const double most =
          std::max({before, above, light_at(row, column + 1), light_at(row + 1, column)});
      if (most < kAlone * here) squares += (1 / (kStep * kStep) - 4) * here * here;
    }
  return sum > 0 ? kStep * std::sqrt(squares) / sum : 0;
}

double pixel_error_of(const image::Image& texels, double flux_error, double rate) {
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < texels.radiance.size(); i += 3) {
    const float* c = texels.radiance.data() + i;
    const double light =
        static_cast<double>(c[0]) + static_cast<double>(c[1]) + static_cast<double>(c[2]);
    sum += light;
    squares += light * light;
  }
  return squares > 0 ? flux_error * sum / (std::sqrt(squares) * rate) : 0;
}

void convolve(double sigma, image::Image& image) {
  const std::vector<double> kernel = kernel_of(sigma);
  convolve_layer(kernel, 3, image.width, image.height, image.radiance);
  convolve_layer(kernel, 1, image.width, image.height, image.coverage);
}

void add_patches(std::span<const ImposterPatch> patches, image::Image& image) {
  for (const ImposterPatch& patch : patches) {
    const double* light = patch.light.data();
    for (std::size_t y = 0; y < patch.part.height; ++y)
      for (std::size_t x = 0; x < patch.part.width; ++x, light += 4) {
        const std::size_t at = (patch.part.y + y) * image.width + patch.part.x + x;
        for (std::size_t k = 0; k < 3; ++k) {
          float& radiance = image.radiance[3 * at + k];
          radiance = static_cast<float>(std::max(static_cast<double>(radiance) + light[k], 0.0));
        }
        const double coverage = static_cast<double>(image.coverage[at]) + light[3];
        image.coverage[at] = static_cast<float>(std::clamp(coverage, 0.0, 1.0));
      }
  }
}

}  // namespace panwright::preview
