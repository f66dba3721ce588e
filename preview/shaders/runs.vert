// Rectangles of pixels as rectangles of samples, at one depth: two triangles each.
layout(location = 0) uniform uvec2 side_and_first;  // x: N; y: the first rectangle
layout(location = 1) uniform vec2 scale;             // 2 / samples of the window
layout(location = 2) uniform float depth;
layout(binding = 19) uniform usamplerBuffer rectangles;  // x | y << 16, width | height << 16

void main() {
  uvec2 one = texelFetch(rectangles, int(side_and_first.y) + gl_VertexID / 6).xy;
  int corner = gl_VertexID % 6;
  uvec2 at = uvec2(one.x & 0xffffu, one.x >> 16);
  at.x += (corner == 1 || corner == 2 || corner == 4) ? one.y & 0xffffu : 0u;
  at.y += (corner == 2 || corner == 4 || corner == 5) ? one.y >> 16 : 0u;
  gl_Position = vec4(vec2(at * side_and_first.x) * scale - 1.0, depth, 1.0);
}
