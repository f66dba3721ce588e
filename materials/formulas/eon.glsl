// Oren and Nayar's microfacets with all light kept: FON (Fujii's form of the qualitative model) and what
// it loses, scattered again. 1/sr. Roughness r: 0 to 1; 0 is Lambert.
// J. Portsmouth, P. Kutz, S. Hill, "EON: a practical energy-preserving rough diffuse BRDF", 2025,
// with the exact albedos.

// A of a roughness: 1/A = 1 + (1/2 - 2/(3 pi)) r.
FORMULA Real fon_scale(Real roughness) {
  return Real(1) / (Real(1) + Real(0.28779340921080620) * roughness);
}

// What FON reflects of a white surface.
FORMULA Real fon(Real roughness, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  Vec3 along_l = along_surface(to_light, normal, cos_nl);
  Vec3 along_v = along_surface(to_viewer, normal, cos_nv);
  Real s = dot3(along_l, along_v);
  Real shape = Real(1) + roughness * (s / max(max(cos_nl, cos_nv), Real(1e-10)));
  if (s < Real(0)) {
    // 1 + r s; at grazing 1 + s is the difference of nearly opposite directions
    Vec3 both = along_l + along_v;
    Real near = Real(0.5) * (dot3(both, both) + (cos_nl * cos_nl + cos_nv * cos_nv));
    shape = max(Real(1) - roughness, Real(0)) + roughness * near;
  }
  return fon_scale(roughness) * Real(0.31830988618379067) * shape;
}

// (1 - E)/(r A) of FON's directional albedo E at an angle with this cosine and sine. The paper's
// E = A + r A G/pi, with G = S (acos(mu) - S mu) + 2/3 (S/mu (1 - S^3) - S), loses every digit of
// 1 - E towards grazing; here pi/2 - acos and 1 - S are taken together first.
FORMULA Real fon_albedo_deficit(Real cosine, Real sine) {
  Real far = Real(1) + sine;
  Real rest = angle_of(cosine, sine) -
              cosine * cosine * cosine * (sine + Real(2)) / (Real(3) * far * far);
  return Real(0.31830988618379067) *
         (Real(0.90412966012822990) * (cosine * cosine / far) + sine * rest);
}

FORMULA Vec3 eon(Vec3 albedo, Real roughness, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Vec3(Real(0));
  Real deficit_l = fon_albedo_deficit(cos_nl, length3(along_surface(to_light, normal, cos_nl)));
  Real deficit_v = fon_albedo_deficit(cos_nv, length3(along_surface(to_viewer, normal, cos_nv)));
  // (1 - E(l)) (1 - E(v))/(1 - mean E) with r A taken out, so that nothing is 0/0 at r = 0;
  // 1 - mean E is r A (6/(5 pi) - 1/6)
  Real spread = roughness * fon_scale(roughness);
  Real lost = spread * (deficit_l * deficit_v) * Real(4.6445697320678745);
  Real mean_albedo_deficit = spread * Real(0.21530519675388227);
  // albedo^2 (1 - loss)/(1 - albedo loss); an albedo far above 1 would divide by nothing
  Vec3 again = albedo * albedo * (Real(1) - mean_albedo_deficit);
  Vec3 kept = Vec3(Real(1)) - albedo * mean_albedo_deficit;
  Vec3 many = Vec3(again.x / max(kept.x, Real(0.1)), again.y / max(kept.y, Real(0.1)),
                   again.z / max(kept.z, Real(0.1)));
  return albedo * fon(roughness, to_light, to_viewer, normal) +
         many * (lost * Real(0.31830988618379067));
}

FORMULA Vec3 eon_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return eon(s.diffuse, s.oren, to_light, to_viewer, normal);
}
