#include "labels/internal/outline.h"

namespace panwright::labels {
namespace {

using Corner = std::pair<std::uint32_t, std::uint32_t>;

// Follows edges with the mask on their right: right along the top of a pixel, down its right side.
class OutlineTracer {
 public:
  explicit OutlineTracer(const PixelMask& mask)
      : mask_(mask), done_(std::size_t{mask.width} * mask.height) {}

  std::vector<Corner> run() {
    std::vector<Corner> out;
    for (std::uint32_t j = 0; j < mask_.height; ++j)
      for (std::uint32_t i = 0; i < mask_.width; ++i) {
        // each border has an edge to the right: the top of a pixel that is set
        if (!set(i, j) || set(i, std::int64_t{j} - 1) || done(i, j)) continue;
        const std::vector<Corner> loop = trace(i, j);
        const bool first = out.empty();
        if (loops_++ == 1) out.push_back(out.front());
        out.insert(out.end(), loop.begin(), loop.end());
        if (!first) {
          out.push_back(loop.front());
          out.push_back(out.front());
        }
      }
    return out;
  }

 private:
  bool set(std::int64_t i, std::int64_t j) const { return mask_.at(mask_.left + i, mask_.top + j); }
  bool done(std::uint32_t i, std::uint32_t j) const {
    return done_[std::size_t{j} * mask_.width + i] != 0;
  }

  // From the upper left corner of pixel (i, j) to the right. At corners where pixels touch, the
  // border stays with its own pixel.
  std::vector<Corner> trace(std::uint32_t i, std::uint32_t j) {
    constexpr int kStep[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};  // right, down, left, up
    std::vector<Corner> loop;
    std::int64_t x = i, y = j;
    int way = 0, before = -1;
    do {
      if (way != before)
        loop.emplace_back(static_cast<std::uint32_t>(mask_.left + x),
                          static_cast<std::uint32_t>(mask_.top + y));
      if (way == 0)
        done_[static_cast<std::size_t>(y) * mask_.width + static_cast<std::size_t>(x)] = 1;
      before = way;
      x += kStep[way][0];
      y += kStep[way][1];
      // the pixels ahead, to the right and to the left of the way
      const int right = (way + 1) % 4;
      const std::int64_t ahead_x = x + (way == 2 || right == 2 ? -1 : 0);
      const std::int64_t ahead_y = y + (way == 3 || right == 3 ? -1 : 0);
      const std::int64_t left_x = ahead_x - kStep[right][0], left_y = ahead_y - kStep[right][1];
      if (!set(ahead_x, ahead_y))
        way = right;
      else if (set(left_x, left_y))
        way = (way + 3) % 4;
    } while (x != i || y != j || way != 0);
    return loop;
  }

  const PixelMask& mask_;
  int loops_ = 0;
  std::vector<std::uint8_t> done_;  // edges to the right, by pixel
};

}  // namespace

std::vector<Corner> outline_of(const PixelMask& mask) { return OutlineTracer(mask).run(); }

}  // namespace panwright::labels
