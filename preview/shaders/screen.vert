// One triangle that covers the window, at one depth.
layout(location = 1) uniform float depth;

void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, depth, 1.0);
}
