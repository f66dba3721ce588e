// How much of a light a sample sees, from the shadow map around it. Defined in front: sample_normal.glsl.
#ifdef ADDED
LAMPS_BLOCK
#define SHADOW_MAP lamps
#else
LIGHT_BLOCK
#define SHADOW_MAP light
#endif

// Room for what is rounded: 16 roundings of a depth near 1, and how far across a point may be off,
// in texels (a context's grid for vertices and half floats for slopes come to 1/100)
const float kDepthSlack = 1e-6;
const float kTexelSlack = 1.0 / 16.0;
// Relief finer than texels: each stands for what is lower or higher within it by up to so many texels,
// or by twice what the two planes come apart over a texel. Without, valleys would lie in the shadow of
// their own slopes (0.1 to 0.9 % of a spacecraft in foil); contacts leak by no more than this. Of parallel
// planes the upper one is another surface, as a panel's: an eighth of a texel holds what is rounded.
const float kRelief = 0.7;
const float kReliefOfSlopes = 2.0;
const float kReliefOfPlanes = 0.125;
// A surface is followed down its slope by no more than so many texels: behind a wall that the Sun
// grazes lies something else.
const float kMostDown = 16.0;
// Of cosines of packed normals
const float kNormalSlack = 1e-4;

// x, from 0 to 1: the share of the four texels around a sample that do not hide it, weighted by how near
// they are. Whether one does: the texel and the sample are planes here; the texel's must lie above the
// sample, and the texel above the sample's. Along an edge one of the two fails, whichever way it bends,
// so no bias is needed that grows with the slope. y: the same if relief of parallel planes may be as deep
// as other relief: between the two lies the truth of what is finer than texels.
vec2 point_visibility(int layer, vec3 place, vec2 slope, float texel_depth, float slack) {
  vec2 half_size = SHADOW_MAP.half_map;
  vec2 at = clamp((place.xy + 1.0) * half_size - 0.5, vec2(0.0), 2.0 * half_size - 1.001);
  vec2 first = floor(at);
  vec2 share = at - first;
  // between the four, far from where rounding would take others
  vec3 among = vec3((first + 1.0) * SHADOW_MAP.texel_size, float(layer));
  // texels here: below left, below right, above right, above left
  vec4 depth = textureGather(shadow_depths, among);
  vec4 its_slope_x = textureGather(shadow_slopes, among, 0);
  vec4 its_slope_y = textureGather(shadow_slopes, among, 1);
  vec4 step_x = (first.x + vec4(0.5, 1.5, 1.5, 0.5)) / half_size.x - 1.0 - place.x;
  vec4 step_y = (first.y + vec4(1.5, 1.5, 0.5, 0.5)) / half_size.y - 1.0 - place.y;
  vec2 reach = kTexelSlack / half_size;
  // how far the planes come apart over a texel
  vec4 apart = abs(its_slope_x - slope.x) / half_size.x + abs(its_slope_y - slope.y) / half_size.y;
  float most = kRelief * texel_depth;
  vec4 relief = min(kReliefOfPlanes * texel_depth + kReliefOfSlopes * apart, vec4(most));
  // by how much the texel lies above the sample's plane, and its plane above the sample
  vec4 above = depth - (place.z + (slope.x * step_x + slope.y * step_y) + (slack + dot(abs(slope), reach)));
  vec4 down = min(its_slope_x * step_x + its_slope_y * step_y, vec4(kMostDown * texel_depth));
  vec4 below = depth - down - (place.z + slack + (abs(its_slope_x) * reach.x + abs(its_slope_y) * reach.y));
  vec4 height = min(above, below);
  // note: where nothing was drawn, depth 0, slopes are those of another map
  bvec4 drawn = greaterThan(depth, vec4(0.0));
  bvec4 full = greaterThanEqual(depth, vec4(1.0));
  vec4 seen;
  vec4 at_most;
  for (int i = 0; i < 4; ++i) {
    bool hidden = full[i] && place.z <= 1.0;
    seen[i] = hidden || (!full[i] && drawn[i] && height[i] > relief[i]) ? 0.0 : 1.0;
    at_most[i] = hidden || (!full[i] && drawn[i] && height[i] > most) ? 0.0 : 1.0;
  }
  // note: a + (b - a)·t is exactly 1 where all four are
  vec4 rows = vec4(seen.wx, at_most.wx) + (vec4(seen.zy, at_most.zy) - vec4(seen.wx, at_most.wx)) * share.x;
  return rows.xz + (rows.yw - rows.xz) * share.y;
}

// How the depth of a plane changes along x and y of a map.
vec2 slope_of(vec4 plane_x, vec4 plane_y, vec4 plane_z, vec3 at, vec3 normal) {
  vec4 plane = vec4(normal, -dot(normal, at));
  vec3 across = vec3(dot(plane_x, plane), dot(plane_y, plane), dot(plane_z, plane));
  return across.z != 0.0 ? clamp(-across.xy / across.z, vec2(-6e4), vec2(6e4)) : vec2(0.0);
}

#ifdef ADDED
// As point_visibility(), of a place on a light after the Sun.
vec2 map_visibility(int map, bool around, vec3 at, vec3 normal) {
  if (around) {
    vec3 away = at - lamps.eye[map].xyz;
    vec3 size = abs(away);
    int axis = size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    map += 2 * axis + (away[axis] < 0.0 ? 1 : 0);
  }
  vec4 on_map = lamps.map_from_sample[map] * vec4(at, 1.0);
  float texel_depth = lamps.texel_depth[map].x;
  if (!(texel_depth > 0.0) || !(on_map.w > 0.0)) return vec2(1.0);
  vec2 slope = slope_of(lamps.map_plane_from_sample[3 * map], lamps.map_plane_from_sample[3 * map + 1],
                        lamps.map_plane_from_sample[3 * map + 2], at, normal);
  vec3 place = on_map.xyz / on_map.w;
  float slack = kDepthSlack * min(place.z + lamps.texel_depth[map].z, 1.0);
  return point_visibility(int(lamps.texel_depth[map].y), place, slope, texel_depth / on_map.w, slack);
}

// Of a light after the Sun, as light_visibility(). One point: all of it or nothing stands for its disc; above: how
// much of that the horizon leaves to the map.
vec2 lamp_visibility(int lamp, ivec2 sample_at, vec3 at, vec3 normal, vec3 to_middle, float radius, float above) {
  vec4 kind = lamps.kind[lamp];
  if (dot(normal, to_middle) < -radius - kNormalSlack) return vec2(0.0);
  if (kind.y < 0.0) return vec2(1.0);
#ifndef POINTS
  int points = int(abs(kind.z));
  if (points > 1) {
    vec2 seen = vec2(0.0);
    float sum = 0.0;
    bool in_parts = points >= 8 && (sample_blocks.x & 3u) == 0u;
    ivec2 turned = (sample_at >> 1) ^ sample_at.yx;
    int first = in_parts ? (turned.x & 1) + 2 * (turned.y & 1) : 0;
    for (int k = first; k < points; k += in_parts ? 4 : 1) {
      int map = int(kind.y) + (kind.z < 0.0 ? 6 : 1) * k;
      float brought = dot(normal, lamps.eye[map].xyz - at);
      if (brought <= 0.0) continue;
      seen += brought * map_visibility(map, kind.z < 0.0, at, normal);
      sum += brought;
    }
    return sum > 0.0 ? seen / sum : vec2(0.0);
  }
#endif
  vec2 visible = map_visibility(int(kind.y), kind.z < 0.0, at, normal);
  return above < 1.0 ? mix(vec2(1.0), visible, above) : visible;
}
#else
// The finest tile that holds a place. Where none does, nothing shades it: it is out of view.
bool find_tile(inout vec3 place) {
  for (int i = 0; i < light.tiles; ++i) {
    vec3 there = place * light.tile_place[i].w + light.tile_place[i].xyz;
    vec4 inside = light.tile_inside[i];
    if (all(greaterThan(there, vec3(inside.xy, 0.0))) && all(lessThan(there, vec3(inside.zw, 1.0)))) {
      place = there;
      return true;
    }
  }
  return light.tiles == 0;
}

// The mean over the points of the light's disc that stand above the surface's horizon, by the light that they
// bring: each looks along a direction of its own. In light space sheared by it rays to that point run
// along z. to_middle, radius: of the disc. Of N×N samples, N a multiple of four, each takes one of four parts
// of the disc: all four fall in each quarter of a pixel and on each of its rows.
vec2 light_visibility(ivec2 sample_at, vec3 to_middle, float radius) {
  uvec4 found = texelFetch(position_samples, sample_at, 0);
  vec3 at = uintBitsToFloat(found.xyz);
  vec3 normal = unpacked_normal(found.w);
  // the horizon is the surface's own: a mean normal may face the light where its triangle does not
  float cosine = dot(normal, to_middle);
  if (cosine < -radius - kNormalSlack) return vec2(0.0);
  bool below = cosine < 0.0;
  vec4 on_map = light.map_from_sample * vec4(at, 1.0);
  vec3 place = on_map.xyz / on_map.w;
  float texel_depth = light.texel_depth / on_map.w;
  bool held = find_tile(place);
  vec2 slope = slope_of(light.map_plane_from_sample[0], light.map_plane_from_sample[1], light.map_plane_from_sample[2],
                        at, normal);
  vec2 seen = vec2(0.0);
  float sum = 0.0;
  bool in_parts = light.points >= 8 && (sample_blocks.x & 3u) == 0u;
  ivec2 turned = (sample_at >> 1) ^ sample_at.yx;
  int first = in_parts ? (turned.x & 1) + 2 * (turned.y & 1) : 0;
  for (int k = first; k < light.points; k += in_parts ? 4 : 1) {
    vec4 pair = light.disc[k >> 1];
    vec2 shear = (k & 1) == 0 ? pair.xy : pair.zw;
    // the cosine to this point, in parts of that to the centre
    float facing = 1.0 - dot(slope, shear);
    // one point stands for all
    float brought = below && light.points > 1 ? -facing : facing;
    if (brought <= 0.0) continue;
    vec3 there = vec3(place.xy - shear * (place.z - 0.5), place.z);
    seen += brought * (held ? point_visibility(k, there, slope / facing, texel_depth, kDepthSlack) : vec2(1.0));
    sum += brought;
  }
  return sum > 0.0 ? seen / sum : vec2(0.0);
}
#endif
