// Nothing is seen here yet.
layout(location = 0) out vec4 seen;

void main() { seen = vec4(0.0); }
