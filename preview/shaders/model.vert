// The vertices of one instance. Defined in front: version, and any of GEOMETRY TEXTURED COLOURED FLAT.
layout(location = 0) in vec3 position;  // metres, relative to the mesh's origin
layout(location = 1) in vec3 normal;    // mesh frame
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec3 colour;

// formed in double for each view and tile, rounded once
layout(std140, binding = 1) uniform Draw {
  mat4 clip_from_mesh;
  mat3 world_normal_from_mesh;
  uvec4 id;  // x: item + 1
}
draw;

#ifdef GEOMETRY
#ifndef FLAT
layout(location = 0) out vec3 mesh_normal;
#endif
#ifdef TEXTURED
layout(location = 1) out vec2 surface_texcoord;
#endif
#ifdef COLOURED
layout(location = 2) out vec3 surface_colour;
#endif
#endif

// all programs put a vertex on the same spot
invariant gl_Position;

void main() {
  gl_Position = draw.clip_from_mesh * vec4(position, 1.0);
#ifdef GEOMETRY
#ifndef FLAT
  mesh_normal = normal;
#endif
#ifdef TEXTURED
  surface_texcoord = texcoord;
#endif
#ifdef COLOURED
  surface_colour = colour;
#endif
#endif
}
