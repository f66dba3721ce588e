// Light of one source at a point of a surface.
struct Incidence {
  // unit, from the surface to the middle of the light
  Vec3 to_light;
  // RGB, on a plane that faces it
  Vec3 irradiance;
  // an eighth of the square of its disc's angular radius (its sine), which a uniform disc adds to alpha
  // squared at normal incidence; 0: a point
  Real alpha2;
  // limb darkening u of the disc, I = 1 - u (1 - mu), 0 to 1
  Real limb;
};
