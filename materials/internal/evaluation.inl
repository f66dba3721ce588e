// Bodies of materials/brdf.h, included once for each precision inside its namespace.

Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint, const Local& local) {
  SurfaceFields s = surface_of(material, rounded(local.tangent), static_cast<Real>(local.sun_alpha2));
  s.diffuse = s.diffuse * tint;
  return composition_of(material).surface_brdf(s, to_light, to_viewer, normal);
}

Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint, const Local& local) {
  SurfaceFields s = surface_of(material, rounded(local.tangent), static_cast<Real>(local.sun_alpha2));
  s.diffuse = s.diffuse * tint;
  return composition_of(material).surface_radiance(s, to_light, to_viewer, normal, irradiance);
}
