// A texture over the diffuse colour of what is seen; blended, so that the colour it leaves is
// colour·(1 − a) + texture. Only what is seen passes the depth test; of surfaces that coincide, the
// one that the geometry pass kept. Defined in front: version,
// uniforms.glsl, draw.glsl.
layout(location = 5) in vec3 decal_place;
layout(location = 6) in float decal_facing;

layout(location = kAlbedoLayer) out vec4 albedo;

void main() {
  vec2 size = vec2(textureSize(decal_map, 0));
  vec2 right = dFdx(decal_place.xy) * size;
  vec2 down = dFdy(decal_place.xy) * size;
  float level = 0.5 * log2(max(max(dot(right, right), dot(down, down)), 1e-30));
  vec2 at = clamp(decal_place.xy, vec2(0.0), vec2(1.0));
  albedo = textureLod(decal_map, at, max(level, 0.0));
  bool inside = at == decal_place.xy && abs(decal_place.z) <= 1.0 &&
                (gl_FrontFacing ? decal_facing : -decal_facing) > 0.0;
  bool own = (texelFetch(normal_samples, ivec2(gl_FragCoord.xy), 0).w & ~kTurns) == draw.id;
  if (!inside || !own) discard;
}
