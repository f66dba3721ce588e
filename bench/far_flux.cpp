#include "bench/far_flux.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/clock.h"
#include "preview/reference/reference.h"

namespace panwright::bench {

double flux_of(const image::Image& image) {
  double sum = 0;
  for (std::size_t i = 1; i < image.radiance.size(); i += 3)
    sum += static_cast<double>(image.radiance[i]);
  return sum;
}

std::optional<double> traced_flux(const world::World& world, const world::Camera& camera,
                                  std::uint32_t seed, unsigned bounces) {
  DiagnosticLog log;
  preview::ReferenceOptions options;
  options.samples = 16;
  options.bounces = bounces;
  options.seed = seed;
  const auto traced = preview::Reference().render(world, camera, options, log);
  if (!traced) return std::nullopt;
  return flux_of(traced->image);
}

bool FarFlux::add(preview::Renderer& renderer, const world::World& world,
                  const world::Camera& camera, const pan::Model& model, std::size_t level,
                  unsigned samples, double wanted) {
  DiagnosticLog log;
  preview::RenderOptions options;
  options.samples = samples;
  options.level_pixel = level == 0 ? 0 : model.levels()[level - 1].detail;
  const auto start = std::chrono::steady_clock::now();
  const auto image = renderer.render(world, camera, options, log);
  if (!image) return false;
  const double got = flux_of(*image);
  seconds_.push_back(seconds_since(start));
  all_ += got;
  wanted_ += wanted;
  squares_ += (got - wanted) * (got - wanted);
  ++seeds_;
  return true;
}

Row FarFlux::row(std::string case_name, std::string setting, const std::string& of,
                 double must) const {
  const double mean = (all_ - wanted_) / seeds_;
  // of one, from the sample
  const double deviation =
      std::sqrt(std::max(squares_ - seeds_ * mean * mean, 0.0) / std::max(seeds_ - 1, 1u)) *
      seeds_ / wanted_;
  Row out{.case_name = std::move(case_name),
          .setting = std::move(setting),
          .speed_unit = "ms/frame",
          .error = std::fabs(all_ / wanted_ - 1),
          .error_unit = fmt::format("flux, mean of {}s", of),
          .reference = fmt::format("finest {0}s, path traced; {1} seeds; {2}; one {0} {3:.2g}", of,
                                   seeds_, all_ < wanted_ ? "too dark" : "too bright", deviation),
          .reference_error = deviation / std::sqrt(seeds_),
          .must_error = must};
  std::vector<double> sorted = seconds_;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  set_time(out, {at(0.5), at(0.25), at(0.75), static_cast<int>(sorted.size())}, 1e3);
  return out;
}

}  // namespace panwright::bench
