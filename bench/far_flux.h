// Mean flux over seeds of distant levels of detail, against the path-traced finest one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "image/image.h"
#include "pan/model.h"
#include "preview/renderer.h"
#include "tests/support/view.h"

namespace panwright::bench {

// Sum over the pixels of the second channel.
double flux_of(const image::Image& image);

// Traces the flux; only direct light unless bounces is above 0; nothing: not drawn.
std::optional<double> traced_flux(const world::World& world, const world::Camera& camera,
                                  std::uint32_t seed, unsigned bounces);

// Flux of one level in one view.
class FarFlux {
 public:
  // Draws, and adds the result beside the expected flux. level: 0 for the finest, k for the model's
  // k-th. False: not drawn.
  bool add(preview::Renderer& renderer, const world::World& world, const world::Camera& camera,
           const pan::Model& model, std::size_t level, unsigned samples, double wanted);
  std::uint32_t seeds() const { return seeds_; }
  // of: name of one sample per seed, "sheet"
  Row row(std::string case_name, std::string setting, const std::string& of, double must) const;

 private:
  double all_ = 0, wanted_ = 0, squares_ = 0;
  std::uint32_t seeds_ = 0;
  std::vector<double> seconds_;
};

}  // namespace panwright::bench
