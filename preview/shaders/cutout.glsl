// Whether a sample lies on the surface or in a hole of it.
layout(location = 3) in vec2 map_texcoord;

// lowbias32 by C. Wellons, 2018
uint scrambled(uint x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

// A number between 0 and 1 for each sample. Any aligned square of 2, 4 or 8 samples has one in each
// 4th, 16th or 64th of the range, at random within it (a nested scrambled van der Corput sequence
// along the Morton curve); squares and surfaces are independent of each other, but for surfaces of
// one instance that lie behind each other and face the same way.
float dither() {
  uvec2 at = uvec2(gl_FragCoord.xy) + view.first_sample;
  uint seed = scrambled((at.x >> 3) + scrambled((at.y >> 3) + scrambled(
                  2u * draw.id + uint(gl_FrontFacing))));
  uint flips[2] = uint[2](scrambled(seed ^ 0x9e3779b9u), scrambled(seed ^ 0x3c6ef372u));
  uint number = 0u;
  uint path = 1u;  // a node of the tree of halves: a leading 1, then the halves before scrambling
  for (int bit = 0; bit < 6; ++bit) {
    uint half_of = ((bit & 1) == 0 ? at.x : at.y) >> (bit >> 1) & 1u;
    number = 2u * number + (half_of ^ (flips[path >> 5] >> (path & 31u) & 1u));
    path = 2u * path + half_of;
  }
  uint rest = scrambled(seed + path) & 255u;
  return (float(number) + (float(rest) + 0.5) / 256.0) / 64.0;
}

// Near, alpha decides. Where less than two samples fall on a texel, and far away, a share of the
// samples lies on the surface: that of what they span. The mean over a region is right at any
// distance.
bool is_there() {
  vec2 size = vec2(textureSize(cutout_map, 0));
  vec2 right = dFdx(map_texcoord) * size;
  vec2 down = dFdy(map_texcoord) * size;
  float level = 0.5 * log2(max(max(dot(right, right), dot(down, down)), 1e-30));
  float sharp = textureLod(cutout_map, map_texcoord, 0.0).r >= 0.0 ? 1.0 : 0.0;
  float share = textureLod(cutout_map, map_texcoord, max(level, 0.0)).g;
  return dither() < mix(sharp, share, clamp(level + 1.0, 0.0, 1.0));
}
