// The least a fragment can cost: what the renderer's time is held against.
layout(location = 0) out vec4 radiance;

void main() { radiance = vec4(1.0); }
