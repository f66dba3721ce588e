// Which triangle of which instance is seen. Defined in front: version, uniforms.glsl,
// draw.glsl, and CUTOUT with
// cutout.glsl.
layout(location = 0) out uvec2 triangle_id;

void main() {
  triangle_id = uvec2(draw.id, uint(gl_PrimitiveID));
#ifdef CUTOUT
  if (!is_there()) discard;
#endif
}
