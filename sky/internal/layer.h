// Bodies of one side of the targets of an image. Private to sky.
#pragma once

#include <vector>

#include "base/job.h"
#include "sky/sky.h"
#include "world/camera.h"

namespace panwright::sky {

struct Layer {
  std::vector<float> light, cover;  // three bands; cover: of one side alone
};

// The bodies of a side of the depths, or all.
//
//   depths    height·width; null: all bodies
//   coverage  as of backdrop()
Layer layer(const Sky& sky, const world::Camera& camera, double psf_sigma,
            const std::vector<float>* depths, bool before, const Job& job,
            const std::vector<float>* coverage = nullptr);

}  // namespace panwright::sky
