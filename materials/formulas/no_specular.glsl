// No highlight.
FORMULA Real no_specular_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return Real(0);
}
