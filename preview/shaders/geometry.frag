// What is seen at a sample: its normal and its instance. Light comes later, once for each sample
// and not once for each of the many fragments that small triangles throw away. Defined in front:
// version, and any of TINTED TEXTURED COLOURED FLAT.
layout(std140, binding = 1) uniform Draw {
  mat4 clip_from_mesh;
  mat3 world_normal_from_mesh;
  uvec4 id;  // x: item + 1
}
draw;

#ifdef FLAT
layout(binding = 1) uniform samplerBuffer triangle_normals;
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

// xyz: world normal of any length, on the side that is seen; w: item + 1, exact in a float
layout(location = 0) out vec4 seen;
#ifdef TINTED
layout(location = 1) out vec4 tint;  // multiplies the diffuse colour
#endif

void main() {
#ifdef FLAT
  vec3 normal = texelFetch(triangle_normals, gl_PrimitiveID).xyz;
#else
  // a linear map may come after the interpolation, where several threads share the work
  vec3 normal = mesh_normal;
#endif
  normal = draw.world_normal_from_mesh * normal;
  // the back of an open mesh is as good as its front
  seen = vec4(gl_FrontFacing ? normal : -normal, float(draw.id.x));
#ifdef TINTED
  vec3 colour = vec3(1.0);
#ifdef TEXTURED
  colour *= texture(diffuse_map, surface_texcoord).rgb;
#endif
#ifdef COLOURED
  colour *= surface_colour;
#endif
  tint = vec4(colour, 1.0);
#endif
}
