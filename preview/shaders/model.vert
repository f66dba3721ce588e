// The vertices of one instance. Defined in front: version, uniforms.glsl, draw.glsl, and any of GEOMETRY TEXTURED
// COLOURED FLAT MAPPED BUMPED TANGENTS CELLS DECAL PLACED.
layout(location = kPositionAttribute) in vec3 position;  // metres, relative to the mesh's origin
layout(location = kNormalAttribute) in vec3 normal;    // mesh frame
layout(location = kTexcoordAttribute) in vec2 texcoord;
layout(location = kColorAttribute) in vec3 color;
layout(location = kTangentAttribute) in vec4 tangent;  // mesh frame; w: -1 where the texture is mirrored

#ifdef GEOMETRY
#ifndef FLAT
layout(location = 0) out vec3 mesh_normal;
#endif
#ifdef TEXTURED
layout(location = 1) out vec2 surface_texcoord;
#endif
#ifdef COLOURED
layout(location = 2) out vec3 surface_color;
#endif
#endif
#ifdef MAPPED
layout(location = 3) out vec2 map_texcoord;
#endif
#ifdef TANGENTS
layout(location = 4) out vec4 mesh_tangent;
#endif
#ifdef CELLS
layout(location = 9) out vec2 cell_place;
#endif

#ifdef PLACED
layout(location = 7) out vec3 place_in_target;
#endif

#ifdef DECAL
DECAL_BLOCK
layout(location = 5) out vec3 decal_place;
layout(location = 6) out float decal_facing;
#endif

// so far out that a float holds no fraction of a texel, and no infinity comes of it
const float kFarOut = 1e9;

// all programs put a vertex on the same spot
invariant gl_Position;

void main() {
#ifdef INSTANCED
  draw_index = gl_InstanceID;
#endif
  gl_Position = draw.clip_from_mesh * vec4(position, 1.0);
#ifdef GEOMETRY
#ifndef FLAT
  mesh_normal = normal;
#endif
#ifdef TEXTURED
  surface_texcoord = clamp(texcoord, vec2(-kFarOut), vec2(kFarOut));
#endif
#ifdef COLOURED
  surface_color = color;
#endif
#endif
#ifdef MAPPED
  map_texcoord = clamp(texcoord * draw.repeat, vec2(-kFarOut), vec2(kFarOut));
#endif
#ifdef CELLS
  cell_place = clamp(texcoord * draw.cell_count, vec2(-kFarOut), vec2(kFarOut));
#endif
#ifdef TANGENTS
  mesh_tangent = tangent;
#endif
#ifdef PLACED
  for (int row = 0; row < 3; ++row)
    place_in_target[row] = dot(draw.sample_from_mesh[row], vec4(position, 1.0));
#endif
#ifdef DECAL
  vec4 at = vec4(position, 1.0);
  decal_place = vec3(dot(decal.place[0], at), dot(decal.place[1], at), dot(decal.place[2], at));
  decal_facing = dot(decal.outwards, normal);
#endif
}
