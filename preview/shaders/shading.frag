// The radiance of what is seen, towards the camera. Defined in front: version, any of PAINTED
// ROUGH BRUSHED REFLECTING ONE_MATERIAL, sample_place.glsl, SHADOWED (with shadow.glsl), and the
// formulas of its BRDF model (materials/formulas), with what reads a material (materials/formula_text.h).

layout(std140, binding = 0) uniform View {
  vec4 view_ray;        // world direction through the tile's upper left corner, any length
  vec4 view_ray_right;  // its change from sample to sample
  vec4 view_ray_down;
  vec4 to_sun;      // world, unit; w: what its disc adds to the squares of alpha
  vec4 irradiance;  // RGB; w: above 0 where one sample stands for many
}
view;

// of the target that this pass shades: its first item
layout(location = 0) uniform uvec4 range;
layout(binding = 5) uniform usamplerBuffer items;  // x: material, y: class
#ifndef SHADOWED
layout(binding = 2) uniform sampler2D normal_samples;  // as geometry.frag leaves them
#endif
#ifdef PAINTED
layout(binding = 3) uniform sampler2D albedo_samples;
#endif
#ifdef ROUGH
layout(binding = 6) uniform sampler2D roughness_samples;
#endif
#ifdef BRUSHED
layout(binding = 15) uniform sampler2D brushes;
#endif

#ifdef REFLECTING
layout(binding = 17) uniform sampler2D reflectances;
#endif

#ifdef ONE_MATERIAL
const int first_row = 0;
// a material record of a pan file as it stands
layout(std140, binding = 2) uniform MaterialRecord { vec4 rows[kMaterialRows]; }
material;
vec4 material_row(int i) { return material.rows[i]; }
#else
layout(binding = 4) uniform samplerBuffer materials;  // kMaterialRows texels a record
vec4 material_row(int i) { return texelFetch(materials, i); }
#endif

layout(location = 0) out vec4 radiance;
// what classify.frag compares: the largest channel; of solar cells, whose pattern is filtered to the
// sample already, what a surface of albedo 1/2 would show
layout(location = 1) out float light;

// Zero stays zero: such a point is not lit, and never a NaN.
vec3 unit_or_zero(vec3 v) {
  float square = dot(v, v);
  return square > 0.0 ? v * inversesqrt(square) : vec3(0.0);
}

#ifdef SHADOWED
// What is left where the Sun does not shine.
vec3 shaded_radiance(Surface surface) {
  return view.irradiance.rgb * surface.emissive * (surface.weights.z * 0.31830988618379067);
}
#endif

#ifdef ROUGH
// What a roughness map says, and the bumps that a sample is too large to show. Lambert's law is
// linear in the normal, so the length of the mean normal gives their mean; microfacets on bumps
// have the squared slopes of both. A Blinn-Phong lobe is as wide as one of slopes 2 / (shine + 2).
void roughen(inout Surface surface, float length_of_mean, vec2 roughness_sample) {
  surface.diffuse *= length_of_mean;
  surface.oren *= roughness_sample.x;
  // floor: what the Sun's disc blurs is 50 times as much
  float slope = max(surface.alpha_x * roughness_sample.x, min(surface.alpha_x, 1e-4));
  surface.alpha_x = roughness_sample.y > 0.0 ? sqrt(slope * slope + roughness_sample.y) : slope;
  slope = max(surface.alpha_y * roughness_sample.x, min(surface.alpha_y, 1e-4));
  surface.alpha_y = roughness_sample.y > 0.0 ? sqrt(slope * slope + roughness_sample.y) : slope;
  if (roughness_sample.y > 0.0)
    surface.shine = max(2.0 / (2.0 / (surface.shine + 2.0) + roughness_sample.y) - 2.0, 0.0);
}
#endif

void main() {
  ivec2 place = sample_place();
  vec4 normal_sample = texelFetch(normal_samples, place, 0);
  // note: what is here belongs to the class of this pass, by the depth test (classes.frag)
#ifndef ONE_MATERIAL
  int item = abs(int(normal_sample.w)) - 1 - int(range.x);
  int first_row = kMaterialRows * int(texelFetch(items, item).x);
#endif

  // the line of sight of this sample, free of where the surface is and how far
  vec3 view_ray = view.view_ray.xyz + (float(place.x) + 0.5) * view.view_ray_right.xyz +
               (float(place.y) + 0.5) * view.view_ray_down.xyz;
  vec3 to_viewer = -normalize(view_ray);

  Surface surface = surface_of(first_row, view.to_sun.w);
#ifdef PAINTED
  vec4 albedo = texelFetch(albedo_samples, place, 0);
  surface.diffuse = albedo.rgb;
#endif
#ifdef ROUGH
  vec4 roughness_sample = texelFetch(roughness_samples, place, 0);
  roughen(surface, albedo.a, roughness_sample.xy);
  // of solar cells the paint has the colour of cells and fingers, weights included
  bool has_cells = material_cell_count(first_row).x > 0.0;
  if (has_cells) {
    surface.weights.x = 1.0;
    surface.weights.y *= roughness_sample.w;
  }
#endif

#ifdef REFLECTING
  surface.reflectance = texelFetch(reflectances, place, 0).rgb;
#endif
#ifdef BRUSHED
  vec3 brush = unit_or_zero(texelFetch(brushes, place, 0).xyz);
  vec3 facing = unit_or_zero(normal_sample.xyz);
  surface.tangent = unit_or_zero(brush - facing * dot(facing, brush));
#endif

  // where the normal faces away from the viewer, at the limb of a smooth mesh, surface_brdf takes
  // the viewer to the horizon
  radiance = vec4(surface_radiance(surface, view.to_sun.xyz, to_viewer, unit_or_zero(normal_sample.xyz),
                                   view.irradiance.rgb),
                  1.0);
#ifdef ROUGH
  // Lambert's gaps between cells, without cover glass
  if (has_cells) {
    float lit = max(dot(unit_or_zero(normal_sample.xyz), view.to_sun.xyz), 0.0) * 0.31830988618379067;
    radiance.rgb = roughness_sample.z * radiance.rgb + (1.0 - roughness_sample.z) * (lit * albedo.a) *
                                                material_gap_color(first_row) * view.irradiance.rgb;
  }
#endif
  float visibility = 1.0;
#ifdef SHADOWED
  if (dot(normal_sample.xyz, view.to_sun.xyz) > 0.0) {
    visibility = sun_visibility(place);
    radiance.rgb = mix(shaded_radiance(surface), radiance.rgb, visibility);
  }
#endif
  light = max(radiance.r, max(radiance.g, radiance.b));
#ifdef ROUGH
  // a pattern that one sample means over its box of texcoords: wider than the pixel, where aslant
  if (has_cells) light *= 4.0;
#endif
#ifdef SHADOWED
  // far from all light there is: the pixel gets all its samples
  if (view.irradiance.w > 0.0 && blocks.y == 0u && dot(normal_sample.xyz, view.to_sun.xyz) > 0.0 &&
      sun_varies(place, abs(int(normal_sample.w))))
    light = 1e30;
#endif
}
