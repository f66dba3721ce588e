// Every formula in C++, inline, as f32 and as f64. Private to materials; only tests and benches
// call single formulas, all others use materials/brdf.h.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "base/math.h"
#include "materials/hapke_h.h"
#include "materials/material.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
// BRDFs share one list of parameters
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

namespace panwright::materials::f32 {
using Real = float;
using Vec3 = glm::vec3;
#include "materials/internal/formulas.inl"
}  // namespace panwright::materials::f32

namespace panwright::materials::f64 {
using Real = double;
using Vec3 = glm::dvec3;
#include "materials/internal/formulas.inl"
}  // namespace panwright::materials::f64

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
