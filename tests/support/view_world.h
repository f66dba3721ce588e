// Worlds of one target, for tests that draw one view by both renderers.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "pan/model.h"
#include "tests/support/view.h"
#include "world/world.h"

namespace panwright::testing_support {

// Wraps a model for worlds. The second copies a model owned elsewhere.
inline world::ModelPtr shared(pan::Model&& model) {
  return std::make_shared<const pan::Model>(std::move(model));
}
inline world::ModelPtr shared(const pan::Model& model) {
  DiagnosticLog log;
  auto copy = pan::Model::from_bytes(model.bytes(), model.name(), log);
  EXPECT_TRUE(copy && copy->check(log)) << to_text(log);
  return shared(std::move(*copy));
}

// The Sun of a view.
inline world::Sun sun_of(const preview::View& view) {
  world::Sun sun;
  sun.direction = view.to_sun;
  sun.distance = view.sun_distance;
  sun.irradiance = view.sun_irradiance;
  return sun;
}

// As preview::world_of, of a copy of a model.
inline world::World world_of(const pan::Model& model, const preview::View& view) {
  return preview::world_of(shared(model), view);
}

}  // namespace panwright::testing_support
