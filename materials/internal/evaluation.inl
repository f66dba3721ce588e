// Bodies of materials/brdf.h, included once for each precision inside its namespace.

Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint) {
  Surface s = surface_of(material);
  s.diffuse = s.diffuse * tint;
  return with_laws(material,
                   [&](auto pair) { return pair.surface_brdf(s, to_light, to_viewer, normal); });
}

Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint) {
  Surface s = surface_of(material);
  s.diffuse = s.diffuse * tint;
  return with_laws(material, [&](auto pair) {
    return pair.surface_radiance(s, to_light, to_viewer, normal, irradiance);
  });
}
