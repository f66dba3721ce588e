// The mean of N×N samples: a pixel, or a block of pixels that stand apart (sample_place.glsl). Each
// row is summed from the left, then the rows from the top, all in float, so that every context adds
// in one order. Defined in front: version, uniforms.glsl, and SPREAD.

layout(location = 0) out vec4 mean;
#ifdef SPREAD
// RGB: how far the means of the four grids of N/2×N/2 that make up the samples lie from the whole
// mean, root of the mean square; 0 for an odd N
layout(location = 1) out vec4 spread;
#endif

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * int(samples_a_side);
  precise float weight = 1.0 / float(samples_a_side * samples_a_side);
#ifdef SPREAD
  precise vec4 part[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
#endif
  precise vec4 sum = vec4(0.0);
  for (int y = 0; y < int(samples_a_side); ++y) {
    precise vec4 row = vec4(0.0);
    for (int x = 0; x < int(samples_a_side); ++x) {
      precise vec4 one = texelFetch(color_samples, first + ivec2(x, y), 0);
      row += one;
#ifdef SPREAD
      part[(y & 1) * 2 + (x & 1)] += one;
#endif
    }
    sum += row;
  }
  mean = sum * weight;
#ifdef SPREAD
  precise vec4 squares = vec4(0.0);
  if ((samples_a_side & 1u) == 0u)
    for (int i = 0; i < 4; ++i) {
      precise vec4 off = part[i] * (4.0 * weight) - mean;
      squares += off * off;
    }
  spread = sqrt(squares * 0.25);
#endif
}
