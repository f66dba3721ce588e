// Corner cubes with a circular face: a lobe about the direction to the light. 1/sr.
//
// The corner turns a beam into its image through the corner: what enters the face at P leaves it at
// 2 L tan(refracted angle) - P. The part of the face that works is the overlap of two circles.
// P. R. Yoder, "Study of light deviation errors in triple mirrors and tetrahedral prisms", 1958;
// H. D. Eckhardt, "Simple model of corner reflector phenomena", Applied Optics 10, 1971.

// acos(q) - q sqrt(1 - q^2) over pi/2, given q and sqrt(1 - q^2): the overlap of two circles of
// radius 1 whose centres are 2 q apart, over one of them
FORMULA Real circle_overlap(Real q, Real p) {
  Real angle = angle_of(p, q);
  if (angle > Real(0.5)) return Real(0.63661977236758134) * (angle - q * p);
  // x - sin(2 x)/2 by its series: near the cut-off the difference has no digits
  Real x = angle * angle;
  Real sum = Real(1.8425166262078804e-10);
  sum = Real(1.2529113058213587e-08) - x * sum;
  sum = Real(6.577784355562133e-07) - x * sum;
  sum = Real(2.565335898669232e-05) - x * sum;
  sum = Real(0.0007054673721340388) - x * sum;
  sum = Real(0.012698412698412698) - x * sum;
  sum = Real(0.13333333333333333) - x * sum;
  sum = Real(0.6666666666666666) - x * sum;
  return Real(0.63661977236758134) * (angle * x * sum);
}

// Effective aperture over the face, both as seen, of light at an angle of incidence with this cosine.
// depth: L over the face's diameter.
FORMULA Real retro_aperture(Real index, Real depth, Real cosine) {
  Real sin2 = max((Real(1) - cosine) * (Real(1) + cosine), Real(0));
  Real q2 = Real(4) * depth * depth * sin2 / max(index * index - sin2, Real(1e-12));
  if (!(q2 < Real(1))) return Real(0);
  Real q = sqrt(q2);
  return circle_overlap(q, sqrt((Real(1) - q) * (Real(1) + q)));
}

// What the cut-off leaves; cutoff: its cosine.
FORMULA Real retro_vignette(Real cutoff, Real cosine) {
  return min(max((cosine - cutoff) / max(Real(0.05) * (Real(1) - cutoff), Real(1e-7)), Real(0)),
             Real(1));
}

// Both together.
FORMULA Real retro_efficiency(Surface s, Real cosine) {
  return retro_aperture(s.retro_index, s.retro_depth, cosine) *
         retro_vignette(s.retro_cutoff, cosine);
}

// 1 over the variance along each axis, that of the light's disc included. Below a coat the disc is smaller
// by its index.
FORMULA Real retro_concentration(Surface s, Incidence light, Real index) {
  Real disc = Real(8) * light.alpha2 * disc_variance(light.limb);
  if (index > Real(0)) disc = disc / (index * index);
  return Real(1) / max(s.retro_width * s.retro_width + disc, Real(1e-12));
}

// The distribution of von Mises and Fisher about the light, 1 over the sphere. apart2: |l - v|^2
FORMULA Real retro_spread(Real concentration, Real apart2) {
  Real x = Real(0.5) * concentration * apart2;
  if (!(x < Real(80))) return Real(0);
  return concentration * Real(0.15915494309189535) /
         one_minus_exp(Real(2) * concentration) * exp_negative(x);
}

// The same, its mean over the light's disc.
FORMULA Real retro_over_disc(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Real index) {
  Vec3 inside = below_index(light.to_light, normal, index);
  Vec3 apart = inside - below_index(to_viewer, normal, index);
  Real radius = disc_radius(light.alpha2);
  if (!(s.retro_width < Real(2.3) * radius))
    return retro_spread(retro_concentration(s, light, index), dot3(apart, apart));
  Real concentration = Real(1) / max(s.retro_width * s.retro_width, Real(1e-12));
  Real scale = sqrt(Real(0.5) * concentration);
  Vec3 l = light.to_light;
  Vec3 step_x = scale * light_step(disc_x(l), radius, l, l, inside, normal, index);
  Vec3 step_y = scale * light_step(disc_y(l), radius, l, l, inside, normal, index);
  Vec3 form = slope_form(step_x, step_y);
  Vec3 axis = narrow_axis(form);
  Real determinant = max(form.x * form.z - form.y * form.y, Real(1e-30));
  Real toward_x = Real(0) - scale * dot3(apart, step_x);
  Real toward_y = Real(0) - scale * dot3(apart, step_y);
  Real place_x = (form.z * toward_x - form.y * toward_y) / determinant;
  Real place_y = (form.x * toward_y - form.y * toward_x) / determinant;
  Real narrow = Real(1) / sqrt(axis.z);
  Real wide = sqrt(axis.z / determinant);
  return Real(0.15915494309189535) * concentration *
         gaussian_over_disc(place_x * axis.x + place_y * axis.y, place_y * axis.x - place_x * axis.y, narrow,
                            wide, light.limb);
}

// Reciprocal; never more than the light on the aperture, as the smaller efficiency is taken and the
// larger cosine: the directional albedo is at most the efficiency.
FORMULA Real retroreflector_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                 Real index) {
  Vec3 l = below_index(light.to_light, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  Vec3 apart = l - v;
  Real spread = light.alpha2 > Real(0) ? retro_over_disc(s, light, to_viewer, normal, index)
                                       : retro_spread(retro_concentration(s, light, index), dot3(apart, apart));
  return retro_efficiency(s, min(cos_nl, cos_nv)) * spread / max(cos_nl, cos_nv);
}

FORMULA Vec3 retroreflector_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                      Real index) {
  return light.to_light;
}
