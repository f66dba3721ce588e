#include "materials/brdf.h"

#include "materials/internal/formulas.h"

namespace panwright::materials {

namespace f32 {
#include "materials/internal/evaluation.inl"
}  // namespace f32

namespace f64 {
#include "materials/internal/evaluation.inl"
}  // namespace f64

}  // namespace panwright::materials
