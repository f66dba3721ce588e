// Views, and what tests of the reference renderer measure on its images.
#pragma once

#include <cmath>

#include "preview/reference/reference.h"
#include "tests/preview_gl/models.h"

namespace panwright::preview::testing_support {

inline ReferenceImage traced(const pan::Model& model, const View& view,
                             const ReferenceOptions& options = {}) {
  DiagnosticLog log;
  const auto reference = Reference::create(model, log);
  EXPECT_TRUE(reference) << to_text(log);
  auto image = reference->render(view, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return std::move(*image);
}

inline ReferenceOptions direct_light(std::uint32_t samples) {
  ReferenceOptions options;
  options.samples = samples;
  options.bounces = 0;
  options.sun_disc = false;
  return options;
}

}  // namespace panwright::preview::testing_support
