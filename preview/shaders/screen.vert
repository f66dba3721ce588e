// One triangle that covers the window, at one depth. Defined in front: version, uniforms.glsl.

void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, screen_depth, 1.0);
}
