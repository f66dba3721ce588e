#include "labels/internal/coverage.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "labels/internal/visible_bits.h"

namespace panwright::labels {

namespace {

constexpr int kBandRows = 32;             // pixels
constexpr double kNarrow = 4;             // pixels: narrower things are sampled more finely
constexpr double kMostSquares = 1 << 16;  // of a finer region

// Samples of one thing.
struct Counted {
  std::uint64_t amodal = 0, visible = 0;
  AxisRectangle visible_box;
  AxisRectangle box;  // of things with terrain
};

// Bits of a thing in a region: of all its leaves.
struct ThingBits {
  SampleBits amodal;
  std::vector<std::uint64_t> visible;
};

ThingBits thing_bits(const std::vector<LeafBits>& leaves, const std::vector<char>& has) {
  ThingBits out;
  int right = 0, bottom = 0;
  bool first = true;
  for (const LeafBits& each : leaves) {
    if (!has[each.leaf]) continue;
    const SampleBits& bits = each.amodal;
    out.amodal.left = first ? bits.left : std::min(out.amodal.left, bits.left);
    out.amodal.top = first ? bits.top : std::min(out.amodal.top, bits.top);
    right = std::max(right, bits.left + bits.width);
    bottom = std::max(bottom, bits.top + bits.height);
    first = false;
  }
  if (first) return out;
  out.amodal.width = right - out.amodal.left;
  out.amodal.height = bottom - out.amodal.top;
  const std::size_t size =
      static_cast<std::size_t>(out.amodal.width) * static_cast<std::size_t>(out.amodal.height);
  out.amodal.words.resize(size);
  out.visible.resize(size);
  for (const LeafBits& each : leaves) {
    if (!has[each.leaf]) continue;
    const SampleBits& bits = each.amodal;
    for (int y = bits.top; y < bits.top + bits.height; ++y) {
      const std::size_t from = bits.index(bits.left, y), to = out.amodal.index(bits.left, y);
      for (std::size_t x = 0; x < static_cast<std::size_t>(bits.width); ++x) {
        out.amodal.words[to + x] |= bits.words[from + x];
        out.visible[to + x] |= each.visible[from + x];
      }
    }
  }
  return out;
}

// Adds the square of a word's samples to a box, pixels.
void add_samples(const Region& region, int x, int y, std::uint64_t word, AxisRectangle& box) {
  const Vec2 low = Vec2(region.left, region.top) + Vec2(x, y) / region.scale;
  const Vec2 high = low + 1 / region.scale;
  if (low.x >= box.low.x && low.y >= box.low.y && high.x <= box.high.x && high.y <= box.high.y)
    return;
  std::uint64_t columns = word;
  for (const int shift : {32, 16, 8}) columns |= columns >> shift;
  columns &= 0xff;
  const double step = 1 / (8 * region.scale);
  box.add(low + step * Vec2(std::countr_zero(columns), std::countr_zero(word) / 8));
  box.add(low + step * Vec2(64 - std::countl_zero(columns), 8 - std::countl_zero(word) / 8));
}

// Coverage of the pixels of a rectangle, as it is collected.
struct Raster {
  int left = 0, top = 0, width = 0, height = 0;  // within the image
  std::vector<std::uint8_t> amodal, visible;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - top) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x - left);
  }
};

std::uint8_t byte_of(double share) {
  if (!(share > 0)) return 0;
  return static_cast<std::uint8_t>(std::clamp(std::floor(255 * share + 0.5), 1.0, 255.0));
}

Mask mask_of(const Raster& raster, const std::vector<std::uint8_t>& coverage) {
  int left = raster.width, right = 0, top = raster.height, bottom = 0;
  for (int y = 0; y < raster.height; ++y) {
    const auto row = coverage.begin() + static_cast<std::ptrdiff_t>(y) * raster.width;
    const auto end = row + raster.width;
    const auto first = std::find_if(row, end, [](std::uint8_t v) { return v != 0; });
    if (first == end) continue;
    auto last = end;
    while (*(last - 1) == 0) --last;
    left = std::min(left, static_cast<int>(first - row));
    right = std::max(right, static_cast<int>(last - row));
    top = std::min(top, y);
    bottom = y + 1;
  }
  Mask mask;
  if (bottom == 0) return mask;
  mask.left = static_cast<std::uint32_t>(raster.left + left);
  mask.top = static_cast<std::uint32_t>(raster.top + top);
  mask.width = static_cast<std::uint32_t>(right - left);
  mask.height = static_cast<std::uint32_t>(bottom - top);
  mask.coverage.reserve(std::size_t{mask.width} * mask.height);
  for (int y = top; y < bottom; ++y) {
    const auto row = coverage.begin() + static_cast<std::ptrdiff_t>(y) * raster.width;
    mask.coverage.insert(mask.coverage.end(), row + left, row + right);
  }
  return mask;
}

class Coverer {
 public:
  Coverer(const Shown& shown, const Surfaces& surfaces)
      : shown_(shown),
        surfaces_(surfaces),
        size_(shown.plane.camera().width, shown.plane.camera().height),
        canvas_(shown.canvas),
        result_(shown.things.things.size()),
        rasters_(result_.size()),
        has_(result_.size(), std::vector<char>(shown.things.of_leaf.size())) {
    for (std::size_t leaf = 0; leaf < shown.things.of_leaf.size(); ++leaf)
      for (const std::uint32_t thing : shown.things.of_leaf[leaf]) has_[thing][leaf] = 1;
    for (std::size_t t = 0; t < result_.size(); ++t) set_box(t);
  }

  std::vector<Coverage> run(const Job& job) {
    run_bands(job);
    run_narrow(job);
    for (std::size_t t = 0; t < result_.size(); ++t) finish(t);
    return std::move(result_);
  }

 private:
  static AxisRectangle common(const AxisRectangle& a, const AxisRectangle& b) {
    return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
  }

  // Of the canvas.
  AxisRectangle shown_image() const { return common(canvas_, {Vec2(0), size_}); }

  void set_box(std::size_t t) {
    AxisRectangle& box = result_[t].box;
    bool cut = false;
    for (std::size_t leaf = 0; leaf < has_[t].size(); ++leaf)
      if (has_[t][leaf]) {
        box.add(surfaces_.boxes[leaf]);
        cut = cut || surfaces_.cut[leaf];
      }
    if (cut) box = common(box, canvas_);
    if (box.empty()) box = {};
    outer_.push_back(box);
    const AxisRectangle seen = common(box, shown_image());
    if (seen.empty()) return;
    Raster& raster = rasters_[t];
    raster.left = static_cast<int>(std::floor(seen.low.x));
    raster.top = static_cast<int>(std::floor(seen.low.y));
    // a box of no width on a pixel's edge has none
    raster.width = static_cast<int>(std::ceil(seen.high.x)) - raster.left;
    raster.height = static_cast<int>(std::ceil(seen.high.y)) - raster.top;
    const std::size_t pixels =
        static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
    raster.amodal.resize(pixels);
    raster.visible.resize(pixels);
  }

  bool has_ground(std::size_t t) const {
    for (std::size_t leaf = 0; leaf < has_[t].size(); ++leaf)
      if (has_[t][leaf] && surfaces_.ground[leaf]) return true;
    return false;
  }

  bool is_narrow(std::size_t t) const {
    const AxisRectangle box = common(outer_[t], canvas_);
    if (box.empty()) return false;
    const Vec2 sides = box.extent();
    return std::min(sides.x, sides.y) < kNarrow;
  }

  // All at one scale, in bands of rows.
  void run_bands(const Job& job) {
    AxisRectangle all;
    for (const Coverage& each : result_) all.add(common(each.box, canvas_));
    if (all.empty()) return;
    Region whole;
    whole.left = std::floor(all.low.x);
    whole.top = std::floor(all.low.y);
    whole.width = static_cast<int>(std::ceil(all.high.x) - whole.left);
    whole.height = static_cast<int>(std::ceil(all.high.y) - whole.top);
    const std::size_t bands = static_cast<std::size_t>((whole.height + kBandRows - 1) / kBandRows);
    std::vector<std::vector<Counted>> counted(bands, std::vector<Counted>(result_.size()));
    const std::vector<char> wanted(shown_.things.of_leaf.size(), 1);
    const auto cover = [&](std::size_t band) {
      Region region = whole;
      region.top += static_cast<double>(band) * kBandRows;
      region.height = std::min(kBandRows, whole.height - static_cast<int>(band) * kBandRows);
      const std::vector<LeafBits> leaves = region_bits(shown_, surfaces_, region, wanted);
      for (std::size_t t = 0; t < result_.size(); ++t)
        count(t, region, thing_bits(leaves, has_[t]), counted[band][t]);
    };
    parallel_for(bands, cover, job);
    for (std::size_t t = 0; t < result_.size(); ++t) {
      Counted sum;
      for (const auto& band : counted) {
        sum.amodal += band[t].amodal;
        sum.visible += band[t].visible;
        sum.visible_box.add(band[t].visible_box);
        sum.box.add(band[t].box);
      }
      take(t, sum, 1);
    }
  }

  void take(std::size_t t, const Counted& sum, double scale) {
    const double area = 1 / (64 * scale * scale);
    result_[t].amodal_pixels = static_cast<double>(sum.amodal) * area;
    result_[t].visible_pixels = static_cast<double>(sum.visible) * area;
    result_[t].visible_box = sum.visible_box;
    if (has_ground(t)) result_[t].box = sum.box;
  }

  // At scale 1: pixels too.
  void count(std::size_t t, const Region& region, const ThingBits& bits, Counted& out) {
    Raster& raster = rasters_[t];
    const bool ground = has_ground(t);
    const int left = static_cast<int>(region.left), top = static_cast<int>(region.top);
    for (int y = bits.amodal.top; y < bits.amodal.top + bits.amodal.height; ++y)
      for (int x = bits.amodal.left; x < bits.amodal.left + bits.amodal.width; ++x) {
        const std::size_t at = bits.amodal.index(x, y);
        const std::uint64_t word = bits.amodal.words[at];
        if (word == 0) continue;
        const int samples = std::popcount(word);
        out.amodal += static_cast<std::uint64_t>(samples);
        if (ground) add_samples(region, x, y, word, out.box);
        const int column = left + x - raster.left, row = top + y - raster.top;
        if (column < 0 || row < 0 || column >= raster.width || row >= raster.height) continue;
        const std::size_t pixel = raster.index(left + x, top + y);
        raster.amodal[pixel] = byte_of(samples / 64.0);
        if (bits.visible[at] == 0) continue;
        const int seen = std::popcount(bits.visible[at]);
        out.visible += static_cast<std::uint64_t>(seen);
        raster.visible[pixel] = byte_of(seen / 64.0);
        add_samples(region, x, y, bits.visible[at], out.visible_box);
      }
  }

  // Narrow things each at a scale of its own.
  void run_narrow(const Job& job) {
    std::vector<std::size_t> narrow;
    for (std::size_t t = 0; t < result_.size(); ++t)
      if (is_narrow(t)) narrow.push_back(t);
    parallel_for(
        narrow.size(), [&](std::size_t k) { cover_narrow(narrow[k]); }, job);
  }

  void cover_narrow(std::size_t t) {
    const AxisRectangle box = common(outer_[t], canvas_);
    const Vec2 sides = box.extent();
    Region region;
    const auto squares = [&](double scale) {
      return (sides.x * scale + 1) * (sides.y * scale + 1);
    };
    constexpr double kFinest = 1 << 30;
    while (region.scale < kFinest && std::min(sides.x, sides.y) * region.scale < kNarrow &&
           squares(2 * region.scale) <= kMostSquares)
      region.scale *= 2;
    region.left = std::floor(box.low.x * region.scale) / region.scale;
    region.top = std::floor(box.low.y * region.scale) / region.scale;
    region.width = static_cast<int>(std::ceil((box.high.x - region.left) * region.scale));
    region.height = static_cast<int>(std::ceil((box.high.y - region.top) * region.scale));
    const ThingBits bits = thing_bits(region_bits(shown_, surfaces_, region, has_[t]), has_[t]);
    Raster& raster = rasters_[t];
    std::vector<double> amodal(raster.amodal.size()), visible(raster.visible.size());
    const double area = 1 / (64 * region.scale * region.scale);
    Counted sum;
    for (int y = bits.amodal.top; y < bits.amodal.top + bits.amodal.height; ++y)
      for (int x = bits.amodal.left; x < bits.amodal.left + bits.amodal.width; ++x) {
        const std::size_t at = bits.amodal.index(x, y);
        if (bits.amodal.words[at] == 0) continue;
        const int samples = std::popcount(bits.amodal.words[at]);
        const int seen = std::popcount(bits.visible[at]);
        sum.amodal += static_cast<std::uint64_t>(samples);
        sum.visible += static_cast<std::uint64_t>(seen);
        if (seen > 0) add_samples(region, x, y, bits.visible[at], sum.visible_box);
        if (has_ground(t)) add_samples(region, x, y, bits.amodal.words[at], sum.box);
        const Vec2 place = region.place(x, y, 0);
        const int column = static_cast<int>(std::floor(place.x)) - raster.left;
        const int row = static_cast<int>(std::floor(place.y)) - raster.top;
        if (column < 0 || row < 0 || column >= raster.width || row >= raster.height) continue;
        const std::size_t pixel = raster.index(column + raster.left, row + raster.top);
        amodal[pixel] += samples * area;
        visible[pixel] += seen * area;
      }
    std::ranges::transform(amodal, raster.amodal.begin(), byte_of);
    std::ranges::transform(visible, raster.visible.begin(), byte_of);
    take(t, sum, region.scale);
  }

  void finish(std::size_t t) {
    Coverage& out = result_[t];
    out.amodal = mask_of(rasters_[t], rasters_[t].amodal);
    out.visible = mask_of(rasters_[t], rasters_[t].visible);
    const AxisRectangle seen = common(out.box, shown_image());
    // where nothing hides it, exactly
    if (out.visible_pixels > 0)
      out.visible_box = out.visible_pixels == out.amodal_pixels && !reaches_beyond(t)
                            ? seen
                            : common(out.visible_box, seen);
    if (out.visible_box.empty()) out.visible_box = {};
  }

  // True: a part of it lies outside of the image.
  bool reaches_beyond(std::size_t t) const {
    const AxisRectangle& box = result_[t].box;
    return !(box.low.x >= 0 && box.low.y >= 0 && box.high.x <= size_.x && box.high.y <= size_.y);
  }

  const Shown& shown_;
  const Surfaces& surfaces_;
  const Vec2 size_;
  const AxisRectangle& canvas_;
  std::vector<Coverage> result_;
  std::vector<AxisRectangle> outer_;  // of each: of terrain, about its box
  std::vector<Raster> rasters_;
  std::vector<std::vector<char>> has_;  // by thing and leaf
};

}  // namespace

std::vector<Coverage> covered(const Shown& shown, const Surfaces& surfaces, const Job& job) {
  return Coverer(shown, surfaces).run(job);
}

}  // namespace panwright::labels
