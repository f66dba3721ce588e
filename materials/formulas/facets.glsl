// Mirror facets with Smith's masking, and what they scatter more than once.
FORMULA Real beckmann_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return cook_torrance(with_sun(s.alpha, s.sun_alpha2), to_light, to_viewer, normal);
}

FORMULA Real ggx_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return cook_torrance(with_sun(s.alpha, s.sun_alpha2), to_light, to_viewer, normal);
}

// A mirror under the Sun's disc alone; 0 under a Sun without a disc.
FORMULA Real mirror_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  if (!(s.sun_alpha2 > Real(0))) return Real(0);
  return cook_torrance(sqrt(s.sun_alpha2), to_light, to_viewer, normal);
}

FORMULA Vec3 no_many(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return Vec3(Real(0));
}

FORMULA Real facet_loss(Surface s, Real cosine) {
  Real x = sqrt(max(cosine, Real(0)));
  Real loss = s.loss7;
  loss = loss * x + s.loss6;
  loss = loss * x + s.loss5;
  loss = loss * x + s.loss4;
  loss = loss * x + s.loss3;
  loss = loss * x + s.loss2;
  loss = loss * x + s.loss1;
  loss = loss * x + s.loss0;
  return max(loss, Real(0));
}

// C. Kulla, A. Conty, "Revisiting physically based shading at Imageworks", 2017.
FORMULA Vec3 facet_many(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return s.many_scale *
         (facet_loss(s, dot3(normal, to_light)) * facet_loss(s, dot3(normal, to_viewer)));
}
