// What lobes send of light that is wide beside them. Defined in front: any of COATED and COMPENSATED (for what microfacets scatter
// more than once), and where there are lobes LOBE_ANY and one of LOBE_BLINN_PHONG, LOBE_COOK_TORRANCE, LOBE_SLOPES,
// LOBE_HEAVY (GGX), LOBE_MIRROR, LOBE_RETURNS; and INDIRECT where other surfaces send light.

#ifdef INDIRECT
INDIRECT_BLOCK
#define MIRRORS_APART (indirect.mirrors_apart != 0)
#else
#define MIRRORS_APART false
#endif

// Whether rays add what a smooth coat, or a mirror, shows of such light.
bool coat_is_apart(Surface s) {
#ifdef COATED
  return MIRRORS_APART && !(s.coat_alpha > 0.0);
#else
  return false;
#endif
}
bool lobe_is_apart(Surface s) {
#if !defined(LOBE_MIRROR)
  return false;
#elif defined(COATED)
  return MIRRORS_APART && (!(s.coat_alpha > 0.0) || s.coat_index == 1.0);
#else
  return MIRRORS_APART;
#endif
}

// What a surface sends of such light to the viewer. diffuse: apart from what lobes send
struct WideLight {
  vec3 irradiance;
  vec3 diffuse;
  vec3 mirrored;
};

// Lobes without a coat, or under one, as seen from outside.
struct WideLobe {
  float share;   // what they send of light from everywhere, F apart
  float slope;
  float square;  // of angles along each axis
};

// Microfacets that scatter once lose what they hide, and under a coat what meets it too flat to leave: of slopes as
// GGX has them, those in a circle beside their middle. Within 0.05 of a mean over the lobe.
float wide_share(float slope2, float cosine, float index) {
#if defined(COMPENSATED)
  return 1.0;
#elif defined(COATED)
  float steepest = 1.0 / (index + sqrt(max(index * index - 1.0, 0.0)));
  float sine2 = max(1.0 - cosine * cosine, 0.0);
  float beside2 = sine2 / (index + sqrt(max(index * index - sine2, 0.0)));
  beside2 *= 1.0 / (index + sqrt(max(index * index - sine2, 0.0)));
  float within2 = steepest * steepest;
  float apart = within2 - beside2 - slope2;
  return max(within2 / (slope2 + within2 + beside2),
             0.5 + 0.5 * apart * inversesqrt(max(apart * apart + 4.0 * slope2 * within2, 1e-30)));
#elif defined(LOBE_HEAVY)
  return 1.0 / (1.0 + 1.6 * slope2);
#else
  return 1.0 / (1.0 + 0.8 * slope2);
#endif
}

WideLobe wide_lobe(Surface s, float cosine) {
#ifdef COATED
  float index = s.coat_index;
  const float kBounded = 1.3;  // by the horizon inside
#else
  const float index = 1.0;
  const float kBounded = 0.0;
#endif
  // slopes turn light by twice themselves in the plane of incidence, by less across it
  float turned = index * index * (1.0 + cosine * cosine);
#if defined(LOBE_HEAVY)
  float slope2 = s.alpha_x * s.alpha_y;
  // the spread about the mean over the hemisphere, of the tail most
  float square = 0.65 * index * sqrt(slope2);
  return WideLobe(wide_share(slope2, cosine, index), index * sqrt(slope2), square / (1.0 + kBounded * square));
#elif defined(LOBE_SLOPES)
  float slope2 = s.alpha_x * s.alpha_y;
  float square = turned * slope2;
  return WideLobe(wide_share(0.6 * slope2, cosine, index), 0.7 * index * sqrt(slope2),
                    square / (1.0 + kBounded * square));
#elif defined(LOBE_COOK_TORRANCE)
  float square = turned * s.alpha_x * s.alpha_x;
  return WideLobe(s.d_scale * s.f_scale * s.g_scale, 0.7 * index * s.alpha_x, square / (1.0 + kBounded * square));
#elif defined(LOBE_BLINN_PHONG)
  float slope2 = 2.0 / max(s.shine, 1e-3);
  float square = turned * slope2;
  return WideLobe(1.0, 0.7 * index * sqrt(slope2), square / (1.0 + kBounded * square));
#elif defined(LOBE_MIRROR)
  float bent = (index - 1.0) * s.coat_alpha;
  return WideLobe(1.0, 0.0, 0.5 * bent * bent * (1.0 + cosine * cosine));
#elif defined(LOBE_RETURNS)
  return WideLobe(retro_efficiency(s, cosine), 0.0, s.retro_width * s.retro_width);
#else
  return WideLobe(0.0, 0.0, 0.0);
#endif
}
