// Which shading class a sample belongs to, as depth: the shading passes test for it, so that each
// runs where its class is and nowhere else. Defined in front: version, sample_place.glsl.

// of the target: its first item, how many it has; what stands below the numbers of its classes;
// 1 of the first target, which leaves background where it is not
layout(location = 0) uniform uvec4 range;
layout(binding = 5) uniform usamplerBuffer items;    // x: material, y: class
layout(binding = 2) uniform sampler2D normal_samples;  // as geometry.frag leaves them

layout(location = 0) out vec4 radiance;

void main() {
  radiance = vec4(0.0);
  int item = int(texelFetch(normal_samples, sample_place(), 0).w) - 1 - int(range.x);
  bool mine = item >= 0 && item < int(range.y);
  if (!mine && range.w == 0u) discard;
  // exact: a power of two, and numbers far below 2^23
  gl_FragDepth = mine ? float(texelFetch(items, item).y + range.z + 1u) * (1.0 / 1048576.0) : 0.0;
}
