// The radiance of what is seen, towards the camera. Defined in front: version, any of PAINTED
// ROUGH ONE_MATERIAL, PAIR (the number of this pair of laws), and the pair's formulas (materials/formulas).

layout(std140, binding = 0) uniform View {
  vec4 sight;        // world direction through the tile's upper left corner, any length
  vec4 sight_right;  // its change from sample to sample
  vec4 sight_down;
  vec4 to_sun;      // world, unit
  vec4 irradiance;  // RGB
}
view;

layout(binding = 2) uniform sampler2D seen_samples;  // as geometry.frag leaves them
#ifdef PAINTED
layout(binding = 3) uniform sampler2D paints;
#endif
#ifdef ROUGH
layout(binding = 6) uniform sampler2D roughs;
#endif

#ifdef ONE_MATERIAL
// a material record of a pan file as it stands
layout(std140, binding = 2) uniform MaterialRecord { vec4 rows[10]; }
material;
#define ROW(i) material.rows[i]
#else
layout(binding = 4) uniform samplerBuffer materials;  // ten texels a record
layout(binding = 5) uniform usamplerBuffer items;     // x: material, y: pair of laws
#define ROW(i) texelFetch(materials, first_row + i)
#endif

layout(location = 0) out vec4 radiance;

// Zero stays zero: such a point is not lit, and never a NaN.
vec3 unit_or_zero(vec3 v) {
  float square = dot(v, v);
  return square > 0.0 ? v * inversesqrt(square) : vec3(0.0);
}

#ifdef ROUGH
// What a roughness map says, and the bumps that a sample is too large to show. Lambert's law is
// linear in the normal, so the length of the mean normal gives their mean; mirror facets on bumps
// have the squared slopes of both. A Blinn-Phong lobe is as wide as one of slopes 2 / (shine + 2).
void roughen(inout Surface surface, float length_of_mean, vec2 rough) {
  surface.diffuse *= length_of_mean;
  surface.oren *= rough.x;
  // floor: what the Sun's disc blurs is 50 times as much
  float slope = max(surface.cook_m * rough.x, min(surface.cook_m, 1e-4));
  surface.cook_m = rough.y > 0.0 ? sqrt(slope * slope + rough.y) : slope;
  if (rough.y > 0.0)
    surface.shine = max(2.0 / (2.0 / (surface.shine + 2.0) + rough.y) - 2.0, 0.0);
}
#endif

void main() {
  vec4 seen = texelFetch(seen_samples, ivec2(gl_FragCoord.xy), 0);
  int item = int(seen.w) - 1;
  if (item < 0) discard;
#ifndef ONE_MATERIAL
  uvec4 of_item = texelFetch(items, item);
  if (of_item.y != PAIR) discard;
  int first_row = 10 * int(of_item.x);
#endif

  // the line of sight of this sample, free of where the surface is and how far
  vec3 sight = view.sight.xyz + gl_FragCoord.x * view.sight_right.xyz +
               gl_FragCoord.y * view.sight_down.xyz;
  vec3 to_viewer = -normalize(sight);

  vec4 diffuse = ROW(0);
  vec4 specular = ROW(1);
  vec4 emissive = ROW(2);
  vec4 refract_shine = ROW(3);
  vec4 cook = ROW(4);
  vec4 hapke = ROW(5);
  Surface surface;
  surface.diffuse = diffuse.rgb;
#ifdef PAINTED
  vec4 paint = texelFetch(paints, ivec2(gl_FragCoord.xy), 0);
  surface.diffuse = paint.rgb;
#endif
  surface.specular = specular.rgb;
  surface.emissive = emissive.rgb;
  surface.weights = vec3(diffuse.a, specular.a, emissive.a);
  surface.indices = refract_shine.rgb;
  surface.shine = refract_shine.a;
  surface.cook_d = cook.x;
  surface.cook_m = cook.y;
  surface.cook_f = cook.z;
  surface.cook_g = cook.w;
  surface.oren = ROW(6).x;
  surface.hapke_w = hapke.x;
  surface.hapke_h = hapke.y;
  surface.hapke_b0 = hapke.z;
  surface.hapke_rough = hapke.w;
  // level 0 of the language has isotropic particles
  surface.hapke_b = 0.0;
  surface.hapke_c = 0.0;
#ifdef ROUGH
  roughen(surface, paint.a, texelFetch(roughs, ivec2(gl_FragCoord.xy), 0).xy);
#endif

  // where the normal faces away from the viewer, at the limb of a smooth mesh, surface_brdf takes
  // the viewer to the horizon
  radiance = vec4(surface_radiance(surface, view.to_sun.xyz, to_viewer, unit_or_zero(seen.xyz),
                                   view.irradiance.rgb),
                  1.0);
}
