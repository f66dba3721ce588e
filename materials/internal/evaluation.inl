// Bodies of materials/brdf.h, included once for each precision inside its namespace.

Vec3 brdf(const Material& material, const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
          const Vec3& tint, const ShadingContext& local) {
  SurfaceFields s =
      surface_of(material, rounded(local.tangent), static_cast<Real>(local.sun_alpha2),
                 static_cast<Real>(local.sun_limb));
  s.diffuse = s.diffuse * tint;
  if (local.reflectance) s.reflectance = rounded(*local.reflectance);
  return composition_of(material).surface_brdf(s, to_light, to_viewer, normal);
}

Vec3 radiance(const Material& material, const Vec3& to_light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& irradiance, const Vec3& tint, const ShadingContext& local) {
  SurfaceFields s =
      surface_of(material, rounded(local.tangent), static_cast<Real>(local.sun_alpha2),
                 static_cast<Real>(local.sun_limb));
  s.diffuse = s.diffuse * tint;
  if (local.reflectance) s.reflectance = rounded(*local.reflectance);
  return composition_of(material).surface_radiance(s, to_light, to_viewer, normal, irradiance);
}

struct CompiledBrdf::Parts {
  SurfaceFields surface;
  Composition composition;
};

CompiledBrdf::CompiledBrdf(const Material& material)
    : parts_(std::make_unique<const Parts>(Parts{surface_of(material), composition_of(material)})) {
}
CompiledBrdf::~CompiledBrdf() = default;
CompiledBrdf::CompiledBrdf(CompiledBrdf&&) noexcept = default;
CompiledBrdf& CompiledBrdf::operator=(CompiledBrdf&&) noexcept = default;

Vec3 CompiledBrdf::brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
                    const Vec3& tint, const ShadingContext& local) const {
  SurfaceFields s = parts_->surface;
  s.tangent = rounded(local.tangent);
  s.sun_alpha2 = static_cast<Real>(local.sun_alpha2);
  s.sun_limb = static_cast<Real>(local.sun_limb);
  s.diffuse = s.diffuse * tint;
  if (local.reflectance) s.reflectance = rounded(*local.reflectance);
  Composition composition = parts_->composition;
  return composition.surface_brdf(s, to_light, to_viewer, normal);
}
