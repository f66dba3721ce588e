#include "preview/reference/internal/batches.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "base/random.h"
#include "preview/reference/internal/pixel_errors.h"
#include "preview/reference/internal/view_rays.h"

namespace panwright::preview::reference {
namespace {

constexpr std::uint32_t kUnitSamples = 2048;
// no sample has this number: numbers of a whole cell and round
constexpr std::uint32_t kWholeCell = ~0u;

// The mean of each cell in each of some batches, from one unit.
struct UnitResult {
  std::vector<Light> sums;    // batches × cells of the unit
  std::vector<Light> totals;  // one per batch
  RayCounts counts;
};

void add_counts(RayCounts& sum, const RayCounts& more) {
  sum.camera += more.camera;
  sum.shadow += more.shadow;
  sum.bounce += more.bounce;
}

class BoxBatches final : public Batches {
 public:
  BoxBatches(const ViewSamples& view, std::span<const Cell> cells, std::vector<double> weights)
      : view_(view), cells_(cells), weights_(std::move(weights)), statistics_(cells.size()) {
    units_ = units_of(cells.size(), view.batch_samples());
  }

  void add(std::uint32_t batches) override {
    const bool whole = view_.batch_samples() <= kUnitSamples;
    std::vector<UnitResult> results(units_.size());
    const auto trace = [&](std::size_t i) {
      results[i] = traced_unit(units_[i], batches);
      if (!whole) return;
      // cells of no other unit
      add_cells(units_[i], results[i]);
      results[i].sums = {};
    };
    parallel_for(units_.size(), trace, job);
    if (!whole) join_parts(results, batches);
    for (std::uint32_t r = 0; r < batches; ++r) {
      Light total(0);
      for (const UnitResult& result : results) total += result.totals[r];
      total_.add(0, total, batches_ + r + 1);
    }
    for (const UnitResult& result : results) add_counts(counts_, result.counts);
    batches_ += batches;
  }

  void write(ReferenceImage& result) const override {
    const std::vector<Vec3> errors =
        pixel_errors(cells_, statistics_, batches_, view_.batch_samples(), job);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const std::size_t pixel = std::size_t{cells_[i].row} * result.image.width + cells_[i].column;
      for (std::size_t k = 0; k < 3; ++k) {
        result.image.radiance[3 * pixel + k] =
            static_cast<float>(statistics_.mean(i)[static_cast<int>(k)]);
        result.standard_error[3 * pixel + k] = static_cast<float>(errors[i][static_cast<int>(k)]);
      }
      result.image.coverage[pixel] =
          static_cast<float>(std::clamp(statistics_.mean(i).w, 0.0, 1.0));
    }
  }

 private:
  UnitResult traced_unit(const Unit& unit, std::uint32_t batches) const {
    UnitResult result;
    const std::size_t cells = unit.end - unit.begin;
    result.sums.resize(batches * cells);
    result.totals.resize(batches);
    for (std::size_t c = 0; c < cells; ++c) {
      job.poll();
      const Cell& cell = cells_[unit.begin + c];
      const Vec2 size = cell.high - cell.low;
      const double share = size.x * size.y / view_.batch_samples();
      for (std::uint32_t r = 0; r < batches; ++r) {
        const CellSampler sampler(view_, cell, batches_ + r);
        Light sum(0);
        for (std::uint32_t k = 0; k < unit.count; ++k)
          sum += sampler(unit.first + k, result.counts).light;
        sum *= share;
        result.sums[r * cells + c] = sum;
        result.totals[r] += sum * weights_[unit.begin + c];
      }
    }
    return result;
  }

  void add_cells(const Unit& unit, const UnitResult& result) {
    const std::size_t cells = unit.end - unit.begin;
    for (std::size_t i = 0; i < result.sums.size(); ++i)
      statistics_.add(unit.begin + i % cells, result.sums[i],
                      batches_ + static_cast<std::uint32_t>(i / cells) + 1);
  }

  // cells that several units have worked on: their parts are added up in order
  void join_parts(const std::vector<UnitResult>& results, std::uint32_t batches) {
    for (std::size_t i = 0; i < units_.size();) {
      std::size_t end = i;
      while (end < units_.size() && units_[end].begin == units_[i].begin) ++end;
      for (std::uint32_t r = 0; r < batches; ++r) {
        Light sum(0);
        for (std::size_t k = i; k < end; ++k) sum += results[k].sums[r];
        statistics_.add(units_[i].begin, sum, batches_ + r + 1);
      }
      i = end;
    }
  }

  const ViewSamples& view_;
  std::span<const Cell> cells_;
  std::vector<double> weights_;
  std::vector<Unit> units_;
  RunningStatistics statistics_;
};

}  // namespace

CellSampler::CellSampler(const ViewSamples& view, const Cell& cell, std::uint32_t batch)
    : view_(view), cell_(cell) {
  name_.pixel = cell.row * view.camera.width + cell.column;
  name_.batch = batch;
  name_.seed = view.seed;
  if (view.batch_samples() == 1) return;
  words_ =
      philox({name_.pixel, batch, kWholeCell, 0},
             {static_cast<std::uint32_t>(view.seed), static_cast<std::uint32_t>(view.seed >> 32)});
}

// Products with odd numbers and folds of the high half onto the low one are orders each; the last
// step alone makes every place as likely as any other.
std::uint32_t CellSampler::shuffled(std::uint32_t number, std::size_t order) const {
  const std::uint32_t mask = view_.batch_samples() - 1;
  const int half = (std::bit_width(mask) + 1) / 2;
  const std::uint32_t a = words_[2 * order];
  const std::uint32_t b = words_[2 * order + 1];
  number = (number * (a | 1) + (a >> 16)) & mask;
  number ^= number >> half;
  number = (number * ((a >> 8) | 1) + (a >> 24)) & mask;
  number ^= number >> half;
  return (number + b) & mask;
}

Sample CellSampler::operator()(std::uint32_t number, RayCounts& counts) const {
  StreamKey name = name_;
  name.number = number;
  const std::uint32_t columns = view_.columns;
  const Vec2 step(1.0 / columns, 1.0 / view_.rows);
  const auto jittered = [&](std::uint32_t place, double x, double y) {
    return Vec2(place % columns + x, place / columns + y) * step;
  };
  const std::array<double, 4> u = numbers(name, 0);
  const Vec2 in_cell = jittered(number, u[0], u[1]);
  FirstRandoms first;
  first.sun = jittered(shuffled(number, 0), u[2], u[3]);
  // without a disc to look for and without bounces no direction is drawn
  if (view_.path.bounces > 0 || !view_.bodies.empty() ||
      (!view_.suns.empty() && view_.suns[0].has_disc())) {
    const std::array<double, 4> v = numbers(name, 1);
    first.bounce = jittered(shuffled(number, 1), v[0], v[1]);
    first.lobe = v[2];
  }
  Sample sample;
  sample.place = Vec2(cell_.column, cell_.row) + glm::mix(cell_.low, cell_.high, in_cell);
  const auto seen = view_ray(view_.camera, sample.place);
  if (!seen) return sample;
  const trace::Ray ray{*seen};
  const PathResult path =
      traced(view_.scene, view_.suns, view_.bodies, ray, first, name, view_.path, counts);
  sample.light = Light(path.radiance, path.covered ? 1 : 0);
  return sample;
}

std::vector<Unit> units_of(std::size_t cells, std::uint32_t batch_samples) {
  std::vector<Unit> units;
  if (batch_samples <= kUnitSamples) {
    const std::size_t step = kUnitSamples / batch_samples;
    for (std::size_t i = 0; i < cells; i += step)
      units.push_back({i, std::min(cells, i + step), 0, batch_samples});
    return units;
  }
  for (std::size_t i = 0; i < cells; ++i)
    for (std::uint32_t first = 0; first < batch_samples; first += kUnitSamples)
      units.push_back({i, i + 1, first, std::min(kUnitSamples, batch_samples - first)});
  return units;
}

std::unique_ptr<Batches> box_batches(const ViewSamples& view, std::span<const Cell> cells,
                                     std::vector<double> weights) {
  return std::make_unique<BoxBatches>(view, cells, std::move(weights));
}

}  // namespace panwright::preview::reference
