#include "terrain/internal/slope_blocks.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace panwright::terrain::internal {

namespace {

constexpr std::uint32_t kMostColumns = kTilePosts;

// Slopes of the posts of one row.
struct PostSlopes {
  std::array<float, kMostColumns> p, q;
};

// Differences over twice the distance of posts, over the distance at borders.
void set_slopes(const float* posts, std::size_t pitch, std::uint32_t nx, std::uint32_t ny,
                std::uint32_t y, PostSlopes& out) {
  const float* here = posts + y * pitch;
  const float *above = y > 0 ? here - pitch : here, *below = y + 1 < ny ? here + pitch : here;
  const float down = y > 0 && y + 1 < ny ? 0.5f : 1.0f;
  for (std::uint32_t x = 0; x < nx; ++x) out.q[x] = (below[x] - above[x]) * down;
  for (std::uint32_t x = 1; x + 1 < nx; ++x) out.p[x] = (here[x + 1] - here[x - 1]) * 0.5f;
  out.p[0] = here[1] - here[0];
  out.p[nx - 1] = here[nx - 1] - here[nx - 2];
}

// Sums of columns of cells.
struct ColumnSums {
  std::array<float, kMostColumns> cells, p, q, pp, qq, pq;
  void clear(std::uint32_t columns) {
    for (auto* each : {&cells, &p, &q, &pp, &qq, &pq}) std::fill_n(each->begin(), columns, 0.0f);
  }
  SlopeSums sum(std::uint32_t from, std::uint32_t to, const Vec2& per_post) const {
    SlopeSums out;
    for (std::uint32_t x = from; x < to; ++x) out.add({cells[x], p[x], q[x], pp[x], qq[x], pq[x]});
    const auto u = static_cast<float>(per_post.x), v = static_cast<float>(per_post.y);
    out.p *= u;
    out.q *= v;
    out.pp *= u * u;
    out.qq *= v * v;
    out.pq *= u * v;
    return out;
  }
};

// One row of cells: the means of what is linear between corners, and of its products.
void add_row(const PostSlopes& above, const PostSlopes& below, std::uint32_t left,
             std::uint32_t cells, ColumnSums& out) {
  const float *p0 = above.p.data() + left, *p1 = below.p.data() + left, *q0 = above.q.data() + left,
              *q1 = below.q.data() + left;
  for (std::uint32_t x = 0; x < cells; ++x) {
    const float a = p0[x], b = p0[x + 1], c = p1[x], d = p1[x + 1];
    const float e = q0[x], f = q0[x + 1], g = q1[x], h = q1[x + 1];
    float p = 0.25f * ((a + b) + (c + d)), q = 0.25f * ((e + f) + (g + h));
    const float px = 0.5f * ((b + d) - (a + c)), py = 0.5f * ((c + d) - (a + b));
    const float qx = 0.5f * ((f + h) - (e + g)), qy = 0.5f * ((g + h) - (e + f));
    const float pxy = (a + d) - (b + c), qxy = (e + h) - (f + g);
    constexpr float kTwelfth = 1.0f / 12;
    float pp = p * p + kTwelfth * (px * px + py * py + kTwelfth * pxy * pxy);
    float qq = q * q + kTwelfth * (qx * qx + qy * qy + kTwelfth * qxy * qxy);
    float pq = p * q + kTwelfth * (px * qx + py * qy + kTwelfth * pxy * qxy);
    // false for NaN
    const bool whole = pp + qq < 1e12f;
    p = whole ? p : 0;
    q = whole ? q : 0;
    pp = whole ? pp : 0;
    qq = whole ? qq : 0;
    pq = whole ? pq : 0;
    out.cells[x] += whole ? 1.0f : 0.0f;
    out.p[x] += p;
    out.q[x] += q;
    out.pp[x] += pp;
    out.qq[x] += qq;
    out.pq[x] += pq;
  }
}

std::int16_t signed_code(double share) {
  return static_cast<std::int16_t>(std::lround(std::clamp(share, -1.0, 1.0) * 32767));
}
std::uint16_t code(double share) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * 65535));
}

}  // namespace

void add_slopes(const float* posts, std::size_t pitch, std::uint32_t nx, std::uint32_t ny,
                std::span<const Vec2> per_post, SlopeSums* out, std::size_t out_pitch) {
  if (nx < 2 || ny < 2) return;
  PostSlopes rows[2];
  ColumnSums sums;
  set_slopes(posts, pitch, nx, ny, 0, rows[0]);
  std::size_t place = 0;
  for (std::uint32_t top = 0; top + 1 < ny; top += kBlockPosts, out += out_pitch) {
    sums.clear(nx - 1);
    for (std::uint32_t y = top; y < std::min(top + kBlockPosts, ny - 1); ++y) {
      set_slopes(posts, pitch, nx, ny, y + 1, rows[(y + 1) % 2]);
      add_row(rows[y % 2], rows[(y + 1) % 2], 0, nx - 1, sums);
    }
    for (std::uint32_t left = 0; left + 1 < nx; left += kBlockPosts, ++place)
      out[left / kBlockPosts].add(
          sums.sum(left, std::min(left + kBlockPosts, nx - 1), per_post[place]));
  }
}

SlopeSums slopes_within(const float* posts, std::uint32_t nx, std::uint32_t ny,
                        const CellRange& cells, const Vec2& per_post) {
  PostSlopes rows[2];
  ColumnSums sums;
  sums.clear(cells.columns);
  const std::uint32_t top = cells.top, bottom = cells.top + cells.rows;
  set_slopes(posts, nx, nx, ny, top, rows[top % 2]);
  for (std::uint32_t y = top; y < bottom; ++y) {
    set_slopes(posts, nx, nx, ny, y + 1, rows[(y + 1) % 2]);
    add_row(rows[y % 2], rows[(y + 1) % 2], cells.left, cells.columns, sums);
  }
  return sums.sum(0, cells.columns, per_post);
}

SlopeMoments moments_of(const SlopeSums& sums) {
  const double n = double(sums.cells);
  SlopeMoments out{sums.p / n, sums.q / n, 0, 0, 0};
  out.pp = std::max(0.0, sums.pp / n - out.p * out.p);
  out.qq = std::max(0.0, sums.qq / n - out.q * out.q);
  const double most = std::sqrt(out.pp * out.qq);
  out.pq = std::clamp(sums.pq / n - out.p * out.q, -most, most);
  return out;
}

void append_slopes(std::span<const SlopeSums> blocks, std::vector<std::byte>& bytes) {
  double most = 0;
  for (const SlopeSums& sums : blocks) {
    if (!(sums.cells > 0)) continue;
    const SlopeMoments m = moments_of(sums);
    most = std::max({most, std::fabs(m.p), std::fabs(m.q), std::sqrt(m.pp), std::sqrt(m.qq)});
  }
  const auto unit = static_cast<float>(most);
  std::vector<SlopeBlock> out(blocks.size(), SlopeBlock{kNoSlope, 0, 0, 0, 0});
  const double share = unit > 0 ? 1 / double(unit) : 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!(blocks[i].cells > 0)) continue;
    const SlopeMoments m = moments_of(blocks[i]);
    const double across = std::sqrt(m.pp), down = std::sqrt(m.qq);
    out[i] = {signed_code(m.p * share), signed_code(m.q * share), code(across * share),
              code(down * share),
              signed_code(across > 0 && down > 0 ? m.pq / (across * down) : 0.0)};
  }
  const auto head = std::as_bytes(std::span(&unit, 1)), rest = std::as_bytes(std::span(out));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
}

SlopeMoments moments_of(const SlopeBlock& block, double unit) {
  const double across = block.across * (unit / 65535), down = block.down * (unit / 65535);
  return {block.p * (unit / 32767), block.q * (unit / 32767), across * across, down * down,
          across * down * block.together / 32767};
}

}  // namespace panwright::terrain::internal
