// Lenses of tests, and a sphere before them.
#pragma once

#include <memory>

#include "tests/reference/reference_models.h"

namespace panwright::preview::testing_support {

struct LensCase {
  const char* name;
  double focal;
  sensor::Distortion distortion;
};
inline const LensCase kLensCases[] = {
    {"brown", 90, sensor::Brown{{-.25, .08, 4e-3, -3e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, .02, .01}}},
    {"fisheye", 50, sensor::Fisheye{{-.02, .005}}},
    {"division", 60, sensor::Division{-.25}},
    {"CAHVOR", 80, sensor::Cahvore{.axis = glm::normalize(Vec3(.02, -.01, 1)), .r = {0, -.1, .02}}},
};

// View of a unit sphere at a place of the camera's axes.
inline View sphere_through(const LensCase& each, const Vec3& place) {
  View view = looking_from({0, -1, 0}, 10, 1, 128, 0.5);
  view.camera.focal = Vec2(each.focal);
  view.camera.world_from_camera = glm::angleAxis(kPi / 2, glm::normalize(Vec3(1, 2, 3)));
  view.camera.position = -(view.camera.world_from_camera * place);
  view.camera.distortion = std::make_shared<sensor::DistortionMap>(each.distortion);
  return view;
}

}  // namespace panwright::preview::testing_support
