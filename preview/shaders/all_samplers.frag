// Uses every texture unit that a program is sure to have, and draws nothing. Software contexts keep the sampler of
// a unit that a later program has a buffer texture on, and build that program again for each other one.
const int kUnits = 16;
uniform usampler2D textures[kUnits];
layout(location = 0) out vec4 radiance;

void main() {
  uvec4 sum = uvec4(0u);
  for (int i = 0; i < kUnits; ++i) sum += texelFetch(textures[i], ivec2(0), 0);
  radiance = vec4(sum);
}
