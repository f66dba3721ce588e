// The files of materials/formulas as GLSL, embedded at build time. Private to materials.
#pragma once

namespace panwright::materials {

extern const char* const parameters_text;
extern const char* const common_text;
extern const char* const fresnel_text;
extern const char* const lambert_text;
extern const char* const oren_nayar_text;
extern const char* const hapke_text;
extern const char* const eon_text;
extern const char* const lommel_seeliger_text;
extern const char* const no_specular_text;
extern const char* const blinn_phong_text;
extern const char* const cook_torrance_text;
extern const char* const facets_text;
extern const char* const coat_text;
extern const char* const cells_text;
extern const char* const surface_text;

}  // namespace panwright::materials
