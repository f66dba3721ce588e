// Light of planets, which is wide beside most lobes. Diffuse surfaces take it in parts, each an even disc; lobes
// by a table of its radiance (sky/shine_table.h), times what they reflect in all. Groups of parts, each with a
// shadow map, say what share of it other surfaces leave. Defined in front: SHADOWED (with shadow.glsl) or not, wide_lobes.glsl
// with what it needs.

PLANETS_BLOCK

vec3 planet_layer(vec2 place, float layer) { return textureLod(planet_light, vec3(place, layer), 0.0).rgb; }

// See packed_normal() in sample_position.glsl.
vec2 planet_place(vec3 direction) {
  vec3 at = direction / max(abs(direction.x) + abs(direction.y) + abs(direction.z), 1e-30);
  vec2 upper = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(at.xy, vec2(0.0)));
  vec2 square = at.z >= 0.0 ? at.xy : (1.0 - abs(at.yx)) * upper;
  float side = float(kPlanetTableSide);
  return ((0.5 * square + 0.5) * side + 1.0) / (side + 2.0);
}

// The radiance about a direction, blurred by a lobe. square: of its angles, along each axis
vec3 planet_radiance(vec3 direction, float square) {
  float width = sqrt(square);
  // kShineWidths
  float layer = width < 0.4 ? width * 5.0 : min(1.0 + width * 2.5, 3.0);
  float first = min(floor(layer), 2.0);
  vec2 place = planet_place(direction);
  return mix(planet_layer(place, first), planet_layer(place, first + 1.0), layer - first);
}

// Where wide lobes of microfacets have their middle: their horizon cuts what lies flat. Fitted to means over the
// lobes of GGX, 5 degrees.
vec3 planet_middle(vec3 mirror, vec3 normal, float slope, float cosine) {
  vec3 middle = mirror + normal * (1.25 * slope * sqrt(slope) / cosine);
  return middle * inversesqrt(max(dot(middle, middle), 1e-30));
}

#ifdef SHADOWED
// The share of a group's light that reaches a sample: all of it or nothing stands for its width. Depths of a
// texel's neighbours lie up to a texel's width off the sample's plane.
float planet_visibility(int group, vec3 at, vec3 normal) {
  vec4 map = planets.map[group];
  if (map.x < 0.0) return 1.0;
  vec4 row_x = planets.map_from_sample[3 * group];
  vec4 row_y = planets.map_from_sample[3 * group + 1];
  vec4 row_z = planets.map_from_sample[3 * group + 2];
  vec3 place = vec3(dot(row_x, vec4(at, 1.0)), dot(row_y, vec4(at, 1.0)), dot(row_z, vec4(at, 1.0)));
  vec3 facing = vec3(dot(row_x.xyz, normal), dot(row_y.xyz, normal), dot(row_z.xyz, normal));
  // change of the depth from texel to texel
  const float kSteepest = 4.0;
  float steepest = kSteepest * map.y;
  vec2 slope = facing.z != 0.0 ? clamp(-map.z * facing.xy / (facing.z * planets.half_map), -steepest, steepest)
                               : vec2(0.0);
  vec2 on_map = clamp((place.xy + 1.0) * planets.half_map - 0.5, vec2(0.0), vec2(2.0 * planets.half_map - 1.001));
  vec2 first = floor(on_map);
  vec2 share = on_map - first;
  // texels here: below left, below right, above right, above left
  vec4 depth = textureGather(planet_depths, vec3((first + 1.0) * planets.texel_size, map.x));
  vec4 plane = place.z + slope.x * (vec4(0.0, 1.0, 1.0, 0.0) - share.x) + slope.y * (vec4(1.0, 1.0, 0.0, 0.0) - share.y);
  vec4 hidden = clamp((depth - plane) / map.y - 1.0, 0.0, 1.0);
  vec2 rows = mix(hidden.wx, hidden.zy, share.x);
  return 1.0 - mix(rows.x, rows.y, share.y);
}
#endif

// Mean cosine of a disc of a radius, which the horizon may cut: see to_mean_light() in shading.frag.
float planet_cosine(float cosine, float radius) {
  float t = cosine / radius;
  float square = t * t;
  float mean = 0.5 * t + 0.212227 + square * (0.317672 - square * (0.0236467 + square * 0.00623719));
  return square < 1.0 ? max(mean, 0.0) * radius : max(cosine, 0.0);
}

#ifdef SHADOWED
// Light that a plate lacks, as a shadow lies on the ground before it: a disc, exactly for plates along the ground.
vec3 ground_shadow(int number, vec3 at, vec3 normal) {
  vec4 place = planets.shadow_place[number];
  vec3 way = place.xyz - at;
  float square = dot(way, way);
  float shorter = inversesqrt(max(square, 1e-30));
  vec3 toward = way * shorter;
  float height = max(-dot(planets.shadow_normal[number].xyz, way), 0.0);
  float sum = square + place.w;
  float root = sqrt(max(sum * sum - 4.0 * place.w * (square - height * height), 1e-30));
  float share = 2.0 * place.w * height / max(shorter * root * (root + square - place.w), 1e-30);
  share = min(share, 1.0);
  return share * planet_cosine(dot(normal, toward), sqrt(max(share, 1e-12))) * planets.shadow_light[number].rgb;
}
#endif

// Of a plate with a normal, and of a lobe about the direction of a mirror.
struct PlanetSums {
  vec3 irradiance;
  vec3 middle;     // where it comes from, any length
  float mirrored;  // share of what the lobe sees that arrives
};
PlanetSums planet_sums(ivec2 sample_at, vec3 normal, vec3 mirror) {
  PlanetSums sums = PlanetSums(vec3(0.0), 1e-6 * normal, 0.0);
  float all = 1e-30;
#ifdef SHADOWED
  uvec4 found = texelFetch(position_samples, sample_at, 0);
  vec3 at = uintBitsToFloat(found.xyz);
  vec3 own_normal = unpacked_normal(found.w);
#endif
  int part = 0;
#ifdef SHADOWED
  int shadow = 0;
  vec3 dark = vec3(0.0);
#endif
  for (int group = 0; group < planets.groups; ++group) {
    vec4 disc = planets.group[group];
    float visible = 1.0;
#ifdef SHADOWED
    // the map looks along the group's middle: surfaces whose horizon cuts it there would shade themselves
    float above = clamp(3.0 * dot(normal, disc.xyz) / disc.w, 0.0, 1.0);
    if (above > 0.0) visible = mix(1.0, planet_visibility(group, at, own_normal), above);
#endif
    vec4 members = planets.members[group];
    float near = 0.5 + 0.5 * dot(mirror, disc.xyz);
    near *= near;
    near *= near;
    near *= near;
    float weight = members.x * near * near;
    all += weight;
    sums.mirrored += weight * visible;
    for (; part < int(members.y); ++part) {
      vec4 its_disc = planets.part[part];
      float lit = planet_cosine(dot(normal, its_disc.xyz), its_disc.w);
      vec3 arriving = lit * visible * planets.irradiance[part].rgb;
      sums.irradiance += arriving;
      sums.middle += (arriving.r + arriving.g + arriving.b) * its_disc.xyz;
    }
#ifdef SHADOWED
    for (; shadow < int(members.z); ++shadow) dark += visible * ground_shadow(shadow, at, normal);
#endif
  }
#ifdef SHADOWED
  sums.irradiance = max(sums.irradiance - dark, vec3(0.0));
#endif
  sums.mirrored /= all;
  return sums;
}

WideLight planet_sent(Surface s, ivec2 sample_at, vec3 to_viewer, vec3 normal) {
  WideLight light = WideLight(vec3(0.0), vec3(0.0), vec3(0.0));
  if (planets.groups == 0 || !(dot(normal, normal) > 0.0)) return light;
  float cosine = dot(normal, to_viewer);
  vec3 seen_from = to_viewer;
  if (cosine < 1e-3) {
    seen_from = normalize(to_viewer + normal * (1e-3 - cosine));
    cosine = dot(normal, seen_from);
  }
  vec3 mirror = 2.0 * cosine * normal - seen_from;
  PlanetSums sums = planet_sums(sample_at, normal, mirror);
  vec3 middle = sums.middle * inversesqrt(dot(sums.middle, sums.middle));
  light.irradiance = sums.irradiance;
  float bumps = 0.5 * (max(s.bump_x, 0.0) + max(s.bump_y, 0.0));
  bumps *= 1.0 + cosine * cosine;
  WideLobe lobe = wide_lobe(s, cosine);
#ifdef COATED
  light.diffuse = coated_diffuse(s, middle, seen_from, normal);
  if (!coat_is_apart(s))
    light.mirrored = coat_first(s, cosine) *
                   planet_radiance(planet_middle(mirror, normal, 0.5 * s.coat_alpha, cosine),
                                   s.coat_alpha * s.coat_alpha * (1.0 + cosine * cosine) + bumps);
  vec3 share = lobe.share > 0.0 && !lobe_is_apart(s) ? lobe.share * coated_reflection(s, cosine, cosine, cosine) : vec3(0.0);
#else
  light.diffuse = bare_diffuse(s, middle, seen_from, normal);
  vec3 share = lobe.share > 0.0 && !lobe_is_apart(s) ? lobe.share * bare_reflection(s, cosine) : vec3(0.0);
#endif
#if defined(LOBE_RETURNS)
  light.mirrored += share * planet_radiance(seen_from, lobe.square);
#elif defined(LOBE_ANY)
  light.mirrored += share * planet_radiance(planet_middle(mirror, normal, lobe.slope, cosine), lobe.square + bumps);
#endif
  light.mirrored *= sums.mirrored;
  light.diffuse *= light.irradiance;
  return light;
}
