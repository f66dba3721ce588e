// Dark particles that scatter once and alike in all directions. 1/sr.
// H. von Seeliger, "Zur Photometrie zerstreut reflektierender Substanzen", 1888.
FORMULA Real lommel_seeliger(Real w, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  return w * Real(0.079577471545947668) / max(cos_nl + cos_nv, Real(1e-10));
}

FORMULA Vec3 lommel_seeliger_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return s.diffuse * lommel_seeliger(s.hapke_w, to_light, to_viewer, normal);
}
