// Which shading class a sample belongs to, as depth: the shading passes test for it, so that each
// runs where its class is and nowhere else. Defined in front: version, uniforms.glsl,
// sample_place.glsl.

layout(location = 0) out vec4 radiance;

void main() {
  radiance = vec4(0.0);
  int item = int(texelFetch(normal_samples, sample_place(), 0).w & ~kTurns) - 1 - int(item_range.x);
  bool mine = item >= 0 && item < int(item_range.y);
  if (!mine && item_range.w == 0u) discard;
  // exact: a power of two, and numbers far below 2^23
  gl_FragDepth = mine ? float(texelFetch(items, item).y + item_range.z + 1u) * (1.0 / 1048576.0) : 0.0;
}
