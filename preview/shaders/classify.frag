// Whether one sample stands for a pixel, or all N×N are to be shaded (docs/sampling.md). Defined in
// front: version.
layout(location = 0) uniform uint side;           // N
layout(location = 2) uniform float smoothness;    // greatest second difference of radiance
layout(location = 3) uniform uvec2 size;          // of the tile, pixels
layout(location = 4) uniform vec2 depth_step;     // x·depth + y: depth that counts as a step
layout(binding = 18) uniform usampler2D coverage;  // N×N, as coverage.frag leaves it
layout(binding = 2) uniform sampler2D normal_samples;  // one a pixel, as geometry.frag leaves them
layout(binding = 3) uniform sampler2D lights;        // as shading.frag leaves them
layout(binding = 4) uniform sampler2D depths;        // N×N

layout(location = 0) out float mark;

int item_at(ivec2 pixel) { return abs(int(texelFetch(normal_samples, pixel, 0).w)); }

bool is_one_thing(ivec2 pixel, uvec2 one) {
  ivec2 first = pixel * int(side);
  vec2 normal = unpackSnorm2x16(one.y);
  vec2 low = normal;
  vec2 high = normal;
  for (int y = 0; y < int(side); ++y)
    for (int x = 0; x < int(side); ++x) {
      uvec2 other = texelFetch(coverage, first + ivec2(x, y), 0).xy;
      if (other.x != one.x) return false;
      vec2 at = unpackSnorm2x16(other.y);
      low = min(low, at);
      high = max(high, at);
    }
  float most = exp2(-0.0625 * float(one.x >> 24));
  return all(lessThanEqual(high - low, vec2(most)));
}

// A surface that lies before another part of the same instance: a step in depth.
bool has_step(ivec2 pixel) {
  ivec2 first = pixel * int(side);
  int last = int(side) - 1;
  vec4 corner;
  for (int i = 0; i < 4; ++i)
    corner[i] = texelFetch(depths, first + ivec2((i & 1) * last, (i >> 1) * last), 0).r;
  vec2 across = vec2(corner[1] - corner[0], corner[3] - corner[2]);
  float bend = abs(across.y - across.x);
  for (int y = 0; y < int(side); ++y)
    for (int x = 0; x < int(side); ++x) {
      float here = texelFetch(depths, first + ivec2(x, y), 0).r;
      vec2 share = vec2(x, y) / float(max(last, 1));
      float plane = mix(mix(corner[0], corner[1], share.x), mix(corner[2], corner[3], share.x), share.y);
      bend = max(bend, abs(here - plane));
    }
  return bend > depth_step.x * corner[0] + depth_step.y;
}

float light_at(ivec2 pixel) { return texelFetch(lights, pixel, 0).r; }

// The second difference along an axis; at the border of a thing, the first difference.
float bend_of_light(ivec2 pixel, ivec2 axis, int item, float here) {
  ivec2 before = pixel - axis;
  ivec2 behind = pixel + axis;
  bool has_before = all(greaterThanEqual(before, ivec2(0))) && item_at(before) == item;
  bool has_behind = all(lessThan(behind, ivec2(size))) && item_at(behind) == item;
  float difference = 0.0;
  if (has_before && light_at(before) < 1e29) difference += light_at(before) - here;
  if (has_behind && light_at(behind) < 1e29) difference += light_at(behind) - here;
  return abs(difference);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  mark = 1.0;
  uvec2 one = texelFetch(coverage, pixel * int(side), 0).xy;
  if (!is_one_thing(pixel, one)) return;
  float normal_sample = texelFetch(normal_samples, pixel, 0).w;
  int item = int(one.x & 0xffffffu);
  // sign: its maps hold more than one sample shows
  if (normal_sample < 0.0 || int(normal_sample) != item) return;
  mark = 0.0;
  if (item == 0) return;
  mark = 1.0;
  if (has_step(pixel)) return;
  float here = light_at(pixel);
  if (here > 1e29) return;
  if (bend_of_light(pixel, ivec2(1, 0), item, here) > smoothness) return;
  if (bend_of_light(pixel, ivec2(0, 1), item, here) > smoothness) return;
  mark = 0.0;
}
