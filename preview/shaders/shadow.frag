// What the Sun sees first: its depth, and how the depth changes along x and y, each from -1 to 1
// across the map. Defined in front: version, uniforms.glsl, draw.glsl, and CUTOUT with cutout.glsl.
layout(location = 0) out vec2 slope;

void main() {
  vec2 change = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z)) *
                view.half_map;
  slope = clamp(change, vec2(-6e4), vec2(6e4));
#ifdef CUTOUT
  if (!is_there()) discard;
#endif
}
