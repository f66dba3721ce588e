// Runs of pixels as rectangles of samples, at one depth: two triangles each. Defined in front: version,
// uniforms.glsl.

void main() {
  uvec2 run = texelFetch(pixel_places, gl_VertexID / 6).xy;
  int corner = gl_VertexID % 6;
  uvec2 at = uvec2(run.x & 0xffffu, run.x >> 16);
  at.x += (corner == 1 || corner == 2 || corner == 4) ? run.y : 0u;
  at.y += (corner == 2 || corner == 4 || corner == 5) ? 1u : 0u;
  gl_Position = vec4(vec2(at * samples_a_side) * run_scale - 1.0, screen_depth, 1.0);
}
