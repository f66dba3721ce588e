// Where the sample stands that is shaded: at its place in the window, or in one of many blocks of N×N
// that are shaded one behind the other, each the samples of one pixel.
ivec2 sample_place() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  if (sample_blocks.y == 0u) return here;
  uvec2 block = uvec2(here) / sample_blocks.x;
  uint pixel = texelFetch(pixel_places, int(block.y * sample_blocks.y + block.x)).x;
  return ivec2(uvec2(pixel & 0xffffu, pixel >> 16) * sample_blocks.x + uvec2(here) - block * sample_blocks.x);
}
