// What is seen at a sample: its normal, its instance, its colour. Light comes later, once for each
// sample and not once for each of the many fragments that small triangles throw away. Defined in
// front: version, uniforms.glsl, draw.glsl, any of PAINTED ROUGH BRUSHED (the layers there are), TEXTURED COLOURED
// FLAT, ALBEDO_MAP BUMPED ROUGHNESS_MAP REFLECTANCE_MAP (MAPPED with each of these), TANGENTS (BUMPED has them, and
// BRUSHED), CELLS
// with its formulas, CUTOUT with cutout.glsl, CURVED with turning.glsl (BRUSHED is defined then), and PLACED with sample_position.glsl.

#ifndef FLAT
layout(location = 0) in vec3 mesh_normal;
#endif
#ifdef TEXTURED
layout(location = 1) in vec2 surface_texcoord;
#endif
#ifdef COLOURED
layout(location = 2) in vec3 surface_color;
#endif
#if defined(MAPPED) && !defined(CUTOUT)
layout(location = 3) in vec2 map_texcoord;
#endif
#ifdef TANGENTS
layout(location = 4) in vec4 mesh_tangent;
#endif
#ifdef CELLS
layout(location = 9) in vec2 cell_place;  // in pitches
#endif

// xyz: world normal of any length, on the side that is seen (where it turns: as long as the squared slope of the narrowest
// lobe), as floats; w: item + 1, and kTurns
layout(location = kNormalLayer) out uvec4 normal_sample;
#ifdef PAINTED
layout(location = kAlbedoLayer) out vec4 albedo;  // diffuse colour; a: length of the mean normal
#endif
#ifdef ROUGH
// factor of the roughness; squared slope of unseen bumps along the brush, 0: there are none; of a normal that turns from
// sample to sample, by how much (turning.glsl); share of
// cells with their fingers, and in these of cells without
layout(location = kRoughnessLayer) out vec4 roughness_sample;
#endif
#ifdef BRUSHED
// world direction along the tangent, of any length; where there are unseen bumps its length is their
// squared slope across the brush, and w what their slopes along and across have in common
layout(location = kTangentLayer) out vec4 brush;
#endif
#ifdef REFLECTANCE_MAP
layout(location = kReflectanceLayer) out vec4 reflectance;  // RGB; what has no map is not asked
#endif

#ifdef CUTOUT
// Textures of surfaces with holes are premultiplied: what colour a hole has counts nowhere.
vec3 color_of(vec4 texel) { return texel.a > 0.0 ? texel.rgb / texel.a : texel.rgb; }
#else
vec3 color_of(vec4 texel) { return texel.rgb; }
#endif

#if defined(BUMPED) || defined(CURVED)
vec3 unit_or_zero(vec3 v) {
  float square = dot(v, v);
  return square > 0.0 ? v * inversesqrt(square) : vec3(0.0);
}
#endif

#ifdef CURVED
// How far the unit normal turns from sample to sample: squares xx, xy, yy along two axes of the surface.
// turning, falling: its change to the right and down
vec3 turned_squares(vec3 turning, vec3 falling, vec3 along, vec3 across) {
  vec2 a = vec2(dot(turning, along), dot(turning, across));
  vec2 b = vec2(dot(falling, along), dot(falling, across));
  return vec3(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
}
#endif

#ifdef BUMPED
// The bumps are the mesh's: an instance mirrors and stretches them with it. Columns: along u, along v,
// outwards.
mat3 bump_frame(vec3 normal) {
  vec3 outwards = unit_or_zero(normal);
  vec3 along = unit_or_zero(mesh_tangent.xyz - outwards * dot(outwards, mesh_tangent.xyz));
  vec3 across = cross(outwards, along) * (mesh_tangent.w < 0.0 ? -1.0 : 1.0);
  return mat3(along, across, outwards);
}

// What squared slopes xx, xy, yy of the map are along a world direction in the surface, and across it.
// normal: world, what becomes of a mean normal of that height
vec3 world_slopes(vec3 slopes, mat3 frame, vec3 normal, float height, vec3 along, vec3 across) {
  // a slope moves a normal of height 1 by as much
  float scale = height * inversesqrt(max(dot(normal, normal), 1e-30));
  vec3 of_u = scale * (draw.world_normal_from_mesh * frame[0]);
  vec3 of_v = scale * (draw.world_normal_from_mesh * frame[1]);
  vec2 u = vec2(dot(of_u, along), dot(of_u, across));
  vec2 v = vec2(dot(of_v, along), dot(of_v, across));
  // never below 0, whatever rounding does
  float both = sqrt(slopes.x * slopes.z);
  float xy = clamp(slopes.y, -both, both);
  return vec3(slopes.x * u.x * u.x + 2.0 * xy * u.x * v.x + slopes.z * v.x * v.x,
              slopes.x * u.x * u.y + xy * (u.x * v.y + u.y * v.x) + slopes.z * v.x * v.y,
              slopes.x * u.y * u.y + 2.0 * xy * u.y * v.y + slopes.z * v.y * v.y);
}
#endif

void main() {
#ifdef FLAT
  vec3 normal = texelFetch(triangle_normals, gl_PrimitiveID).xyz;
#else
  // a linear map may come after the interpolation, where several threads share the work
  vec3 normal = mesh_normal;
#endif
#ifdef PLACED
  position_sample = placed_sample(gl_FrontFacing ? normal : -normal);
#endif
  float length_of_mean = 1.0;
  vec2 roughness = vec2(1.0, 0.0);
  vec3 shares = vec3(1.0, 0.0, 0.0);
#ifdef BUMPED
  vec4 bump = texture(normal_map, map_texcoord);
  bool turned_u = (draw.flags & kBumpsTurnedU) != 0u;
  bool turned_v = (draw.flags & kBumpsTurnedV) != 0u;
  if (turned_u) bump.x = -bump.x;
  if (turned_v) bump.y = -bump.y;
  mat3 frame = bump_frame(normal);
  normal = frame * bump.xyz;
  length_of_mean = min(length(bump.xyz), 1.0);
#endif
#ifdef ROUGHNESS_MAP
  roughness.x = texture(roughness_map, map_texcoord).r;
#endif
#ifdef BRUSHED
  // along u, or around z where there are no texture coordinates. A cross product of what normals
  // become turns with the instance as tangents do, whatever stretches it.
#ifdef TANGENTS
  vec3 across = cross(normal, mesh_tangent.xyz);
#else
  vec3 across = cross(normal, vec3(-normal.y, normal.x, 0.0));
#endif
  vec3 along = cross(draw.world_normal_from_mesh * across, draw.world_normal_from_mesh * normal);
  brush = vec4(determinant(draw.world_normal_from_mesh) < 0.0 ? -along : along, 0.0);
#endif
#ifdef CURVED
  vec3 smooth_normal = unit_or_zero(draw.world_normal_from_mesh * mesh_normal);
#endif
  normal = draw.world_normal_from_mesh * normal;
  // the back of an open mesh is as good as its front
  vec3 seen_normal = gl_FrontFacing ? normal : -normal;
  uint id = draw.id;
#if defined(BUMPED) || defined(CURVED)
  vec3 facing = unit_or_zero(seen_normal);
  vec3 direction = unit_or_zero(brush.xyz - facing * (dot(facing, brush.xyz) / max(dot(facing, facing), 1e-30)));
  vec3 slopes = vec3(0.0);
#ifdef BUMPED
  vec2 squares = texture(slope_map, map_texcoord).rg;
  if (squares.x + squares.y > 0.0)
    slopes = max(world_slopes(vec3(squares.x, turned_u == turned_v ? bump.a : -bump.a, squares.y), frame, normal,
                              bump.z, direction, cross(facing, direction)), vec3(1e-12, -1e30, 1e-12));
#endif
#ifdef CURVED
  // an axis of the surface, where nothing brushes it
  if (dot(direction, direction) == 0.0)
    direction = unit_or_zero(cross(facing, abs(facing.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  vec3 turned = kTurningSlopes *
                turned_squares(dFdx(smooth_normal), dFdy(smooth_normal), direction, cross(facing, direction));
  float lobe = max(narrowest_lobe.x * roughness.x * roughness.x, min(narrowest_lobe.x, 1e-8)) + narrowest_lobe.y;
  // note: lobes over bumps are wide by them
  if (!(slopes.x > 0.0) && kMostTurning * (turned.x + turned.z) > lobe) {
    roughness.y = max(turned.x, 1e-12);
    brush = vec4(direction * max(turned.z, 1e-12), turned.y);
    seen_normal = facing * lobe;
    id |= kTurns;
  }
#endif
  if (slopes.x > 0.0) {
    roughness.y = slopes.x;
    brush = vec4(direction * slopes.z, slopes.y);
  }
#endif
  normal_sample = uvec4(floatBitsToUint(seen_normal), id);
#ifdef PAINTED
  vec3 color = vec3(1.0);
#ifdef TEXTURED
  color *= color_of(texture(diffuse_map, surface_texcoord));
#endif
#ifdef ALBEDO_MAP
  color *= color_of(texture(albedo_map, map_texcoord));
#endif
#ifdef COLOURED
  color *= surface_color;
#endif
  color *= draw.diffuse;
#ifdef CELLS
  // The footprint is a parallelogram: so many parts along each side, and for each the box of its
  // variances along u and v.
  vec2 right = dFdx(cell_place);
  vec2 down = dFdy(cell_place);
  int parts = int(view.cell_parts);
  float step = 1.0 / view.cell_parts;
  vec2 size = sqrt(right * right + down * down) * step;
  shares = vec3(0.0);
  for (int y = 0; y < parts; ++y)
    for (int x = 0; x < parts; ++x) {
      vec2 at = cell_place + ((float(x) + 0.5) * step - 0.5) * right + ((float(y) + 0.5) * step - 0.5) * down;
      shares += cell_shares(at.x, at.y, size.x, size.y, draw.cell_gaps.x, draw.cell_gaps.y, draw.fingers,
                            draw.finger_width);
    }
  shares *= step * step;
  // light goes back and forth between each part and the glass: c/(1 - c r) is what is mixed
  vec3 back = draw.coat_return;
  vec3 cell = color / max(1.0 - min(color, vec3(1.0)) * back, vec3(1e-10));
  vec3 line = draw.finger_color;
  line = line / max(1.0 - min(line, vec3(1.0)) * back, vec3(1e-10));
  color = (shares.x * cell + shares.y * line) / max(1.0 - shares.z, 1e-20);
  color = color / (1.0 + color * back);
#endif
  albedo = vec4(color, length_of_mean);
#endif
#ifdef ROUGH
  roughness_sample = vec4(roughness, 1.0 - shares.z, shares.x / max(1.0 - shares.z, 1e-20));
#endif
#ifdef REFLECTANCE_MAP
  reflectance = vec4(color_of(texture(reflectance_map, map_texcoord)), 1.0);
#endif
#ifdef CUTOUT
  if (!is_there()) discard;
#endif
}
