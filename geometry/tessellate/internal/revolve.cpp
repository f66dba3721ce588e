#include "geometry/tessellate/internal/revolve.h"

#include <algorithm>
#include <cmath>

#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/circle.h"

namespace panwright::geometry::internal {

namespace {

// numbers of segments that are compared for curved profiles
constexpr std::uint32_t kCandidates = 24;
// how often more segments are tried where chords alone do not reach the error
constexpr int kRetries = 16;
// segments of the larger of two circular edges for which the smaller may have one fewer
constexpr std::uint64_t kMostPeriod = 32;
// below this many triangles other numbers of segments are tried as well
constexpr double kSmall = 300;

bool on_axis(const Vec2& p) { return p.x == 0; }

// how a part's end stands to the axis
End end_of(const Curve& curve, bool last) {
  if (curve.loop()) return End::loop;
  const Jet jet = curve.at(last ? curve.end() : curve.begin());
  // note: a quarter turn of an arc misses the axis by rounding
  const double size = std::max(std::fabs(jet.p.x), std::fabs(jet.p.y));
  return std::fabs(jet.p.x) <= 1e-15 * size || jet.p.x == 0 ? End::pole : End::edge;
}

class Solver {
 public:
  Solver(const Revolution& shape, const TessellationOptions& options, bool shared_circular_edges)
      : shape_(shape),
        options_(options),
        balanced_(shape.counts.around == 0 && shape.counts.along == 0),
        on_shape_(!balanced_ || shared_circular_edges || options.edge_segments > 0) {
    Vec2 low(0), high(0);
    bool first = true;
    const auto grow = [&](const Vec2& p) {
      low = first ? p : glm::min(low, p);
      high = first ? p : glm::max(high, p);
      first = false;
    };
    for (const Part& part : shape.parts) {
      if (!part.curve) {
        samples_.emplace_back(std::nullopt);
        grow(part.from);
        grow(part.to);
        rim_radius_ = std::max({rim_radius_, part.from.x, part.to.x});
        continue;
      }
      samples_.emplace_back(*part.curve);
      grow(samples_.back()->low());
      grow(samples_.back()->high());
      lever_ = std::max(lever_, samples_.back()->largest_lever());
      for (const bool last : {false, true})
        if (end_of(*part.curve, last) == End::edge)
          rim_radius_ = std::max(
              rim_radius_, part.curve->at(last ? part.curve->end() : part.curve->begin()).p.x);
    }
    // the bounds of a sector may lie to one side
    const double across = high.x * (shape.sector.whole() ? 1 : std::sqrt(2.0));
    reach_ = std::hypot(across, 0.5 * (high.y - low.y));
  }

  Layout solve() {
    const double reserve = rounding_bound(reach_ + std::min(options_.max_error, reach_));
    layout_.least_error = 1.01 * reserve;
    half_range_ = options_.max_error - reserve;
    const bool counted = shape_.counts.around != 0 && (shape_.counts.along != 0 || !curved());
    if (half_range_ <= 0 && !counted) {
      layout_.state = Layout::State::too_fine;
      return layout_;
    }
    const double most = static_cast<double>(options_.max_triangles);
    const bool free = shape_.counts.around == 0 && options_.edge_segments == 0;
    std::uint32_t n = segments();
    if (free && !on_shape_) n = narrowed(n);
    if (!lay(n)) return too_many();
    // note: few wide segments bend a coarse profile in ways that its chords cannot mend
    for (int i = 0; i < kRetries && free && layout_.error > half_range_; ++i)
      if (!lay(n += 1 + n / 8)) return too_many();
    if (free && lever_ > 0 && layout_.triangles < kSmall) try_neighbours();
    if (layout_.triangles > std::min(most, kMostVertices) || layout_.vertices > kMostVertices)
      return too_many();
    return layout_;
  }

 private:
  Layout too_many() {
    layout_.state = Layout::State::too_many;
    layout_.parts.clear();
    return layout_;
  }

  bool curved() const {
    for (const Part& part : shape_.parts)
      if (part.curve) return true;
    return false;
  }

  // Everything for a number of segments; false: far too many triangles.
  bool lay(std::uint32_t segments) {
    layout_.segments = segments;
    const double half = 0.5 * span_of(shape_.sector) / segments;
    layout_.edge_factor = on_shape_ ? 1 : area_factor(half);
    layout_.error = rim_error(rim_radius_, layout_.edge_factor, half);
    if (layout_.narrow_segments != 0) {
      // between edges the mesh misses the shape by no more than a mean of what the edges do
      const double wide = 0.5 * span_of(shape_.sector) / layout_.narrow_segments;
      layout_.narrow_factor = area_factor(wide);
      layout_.error =
          std::max(layout_.error, rim_error(layout_.narrow_radius, layout_.narrow_factor, wide));
    }
    const double most = static_cast<double>(options_.max_triangles);
    if (!(segments * rows(segment_dip(half, balanced_)) <= 4 * most + 100)) return false;
    lay_parts(half);
    count();
    return true;
  }

  static double rim_error(double radius, double factor, double half) {
    return radius * std::max(factor - 1, 1 - factor * (1 - segment_dip(half, false)));
  }

  // Fewer segments for the smaller of two circular edges; returns those of the larger one.
  std::uint32_t narrowed(std::uint32_t segments) {
    double narrow = 0;
    for (const Part& part : shape_.parts) {
      if (part.curve) return segments;
      for (const double radius : {part.from.x, part.to.x}) {
        if (radius == 0 || radius == rim_radius_ || radius == narrow) continue;
        if (narrow != 0) return segments;
        narrow = radius;
      }
    }
    if (narrow == 0) return segments;
    const std::uint64_t needed = segments_within(half_range_ / narrow, shape_.sector, on_shape_);
    const std::uint64_t wide = segments;
    std::uint64_t best = 2 * wide;
    for (std::uint64_t k = 1; k <= kMostPeriod && k < wide; ++k) {
      const std::uint64_t periods = std::max((wide + k) / (k + 1), (needed + k - 1) / k);
      if ((2 * k + 1) * periods >= best) continue;
      best = (2 * k + 1) * periods;
      segments = static_cast<std::uint32_t>((k + 1) * periods);
      layout_.narrow_segments = static_cast<std::uint32_t>(k * periods);
      layout_.narrow_radius = narrow;
    }
    return segments;
  }

  // Where there are few triangles whole numbers matter more than any estimate.
  void try_neighbours() {
    Layout best = layout_;
    const std::uint32_t first = std::max(least_, best.segments - std::min(best.segments, 3u));
    for (std::uint32_t n = first; n <= first + 6; ++n) {
      if (n == best.segments || !lay(n)) continue;
      const bool better = layout_.triangles < best.triangles || best.error > half_range_;
      if (layout_.error <= half_range_ && better) best = layout_;
    }
    layout_ = std::move(best);
  }

  // chords and straight parts together, about
  double rows(double dip) const {
    double sum = 0;
    for (const auto& samples : samples_) {
      if (!samples)
        sum += 1;
      else if (shape_.counts.along != 0)
        sum += shape_.counts.along;
      else
        sum += std::max(1.0, std::ceil(samples->chords(half_range_, dip, balanced_)));
    }
    return sum;
  }

  std::uint32_t segments() {
    const std::uint32_t fewest = fewest_segments(shape_.sector);
    if (shape_.counts.around != 0) return shape_.counts.around;
    if (options_.edge_segments != 0) return std::max(fewest, options_.edge_segments);
    least_ = fewest;
    if (rim_radius_ > 0)
      least_ = segments_within(half_range_ / rim_radius_, shape_.sector, on_shape_);
    if (!(lever_ > 0)) return least_;
    const auto within = [&](double share) {
      const double dip = share * half_range_ / lever_;
      return segments_within(balanced_ ? 2 * dip / (1 + dip) : dip, shape_.sector, true);
    };
    // half of the error for segments is the best for chords that are all alike
    const std::uint32_t usual = within(0.5);
    if (shape_.counts.along != 0) return std::max(least_, usual);
    const std::uint32_t possible = within(0.9);
    const std::uint32_t first = std::max({least_, possible, usual - usual / 4});
    const std::uint32_t last = std::max(first, usual + usual / 2 + 2);
    const std::uint32_t step = std::max(1u, (last - first) / kCandidates);
    std::uint32_t best = first;
    double best_cost = 0;
    for (std::uint32_t n = first; n <= last; n += step) {
      const double cost = n * rows(segment_dip(0.5 * span_of(shape_.sector) / n, balanced_));
      if (n == first || cost < best_cost) {
        best = n;
        best_cost = cost;
      }
    }
    return best;
  }

  void lay_parts(double half) {
    layout_.parts.clear();
    for (std::size_t i = 0; i < shape_.parts.size(); ++i) {
      const Part& part = shape_.parts[i];
      if (!part.curve) {
        layout_.parts.push_back(straight(part));
        continue;
      }
      const ChordSettings settings{half_range_,
                                   half,
                                   layout_.edge_factor,
                                   balanced_,
                                   shape_.counts.along,
                                   end_of(*part.curve, false),
                                   end_of(*part.curve, true)};
      Chords chords = laid_chords(*part.curve, *samples_[i], settings);
      layout_.error = std::max(layout_.error, chords.error);
      for (std::size_t k = 0; k < chords.points.size(); ++k) {
        double& v = chords.points[k].v;
        if (part.mapping == Mapping::angle)
          v = part.v_begin + (part.v_end - part.v_begin) * v;
        else
          v = std::min(1.0, part.curve->at(chords.t[k]).p.x / part.plane_radius);
      }
      layout_.parts.push_back(std::move(chords.points));
    }
  }

  std::vector<ProfilePoint> straight(const Part& part) const {
    const Vec2 d = part.to - part.from;
    const double length = glm::length(d);
    const Vec2 normal(d.y / length, -d.x / length);
    const bool plane = part.mapping != Mapping::angle;
    return {{layout_.factor_at(part.from.x) * part.from.x, part.from.y, normal,
             plane ? part.from.x / part.plane_radius : part.v_begin},
            {layout_.factor_at(part.to.x) * part.to.x, part.to.y, normal,
             plane ? part.to.x / part.plane_radius : part.v_end}};
  }

  void count() {
    layout_.triangles = layout_.vertices = 0;
    const double n = layout_.segments;
    const bool whole = shape_.sector.whole();
    for (std::size_t i = 0; i < shape_.parts.size(); ++i) {
      const Part& part = shape_.parts[i];
      const auto& points = layout_.parts[i];
      if (part.cap) {
        const double edge = layout_.segments_at(std::max(part.from.x, part.to.x));
        layout_.triangles += whole ? edge - 2 : edge;
        layout_.vertices += whole ? edge : edge + 2;
        continue;
      }
      if (layout_.narrow_segments != 0) {
        for (const double radius : {part.from.x, part.to.x})
          if (radius > 0) layout_.triangles += layout_.segments_at(radius);
      } else {
        layout_.triangles += 2 * n * (static_cast<double>(points.size()) - 1);
        if (points.front().radius == 0) layout_.triangles -= n;
        if (points.back().radius == 0) layout_.triangles -= n;
      }
      layout_.vertices += (n + 1) * static_cast<double>(points.size());
    }
    if (!shape_.wall.empty())
      layout_.triangles += 2 * (static_cast<double>(shape_.wall.size()) - 2);
  }

  const Revolution& shape_;
  const TessellationOptions& options_;
  bool balanced_, on_shape_;
  std::vector<std::optional<CurveSamples>> samples_;
  std::uint32_t least_ = 0;  // segments
  double rim_radius_ = 0;    // the largest of an edge
  double lever_ = 0;         // the largest of a curve
  double reach_ = 0;
  double half_range_ = 0;
  Layout layout_;
};

}  // namespace

Part Part::straight(const Vec2& from, const Vec2& to) {
  Part part;
  part.from = from;
  part.to = to;
  return part;
}

Part Part::face(const Vec2& from, const Vec2& to) {
  Part part = straight(from, to);
  part.cap = on_axis(from) || on_axis(to);
  part.mapping = from.x > to.x ? Mapping::above : Mapping::below;
  part.plane_radius = std::max(from.x, to.x);
  return part;
}

Part Part::curved(Curve curve) {
  Part part;
  part.curve = std::move(curve);
  return part;
}

Layout laid_out(const Revolution& revolution, const TessellationOptions& options,
                bool shared_circular_edges) {
  return Solver(revolution, options, shared_circular_edges).solve();
}

double planned_triangles(const Revolution& revolution, const TessellationOptions& options) {
  TessellationOptions unlimited = options;
  unlimited.max_triangles = std::uint64_t{1} << 31;
  const Layout layout = laid_out(revolution, unlimited);
  return layout.state == Layout::State::good ? layout.triangles : kMostVertices;
}

std::uint32_t shared_segments(const Revolution& revolution, const TessellationOptions& options) {
  TessellationOptions free = options;
  free.edge_segments = 0;
  const Layout layout = laid_out(revolution, free, true);
  return layout.segments == 0 ? std::uint32_t{1} << 31 : layout.segments;
}

CircularEdge circular_edge(double radius, double z, const Sector& sector) {
  const det::SinCos start = directions(sector, fewest_segments(sector)).front();
  return {{0, 0, z}, {0, 0, 1}, {radius * start.cos, radius * start.sin, 0}, span_of(sector)};
}

}  // namespace panwright::geometry::internal
