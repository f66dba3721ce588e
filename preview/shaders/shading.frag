// The radiance of what is seen, towards the camera. Defined in front: version, uniforms.glsl, any of PAINTED
// ROUGH BRUSHED TWO_SLOPES (the microfacets have) REFLECTING ONE_MATERIAL ADDED (all lights after the Sun), POINTS
// (none of them has a size), PLANETS (with planets.glsl), BODIES (whose limbs bend), INDIRECT (with indirect.glsl),
// sample_place.glsl, turning.glsl with BRUSHED, SHADOWED (with shadow.glsl), and the
// formulas of its BRDF model (materials/formulas), with what reads a material (materials/formula_text.h).

VIEW_BLOCK
#ifndef SHADOWED
#ifdef ADDED
LAMPS_BLOCK
#else
LIGHT_BLOCK
#endif
#endif

#ifdef ONE_MATERIAL
const int first_row = 0;
// a material record of a pan file as it stands
layout(std140, binding = kMaterialBinding) uniform MaterialRecord { vec4 rows[kMaterialRows]; }
material;
vec4 material_row(int i) { return material.rows[i]; }
#else
vec4 material_row(int i) { return texelFetch(materials, i); }
#endif

// a: 1, once for all lights. Where errors are predicted (sampling.h), of solar cells, whose pattern is filtered to the sample
// already: 1 and what the mean of the pattern shows, rms over the channels, in parts of
// the irradiance's largest. Of imposters, 1 and what relief finer than the shadow map's texels may add, the
// mean of the channels, in the same parts.
layout(location = 0) out vec4 radiance;
#ifdef ADDED
const float kCoverage = 0.0;
#else
const float kCoverage = 1.0;
#endif

// Zero stays zero: such a point is not lit, and never a NaN.
vec3 unit_or_zero(vec3 v) {
  float square = dot(v, v);
  return square > 0.0 ? v * inversesqrt(square) : vec3(0.0);
}

#ifdef ADDED
// pow() of drivers errs by 1e-6 in the logarithm.
float power(float base, float exponent) {
  float result = fract(exponent) > 0.0 ? pow(base, fract(exponent)) : 1.0;
  for (uint n = uint(min(exponent, 1e9)); n > 0u; n >>= 1) {
    if ((n & 1u) != 0u) result *= base;
    base *= base;
  }
  return result;
}

// A light after the Sun at a point, unoccluded, as light/light.cpp.
Incidence light_at(vec3 at, int lamp) {
  vec4 place = lamps.place[lamp];
  vec4 intensity = lamps.intensity[lamp];
#ifndef POINTS
  vec4 kind = lamps.kind[lamp];
  if (kind.x == 2.0) return Incidence(place.xyz, intensity.rgb, place.w, kind.w);
#endif
  vec3 toward = place.xyz - at;
  float square = dot(toward, toward);
  vec3 to_light = square > 0.0 ? toward * inversesqrt(square) : vec3(0.0, 0.0, 1.0);
#ifdef POINTS
  float nearest = square;
#else
  float nearest = kind.x == 1.0 ? square + place.w : max(square, place.w);
#endif
  vec4 axis = lamps.axis[lamp];
  float cosine = -dot(axis.xyz, to_light);
  float share = cosine >= axis.w ? 1.0 : 0.0;
  if (intensity.w == 1.0)
    share *= max(cosine, 0.0);
  else if (intensity.w > 0.0)
    share *= cosine > 0.0 ? power(min(cosine, 1.0), intensity.w) : 0.0;
  // no square of a distance is as small that counts, and no irradiance infinite
  share = nearest > 1e-30 ? share / nearest : 0.0;
  return Incidence(to_light, min(intensity.rgb * share, vec3(1e30)),
#ifdef POINTS
                   0.0,
#else
                   place.w > 0.0 ? 0.125 * place.w / nearest : 0.0,
#endif
                   0.0);
}
#else
// The Sun at a sample, unoccluded: from infinity, the same everywhere.
Incidence light_at() {
  return Incidence(light.to_light, light.irradiance, light.alpha2, light.limb_darkening);
}
#endif

// The radius of a disc of one brightness as far from its centre on average as the light's, which is darker
// at its limb.
float disc_radius(Incidence from) {
  float darkened = from.limb;
  return sqrt(8.0 * from.alpha2) * (1.0 - 0.410951 * darkened) / (1.0 - 0.333333 * darkened);
}

// The direction to a light; where the horizon cuts its disc, lifted until the cosine is the mean over the
// disc, as of what stands above: (2 + t²)·sqrt(1 - t²) + 3 t·asin(t), over 3 pi, by its series within 6e-5.
vec3 to_mean_light(vec3 normal, Incidence from) {
  float radius = disc_radius(from);
  float cosine = dot(normal, from.to_light);
  float t = cosine / radius;
  float square = t * t;
  if (!(square < 1.0)) return from.to_light;
  float mean = 0.5 * t + 0.212227 + square * (0.317672 - square * (0.0236467 + square * 0.00623719));
  return from.to_light + normal * (max(mean, 0.0) * radius - cosine);
}

#ifdef ADDED
// Of an alpha2 beyond it, discs of lights count as bumps of the surface: those of lamps close by.
const float kWideDisc = 1e-3;

void widen(inout Surface surface, inout Incidence from, vec3 normal) {
  if (dot(surface.tangent, surface.tangent) < 0.5) {
    vec3 aside = abs(normal.z) < 0.7 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    surface.tangent = unit_or_zero(cross(normal, aside));
  }
  surface.bump_x = max(surface.bump_x, 0.0) + from.alpha2;
  surface.bump_y = max(surface.bump_y, 0.0) + from.alpha2;
  from.alpha2 = 0.0;
  from.limb = 0.0;
}
#endif

#ifdef ROUGH
// What a roughness map says. Lambert's BRDF is linear in the normal, so the length of the mean normal
// gives the mean over bumps that a sample is too large to show.
void roughen(inout Surface surface, float length_of_mean, float roughness) {
  surface.diffuse *= length_of_mean;
  surface.oren *= roughness;
  // floor: what the Sun's disc blurs is 50 times as much
  surface.alpha_x = max(surface.alpha_x * roughness, min(surface.alpha_x, 1e-4));
  surface.alpha_y = max(surface.alpha_y * roughness, min(surface.alpha_y, 1e-4));
}
#endif

#ifdef BRUSHED
// Bumps that a sample is too large to show, along and across the principal axes of their squared
// slopes (xx, xy, yy in the frame of the surface's tangent), those of the microfacets included where
// these have two.
void add_bumps(inout Surface surface, vec3 bumps, vec3 normal) {
  vec3 own = vec3(0.0);
#ifdef TWO_SLOPES
  own = vec3(surface.alpha_x * surface.alpha_x, 0.0, surface.alpha_y * surface.alpha_y);
  if (own.x == own.z) own = vec3(0.0);
  float inside = surface.coat_index > 1.0 ? 1.0 / (surface.coat_index * surface.coat_index) : 1.0;
#else
  const float inside = 1.0;
#endif
  vec2 axis = narrow_axis(own + inside * bumps).xy;
  vec2 square = axis * axis;
  float twice = 2.0 * axis.x * axis.y;
  surface.bump_x = max(square.x * bumps.x + twice * bumps.y + square.y * bumps.z, 1e-12);
  surface.bump_y = max(square.y * bumps.x - twice * bumps.y + square.x * bumps.z, 0.0);
  surface.tangent = axis.x * surface.tangent + axis.y * cross(normal, surface.tangent);
  vec2 tilt = vec2(surface.tilt_x, surface.tilt_y);
  surface.tilt_x = axis.x * tilt.x + axis.y * tilt.y;
  surface.tilt_y = axis.x * tilt.y - axis.y * tilt.x;
#ifdef TWO_SLOPES
  if (own.x > 0.0) {
    surface.alpha_x = sqrt(square.x * own.x + square.y * own.z);
    surface.alpha_y = sqrt(square.y * own.x + square.x * own.z);
  }
#endif
}
#endif

#ifdef BRUSHED
// A normal that turns from sample to sample (turning.glsl).
void add_turning(inout Surface surface, vec3 squares, float lobe, vec3 to_light, vec3 to_viewer, vec3 normal) {
  // both cosines are to the viewer: here, and where the normal is the half vector
  float mirroring = max(0.5 * length(to_light + to_viewer), 1e-3);
  float ratio = max(dot(normal, to_viewer), 0.0) / mirroring;
  vec3 slopes = turning_slopes(squares, min(ratio * ratio, kMostTurning), mirroring, lobe);
  if (!(slopes.x + slopes.z > 0.0)) return;
  add_bumps(surface, max(slopes, vec3(1e-12, -1e30, 1e-12)), normal);
  // a Gaussian of slopes holds more of the directions about its mean than one of angles, by its variance
  surface.specular /= 1.0 + 0.5 * max(surface.bump_x, surface.bump_y);
}
#endif

#ifdef ROUGH
// Whether another draw of a class, added to its light, writes what the mean of the pattern of solar cells shows.
bool is_patternless() { return item_range.w != 0u; }

// What geometry.frag leaves of solar cells where a sample is as large as many: the paint, the share of
// cells without fingers, and that of cells with theirs.
void mean_cells(int row, vec3 cell, out vec3 paint, out vec2 shares) {
  vec2 extents = vec2(1.0) - material_cell_gap(row);
  float covered = material_fingers(row) > 0.0 ? material_finger_width(row) : 0.0;
  vec3 back = material_coat_return(row);
  vec3 finger = material_finger_color(row);
  vec3 mixed = (1.0 - covered) * cell / max(1.0 - min(cell, vec3(1.0)) * back, vec3(1e-10)) +
               covered * finger / max(1.0 - min(finger, vec3(1.0)) * back, vec3(1e-10));
  paint = mixed / (1.0 + mixed * back);
  shares = vec2(1.0 - covered, extents.x * extents.y);
}
#endif

#if defined(SHADOWED) && !defined(ADDED)
#ifdef BODIES
// Integral of the disc's brightness along a chord of half-length `width`, from x.x to x.y.
float chord_light(vec2 x, float width) {
  if (!(x.x < x.y)) return 0.0;
  float u = light.limb_darkening;
  vec2 t = clamp(x / width, vec2(-1.0), vec2(1.0));
  vec2 round_part = t * sqrt(max(1.0 - t * t, vec2(0.0))) + asin(t);
  return (1.0 - u) * (x.y - x.x) + 0.5 * u * width * width * (round_part.y - round_part.x);
}

// What a body hides of a chord of the Sun's disc, two spans of x: where c.x + 2·c.y·x + c.z·x² > 0, as
// sky::add_hidden(). from, middle, along: in the space where the body is the unit sphere.
void hidden_spans(vec3 from, vec3 middle, vec3 along, float width, out vec2 first, out vec2 second) {
  first = second = vec2(0.0);
  vec3 w = cross(from, middle), wx = cross(from, along);
  vec3 c = vec3(dot(middle, middle) - dot(w, w), dot(middle, along) - dot(w, wx), dot(along, along) - dot(wx, wx));
  // in front
  float d0 = -dot(from, middle), d1 = -dot(from, along);
  vec2 part = vec2(-width, width);
  if (d1 > 0.0) part.x = max(part.x, -d0 / d1);
  if (d1 < 0.0) part.y = min(part.y, -d0 / d1);
  if (d1 == 0.0 && !(d0 > 0.0)) return;
  float discriminant = c.y * c.y - c.x * c.z;
  if (c.z == 0.0 || !(discriminant > 0.0)) {
    if (c.z > 0.0 || (c.z == 0.0 && c.x > 0.0)) first = part;
    return;
  }
  float sum = -(c.y + (c.y < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
  vec2 roots = vec2(sum / c.z, sum != 0.0 ? c.x / sum : sum / c.z);
  roots = vec2(min(roots.x, roots.y), max(roots.x, roots.y));
  if (c.z < 0.0) {
    first = vec2(max(roots.x, part.x), min(roots.y, part.y));
  } else {
    first = vec2(part.x, min(roots.x, part.y));
    second = vec2(max(roots.y, part.x), part.y);
  }
}

vec2 common_span(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); }

// How far along a node and the next one the Sun stands beyond a limb with air, t radii of its disc.
float sunset_node(float t) {
  return clamp((t - light.sunset.x) * light.sunset.y, 0.0, float(kSunsetNodes - 1));
}

// The share of the Sun's disc beside one body or two, at a place: by chords of the disc that point from
// its middle to the first body, as sky::Sky::sun_share(). 24 chords: 7e-4 of the disc; 96 for two,
// whose edges lie anywhere. Behind air chords are along the limb, each with a share of its own.
vec3 share_beside_bodies(vec3 at) {
  int chords = light.eclipses > 1 || light.sunset.y > 0.0 ? 96 : 24;
  vec4 place = vec4(at, 1.0);
  vec3 from[2], middle[2], along[2], across[2];
  vec2 turn = vec2(1.0, 0.0);
  for (int i = 0; i < 2; ++i) {
    int body = min(i, light.eclipses - 1);
    from[i] = vec3(dot(light.eclipse_space[3 * body], place), dot(light.eclipse_space[3 * body + 1], place),
                   dot(light.eclipse_space[3 * body + 2], place));
    if (dot(from[i], from[i]) < 1.0) return vec3(0.0);
    middle[i] = light.eclipse_sun[3 * body].xyz;
    vec3 x = light.eclipse_sun[3 * body + 1].xyz, y = light.eclipse_sun[3 * body + 2].xyz;
    if (i == 0 && !(light.sunset.y > 0.0)) {
      vec2 beside = -vec2(dot(from[0], x), dot(from[0], y));
      float far = length(beside);
      if (far > 0.0) turn = beside / far;
    }
    along[i] = turn.x * x + turn.y * y;
    across[i] = turn.x * y - turn.y * x;
  }
  float hidden = 0.0;
  vec3 arriving = vec3(0.0);
  float edge = dot(light.eclipse, place);
  for (int k = 0; k < chords; ++k) {
    float angle = 3.14159265 * ((float(k) + 0.5) / float(chords) - 0.5);
    float y = light.eclipse_chords * sin(angle);
    float width = sqrt(1.0 - y * y);
    vec2 a, b, c, d;
    hidden_spans(from[0], middle[0] + y * across[0], along[0], width, a, b);
    float sum = chord_light(a, width) + chord_light(b, width);
    if (light.eclipses > 1) {
      hidden_spans(from[1], middle[1] + y * across[1], along[1], width, c, d);
      sum += chord_light(c, width) + chord_light(d, width) - chord_light(common_span(a, c), width) -
             chord_light(common_span(a, d), width) - chord_light(common_span(b, c), width) -
             chord_light(common_span(b, d), width);
    }
    hidden += sum * cos(angle);
    if (light.sunset.y > 0.0) {
      float node = sunset_node(edge + y);
      float first = min(floor(node), float(kSunsetNodes - 2));
      vec3 through = mix(light.sunset_through[int(first)].rgb, light.sunset_through[int(first) + 1].rgb, node - first);
      arriving += through * ((chord_light(vec2(-width, width), width) - sum) * cos(angle));
    }
  }
  float whole = float(chords) * (1.0 - light.limb_darkening / 3.0);
  if (light.sunset.y > 0.0) return clamp(arriving / whole, vec3(0.0), vec3(1.0));
  return vec3(clamp(1.0 - hidden * light.eclipse_chords / whole, 0.0, 1.0));
}

#endif

// The share of the Sun's disc beyond the straight limb of a body: sky::share_beyond().
float share_beyond_edge(vec3 at) {
  float t = dot(light.eclipse, vec4(at, 1.0));
  if (t >= 1.0) return 1.0;
  t = max(t, -1.0);
  float u = light.limb_darkening;
  float even = 0.5 + (asin(t) + t * sqrt(1.0 - t * t)) * 0.31830988618379067;
  float round_disc = 0.5 + 0.25 * t * (3.0 - t * t);
  return ((1.0 - u) * even + u * 0.66666667 * round_disc) / (1.0 - u * 0.33333333);
}

#ifdef BODIES
// sky::Sunset::at()
vec3 share_through_air(vec3 at) {
  float place = sunset_node(dot(light.eclipse, vec4(at, 1.0)));
  float node = min(floor(place), float(kSunsetNodes - 2));
  return mix(light.sunset_shares[int(node)].rgb, light.sunset_shares[int(node) + 1].rgb, place - node);
}

vec3 share_beyond_limb(vec3 at) {
  if (light.eclipses > 0) return share_beside_bodies(at);
  return light.sunset.y > 0.0 ? share_through_air(at) : vec3(share_beyond_edge(at));
}
#else
float share_beyond_limb(vec3 at) { return share_beyond_edge(at); }
#endif
#endif

// What a sample has for every light.
struct Seen {
  ivec2 place;
  vec3 at;          // of ADDED, and the surface's own normal
  vec3 own_normal;
  vec3 to_viewer;
  vec3 normal;        // unit, or 0
  float turning;      // length of the normal sample where the normal turns from sample to sample, else 0
  vec3 slopes;        // what turning adds
  vec4 cells;         // roughness_sample
  vec2 shares;        // of solar cells: cells without fingers, and those with theirs
  float gap;          // length of the mean normal
  int first_row;
};

// What one light sends to the viewer, with what is said of errors.
vec4 sent_of(Surface surface, Incidence from, const Seen seen, int lamp, vec3 emitted) {
#ifdef BRUSHED
  if (seen.turning > 0.0)
    add_turning(surface, seen.slopes, seen.turning, from.to_light, seen.to_viewer, seen.normal);
#endif
  vec4 sent;
  vec3 to_middle = from.to_light;
#ifdef POINTS
  const float radius = 0.0;
  const bool wide = false;
#else
  from.to_light = to_mean_light(seen.normal, from);
#ifdef ADDED
  // a disc may be wide: BRDFs expect unit directions, and the cosine stays
  float lifted = length(from.to_light);
  from.to_light /= lifted;
  from.irradiance *= lifted;
  float radius = disc_radius(from);
  bool wide = from.alpha2 > kWideDisc;
  if (wide) widen(surface, from, seen.normal);
#endif
#endif
#ifdef ROUGH
  bool has_cells = material_cell_count(seen.first_row).x > 0.0;
  if (has_cells) {
    surface.weights.x = 1.0;
    surface.weights.y *= seen.shares.x;
  }
#endif
  // where the normal faces away from the viewer, at the limb of a smooth mesh, surface_brdf takes
  // the viewer to the horizon
  sent = vec4(surface_radiance(surface, from, seen.to_viewer, seen.normal) + emitted, kCoverage);
#ifdef ROUGH
  // Lambert's gaps between cells, without cover glass
  if (has_cells) {
    float lit = max(dot(seen.normal, from.to_light), 0.0) * 0.31830988618379067;
    sent.rgb = seen.shares.y * sent.rgb +
               (1.0 - seen.shares.y) * (lit * seen.gap) * material_gap_color(seen.first_row) * from.irradiance;
  }
  if (is_patternless()) sent.a = has_cells ? sqrt(dot(sent.rgb, sent.rgb) / 3.0) / view.told_irradiance : 0.0;
#endif
#ifdef SHADOWED
  if (dot(seen.normal, from.to_light) > 0.0) {
#ifdef ADDED
    // the map looks along the disc's middle: surfaces whose horizon cuts the disc would shade themselves
    float above = wide ? clamp(dot(seen.normal, to_middle) / radius, 0.0, 1.0) : 1.0;
    vec2 visibility = lamp_visibility(lamp, seen.place, seen.at, seen.own_normal, to_middle, radius, above);
#else
    vec2 visibility = light_visibility(seen.place, to_middle, disc_radius(from));
    vec3 place = uintBitsToFloat(texelFetch(position_samples, seen.place, 0).xyz);
#ifdef BODIES
    // each band has its own
    vec3 share = share_beyond_limb(place);
    vec3 visible = visibility.x * share;
    visibility *= share.g;
#else
    visibility *= share_beyond_limb(place);
#endif
#endif
#ifndef BODIES
    float visible = visibility.x;
#endif
    // what is left where the light does not shine
    vec3 shaded = emitted;
#ifdef ROUGH
    if (has_cells) shaded *= seen.shares.y;
#endif
    // never below 0, whatever rounding does
    if ((view.flags & kTellsRelief) != 0u)
      sent.a += max(visibility.y - visibility.x, 0.0) * dot(sent.rgb - shaded, vec3(1.0 / 3.0)) /
                view.told_irradiance;
    sent.rgb = mix(shaded, sent.rgb, visible);
  }
#endif
  return sent;
}

#if defined(PLANETS) || defined(INDIRECT)
// What light of planets and of other surfaces sends to the viewer.
vec3 sent_of_wide_light(Surface surface, const Seen seen) {
#ifdef ROUGH
  bool has_cells = material_cell_count(seen.first_row).x > 0.0;
  if (has_cells) {
    surface.weights.x = 1.0;
    surface.weights.y *= seen.cells.w;
  }
#endif
#ifdef PLANETS
  WideLight light = planet_sent(surface, seen.place, seen.to_viewer, seen.normal);
#else
  WideLight light = WideLight(vec3(0.0), vec3(0.0), vec3(0.0));
#endif
#ifdef INDIRECT
  WideLight other = indirect_sent(surface, seen.place, seen.to_viewer, seen.normal);
  light.irradiance += other.irradiance;
  light.diffuse += other.diffuse;
  light.mirrored += other.mirrored;
#endif
  vec3 sent = light.diffuse + light.mirrored;
#ifdef ROUGH
  // Lambert's gaps between cells, without cover glass
  if (has_cells)
    sent = seen.cells.z * sent +
           (1.0 - seen.cells.z) * seen.gap * 0.31830988618379067 * material_gap_color(seen.first_row) *
               light.irradiance;
#endif
  return sent;
}
#endif

#ifdef ADDED
// Whether a lamp, as far as its disc, stands above the horizon of a sample and shines there: no fewer than
// light_at() and surface_brdf() say.
bool may_light(const Seen seen, int lamp) {
  vec4 place = lamps.place[lamp];
#ifndef POINTS
  if (lamps.kind[lamp].x == 2.0) return dot(seen.normal, place.xyz) > -sqrt(8.0 * place.w);
#endif
  vec4 axis = lamps.axis[lamp];
  vec3 toward = place.xyz - seen.at;
  float above = dot(seen.normal, toward);
  bool in_cone = -dot(axis.xyz, toward) >= (axis.w - 1e-6) * length(toward);
  return in_cone && (above > 0.0 || above * above < place.w);
}
#endif

void main() {
  Seen seen;
  seen.place = sample_place();
  uvec4 found = texelFetch(normal_samples, seen.place, 0);
  vec3 normal_sample = uintBitsToFloat(found.xyz);
  // note: what is here belongs to the class of this pass, by the depth test (classes.frag)
#ifndef ONE_MATERIAL
  int item = int(found.w & ~kTurns) - 1 - int(item_range.x);
  int first_row = kMaterialRows * int(texelFetch(items, item).x);
#endif
  seen.first_row = first_row;

  // the line of sight of this sample, free of where the surface is and how far
  vec3 view_ray = view.ray + (float(seen.place.x) + 0.5) * view.ray_right +
               (float(seen.place.y) + 0.5) * view.ray_down;
  seen.to_viewer = -normalize(view_ray);
  seen.normal = unit_or_zero(normal_sample);

  Surface surface = surface_of(first_row);
#ifdef ROUGH
  vec3 whole_cell = surface.weights.x * surface.diffuse;
#endif
#ifdef PAINTED
  vec4 albedo = texelFetch(albedo_samples, seen.place, 0);
  surface.diffuse = albedo.rgb;
#endif
#ifdef ROUGH
  // of solar cells the paint has the colour of cells and fingers, weights included
  seen.cells = texelFetch(roughness_samples, seen.place, 0);
  seen.gap = albedo.a;
  roughen(surface, albedo.a, seen.cells.x);
  seen.shares = seen.cells.wz;
  if (is_patternless() && material_cell_count(first_row).x > 0.0)
    mean_cells(first_row, whole_cell, surface.diffuse, seen.shares);
#endif

#ifdef REFLECTING
  surface.reflectance = texelFetch(reflectance_samples, seen.place, 0).rgb;
#endif
#ifdef BRUSHED
  vec4 brush_sample = texelFetch(tangent_samples, seen.place, 0);
  vec3 brush = unit_or_zero(brush_sample.xyz);
  surface.tangent = unit_or_zero(brush - seen.normal * dot(seen.normal, brush));
  seen.slopes = vec3(seen.cells.y, brush_sample.w, length(brush_sample.xyz));
  seen.turning = (found.w & kTurns) != 0u ? length(normal_sample) : 0.0;
  if (!(seen.turning > 0.0) && seen.slopes.x > 0.0) add_bumps(surface, seen.slopes, seen.normal);
#endif

#ifdef ADDED
  uvec4 placed = texelFetch(position_samples, seen.place, 0);
  seen.at = uintBitsToFloat(placed.xyz);
#ifdef SHADOWED
  seen.own_normal = unpacked_normal(placed.w);
#endif
  radiance = vec4(0.0);
  // Software contexts run both sides of a branch: lamps that do not light a sample are found first, by a few
  // operations each, and each sample goes on to the next of its own.
  int first = 0;
  do {
    uint lit = 0u;
    int lamp = first;
    int end = min(first + 32, lamps.count);
    do {
      if (may_light(seen, lamp)) lit |= 1u << (lamp - first);
      ++lamp;
    } while (lamp < end);
    do {
      int next = first + max(findLSB(lit), 0);
      vec4 sent = sent_of(surface, light_at(seen.at, next), seen, next, vec3(0.0));
      if (lit != 0u) radiance += sent;
      lit &= lit - 1u;
    } while (lit != 0u);
    first = end;
  } while (first < lamps.count);
#else
  radiance = sent_of(surface, light_at(), seen, 0, surface_emission(surface, view.white));
#if defined(PLANETS) || defined(INDIRECT)
  radiance.rgb += sent_of_wide_light(surface, seen);
#endif
#endif
#ifdef ROUGH
  if (is_patternless()) radiance.rgb = vec3(0.0);
#endif
}
