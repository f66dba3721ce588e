// Files of preview/shaders, embedded at build time. Private to preview.
#pragma once

namespace panwright::preview {

extern const char* const uniforms_glsl;
extern const char* const draw_glsl;
extern const char* const cutout_glsl;
extern const char* const model_vert;
extern const char* const screen_vert;
extern const char* const classes_frag;
extern const char* const geometry_frag;
extern const char* const shading_frag;
extern const char* const ids_frag;
extern const char* const decal_frag;
extern const char* const bare_frag;
extern const char* const all_samplers_frag;
extern const char* const shadow_glsl;
extern const char* const wide_lobes_glsl;
extern const char* const planets_glsl;
extern const char* const indirect_glsl;
extern const char* const sample_normal_glsl;
extern const char* const sample_position_glsl;
extern const char* const shadow_frag;
extern const char* const sample_place_glsl;
extern const char* const turning_glsl;
extern const char* const resolve_frag;
extern const char* const runs_vert;
extern const char* const nothing_frag;

}  // namespace panwright::preview
