// Independent images of one view, one after the other. Private to preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/job.h"
#include "preview/reference/internal/cells.h"
#include "preview/reference/internal/path.h"
#include "preview/reference/internal/running_statistics.h"
#include "preview/reference/reference.h"
#include "world/camera.h"

namespace panwright::preview::reference {

// Shared state of all samples of a view.
struct ViewSamples {
  const TraceScene& scene;  // with the camera in it
  std::span<const Sun> suns;
  std::span<const Bodies> bodies;
  world::Camera camera;  // its image may be larger than the requested one
  PathOptions path;
  std::uint64_t seed = 0;
  // powers of two: each batch has columns·rows samples in every cell
  std::uint32_t columns = 1;
  std::uint32_t rows = 1;

  std::uint32_t batch_samples() const { return columns * rows; }
};

// Sample of a cell.
struct Sample {
  Vec2 place;  // on the image, pixels
  Light light;
};
// Sampler of a cell in a batch: jittered on the grid, and likewise on the Sun's disc and over the
// directions of the first bounce, each in an order of its own.
class CellSampler {
 public:
  CellSampler(const ViewSamples& view, const Cell& cell, std::uint32_t batch);
  Sample operator()(std::uint32_t number, RayCounts& counts) const;

 private:
  // Returns the position of a number in an order of the batch's samples.
  std::uint32_t shuffled(std::uint32_t number, std::size_t order) const;

  const ViewSamples& view_;
  const Cell& cell_;
  StreamKey name_;
  std::array<std::uint32_t, 4> words_{};  // at random, two for each order
};

// Work of one thread: samples [first, first + count) of the cells [begin, end).
struct Unit {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};
// Returns units of some thousand samples, whatever the number of threads.
std::vector<Unit> units_of(std::size_t cells, std::uint32_t batch_samples);

// Batches so far, of the image and of its total.
class Batches {
 public:
  virtual ~Batches() = default;

  Job job;  // polled while rays are traced: add() throws Cancelled

  virtual void add(std::uint32_t batches) = 0;
  // Sets radiance, coverage and standard errors. Expects: layers of their size, all 0.
  virtual void write(ReferenceImage& result) const = 0;

  std::uint32_t batches() const { return batches_; }
  const RunningStatistics& total() const { return total_; }
  const RayCounts& counts() const { return counts_; }

 protected:
  std::uint32_t batches_ = 0;
  RunningStatistics total_{1};
  RayCounts counts_;
};

// Makes batches whose pixels are means over their squares.
//
//   weights  of each cell's pixel in the total
std::unique_ptr<Batches> box_batches(const ViewSamples& view, std::span<const Cell> cells,
                                     std::vector<double> weights);

// The same for the image convolved with a Gaussian. The requested image lies `margin` pixels within
// that of the view.
//
//   weight  of a pixel of the requested image in the total, by column and row
std::unique_ptr<Batches> blurred_batches(
    const ViewSamples& view, std::span<const Cell> cells, double sigma, std::uint32_t margin,
    std::function<double(std::uint32_t, std::uint32_t)> weight);
// Returns the reach of a blur, pixels.
std::uint32_t blur_margin(double sigma);

}  // namespace panwright::preview::reference
