// The radiance that a surface emits, the same in all directions and under any light. white: the irradiance
// that a white Lambert surface would need for the radiance of emission 1.
FORMULA Vec3 surface_emission(Surface s, Vec3 white) {
  return white * (s.emissive * (s.weights.z * Real(0.31830988618379067)));
}
