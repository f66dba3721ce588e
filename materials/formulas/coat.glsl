// A clear layer with two faces over a surface. Light is added without regard to phase.

FORMULA Real refracted_cosine(Real cos_i, Real index) {
  Real sin_i2 = max((Real(1) - cos_i) * (Real(1) + cos_i), Real(0));
  return sqrt(max(Real(1) - sin_i2 / (index * index), Real(0)));
}

// The direction inside the layer; both point away from the surface.
FORMULA Vec3 under_coat(Vec3 outside, Vec3 normal, Real index) {
  Real cosine = max(dot3(normal, outside), Real(0));
  return (outside - normal * cosine) / index + normal * refracted_cosine(cosine, index);
}

FORMULA Vec3 transmittance(Vec3 depth, Real path) {
  return Vec3(exp_negative(depth.x * path), exp_negative(depth.y * path),
              exp_negative(depth.z * path));
}

// What a slab reflects beyond its first face: (1 - R1)^2 T^2 R2 / (1 - R1 R2 T^2).
FORMULA Vec3 slab_remainder(Real first, Vec3 below, Vec3 depth, Real cos_t) {
  Vec3 twice = transmittance(depth, Real(2) / cos_t) * below;
  Real passing = (Real(1) - first) * (Real(1) - first);
  return passing * (twice / (Vec3(Real(1)) - first * twice));
}

// Diffuse light from below, through the coat twice and back and forth in it.
FORMULA Vec3 through_coat(Surface s, Vec3 below, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real n = s.coat_index;
  Real cos_nl = max(dot3(normal, to_light), Real(0));
  Real cos_nv = max(dot3(normal, to_viewer), Real(0));
  Real passing = (Real(1) - s.coat_share * fresnel_dielectric(cos_nl, n)) *
                 (Real(1) - s.coat_share * fresnel_dielectric(cos_nv, n));
  Real path = Real(1) / refracted_cosine(cos_nl, n) + Real(1) / refracted_cosine(cos_nv, n);
  Vec3 again = Vec3(Real(1)) - s.weights.x * (s.diffuse * s.coat_return);
  return passing / (n * n) * (transmittance(s.coat_depth, path) * below / again);
}

// The mean normal of cells that are not quite parallel to their cover glass.
FORMULA Vec3 tilted_normal(Surface s, Vec3 normal) {
  Vec3 across = cross3(normal, s.tangent);
  Vec3 tilted = normal - s.tilt_x * s.tangent - s.tilt_y * across;
  return tilted / max(length3(tilted), Real(1e-10));
}
