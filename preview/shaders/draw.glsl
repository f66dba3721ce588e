// What is known of an instance in one view and tile, formed in double and rounded once. Defined in
// front where instances of one mesh and material are drawn at once: INSTANCED; and VERTEX.
struct DrawData {
  mat4 clip_from_mesh;
  mat3 world_normal_from_mesh;
  // x: item + 1; y, z: samples of the image left of and above the tile; w: 1 where shadows are those
  // of the triangles as they stand
  uvec4 id;
  vec4 diffuse;  // colour of the material; a: parts a side in which cells are averaged
  vec4 repeat;   // x, y: multiply the texcoords of maps; z, w: their signs
  vec4 cells;    // x, y: cells in one unit of texcoords; z, w: gaps, parts of their pitch
  vec4 gap_color;     // RGB; a: fingers on a cell
  vec4 finger_color;  // RGB; a: part of their pitch that they cover
  vec4 sun_from_mesh[3];  // rows: the position in light space (light_space.h)
  mat3 sun_normal_from_mesh;
  vec4 normal_offset;  // x: how far a point is moved out before it is lit, mesh frame; y, z, w: the share of
              // diffuse light that the glass over cells sends back
  vec4 tiles[12];  // of the shadow map: the position there, times w, plus xyz; see light_space.glsl
  // 512 bytes: a multiple of what any context aligns blocks to
};
#ifdef INSTANCED
layout(std140, binding = 1) uniform Draws { DrawData draws[32]; };
#ifdef VERTEX
layout(location = 10) flat out int draw_index;
#define draw draws[gl_InstanceID]
#else
layout(location = 10) flat in int draw_index;
#define draw draws[draw_index]
#endif
#else
layout(std140, binding = 1) uniform Draw { DrawData draw; };
#endif
