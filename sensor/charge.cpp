#include "sensor/charge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace panwright::sensor {

namespace {

// Columns that one task takes: a cache line or two of each row.
constexpr std::size_t kColumns = 16;

template <class Body>
void for_columns(std::uint32_t width, const Body& body) {
  const std::size_t tasks = (width + kColumns - 1) / kColumns;
  parallel_for(tasks, [&](std::size_t task) {
    body(task * kColumns, std::min<std::size_t>(width, (task + 1) * kColumns));
  });
}

}  // namespace

void add_smear(std::span<double> electrons, std::uint32_t width, const Smear& smear) {
  const std::size_t height = electrons.size() / width;
  for_columns(width, [&](std::size_t begin, std::size_t end) {
    double sum[kColumns] = {};  // with a flush: of the rows below
    if (!smear.flush)
      for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = begin; x < end; ++x) sum[x - begin] += electrons[y * width + x];
    for (std::size_t y = height; y-- > 0;)
      for (std::size_t x = begin; x < end; ++x) {
        double& q = electrons[y * width + x];
        const double own = q;
        const double others = smear.flush ? sum[x - begin] : sum[x - begin] - own;
        q = own + smear.ratio * others;
        if (smear.flush) sum[x - begin] += own;
      }
  });
}

void remove_smear(std::span<double> electrons, std::uint32_t width, const Smear& smear) {
  const std::size_t height = electrons.size() / width;
  const double rows = static_cast<double>(height);
  for_columns(width, [&](std::size_t begin, std::size_t end) {
    double sum[kColumns] = {};
    if (!smear.flush) {
      for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = begin; x < end; ++x) sum[x - begin] += electrons[y * width + x];
      for (double& each : sum) each /= 1 + (rows - 1) * smear.ratio;
    }
    for (std::size_t y = height; y-- > 0;)
      for (std::size_t x = begin; x < end; ++x) {
        double& q = electrons[y * width + x];
        if (smear.flush) {
          q -= smear.ratio * sum[x - begin];
          sum[x - begin] += q;
        } else {
          q = (q - smear.ratio * sum[x - begin]) / (1 - smear.ratio);
        }
      }
  });
}

double bloom(std::span<double> electrons, std::uint32_t width, double full_well) {
  const std::size_t height = electrons.size() / width;
  const double well = std::floor(full_well);
  std::vector<double> lost(width, 0.0);
  for_columns(width, [&](std::size_t begin, std::size_t end) {
    std::vector<double> up(height), down(height);
    for (std::size_t x = begin; x < end; ++x) {
      bool full = false;
      for (std::size_t y = 0; y < height; ++y) full |= electrons[y * width + x] > well;
      if (!full) continue;
      for (std::size_t y = 0; y < height; ++y) {
        double& q = electrons[y * width + x];
        const double excess = std::max(q - well, 0.0);
        q -= excess;
        up[y] = std::floor(0.5 * excess);
        down[y] = excess - up[y];
      }
      double flow = 0;
      const auto pass = [&](std::size_t y) {
        double& q = electrons[y * width + x];
        const double taken = std::min(flow, well - q);
        q += taken;
        flow -= taken;
      };
      for (std::size_t y = height; y-- > 0;) {
        pass(y);
        flow += up[y];
      }
      for (std::size_t y = 0; y < height; ++y) {
        pass(y);
        flow += down[y];
      }
      lost[x] = flow;
    }
  });
  double sum = 0;
  for (const double each : lost) sum += each;
  return sum;
}

}  // namespace panwright::sensor
