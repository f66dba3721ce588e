// Light that other surfaces send, by surfels near a sample (light/surfels.h). Defined in front: wide_lobes.glsl with what it
// needs, sample_normal.glsl.

// As light::irradiance_at().
const float kFacingScale = 1.0 / 0.7;
const float kAcross = 8.0;
const int kMostLimits = 3;
#if defined(COATED) || defined(LOBE_ANY)
#define GLOSSY
#endif
// Of a direction's radiance to the mean one, as of light from the lowest band alone.
const float kMostRatio = 16.0;
// Of all light, taken as even: shares of bands are those of a hundred rays. Fitted.
const float kEven = 0.3;

uint axis_direction(vec3 n) {
  vec3 a = abs(n);
  if (a.x >= a.y && a.x >= a.z) return n.x < 0.0 ? 1u : 0u;
  if (a.y >= a.z) return n.y < 0.0 ? 3u : 2u;
  return n.z < 0.0 ? 5u : 4u;
}

vec3 surfel_normal(uint word) {
  vec2 at = (vec2(float(word & 255u), float(word >> 8 & 255u)) - 127.0) / 127.0;
  vec3 normal = vec3(at, 1.0 - abs(at.x) - abs(at.y));
  vec2 upper = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(at, vec2(0.0)));
  if (normal.z < 0.0) normal.xy = (1.0 - abs(at.yx)) * upper;
  return normalize(normal);
}

// The list of surfels near a place: first, end of those without limits, end.
uvec3 surfel_list(vec3 at, vec3 normal) {
  vec3 cell = floor(at * indirect.cells_a_metre);
  if (any(lessThan(cell, vec3(0.0))) || any(greaterThanEqual(cell, vec3(65536.0)))) return uvec3(0u);
  uvec3 cube = uvec3(cell);
  uint xy = cube.x | cube.y << 16;
  uint zd = cube.z | axis_direction(normal) << 16;
  uint h = xy * 0x9E3779B1u ^ zd * 0x85EBCA77u;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  uint slot = (h ^ h >> 13) & indirect.last_slot;
  for (int probe = 0; probe < indirect.probes; ++probe) {
    uvec4 list = texelFetch(surfel_cells, int(slot));
    if (list.w == 0u) break;
    uint end = list.z + (list.w & 0xffffu);
    if (list.x == xy && list.y == zd) return uvec3(list.z, end - (list.w >> 16), end);
    slot = (slot + 1u) & indirect.last_slot;
  }
  return uvec3(0u);
}

// Means over surfels near a place, by their weights.
struct Near {
  vec3 irradiance;
  // Of GLOSSY, times the mean of the channels: light::SurfelSides' across and bands.
  vec3 across, bands;
  vec3 normal;
};

// Whether a place is on the side of all limits of a surfel.
//
//   word  of its place: its normal and the number of limits
bool is_within(int surfel, uint word, vec3 at) {
  bool within = true;
  for (int k = 0; k < int(word >> 16); ++k)
    within = within && dot(texelFetch(surfel_limits, kMostLimits * surfel + k), vec4(at, 1.0)) >= 0.0;
  return within;
}

// Sum over the four samples of a quad, the same for each but for rounding.
vec4 quad_sum(vec4 value, vec2 aside) {
  value = 2.0 * value + aside.x * dFdxFine(value);
  return 2.0 * value + aside.y * dFdyFine(value);
}

// Adds a surfel to sums over those near a place.
void add_surfel(int surfel, vec3 at, vec3 normal, bool limited, inout vec4 sum, inout Near near) {
  vec4 place = texelFetch(surfel_light, 3 * surfel);
  vec4 sent = texelFetch(surfel_light, 3 * surfel + 1);
  vec3 apart = place.xyz - at;
  uint word = uint(place.w);
  vec3 its_normal = surfel_normal(word);
  float across = dot(apart, its_normal);
  float left = max(1.0 - (dot(apart, apart) + kAcross * across * across) * sent.w * sent.w, 0.0);
  float facing = clamp(dot(normal, its_normal) * kFacingScale, 0.0, 1.0);
  float weight = left * left * facing * facing;
  if (limited && !is_within(surfel, word, at)) weight = 0.0;
  sum += weight * vec4(sent.rgb, 1.0);
#ifdef GLOSSY
  vec4 sides = texelFetch(surfel_light, 3 * surfel + 2);
  uint bands = uint(sides.w);
  float mean = weight / 3.0 * (sent.r + sent.g + sent.b);
  near.across += mean * sides.xyz;
  near.bands += mean / 255.0 * vec3(float(bands & 255u), float(bands >> 8 & 255u), float(bands >> 16));
  near.normal += weight * its_normal;
#endif
}

// A place in the frame of the grid, and the normal there.
void place_in_grid(ivec2 sample_at, out vec3 at, out vec3 normal) {
  uvec4 found = texelFetch(position_samples, sample_at, 0);
  vec4 place = vec4(uintBitsToFloat(found.xyz), 1.0);
  vec3 own = unpacked_normal(found.w);
  for (int k = 0; k < 3; ++k) {
    at[k] = dot(indirect.from_sample[k], place);
    normal[k] = dot(indirect.from_sample[k].xyz, own);
  }
  normal *= inversesqrt(max(dot(normal, normal), 1e-30));
}

// Samples of a pixel that stand close together have the light at the first of their quad, and look
// up a quarter of its surfels each. Expects: uniform control flow.
Near surfels_near(ivec2 sample_at) {
  vec3 at, normal, first_at, first_normal;
  place_in_grid(sample_at, at, normal);
  // quads are of one pixel
  ivec2 odd = (sample_blocks.x & 1u) == 0u ? ivec2(gl_FragCoord.xy) & 1 : ivec2(0);
  place_in_grid(sample_at - odd, first_at, first_normal);
  vec2 aside = 1.0 - 2.0 * vec2(odd);
  vec3 apart = (first_at - at) * indirect.cells_a_metre;
  // relief of foil turns normals within a pixel; what stands a step behind has light of its own
  bool alike = (sample_blocks.x & 1u) == 0u && dot(first_normal, normal) > 0.5 && dot(apart, apart) < 1.0 &&
               abs(dot(apart, normal)) < 0.25;
  bool shared_by_four = quad_sum(vec4(alike ? 1.0 : 0.0), aside).x > 3.5;
  if (shared_by_four) {
    at = first_at;
    normal = first_normal;
  }
  uvec3 list = surfel_list(at, normal);
  uint stride = shared_by_four ? 4u : 1u;
  uint i = list.x + (shared_by_four ? uint(odd.x + 2 * odd.y) : 0u);
  vec4 sum = vec4(0.0);
  Near near = Near(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  for (; i < list.y; i += stride) add_surfel(int(texelFetch(surfel_entries, int(i)).x), at, normal, false, sum, near);
  for (; i < list.z; i += stride) add_surfel(int(texelFetch(surfel_entries, int(i)).x), at, normal, true, sum, near);
  vec4 whole = quad_sum(sum, aside);
  if (shared_by_four) sum = whole;
  float scale = sum.w > 0.0 ? 1.0 / sum.w : 0.0;
  near.irradiance = sum.rgb * scale;
#ifdef GLOSSY
  vec3 across = quad_sum(vec4(near.across, 0.0), aside).xyz;
  vec3 bands = quad_sum(vec4(near.bands, 0.0), aside).xyz;
  vec3 facing = quad_sum(vec4(near.normal, 0.0), aside).xyz;
  near.across = scale * (shared_by_four ? across : near.across);
  near.bands = scale * (shared_by_four ? bands : near.bands);
  near.normal = shared_by_four ? facing : near.normal;
#endif
  return near;
}

struct Arriving {
  vec3 irradiance;
  float ratio;  // of the radiance that a mirror shows to the mean one
};

// Von Mises' distribution of azimuths, of that of a direction, relative to an even one.
float side_ratio(vec3 across, vec3 seen, vec3 normal) {
  // the concentration by the mean direction; few rays look more alike than they are
  float most = min(length(across), 0.9);
  float spread = most * (2.0 - most * most) / (1.0 - most * most);
  vec3 along = seen - normal * (dot(normal, seen) / max(dot(normal, normal), 1e-30));
  float aside = length(along);
  // near the normal there is no azimuth
  spread *= min(aside / 0.3, 1.0);
  float cosine = dot(across, along) / max(length(across) * aside, 1e-30);
  // cosh over Bessel's I0: Olivares et al. 2018
  float square = spread * spread;
  float bessel = sqrt(sqrt(1.0 + 0.25 * square)) * (1.0 + 0.43023 * square) / (1.0 + 0.24273 * square);
  return 2.0 * exp(spread * (cosine - 1.0)) / (1.0 + exp(-2.0 * spread)) * bessel;
}

// mirrored: the direction that a mirror shows, frame of the sample
Arriving indirect_arriving(ivec2 sample_at, vec3 mirrored) {
  Near near = surfels_near(sample_at);
  vec3 seen;
  for (int k = 0; k < 3; ++k) seen[k] = dot(indirect.from_sample[k].xyz, mirrored);
  seen *= inversesqrt(max(dot(seen, seen), 1e-30));
  float mean = (near.irradiance.r + near.irradiance.g + near.irradiance.b) / 3.0;
  if (!(mean > 0.0)) return Arriving(near.irradiance, 0.0);
  float cosine = max(dot(near.normal, seen), 0.0);
  float square = cosine * cosine / max(dot(near.normal, near.normal), 1e-30);
  // radiances of bands, and linear between their middles
  vec4 bands = vec4(16.0, 16.0 / 3.0, 4.0, 2.0) *
               vec4(near.bands, max(mean - near.bands.x - near.bands.y - near.bands.z, 0.0)) / mean;
  float shown = bands.x;
  shown = mix(shown, bands.y, clamp((square - 1.0 / 32.0) * 8.0, 0.0, 1.0));
  shown = mix(shown, bands.z, clamp((square - 5.0 / 32.0) * (32.0 / 7.0), 0.0, 1.0));
  shown = mix(shown, bands.w, clamp((square - 0.375) * (8.0 / 3.0), 0.0, 1.0));
  shown = mix(shown, 1.0, kEven);
  return Arriving(near.irradiance, min(shown * side_ratio(near.across / mean, seen, near.normal), kMostRatio));
}

// What a surface sends of it to the viewer: as of a sky of even radiance.
WideLight indirect_sent(Surface s, ivec2 sample_at, vec3 to_viewer, vec3 normal) {
  WideLight light = WideLight(vec3(0.0), vec3(0.0), vec3(0.0));
  if (indirect.probes == 0) return light;
  Arriving arriving = indirect_arriving(sample_at, reflect(-to_viewer, normal));
  if (!(dot(normal, normal) > 0.0)) return light;
  light.irradiance = arriving.irradiance;
  float cosine = dot(normal, to_viewer);
  vec3 seen_from = to_viewer;
  if (cosine < 1e-3) {
    seen_from = normalize(to_viewer + normal * (1e-3 - cosine));
    cosine = dot(normal, seen_from);
  }
  vec3 radiance = arriving.ratio * 0.31830988618379067 * light.irradiance;
  WideLobe lobe = wide_lobe(s, cosine);
#ifdef COATED
  light.diffuse = coated_diffuse(s, normal, seen_from, normal) * light.irradiance;
  vec3 share = vec3(coat_is_apart(s) ? 0.0 : coat_first(s, cosine));
  if (lobe.share > 0.0 && !lobe_is_apart(s)) share += lobe.share * coated_reflection(s, cosine, cosine, cosine);
#else
  light.diffuse = bare_diffuse(s, normal, seen_from, normal) * light.irradiance;
  vec3 share = lobe.share > 0.0 && !lobe_is_apart(s) ? lobe.share * bare_reflection(s, cosine) : vec3(0.0);
#endif
  light.mirrored = share * radiance;
  return light;
}
