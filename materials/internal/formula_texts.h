// Formula files as GLSL, embedded at build time. Private to materials.
#pragma once

namespace panwright::materials {

#include "materials/internal/generated/formula_externs.inl"

}  // namespace panwright::materials
