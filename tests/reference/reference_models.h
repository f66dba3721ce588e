// Views, and measurements of the reference renderer's images.
#pragma once

#include <cmath>

#include "preview/reference/reference.h"
#include "tests/preview_gl/models.h"
#include "tests/support/view_world.h"

namespace panwright::preview::testing_support {

inline ReferenceImage traced(const world::World& world, const world::Camera& camera,
                             const ReferenceOptions& options = {}) {
  DiagnosticLog log;
  Reference reference;
  auto image = reference.render(world, camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return std::move(*image);
}

inline ReferenceImage traced(const pan::Model& model, const View& view,
                             const ReferenceOptions& options = {}, double limb_darkening = 0) {
  world::World world = panwright::testing_support::world_of(model, view);
  world::Sun sun = world.sun();
  sun.limb_darkening = limb_darkening;
  world.set_sun(sun);
  return traced(world, view.camera, options);
}

inline ReferenceOptions direct_light(std::uint32_t samples) {
  ReferenceOptions options;
  options.samples = samples;
  options.bounces = 0;
  options.sun_disc = false;
  return options;
}

}  // namespace panwright::preview::testing_support
