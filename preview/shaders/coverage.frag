// Which instance a sample sees, and its normal in brief: what tells whether the samples of a pixel
// see one thing. Defined in front: version, draw.glsl, FLAT, and CUTOUT with cutout.glsl.
#ifdef FLAT
layout(binding = 1) uniform samplerBuffer triangle_normals;
#else
layout(location = 0) in vec3 mesh_normal;
#endif

// x: item + 1, and in the upper 8 bits how much a normal may change within a pixel; y: the world
// normal on the octahedron
layout(location = 0) out uvec2 coverage;

void main() {
#ifdef FLAT
  vec3 normal = texelFetch(triangle_normals, gl_PrimitiveID).xyz;
#else
  vec3 normal = mesh_normal;
#endif
  normal = draw.world_normal_from_mesh * normal;
  normal = gl_FrontFacing ? normal : -normal;
  normal /= max(abs(normal.x) + abs(normal.y) + abs(normal.z), 1e-30);
  vec2 folded = (1.0 - abs(normal.yx)) * vec2(normal.x < 0.0 ? -1.0 : 1.0, normal.y < 0.0 ? -1.0 : 1.0);
  coverage = uvec2(draw.id.x | draw.id.w << 24, packSnorm2x16(normal.z < 0.0 ? folded : normal.xy));
#ifdef CUTOUT
  if (!is_there()) discard;
#endif
}
