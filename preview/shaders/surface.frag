// The radiance of a surface towards the camera. Defined in front: version, any of TEXTURED COLOURED
// FLAT, and the formulas of one pair of laws (materials/formulas).

layout(std140, binding = 0) uniform View {
  vec4 sight;        // world direction through the tile's upper left corner, any length
  vec4 sight_right;  // its change from sample to sample
  vec4 sight_down;
  vec4 to_sun;      // world, unit
  vec4 irradiance;  // RGB
}
view;

layout(std140, binding = 1) uniform Draw {
  mat4 clip_from_mesh;
  mat3 world_normal_from_mesh;
  uvec4 id;
}
draw;

// a material record of a pan file as it stands
layout(std140, binding = 2) uniform MaterialRecord {
  vec4 diffuse_weight;
  vec4 specular_weight;
  vec4 emissive_weight;
  vec4 refract_shine;
  vec4 cook;
  vec4 hapke;
  float oren;
}
material;

#ifdef FLAT
layout(std430, binding = 0) readonly buffer TriangleNormals { float triangle_normals[]; };
#else
layout(location = 0) in vec3 mesh_normal;
#endif
#ifdef TEXTURED
layout(binding = 0) uniform sampler2D diffuse_map;
layout(location = 1) in vec2 surface_texcoord;
#endif
#ifdef COLOURED
layout(location = 2) in vec3 surface_colour;
#endif

layout(location = 0) out vec4 radiance;

// Zero stays zero: such a point is not lit, and never a NaN.
vec3 unit_or_zero(vec3 v) {
  float square = dot(v, v);
  return square > 0.0 ? v * inversesqrt(square) : vec3(0.0);
}

void main() {
#ifdef FLAT
  int first = 3 * gl_PrimitiveID;
  vec3 normal = vec3(triangle_normals[first], triangle_normals[first + 1],
                     triangle_normals[first + 2]);
#else
  vec3 normal = mesh_normal;
#endif
  normal = unit_or_zero(draw.world_normal_from_mesh * normal);
  // the back of an open mesh is as good as its front
  if (!gl_FrontFacing) normal = -normal;

  // the line of sight of this sample, free of where the surface is and how far
  vec3 sight = view.sight.xyz + gl_FragCoord.x * view.sight_right.xyz +
               gl_FragCoord.y * view.sight_down.xyz;
  vec3 to_viewer = -normalize(sight);

  Surface surface;
  surface.diffuse = material.diffuse_weight.rgb;
#ifdef TEXTURED
  surface.diffuse *= texture(diffuse_map, surface_texcoord).rgb;
#endif
#ifdef COLOURED
  surface.diffuse *= surface_colour;
#endif
  surface.specular = material.specular_weight.rgb;
  surface.emissive = material.emissive_weight.rgb;
  surface.weights =
      vec3(material.diffuse_weight.a, material.specular_weight.a, material.emissive_weight.a);
  surface.indices = material.refract_shine.rgb;
  surface.shine = material.refract_shine.a;
  surface.cook_d = material.cook.x;
  surface.cook_m = material.cook.y;
  surface.cook_f = material.cook.z;
  surface.cook_g = material.cook.w;
  surface.oren = material.oren;
  surface.hapke_w = material.hapke.x;
  surface.hapke_h = material.hapke.y;
  surface.hapke_b0 = material.hapke.z;
  surface.hapke_rough = material.hapke.w;
  // level 0 of the language has isotropic particles
  surface.hapke_b = 0.0;
  surface.hapke_c = 0.0;

  // what lies where the normal faces away from the viewer, at the limb of a smooth mesh, is settled
  // in surface_brdf
  radiance = vec4(
      surface_radiance(surface, view.to_sun.xyz, to_viewer, normal, view.irradiance.rgb), 1.0);
}
