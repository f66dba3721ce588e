// Lobes whose slopes differ along two axes, and bumps too small to see, which add to them.

// 1 where microfacets are isotropic, else 0.
FORMULA Real isotropic(Real slope_x, Real slope_y, Vec3 tangent) {
  if (slope_x == slope_y || !(dot3(tangent, tangent) > Real(0.25))) return Real(1);
  return Real(0);
}

// (x/slope_x)^2 + (y/slope_y)^2 of a vector in the surface, given its cross product with the normal.
FORMULA Real over_slopes(Real slope_x, Real slope_y, Vec3 tangent, Vec3 turned, Vec3 normal) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0))
    return dot3(turned, turned) / (slope_x * slope_y);
  Real x = dot3(turned, cross3(normal, tangent)) / slope_x;
  Real y = dot3(turned, tangent) / slope_y;
  return x * x + y * y;
}

// The axes of slopes over alpha.
FORMULA Vec3 over_slope_x(Real slope_x, Real slope_y, Vec3 tangent, Vec3 tilted) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0)) return disc_x(tilted) / sqrt(slope_x * slope_y);
  return tangent / slope_x;
}
FORMULA Vec3 over_slope_y(Real slope_x, Real slope_y, Vec3 tangent, Vec3 tilted) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0)) return disc_y(tilted) / sqrt(slope_x * slope_y);
  return cross3(tilted, tangent) / slope_y;
}

// Bumps that a sample is too large to show add their squared slopes to those of a lobe. Exactly the
// slope where there are none.
FORMULA Real bumped(Real slope, Real bump) {
  if (!(bump > Real(0))) return slope;
  return sqrt(slope * slope + bump);
}

// What slopes seen from outside are inside a coat, squared, for bumps that tilt coat and microfacets
// alike: a turn moves the half vector inside by less.
FORMULA Real bump_inside(Surface s, Vec3 to_light, Vec3 to_viewer, Real index) {
  if (!(s.bump_x > Real(0) && index > Real(0))) return Real(1);
  Real cosine = half_cosine(to_light, to_viewer);
  Real share = cosine / (index * refracted_cosine(cosine, index));
  return share * share;
}
