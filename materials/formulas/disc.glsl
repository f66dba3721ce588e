// Microfacets under the disc of a light: the mean of their slopes' distribution over the directions of its
// light. A step of the light moves the half vector by half of it in the plane of incidence and by
// 1/(2 cos) of it across, so the disc is an ellipse of slopes; its Jacobian is taken exactly, for
// slopes that differ along two axes, normals beside the surface's and light bent by a coat.
//
// Places on the disc count in its radii along disc_x and disc_y. Slopes are over alpha: a density is
// exp(-y^2) (Beckmann; `heavy` 0) or (1 + y^2)^-2 (GGX; 1), y = slopes. Lobes much wider than the
// disc take a closed form, others chords of the disc along the lobe's narrow axis, each exact for an even
// disc, summed along the wide one.
//
//   index  of a coat over the microfacets; 0: none
//   limb   u of the disc's brightness 1 - u (1 - sqrt(1 - r^2)), of Incidence

FORMULA Real refracted_cosine(Real cos_i, Real index) {
  Real sin_i2 = max((Real(1) - cos_i) * (Real(1) + cos_i), Real(0));
  return sqrt(max(Real(1) - sin_i2 / (index * index), Real(1e-20)));
}

// The direction inside a layer; both point away from the surface.
FORMULA Vec3 under_coat(Vec3 outside, Vec3 normal, Real index) {
  Real cosine = max(dot3(normal, outside), Real(0));
  return (outside - normal * cosine) / index + normal * refracted_cosine(cosine, index);
}

FORMULA Vec3 below_index(Vec3 outside, Vec3 normal, Real index) {
  if (!(index > Real(0))) return outside;
  return under_coat(outside, normal, index);
}

// The direction outside of one inside a layer, along the surface where none leaves it.
FORMULA Vec3 above_index(Vec3 inside, Vec3 normal, Real index) {
  if (!(index > Real(0))) return inside;
  Vec3 along = (inside - normal * dot3(normal, inside)) * index;
  return along + normal * sqrt(max(Real(1) - dot3(along, along), Real(0)));
}

FORMULA Vec3 mirrored_about(Vec3 axis, Vec3 direction) {
  return axis * (Real(2) * dot3(axis, direction)) - direction;
}

// Two directions that make a right-handed frame with a unit one. T. Duff et al., "Building an
// orthonormal basis, revisited", 2017.
FORMULA Vec3 disc_x(Vec3 z) {
  Real turn = z.z < Real(0) ? Real(-1) : Real(1);
  Real a = Real(-1) / (turn + z.z);
  return Vec3(Real(1) + turn * z.x * z.x * a, turn * (z.x * z.y * a), Real(0) - turn * z.x);
}

FORMULA Vec3 disc_y(Vec3 z) {
  Real turn = z.z < Real(0) ? Real(-1) : Real(1);
  Real a = Real(-1) / (turn + z.z);
  return Vec3(z.x * z.y * a, turn + z.y * z.y * a, Real(0) - z.y);
}

FORMULA Real disc_radius(Real alpha2) { return sqrt(Real(8) * alpha2); }

// Whether the light has no disc, or one so small beside a lobe of that slope, 40 radii or more, that it changes
// it by less than 4e-4 of its peak: then a point does.
FORMULA Real point_light(Incidence light, Real slope, Vec3 to_viewer, Vec3 tilted) {
  if (!(light.alpha2 > Real(0))) return Real(1);
  Real reach = slope * max(dot3(tilted, light.to_light) + dot3(tilted, to_viewer), Real(0));
  if (!(reach * reach < Real(12800) * light.alpha2)) return Real(1);
  return Real(0);
}

// Mean of (r cos)^2 over the disc, and that of r^4 over twice it.
FORMULA Real disc_variance(Real limb) {
  return (Real(0.25) - Real(0.11666666666666667) * limb) / (Real(1) - Real(0.3333333333333333) * limb);
}
FORMULA Real disc_reach2(Real limb) {
  return (Real(0.3333333333333333) - Real(0.18095238095238095) * limb) /
         (Real(0.5) - Real(0.23333333333333333) * limb);
}

// The brightness over its mean; height: sqrt(1 - r^2).
FORMULA Real disc_brightness(Real limb, Real height) {
  return (Real(1) - limb * (Real(1) - height)) / (Real(1) - Real(0.3333333333333333) * limb);
}

FORMULA Vec3 disc_light(Vec3 to_light, Vec3 place, Real radius) {
  Vec3 aside = radius * (place.x * disc_x(to_light) + place.y * disc_y(to_light));
  return aside + to_light * sqrt(max(Real(1) - dot3(aside, aside), Real(0.01)));
}

// How the light below the coat moves where the place moves by one along an axis; from: outside.
FORMULA Vec3 light_step(Vec3 axis, Real radius, Vec3 to_light, Vec3 from, Vec3 inside, Vec3 normal,
                        Real index) {
  Vec3 outside = radius * axis - to_light * (radius * dot3(axis, from) / dot3(to_light, from));
  if (!(index > Real(0))) return outside;
  Vec3 along = (outside - normal * dot3(normal, outside)) / index;
  return along - normal * (dot3(along, inside) / max(dot3(normal, inside), Real(1e-10)));
}

// What such a step changes the slopes by.
FORMULA Vec3 slope_step(Vec3 step, Vec3 slopes, Vec3 over_x, Vec3 over_y, Vec3 tilted, Real cos_sum) {
  Real up = dot3(tilted, step);
  return Vec3((dot3(over_x, step) - slopes.x * up) / cos_sum,
              (dot3(over_y, step) - slopes.y * up) / cos_sum, Real(0));
}

// The quadratic form x, y, z of y^2 = x a^2 + 2 y a b + z b^2 for steps of the place by (a, b).
FORMULA Vec3 slope_form(Vec3 step_x, Vec3 step_y) {
  return Vec3(dot3(step_x, step_x), dot3(step_x, step_y), dot3(step_y, step_y));
}

// The place where slopes are 0, from one where they are not. determinant: of the steps
FORMULA Vec3 place_of_peak(Vec3 place, Vec3 slopes, Vec3 step_x, Vec3 step_y, Real determinant) {
  return Vec3(place.x - (step_y.y * slopes.x - step_y.x * slopes.y) / determinant,
              place.y - (step_x.x * slopes.y - step_x.y * slopes.x) / determinant, Real(0));
}

FORMULA Real slope_determinant(Vec3 step_x, Vec3 step_y) {
  Real determinant = step_x.x * step_y.y - step_x.y * step_y.x;
  if (abs(determinant) < Real(1e-30)) return Real(1e-30);
  return determinant;
}

// The axis of places along which a form is largest, where the lobe is narrow; z: that value.
FORMULA Vec3 narrow_axis(Vec3 form) {
  Real half_difference = Real(0.5) * (form.x - form.z);
  Real r = sqrt(half_difference * half_difference + form.y * form.y);
  Real largest = Real(0.5) * (form.x + form.z) + r;
  if (!(r > Real(1e-6) * largest)) return Vec3(Real(1), Real(0), largest);
  if (half_difference > Real(0)) {
    Real cosine = sqrt(Real(0.5) * (Real(1) + half_difference / r));
    return Vec3(cosine, Real(0.5) * form.y / (r * cosine), largest);
  }
  Real sine = sqrt(Real(0.5) * (Real(1) - half_difference / r));
  return Vec3(Real(0.5) * form.y / (r * sine), sine, largest);
}

// Whether a lobe is so narrow that the disc's shape shows in it. slope: the smaller one. The closed
// forms are within 1e-3 of the peak beyond.
FORMULA Real shows_disc(Real heavy, Real slope, Real radius, Real cos_sum) {
  Real limit = (heavy > Real(0) ? Real(2.5) : Real(3.2)) * radius;
  if (slope * cos_sum < limit) return Real(1);
  return Real(0);
}

// Whether a lobe that shows the disc does so here. Farther away a Gaussian one is 0 (below e^-80), and
// GGX even over the disc: slopes have no digits to spare then.
FORMULA Real near_disc(Real heavy, Vec3 slopes, Real radius, Vec3 over_x, Vec3 over_y, Real cos_sum) {
  Real square = dot3(slopes, slopes);
  Real reach2 = radius * radius * (dot3(over_x, over_x) + dot3(over_y, over_y)) / (cos_sum * cos_sum);
  Real limit = heavy > Real(0) ? Real(36) * reach2 : Real(162) + Real(2) * reach2;
  if (square < limit) return Real(1);
  return Real(0);
}

// exp(x^2) erfc(x), x >= 0, within 1e-8: a minimax polynomial of 1/(1 + 0.4 x).
FORMULA Real scaled_erfc(Real x) {
  Real t = Real(1) / (Real(1) + Real(0.4) * x);
  Real d = Real(2) * t - Real(1);
  Real p = Real(-2.8530819869310164e-05);
  p = p * d - Real(1.099378235691617e-05);
  p = p * d + Real(0.00026489514838368144);
  p = p * d + Real(0.00016598477288010116);
  p = p * d - Real(0.0019199838693988724);
  p = p * d - Real(0.003353551518349457);
  p = p * d + Real(0.01134304294713416);
  p = p * d + Real(0.06849987411646888);
  p = p * d + Real(0.181565764107219);
  p = p * d + Real(0.32186076592825263);
  p = p * d + Real(0.42161272678990336);
  return p * t;
}

// x/sqrt(1 + x^2)
FORMULA Real unit_slope(Real x) { return x / sqrt(Real(1) + x * x); }

// The mean place on [-h, h] of what a lobe about a centre leaves there: exp(-((x - centre)/wide)^2), or
// (1 + ((x - centre)/wide)^2)^(-3/2), which is (1 + r^2)^-2 summed across.
FORMULA Real mean_on_chord(Real heavy, Real centre, Real h, Real wide) {
  Real c = abs(centre);
  // wide lobes to first order: the others are differences of what is nearly one there
  Real mean = c * (h * h / (h * h + (heavy > Real(0) ? Real(1) : Real(1.5)) * wide * wide));
  if (wide < Real(3) * h) {
    Real far = (h + c) / wide;
    Real near = (h - c) / wide;
    if (heavy > Real(0)) {
      Real a = Real(1) / sqrt(Real(1) + far * far);
      Real b = Real(1) / sqrt(Real(1) + near * near);
      mean = c - wide * (b - a) / (unit_slope(near) + unit_slope(far));
    } else {
      // over exp(-near^2)
      Real less = exp_negative(far * far - near * near);
      Real under = scaled_erfc(abs(near)) - less * scaled_erfc(far);
      if (near > Real(0))
        under = Real(2) / max(exp_negative(near * near), Real(1e-30)) - scaled_erfc(near) - less * scaled_erfc(far);
      mean = c - wide * Real(0.5641895835477563) * (Real(1) - less) / under;
    }
  }
  mean = min(max(mean, Real(0) - h), h);
  return centre < Real(0) ? Real(0) - mean : mean;
}

// The direction in the disc from which most of what the viewer sees comes: all but the slopes'
// distribution is taken there. Exactly to_light where the lobe is wide or far away, and nowhere else.
FORMULA Vec3 lit_from(Real heavy, Incidence light, Real slope, Vec3 over_x, Vec3 over_y, Vec3 to_viewer, Vec3 normal,
                      Vec3 tilted, Real index) {
  Vec3 to_light = light.to_light;
  Real radius = disc_radius(light.alpha2);
  Vec3 inside = below_index(to_light, normal, index);
  Vec3 both = inside + below_index(to_viewer, normal, index);
  Real cos_sum = dot3(tilted, both);
  if (!(cos_sum > Real(1e-6))) return to_light;
  if (!(shows_disc(heavy, slope, radius, cos_sum) > Real(0))) return to_light;
  Vec3 slopes = Vec3(dot3(over_x, both) / cos_sum, dot3(over_y, both) / cos_sum, Real(0));
  if (!(near_disc(heavy, slopes, radius, over_x, over_y, cos_sum) > Real(0))) return to_light;
  Vec3 step_x = slope_step(light_step(disc_x(to_light), radius, to_light, to_light, inside, normal, index),
                           slopes, over_x, over_y, tilted, cos_sum);
  Vec3 step_y = slope_step(light_step(disc_y(to_light), radius, to_light, to_light, inside, normal, index),
                           slopes, over_x, over_y, tilted, cos_sum);
  Real determinant = slope_determinant(step_x, step_y);
  Vec3 peak = above_index(mirrored_about(tilted, below_index(to_viewer, normal, index)), normal, index);
  Vec3 centre = Vec3(dot3(peak, disc_x(to_light)) / radius, dot3(peak, disc_y(to_light)) / radius, Real(0));
  Vec3 axis = narrow_axis(slope_form(step_x, step_y));
  Real narrow2 = Real(1) / max(axis.z, Real(1e-30));
  Real wide2 = axis.z / (determinant * determinant);
  Real across = centre.x * axis.x + centre.y * axis.y;
  Real along = centre.y * axis.x - centre.x * axis.y;
  // the disc is as wide as it is where the lobe is narrow, and as its variance says where it is not
  Real variance = disc_variance(light.limb);
  Real within = sqrt(Real(1) - Real(0.25) * narrow2 / (narrow2 + variance));
  Real beyond = heavy * max(abs(along) - Real(1), Real(0));
  Real apart = across;
  across = mean_on_chord(heavy, across, within, sqrt(narrow2 * (Real(1) + beyond * beyond / wide2)));
  // never the very centre, which stands for a lobe that shows no disc
  if (abs(across) < Real(0.02)) across = Real(0.02);
  across = min(max(across, Real(-0.98)), Real(0.98));
  beyond = heavy * (apart - across);
  within = within * sqrt(Real(1) - across * across);
  along = mean_on_chord(heavy, along, within, sqrt(wide2 * (Real(1) + beyond * beyond / narrow2)));
  Vec3 place = Vec3(across * axis.x - along * axis.y, across * axis.y + along * axis.x, Real(0));
  Vec3 from = disc_light(to_light, place, radius);
  Real height = dot3(normal, from);
  if (height < Real(1e-6)) from = from + normal * (Real(1e-6) - height);
  return from;
}

// The mean of sqrt(h^2 - x^2) on a chord of half length h over what the lobe leaves of it, by the
// mean and variance of that: second order in the variance, the rest fitted.
FORMULA Real chord_height(Real heavy, Real h, Real mean, Real variance) {
  Real h2 = h * h;
  Real z = min(mean * mean / h2, Real(0.9999999));
  Real d = Real(1) - z;
  Real r = min(variance / (h2 * d * d), Real(0.65));
  if (heavy > Real(0)) {
    Real heavy_part = Real(-0.5) + z * (Real(0.030212) - z * Real(0.11027208)) +
              r * (Real(-0.65781074) + Real(1.68215524) * z + r * (Real(0.68316886) - Real(1.47763989) * z));
    return h * sqrt(d) * (Real(1) + r * heavy_part);
  }
  Real part = Real(-0.5) - z * (Real(0.13077928) + z * Real(0.08350523)) +
              r * (Real(-0.58498511) + Real(1.24222564) * z + r * (Real(0.46364596) + Real(1.03111721) * z));
  return h * sqrt(d) * (Real(1) + r * part);
}

// The mean over the disc of exp(-(across/narrow)^2 - (along/wide)^2) about a place.
FORMULA Real gaussian_over_disc(Real across, Real along, Real narrow, Real wide, Real limb) {
  Real c2 = abs(across);
  Real c1 = abs(along);
  Real beyond1 = max(c1 - Real(1), Real(0));
  Real beyond2 = max(c2 - Real(1), Real(0));
  if (!(beyond1 * beyond1 < Real(80) * (wide * wide) && beyond2 * beyond2 < Real(80) * (narrow * narrow)))
    return Real(0);
  // the part of the disc along the wide axis where there is something
  Real reach = Real(2.9) * wide;
  Real low = max(Real(-1), c1 - sqrt(beyond1 * beyond1 + reach * reach));
  Real high = min(Real(1), c1 + reach);
  Real away = c2 - sqrt(beyond2 * beyond2 + Real(4) * (narrow * narrow));
  if (away > Real(0)) {
    Real span = sqrt(max((Real(1) - away) * (Real(1) + away), Real(0)));
    if (max(low, Real(0) - span) < min(high, span)) {
      low = max(low, Real(0) - span);
      high = min(high, span);
    }
  }
  Real middle = Real(0.5) * (low + high);
  Real half_length = Real(0.5) * (high - low);
  // ten chords by the midpoint rule of an angle: exact where the disc's rim ends them, and for
  // lobes that end before
  Real cosine = Real(0.9876883405951378);
  Real sine = Real(0.15643446504023087);
  Real total = Real(0);
  for (int i = 0; i < 10; ++i) {
    Real u = middle - half_length * cosine;
    Real h = sqrt(max((Real(1) - u) * (Real(1) + u), Real(1e-12)));
    Real x = (u - c1) / wide;
    Real a = (h + c2) / narrow;
    Real b = (h - c2) / narrow;
    Real exp_a = exp_negative(a * a);
    Real exp_b = exp_negative(b * b);
    // 2/sqrt pi times the integral from -a to b
    Real left = exp_a * scaled_erfc(a);
    Real right = exp_b * scaled_erfc(abs(b));
    Real sum = b > Real(0) ? Real(2) - left - right : right - left;
    if (sum > Real(0)) {
      Real bright = Real(1);
      if (limb > Real(0)) {
        Real mean = (exp_a - exp_b) * Real(0.5641895835477563) / sum;
        Real square = Real(0.5) - (a * exp_a + b * exp_b) * Real(0.5641895835477563) / sum;
        bright = disc_brightness(limb, chord_height(Real(0), h, c2 + narrow * mean,
                                                    narrow * narrow * max(square - mean * mean, Real(0))));
      }
      total = total + sine * exp_negative(x * x) * sum * bright;
    }
    Real turned = cosine * Real(0.9510565162951535) - sine * Real(0.3090169943749474);
    sine = cosine * Real(0.3090169943749474) + sine * Real(0.9510565162951535);
    cosine = turned;
  }
  return total * half_length * narrow * Real(0.08862269254527580);
}

// The mean over the disc of (1 + (across/narrow)^2 + (along/wide)^2)^-2 about a place.
FORMULA Real heavy_over_disc(Real across, Real along, Real narrow, Real wide, Real limb) {
  Real c2 = abs(across);
  Real c1 = abs(along);
  // evenly in what the lobe has along its wide axis
  Real from = unit_slope((Real(-1) - c1) / wide);
  Real to = unit_slope((Real(1) - c1) / wide);
  Real middle = Real(0.5) * (from + to);
  Real half_length = Real(0.5) * (to - from);
  // twelve chords, or so many more as the disc is wider
  int chords = wide < Real(0.6) ? 32 : 12;
  Real cosine = wide < Real(0.6) ? Real(0.9987954562051724) : Real(0.9914448613738104);
  Real sine = wide < Real(0.6) ? Real(0.049067674327418015) : Real(0.13052619222005157);
  Real turn_cosine = wide < Real(0.6) ? Real(0.9951847266721969) : Real(0.9659258262890683);
  Real turn_sine = wide < Real(0.6) ? Real(0.0980171403295606) : Real(0.25881904510252074);
  Real total = Real(0);
  for (int i = 0; i < chords; ++i) {
    Real place = middle - half_length * cosine;
    Real root = sqrt(max((Real(1) - place) * (Real(1) + place), Real(1e-12)));
    Real u = min(max(c1 + wide * place / root, Real(-1)), Real(1));
    Real h = sqrt(max((Real(1) - u) * (Real(1) + u), Real(1e-12)));
    // the chord's lobe is as wide as narrow/root
    Real scale = root / narrow;
    Real a = (Real(0) - h - c2) * scale;
    Real b = (h - c2) * scale;
    Real over_a = Real(1) / (Real(1) + a * a);
    Real over_b = Real(1) / (Real(1) + b * b);
    Real toward = Real(1) + a * b;
    Real angle = angle_of(b - a, abs(toward));
    if (toward < Real(0)) angle = Real(3.141592653589793) - angle;
    Real ends = b * over_b - a * over_a;
    Real sum = angle + ends;
    if (sum > Real(0)) {
      Real bright = Real(1);
      if (limb > Real(0)) {
        Real mean = (over_a - over_b) / sum;
        Real square = (angle - ends) / sum;
        bright = disc_brightness(limb, chord_height(Real(1), h, c2 + mean / scale,
                                                    max(square - mean * mean, Real(0)) / (scale * scale)));
      }
      total = total + sine * sum * bright;
    }
    Real turned = cosine * turn_cosine - sine * turn_sine;
    sine = cosine * turn_sine + sine * turn_cosine;
    cosine = turned;
  }
  return total * half_length * narrow * wide * (Real(0.5) / Real(chords));
}

FORMULA Real heavy_density(Vec3 slopes) {
  Real t = Real(1) / (Real(1) + dot3(slopes, slopes));
  return t * t;
}

// The mean over the disc where the lobe is even over it: seven places of degree 5.
FORMULA Real heavy_wide(Vec3 slopes, Vec3 step_x, Vec3 step_y, Real limb) {
  Real reach2 = disc_reach2(limb);
  Real reach = sqrt(reach2);
  Real outer = Real(0.3333333333333333) * disc_variance(limb) / reach2;
  Vec3 a = reach * step_x;
  Vec3 b = reach * (Real(0.5) * step_x + Real(0.8660254037844386) * step_y);
  Vec3 c = b - a;
  // note: in variables, as arguments of calls are not `precise`
  Vec3 a_more = slopes + a;
  Vec3 a_less = slopes - a;
  Vec3 b_more = slopes + b;
  Vec3 b_less = slopes - b;
  Vec3 c_more = slopes + c;
  Vec3 c_less = slopes - c;
  return (Real(1) - Real(6) * outer) * heavy_density(slopes) +
         outer * (heavy_density(a_more) + heavy_density(a_less) + heavy_density(b_more) +
                  heavy_density(b_less) + heavy_density(c_more) + heavy_density(c_less));
}

// The mean over the disc where the lobe is Gaussian and wide: its variance added. x: exp(-x) is the
// density under a point Sun, dot3(slopes, slopes) or another law's that is nearly that.
FORMULA Real gaussian_wide(Real x, Vec3 slopes, Vec3 step_x, Vec3 step_y, Real limb) {
  Real twice = Real(2) * disc_variance(limb);
  Real xx = Real(1) + twice * (step_x.x * step_x.x + step_y.x * step_y.x);
  Real yy = Real(1) + twice * (step_x.y * step_x.y + step_y.y * step_y.y);
  Real xy = twice * (step_x.x * step_x.y + step_y.x * step_y.y);
  Real determinant = xx * yy - xy * xy;
  Real square = dot3(slopes, slopes);
  Real blurred = (yy * slopes.x * slopes.x - Real(2) * xy * slopes.x * slopes.y + xx * slopes.y * slopes.y) /
                 determinant;
  return exp_negative(x * (blurred / max(square, Real(1e-30)))) / sqrt(determinant);
}

// (1 + tan^2)^(-shine/2) over exp(-shine tan^2/2); bounded, as both are 0 where it is large.
FORMULA Real over_gaussian(Real shine, Vec3 slopes) {
  if (!(shine > Real(0))) return Real(1);
  Real x = dot3(slopes, slopes);
  Real more = max(x - Real(0.5) * shine * log_one_plus(min(x * Real(2) / shine, Real(1e6))), Real(0));
  return Real(1) / exp_negative(min(more, Real(20)));
}

// The mean over the disc of the slopes' density, which is 1 where they are 0; from: of lit_from,
// slope as there. shine: the density is (1 + tan^2)^(-shine/2), alpha^2 is 2/shine; 0: it is not.
FORMULA Real density_over_disc(Real heavy, Real shine, Incidence light, Real slope, Vec3 over_x, Vec3 over_y,
                               Vec3 from, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  Real radius = disc_radius(light.alpha2);
  Vec3 viewer = below_index(to_viewer, normal, index);
  Real narrow_lobe =
      shows_disc(heavy, slope, radius, dot3(tilted, below_index(light.to_light, normal, index) + viewer));
  Vec3 inside = below_index(from, normal, index);
  Vec3 both = inside + viewer;
  Real cos_sum = max(dot3(tilted, both), Real(1e-6));
  Vec3 slopes = Vec3(dot3(over_x, both) / cos_sum, dot3(over_y, both) / cos_sum, Real(0));
  Vec3 axis_x = disc_x(light.to_light);
  Vec3 axis_y = disc_y(light.to_light);
  Vec3 moved = from - light.to_light;
  Real near_lobe = dot3(moved, moved);
  // what the lengths of half vectors add is no small step far from a narrow lobe
  Vec3 turning = slopes;
  if (narrow_lobe > Real(0) && !(near_lobe > Real(0))) turning = Vec3(Real(0));
  Vec3 step_x = slope_step(light_step(axis_x, radius, light.to_light, from, inside, normal, index), turning, over_x,
                           over_y, tilted, cos_sum);
  Vec3 step_y = slope_step(light_step(axis_y, radius, light.to_light, from, inside, normal, index), turning, over_x,
                           over_y, tilted, cos_sum);
  if (near_lobe > Real(0)) {
    Real determinant = slope_determinant(step_x, step_y);
    Vec3 centre = place_of_peak(Vec3(dot3(from, axis_x) / radius, dot3(from, axis_y) / radius, Real(0)), slopes, step_x,
                           step_y, determinant);
    Vec3 axis = narrow_axis(slope_form(step_x, step_y));
    Real narrow = Real(1) / sqrt(max(axis.z, Real(1e-30)));
    Real wide = Real(1) / (narrow * abs(determinant));
    Real across = centre.x * axis.x + centre.y * axis.y;
    Real along = centre.y * axis.x - centre.x * axis.y;
    if (!(heavy > Real(0)))
      return gaussian_over_disc(across, along, narrow, wide, light.limb) * over_gaussian(shine, slopes);
    return heavy_over_disc(across, along, narrow, wide, light.limb);
  }
  if (heavy > Real(0)) return heavy_wide(slopes, step_x, step_y, light.limb);
  if (narrow_lobe > Real(0)) return Real(0);
  Real square = dot3(slopes, slopes);
  if (shine > Real(0)) square = Real(0.5) * shine * log_one_plus(min(square * Real(2) / shine, Real(1e30)));
  return gaussian_wide(square, slopes, step_x, step_y, light.limb);
}

// What a lobe is multiplied by whose light is taken from there: cosines, and the disc's foreshortening.
// Exactly 1 under a point.
FORMULA Real lobe_weight(Incidence light, Vec3 from, Vec3 normal) {
  if (!(light.alpha2 > Real(0))) return Real(1);
  return dot3(normal, from) / (max(dot3(normal, light.to_light), Real(1e-10)) * dot3(light.to_light, from));
}

// The light that a mirror shows to a viewer, if it lies in the disc, else the disc's centre.
FORMULA Vec3 disc_mirrored(Incidence light, Vec3 to_viewer, Vec3 tilted) {
  Vec3 mirrored = mirrored_about(tilted, to_viewer);
  Vec3 apart = mirrored - light.to_light;
  if (!(dot3(apart, apart) < Real(8) * light.alpha2)) return light.to_light;
  return mirrored;
}

// What a mirror shows of the light's disc, whose squared radius is 8 light.alpha2; from: of disc_mirrored.
// 0 under a light without a disc: that is a direction, not a lobe.
FORMULA Real disc_lobe(Incidence light, Vec3 from, Vec3 to_viewer, Vec3 tilted) {
  if (!(light.alpha2 > Real(0))) return Real(0);
  Real cos_nl = dot3(tilted, light.to_light);
  Real cos_nv = dot3(tilted, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  // the chord from the light to the mirrored viewer
  Vec3 turned = cross3(tilted, light.to_light + to_viewer);
  Real apart = cos_nl - cos_nv;
  Real square = (dot3(turned, turned) + apart * apart) / (Real(8) * light.alpha2);
  if (!(square < Real(1))) return Real(0);
  return disc_brightness(light.limb, sqrt(Real(1) - square)) * Real(0.039788735772973836) * dot3(light.to_light, from) /
         (light.alpha2 * max(dot3(tilted, from), Real(1e-10)));
}
