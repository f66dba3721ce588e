// Runs of pixels as rectangles of samples, at one depth: two triangles each.
layout(location = 0) uniform uvec2 side_and_first;  // x: N; y: the first run
layout(location = 1) uniform vec2 scale;             // 2 / samples of the window
layout(location = 2) uniform float depth;
layout(binding = 19) uniform usamplerBuffer runs;  // x | y << 16, pixels

void main() {
  uvec2 run = texelFetch(runs, int(side_and_first.y) + gl_VertexID / 6).xy;
  int corner = gl_VertexID % 6;
  uvec2 at = uvec2(run.x & 0xffffu, run.x >> 16);
  at.x += (corner == 1 || corner == 2 || corner == 4) ? run.y : 0u;
  at.y += (corner == 2 || corner == 4 || corner == 5) ? 1u : 0u;
  gl_Position = vec4(vec2(at * side_and_first.x) * scale - 1.0, depth, 1.0);
}
