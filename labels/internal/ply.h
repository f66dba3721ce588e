// Models as PLY files. Private to labels.
#pragma once

#include <string>

#include "base/job.h"
#include "base/math.h"
#include "pan/model.h"

namespace panwright::labels {

struct PlyModel {
  std::string bytes;    // binary little-endian: x y z nx ny nz, triangles
  Vec3 least{0};        // of all vertices, in its unit
  Vec3 most{0};         // likewise
  double diameter = 0;  // largest distance of two vertices
};

// The model in its own frame, joints at their initial values, without levels of detail.
//
//   unit  in a metre
// Expects: checked(). Throws Cancelled.
PlyModel ply_of(const pan::Model& model, double unit, const Job& job);

}  // namespace panwright::labels
