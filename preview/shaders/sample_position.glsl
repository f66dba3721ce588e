// Where a sample stands, and how its surface faces: what the light of any source needs. Defined in
// front: FLAT.
layout(location = 7) in vec3 place_in_target;  // world axes, from the origin of the target's samples
// xyz: the same as floats, moved out to the shape that the mesh stands for; w: the surface's own
// world normal without bumps, on the side that is seen, as a point of an octahedron
layout(location = kPositionLayer) out uvec4 position_sample;

#ifndef FLAT
// Of meshes that stand for themselves: their shadows are those of their triangles, and what lies
// beyond an edge rises above the plane of a mean normal. Where the two agree, the mean normal stays.
vec3 normal_of_triangle(vec3 mean) {
  const float kApart = 0.01;  // sin of the angle; derivatives are right to 1e-3
  vec3 right = dFdx(place_in_target);
  vec3 up = dFdy(place_in_target);
  float size = kApart * length(mean);
  if (abs(dot(mean, right)) <= size * length(right) && abs(dot(mean, up)) <= size * length(up)) return mean;
  vec3 own = cross(right, up);
  return dot(own, mean) < 0.0 ? -own : own;
}
#endif

// The octahedron |x| + |y| + |z| = 1, unfolded into a square; the reverse stands in sample_normal.glsl.
uint packed_normal(vec3 normal) {
  float sum = abs(normal.x) + abs(normal.y) + abs(normal.z);
  if (!(sum > 0.0)) return 0u;
  normal /= sum;
  vec2 upper = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(normal.xy, vec2(0.0)));
  return packSnorm2x16(normal.z >= 0.0 ? normal.xy : (1.0 - abs(normal.yx)) * upper);
}

// outwards: of the mesh without bumps, in its frame, on the side that is seen. A faceted body of
// smooth normals is lit as what it stands for: the point is moved out past the chord error.
uvec4 placed_sample(vec3 outwards) {
  float square = dot(outwards, outwards);
  vec3 offset = square > 0.0 ? outwards * (draw.normal_offset * inversesqrt(square)) : vec3(0.0);
  vec3 place = place_in_target;
  for (int row = 0; row < 3; ++row) place[row] += dot(draw.sample_from_mesh[row].xyz, offset);
  vec3 normal = draw.world_normal_from_mesh * outwards;
#ifndef FLAT
  if ((draw.flags & kOwnShape) != 0u) normal = normal_of_triangle(normal);
#endif
  return uvec4(floatBitsToUint(place), packed_normal(normal));
}
