#include "terrain/survey.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace panwright::terrain {

namespace {

constexpr std::uint32_t kBaselines = 7;  // 1, 2 … 64 posts
constexpr std::uint32_t kLongest = 1u << (kBaselines - 1);
constexpr std::uint64_t kMostSlopes = 40'000'000;  // posts that slopes are taken from
constexpr double kBin = 1.0 / 8192;                // of a tangent
constexpr std::size_t kBins = 8 * 8192;            // up to 82.9 degrees

// Tangents of one baseline.
class Tangents {
 public:
  Tangents() : bins_(kBins + 1) {}

  void add(double tangent) {
    const double size = std::fabs(tangent);
    squares_ += size * size;
    ++bins_[std::min(static_cast<std::size_t>(std::min(1e9, size / kBin)), kBins)];
    ++count_;
  }
  std::uint64_t count() const { return count_; }
  double rms() const { return det::atan(std::sqrt(squares_ / double(count_))) / kDegree; }
  double median() const {
    const double half = double(count_) / 2;
    double below = 0;
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      const auto in = static_cast<double>(bins_[k]);
      if (below + in >= half && in > 0)
        return det::atan((double(k) + (half - below) / in) * kBin) / kDegree;
      below += in;
    }
    return 90;
  }

 private:
  double squares_ = 0;
  std::uint64_t count_ = 0;
  std::vector<std::uint64_t> bins_;
};

// Slopes along rows and columns, of the last rows.
class Slopes {
 public:
  explicit Slopes(const DemInfo& info) : info_(info), tangents_(kBaselines) {
    const std::uint64_t posts = std::uint64_t{info.width} * info.height;
    every_ = static_cast<std::uint32_t>((posts + kMostSlopes - 1) / kMostSlopes);
    kept_.resize(std::min(kLongest + 1, info.height));
    for (auto& row : kept_) row.resize(info.width);
  }

  void add(std::uint32_t row, std::span<const double> heights) {
    std::copy(heights.begin(), heights.end(), kept(row).begin());
    if (row % every_ != 0) return;
    for (std::uint32_t k = 0; k < kBaselines; ++k) {
      const std::uint32_t apart = 1u << k;
      const Vec2 here = info_.map.spacing(info_.width / 2.0, row + 0.5);
      // at the poles posts of a row are neighbours of their opposites, and repeat each other
      if (apart < info_.width && here.x > 0.25 * here.y) {
        const double scale = 1 / (here.x * apart);
        for (std::uint32_t x = 0; x + apart < info_.width; ++x) {
          const double step = heights[x + apart] - heights[x];
          if (!std::isnan(step)) tangents_[k].add(step * scale);
        }
      }
      if (row < apart) continue;
      const Vec2 between = info_.map.spacing(info_.width / 2.0, row + 0.5 - apart / 2.0);
      const double scale = 1 / (between.y * apart);
      const auto& above = kept(row - apart);
      for (std::uint32_t x = 0; x < info_.width; ++x) {
        const double step = heights[x] - above[x];
        if (!std::isnan(step)) tangents_[k].add(step * scale);
      }
    }
  }

  void finish(Survey& out) const {
    out.slope_rows = every_;
    const Vec2 middle = info_.map.spacing(info_.width / 2.0, info_.height / 2.0);
    for (std::uint32_t k = 0; k < kBaselines; ++k) {
      const Tangents& each = tangents_[k];
      if (each.count() == 0) continue;
      out.slopes.push_back(
          {1u << k, middle.y * (1u << k), each.count(), each.rms(), each.median()});
    }
  }

 private:
  std::vector<double>& kept(std::uint32_t row) { return kept_[row % kept_.size()]; }

  const DemInfo& info_;
  std::uint32_t every_ = 1;
  std::vector<std::vector<double>> kept_;
  std::vector<Tangents> tangents_;
};

// Means of square blocks of posts, and their shading.
class Blocks {
 public:
  Blocks(const DemInfo& info, std::uint32_t side) : info_(info) {
    if (side == 0) return;
    block_ = std::max(1u, (std::max(info.width, info.height) + side - 1) / side);
    width_ = (info.width + block_ - 1) / block_;
    height_ = (info.height + block_ - 1) / block_;
    sums_.resize(std::size_t{width_} * height_);
    counts_.resize(sums_.size());
  }

  void add(std::uint32_t row, std::span<const double> heights) {
    if (width_ == 0) return;
    const std::size_t begin = std::size_t{row / block_} * width_;
    for (std::uint32_t x = 0; x < info_.width; ++x) {
      if (std::isnan(heights[x])) continue;
      sums_[begin + x / block_] += heights[x];
      ++counts_[begin + x / block_];
    }
  }

  void finish(const SurveyOptions& options, Survey& out) {
    if (width_ == 0) return;
    for (std::size_t i = 0; i < sums_.size(); ++i)
      sums_[i] = counts_[i] > 0 ? sums_[i] / counts_[i] : std::nan("");
    out.shade_width = width_;
    out.shade_height = height_;
    out.block = block_;
    out.shade.resize(3 * sums_.size());
    if (info_.quantity == Quantity::plain) return paint_numbers(out);
    out.exaggeration = exaggeration();
    const double azimuth = options.sun_azimuth * kDegree,
                 elevation = options.sun_elevation * kDegree;
    const Vec3 sun(det::sin(azimuth) * det::cos(elevation), det::cos(azimuth) * det::cos(elevation),
                   det::sin(elevation));
    for (std::uint32_t y = 0; y < height_; ++y)
      for (std::uint32_t x = 0; x < width_; ++x) {
        const auto normal = normal_at(x, y, out.exaggeration);
        const double light = normal ? std::max(0.0, glm::dot(*normal, sun)) : -1;
        paint(out, x, y, light);
      }
  }

 private:
  double at(std::int64_t x, std::int64_t y) const {
    x = std::clamp<std::int64_t>(x, 0, width_ - 1);
    y = std::clamp<std::int64_t>(y, 0, height_ - 1);
    return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  }
  Vec2 spacing(std::uint32_t y) const {
    return info_.map.spacing(info_.width / 2.0, (y + 0.5) * block_) * double(block_);
  }
  // Slope between the neighbours of a block, or to itself beside a void.
  static double slope(double before, double here, double behind, double step) {
    const double low = std::isnan(before) ? here : before,
                 high = std::isnan(behind) ? here : behind;
    const int steps = (std::isnan(before) ? 0 : 1) + (std::isnan(behind) ? 0 : 1);
    return steps == 0 ? 0 : (high - low) / (step * steps);
  }
  std::optional<Vec3> normal_at(std::uint32_t x, std::uint32_t y, double factor) const {
    const double here = at(x, y);
    if (std::isnan(here)) return std::nullopt;
    const Vec2 step = spacing(y);
    const double east = step.x > 0 ? slope(x > 0 ? at(x - 1, y) : std::nan(""), here,
                                           x + 1 < width_ ? at(x + 1, y) : std::nan(""), step.x)
                                   : 0;
    const double down = slope(y > 0 ? at(x, y - 1) : std::nan(""), here,
                              y + 1 < height_ ? at(x, y + 1) : std::nan(""), step.y);
    return glm::normalize(Vec3(-factor * east, factor * down, 1));
  }

  // A round factor that brings the RMS slope of the image near 14 degrees.
  double exaggeration() const {
    double squares = 0;
    std::uint64_t count = 0;
    for (std::uint32_t y = 0; y < height_; ++y) {
      const double step = spacing(y).y;
      for (std::uint32_t x = 0; x < width_ && y + 1 < height_; ++x) {
        const double tangent = (at(x, y + 1) - at(x, y)) / step;
        if (std::isnan(tangent)) continue;
        squares += tangent * tangent;
        ++count;
      }
    }
    if (squares == 0) return 1;
    const double wanted = 0.25 / std::sqrt(squares / double(count));
    double out = 1;
    for (const double factor : {2., 3., 5., 10., 20., 30., 50., 100.})
      if (wanted >= factor) out = factor;
    return out;
  }

  void paint(Survey& out, std::uint32_t x, std::uint32_t y, double light) const {
    std::uint8_t* pixel = &out.shade[3 * (std::size_t{y} * width_ + x)];
    if (light < 0) {
      pixel[0] = 20, pixel[1] = 40, pixel[2] = 110;  // void
      return;
    }
    pixel[0] = pixel[1] = pixel[2] =
        static_cast<std::uint8_t>(std::lround(255 * std::min(light, 1.0)));
  }

  void paint_numbers(Survey& out) const {
    const double low = out.least.height, range = out.largest.height - low;
    for (std::uint32_t y = 0; y < height_; ++y)
      for (std::uint32_t x = 0; x < width_; ++x) {
        const double value = at(x, y);
        paint(out, x, y, std::isnan(value) ? -1 : range > 0 ? (value - low) / range : 0.5);
      }
  }

  const DemInfo& info_;
  std::uint32_t block_ = 1, width_ = 0, height_ = 0;
  std::vector<double> sums_;
  std::vector<std::uint32_t> counts_;
};

// Running statistics of heights: mean and squares about the first height.
class Heights {
 public:
  explicit Heights(Survey& out) : out_(out) {}

  void add(std::uint32_t row, std::span<const double> heights, std::span<const VoidKind> voids) {
    double sum = 0, squares = 0;
    for (std::uint32_t x = 0; x < heights.size(); ++x) {
      if (voids[x] != VoidKind::none) {
        ++out_.voids[static_cast<std::size_t>(voids[x])];
        continue;
      }
      const double height = heights[x];
      if (out_.valid++ == 0) {
        first_ = height;
        out_.least = out_.largest = {height, x, row, 0};
      }
      extreme(out_.least, height < out_.least.height, height, x, row);
      extreme(out_.largest, height > out_.largest.height, height, x, row);
      sum += height - first_;
      squares += (height - first_) * (height - first_);
    }
    sum_ += sum;
    squares_ += squares;
  }
  void finish() const {
    if (out_.valid == 0) return;
    const double n = double(out_.valid), mean = sum_ / n;
    out_.mean = first_ + mean;
    out_.deviation = std::sqrt(std::max(0.0, squares_ / n - mean * mean));
  }

 private:
  static void extreme(Extreme& of, bool beyond, double height, std::uint32_t x, std::uint32_t row) {
    if (beyond) of = {height, x, row, 0};
    of.posts += height == of.height ? 1 : 0;
  }

  Survey& out_;
  double first_ = 0, sum_ = 0, squares_ = 0;
};

void warn_of(const Survey& out, const DemInfo& info, DiagnosticLog& log) {
  const std::string& name = info.files.front();
  if (out.valid == 0) {
    log.report_file(Code("W9603"), name,
                    fmt::format("the file has no height: all {} posts are void", out.void_posts()));
    return;
  }
  if (const auto count = out.voids[static_cast<std::size_t>(VoidKind::undeclared)]; count > 0)
    log.report_file(Code("W9603"), name,
                    fmt::format("{} beyond 1e30 stand for no height, and the file does not say so",
                                counted(count, "number")));
  constexpr std::uint64_t kPlateau = 32;
  if (info.quantity != Quantity::plain && out.least.posts >= kPlateau &&
      out.least.posts * 1000 >= out.valid && out.least.height < out.largest.height)
    log.report_file(
        Code("W9603"), name,
        fmt::format("{} posts have the lowest height, {} m: a plateau there is often a filling of "
                    "voids that the file does not state",
                    out.least.posts, out.least.height),
        "--void VALUE, as stored, makes them void");
}

}  // namespace

std::uint64_t Survey::void_posts() const {
  std::uint64_t out = 0;
  for (const std::uint64_t each : voids) out += each;
  return out;
}

Result<Survey> survey(const Dem& dem, const SurveyOptions& options, DiagnosticLog& log,
                      const Job& job) {
  const DemInfo& info = dem.info();
  Survey out;
  Heights heights(out);
  std::optional<Slopes> slopes;
  // posts of no known distance have no slopes
  if (info.quantity != Quantity::plain && info.map.dx != 0 && info.map.dy != 0)
    slopes.emplace(info);
  Blocks blocks(info, options.hillshade);
  const bool good = dem.read(
      0, info.height,
      [&](const Rows& rows) {
        for (std::uint32_t k = 0; k < rows.count; ++k) {
          const auto line = rows.heights.subspan(std::size_t{k} * info.width, info.width);
          heights.add(rows.first + k, line,
                      rows.voids.subspan(std::size_t{k} * info.width, info.width));
          if (slopes) slopes->add(rows.first + k, line);
          blocks.add(rows.first + k, line);
        }
        return true;
      },
      log, job);
  if (!good) return failed;
  heights.finish();
  if (slopes) slopes->finish(out);
  blocks.finish(options, out);
  warn_of(out, info, log);
  return out;
}

}  // namespace panwright::terrain
