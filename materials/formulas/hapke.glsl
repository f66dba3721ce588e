// Particulate surfaces: single scattering by particles with an opposition effect, isotropic
// multiple scattering, and shadows of macroscopic roughness. 1/sr.
// B. Hapke, "Bidirectional reflectance spectroscopy" 1 (1981), 3 (1984), 4 (1986), 5 (2002), 6
// (2008). The opposition effect is that of 1986; the form of 1981 describes the same shadows, and
// no parameters are published for it alone.

// H(x): multiple scattering, x <= 1. Chandrasekhar's equation gives its reciprocal the form
// 1 - x (polynomial + ln(1 + 1/x) polynomial); the coefficients are fitted for the albedo at hand
// (materials/fit_hapke.cpp). PANWRIGHT_H names it, or its replacement.
FORMULA Real hapke_h_function(Surface s, Real x) {
  Real plain = s.hapke_h0 + x * (s.hapke_h1 + x * (s.hapke_h2 + x * s.hapke_h3));
  Real curved = s.hapke_h4 + x * (s.hapke_h5 + x * (s.hapke_h6 + x * s.hapke_h7));
  return Real(1) / (Real(1) - x * (plain + curved * log_one_plus(Real(1) / max(x, Real(1e-30)))));
}

// Shadows that particles hide at small phase angles: B0/(1 + tan(g/2)/h), tan(g/2) = |l - v|/|l + v|.
FORMULA Real hapke_shadow_hiding(Real b0, Real h, Real minus, Real plus) {
  return b0 * (h * plus) / max(h * plus + minus, Real(1e-30));
}

// Waves that come back on each other's paths: B0 (1 + (1 - exp(-z))/z)/(2 (1 + z)^2), z =
// tan(g/2)/h.
FORMULA Real hapke_coherent(Real b0, Real h, Real minus, Real plus) {
  if (!(h > Real(0))) return Real(0);
  Real z = max(minus / max(h * plus, Real(1e-30)), Real(1e-30));
  Real near = Real(1) / (Real(1) + z);
  return Real(0.5) * b0 * (near * near) * (Real(1) + one_minus_exp(z) / z);
}

// Double Henyey-Greenstein, mean 1 over the sphere. minus2, plus2: |l - v|^2 and |l + v|^2, which
// are 2 (1 -+ cos g).
FORMULA Real hapke_phase(Real b, Real c, Real minus2, Real plus2) {
  Real backward = max((Real(1) - b) * (Real(1) - b) + b * minus2, Real(1e-8));
  Real forward = max((Real(1) - b) * (Real(1) - b) + b * plus2, Real(1e-8));
  return Real(0.5) * (Real(1) - b) * (Real(1) + b) *
         ((Real(1) + c) / (backward * sqrt(backward)) + (Real(1) - c) / (forward * sqrt(forward)));
}

// 2/pi cot(rough) cot(x), the exponent of E1; that of E2 is its square times pi/4.
FORMULA Real hapke_exponent(Real tan_rough, Real cos_x, Real sin_x) {
  return Real(0.63661977236758134) * cos_x / max(tan_rough * sin_x, Real(1e-30));
}

// eta(x)/chi: the cosine of a rough surface seen or lit from an angle x alone. e2: E2;
// below1: 1 - E1.
FORMULA Real hapke_eta(Real tan_rough, Real cos_x, Real sin_x, Real e2, Real below1) {
  return cos_x + sin_x * tan_rough * e2 / (Real(1) + below1);
}

FORMULA Real hapke(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));

  // azimuth: cos^2 and sin^2 of its half, and 1 - azimuth/pi, each good where it is small
  Vec3 along_l = along_surface(to_light, normal, cos_nl);
  Vec3 along_v = along_surface(to_viewer, normal, cos_nv);
  Real sin_nl = length3(along_l);
  Real sin_nv = length3(along_v);
  Vec3 turn = azimuth(along_l, along_v, sin_nl * sin_nv);
  Real near = Real(0.5) * turn.z;
  Real cos2_half = turn.x < Real(0) ? near : Real(0.5) * (Real(1) + turn.x);
  Real sin2_half = turn.x < Real(0) ? Real(0.5) * (Real(1) - turn.x) : near;
  Real angle = angle_of(turn.y, abs(turn.x)) * Real(0.31830988618379067);
  Real from_pi = turn.x < Real(0) ? angle : Real(1) - angle;

  // effective cosines of the smaller angle s and the greater g, over chi
  Real t = tangent(s.hapke_rough);
  Real cos_s = max(cos_nl, cos_nv);
  Real sin_s = min(sin_nl, sin_nv);
  Real cos_g = min(cos_nl, cos_nv);
  Real sin_g = max(sin_nl, sin_nv);
  Real k_s = hapke_exponent(t, cos_s, sin_s);
  Real k_g = hapke_exponent(t, cos_g, sin_g);
  Real q_s = Real(0.78539816339744831) * k_s * k_s;
  Real q_g = Real(0.78539816339744831) * k_g * k_g;
  Real e1_s = exp_negative(k_s);
  Real e2_s = exp_negative(q_s);
  Real e2_g = exp_negative(q_g);
  Real below_s = one_minus_exp_of(k_s, e1_s);
  Real below_g = one_minus_exp(k_g);
  Real rise = one_minus_exp_of(q_s, e2_s) - one_minus_exp_of(q_g, e2_g);
  Real share = max(below_g + below_s + from_pi * e1_s, Real(1e-30));
  Real mu_s = cos_s + sin_s * t * ((cos2_half * e2_g - sin2_half * rise) / share);
  Real mu_g = cos_g + sin_g * t * ((cos2_half * e2_s + rise) / share);
  Real eta_s = hapke_eta(t, cos_s, sin_s, e2_s, below_s);
  Real eta_g = hapke_eta(t, cos_g, sin_g, e2_g, below_g);
  Real chi = Real(1) / sqrt(Real(1) + Real(3.1415926535897932) * t * t);

  // 1 - f + f chi mu/eta: microfacets unseen are the more often unlit the smaller the azimuth is,
  // f = exp(-2 tan(azimuth/2))
  Real grade = Real(2) * sqrt(sin2_half / max(cos2_half, Real(1e-30)));
  Real unlit = exp_negative(grade);
  Real apart = one_minus_exp_of(grade, unlit) + unlit * (cos_s / eta_s);

  Vec3 both = to_light + to_viewer;
  Vec3 between = to_light - to_viewer;
  Real plus2 = dot3(both, both);
  Real minus2 = dot3(between, between);
  Real plus = sqrt(plus2);
  Real minus = sqrt(minus2);
  Real shadow = hapke_shadow_hiding(s.hapke_b0, s.hapke_h, minus, plus);
  Real surge = hapke_coherent(s.hapke_bc0, s.hapke_hc, minus, plus);
  Real dense = max(s.hapke_k, Real(1));
  Real many = PANWRIGHT_H(s, chi * mu_s / dense) * PANWRIGHT_H(s, chi * mu_g / dense);
  Real bracket = (Real(1) + shadow) * hapke_phase(s.hapke_b, s.hapke_c, minus2, plus2) +
                 max(many - Real(1), Real(0));
  Real albedo = min(max(s.hapke_w, Real(0)), Real(1));
  return dense * albedo * Real(0.079577471545947668) * bracket * (Real(1) + surge) *
         (mu_s / eta_s) * (mu_g / eta_g) / (mu_s + mu_g) / apart;
}

FORMULA Vec3 hapke_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return s.diffuse * hapke(s, to_light, to_viewer, normal);
}
