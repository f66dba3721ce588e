// Where a sample stands in light space, and how its surface slopes there.
layout(location = 7) in vec3 light_space_position;
layout(location = kSunLayer) out uvec4 sun_sample;  // x, y, z as floats; the slopes of z along x and y

SHADOW_BLOCK

// The finest tile that holds a place. Where none does, nothing shades it: it is out of view.
vec3 place_in_tile(vec3 place) {
  vec3 found = shadow.tiles > 0 ? vec3(0.0, 0.0, 2.0) : place;
  for (int i = 0; i < shadow.tiles; ++i) {
    vec3 there = place * draw.tiles[i].w + draw.tiles[i].xyz;
    vec4 inside = shadow.inside[i];
    if (all(greaterThan(there, vec3(inside.xy, 0.0))) && all(lessThan(there, vec3(inside.zw, 1.0)))) {
      found = there;
      break;
    }
  }
  return found;
}

#ifndef FLAT
// Of meshes that stand for themselves: their shadows are those of their triangles, and what lies
// beyond an edge rises above the plane of a mean normal. Where the two agree, the mean normal stays.
vec3 normal_of_triangle(vec3 mean) {
  const float kApart = 0.01;  // sin of the angle; derivatives are right to 1e-3
  vec3 right = dFdx(light_space_position);
  vec3 up = dFdy(light_space_position);
  float size = kApart * length(mean);
  if (abs(dot(mean, right)) <= size * length(right) && abs(dot(mean, up)) <= size * length(up)) return mean;
  vec3 own = cross(right, up);
  return dot(own, mean) < 0.0 ? -own : own;
}
#endif

// outwards: of the mesh without bumps, in its frame, on the side that is seen. A faceted body of
// smooth normals is lit as what it stands for: the point is moved out past the chord error.
uvec4 light_space_sample(vec3 outwards) {
  float square = dot(outwards, outwards);
  vec3 normal_offset = square > 0.0 ? outwards * (draw.normal_offset * inversesqrt(square)) : vec3(0.0);
  vec3 place = light_space_position;
  for (int row = 0; row < 3; ++row) place[row] += dot(draw.sun_from_mesh[row].xyz, normal_offset);
  place = place_in_tile(place);
  vec3 normal = draw.sun_normal_from_mesh * outwards;
#ifndef FLAT
  if ((draw.flags & kOwnShape) != 0u) normal = normal_of_triangle(normal);
#endif
  vec2 slope = normal.z != 0.0 ? -normal.xy / normal.z : vec2(0.0);
  return uvec4(floatBitsToUint(place), packHalf2x16(clamp(slope, vec2(-6e4), vec2(6e4))));
}
