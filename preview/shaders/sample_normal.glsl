// The normal of a sample's surface, without bumps.
// See packed_normal() in sample_position.glsl.
vec3 unpacked_normal(uint bits) {
  vec2 at = unpackSnorm2x16(bits);
  vec3 normal = vec3(at, 1.0 - abs(at.x) - abs(at.y));
  vec2 upper = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(at, vec2(0.0)));
  if (normal.z < 0.0) normal.xy = (1.0 - abs(at.yx)) * upper;
  return normal;
}
