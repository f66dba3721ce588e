// Which triangle of which instance is seen.
layout(std140, binding = 1) uniform Draw {
  mat4 clip_from_mesh;
  mat3 world_normal_from_mesh;
  uvec4 id;  // x: item + 1
}
draw;

layout(location = 0) out uvec2 triangle_id;

void main() { triangle_id = uvec2(draw.id.x, uint(gl_PrimitiveID)); }
