// A material without a specular part.
FORMULA Vec3 no_specular_law(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return Vec3(Real(0));
}
