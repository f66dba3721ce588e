// Where the sample stands that is shaded: at its place in the window, or in one of many blocks of N×N
// that are shaded one behind the other, each the samples of one pixel.
layout(location = 2) uniform uvec2 blocks;          // x: N; y: blocks a row, 0: in its place
layout(binding = 19) uniform usamplerBuffer pixels;  // of the blocks: x | y << 16

ivec2 sample_place() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  if (blocks.y == 0u) return here;
  uvec2 block = uvec2(here) / blocks.x;
  uint pixel = texelFetch(pixels, int(block.y * blocks.y + block.x)).x;
  return ivec2(uvec2(pixel & 0xffffu, pixel >> 16) * blocks.x + uvec2(here) - block * blocks.x);
}
