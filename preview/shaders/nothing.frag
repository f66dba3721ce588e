// Nothing is seen here yet.
layout(location = 0) out vec4 normal_sample;

void main() { normal_sample = vec4(0.0); }
