// Light that other surfaces send, by surfels near a sample (light/surfels.h). Defined in front: wide_lobes.glsl with what it
// needs, sample_normal.glsl.

INDIRECT_BLOCK

// As light::irradiance_at().
const float kFacingScale = 1.0 / 0.7;
const float kAcross = 8.0;
#if defined(COATED) || defined(LOBE_ANY)
#define GLOSSY
#endif
// Of a fit's radiance to the mean one: it goes too far where light comes from one side.
const float kMostRatio = 4.0;

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

// The list of surfels near a place: first and count.
uvec2 surfel_list(vec3 at, vec3 normal) {
  vec3 cell = floor(at * indirect.cells_a_metre);
  if (any(lessThan(cell, vec3(0.0))) || any(greaterThanEqual(cell, vec3(65536.0)))) return uvec2(0u);
  uvec3 cube = uvec3(cell);
  uint xy = cube.x | cube.y << 16;
  uint zd = cube.z | axis_direction(normal) << 16;
  uint h = xy * 0x9E3779B1u ^ zd * 0x85EBCA77u;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  uint slot = (h ^ h >> 13) & indirect.last_slot;
  for (int probe = 0; probe < indirect.probes; ++probe) {
    uvec4 list = texelFetch(surfel_cells, int(slot));
    if (list.w == 0u) break;
    if (list.x == xy && list.y == zd) return list.zw;
    slot = (slot + 1u) & indirect.last_slot;
  }
  return uvec2(0u);
}

struct Arriving {
  vec3 irradiance;
  float ratio;  // of the radiance that a mirror shows to the mean one
};

// mirrored: the direction that a mirror shows, frame of the sample
Arriving indirect_arriving(ivec2 sample_at, vec3 mirrored) {
  uvec4 found = texelFetch(position_samples, sample_at, 0);
  vec4 place = vec4(uintBitsToFloat(found.xyz), 1.0);
  vec3 own_normal = unpacked_normal(found.w);
  vec3 at = vec3(dot(indirect.from_sample[0], place), dot(indirect.from_sample[1], place), dot(indirect.from_sample[2], place));
  vec3 normal = vec3(dot(indirect.from_sample[0].xyz, own_normal), dot(indirect.from_sample[1].xyz, own_normal),
                     dot(indirect.from_sample[2].xyz, own_normal));
  normal *= inversesqrt(max(dot(normal, normal), 1e-30));
  uvec2 list = surfel_list(at, normal);
  vec3 seen = vec3(dot(indirect.from_sample[0].xyz, mirrored), dot(indirect.from_sample[1].xyz, mirrored),
                   dot(indirect.from_sample[2].xyz, mirrored));
  vec4 shown = vec4(seen * inversesqrt(max(dot(seen, seen), 1e-30)), 1.0);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  float sum_shown = 0.0;
  for (uint i = list.x; i < list.x + list.y; ++i) {
    uvec4 entry = texelFetch(surfel_entries, int(i));
    vec4 sent = texelFetch(surfel_light, int(entry.w & 0xffffu) * 2);
    vec3 apart = uintBitsToFloat(entry.xyz) - at;
    vec3 its_normal = surfel_normal(entry.w >> 16);
    float across = dot(apart, its_normal);
    float left = max(1.0 - (dot(apart, apart) + kAcross * across * across) * sent.w * sent.w, 0.0);
    float facing = clamp(dot(normal, its_normal) * kFacingScale, 0.0, 1.0);
    float weight = left * left * facing * facing;
    sum += weight * sent.rgb;
    weights += weight;
#ifdef GLOSSY
    if (weight > 0.0)
      sum_shown += weight * max(dot(texelFetch(surfel_light, int(entry.w & 0xffffu) * 2 + 1), shown), 0.0);
#endif
  }
  float whole = (sum.r + sum.g + sum.b) / 3.0;
  return Arriving(weights > 0.0 ? sum / weights : vec3(0.0), whole > 0.0 ? min(sum_shown / whole, kMostRatio) : 0.0);
}

// What a surface sends of it to the viewer: as of a sky of even radiance.
WideLight indirect_sent(Surface s, ivec2 sample_at, vec3 to_viewer, vec3 normal) {
  WideLight light = WideLight(vec3(0.0), vec3(0.0), vec3(0.0));
  if (indirect.probes == 0 || !(dot(normal, normal) > 0.0)) return light;
  Arriving arriving = indirect_arriving(sample_at, reflect(-to_viewer, normal));
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
  vec3 share = vec3(coat_first(s, cosine));
  if (lobe.share > 0.0) share += lobe.share * coated_reflection(s, cosine, cosine, cosine);
#else
  light.diffuse = bare_diffuse(s, normal, seen_from, normal) * light.irradiance;
  vec3 share = lobe.share > 0.0 ? lobe.share * bare_reflection(s, cosine) : vec3(0.0);
#endif
  light.mirrored = share * radiance;
  return light;
}
