// Nothing is seen here yet.
layout(location = kNormalLayer) out uvec4 normal_sample;

void main() { normal_sample = uvec4(0u); }
