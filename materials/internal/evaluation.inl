// Bodies of materials/brdf.h, included once for each precision inside its namespace.

inline IncidenceFields rounded(const materials::Incidence& light) {
  return {rounded(light.to_light), rounded(light.irradiance), real(light.alpha2), real(light.limb)};
}

// The place of a surface: what it has beside its material's parameters.
inline void place(SurfaceFields& s, const Vec3& tint, const ShadingContext& local) {
  s.tangent = rounded(local.tangent);
  s.diffuse = s.diffuse * tint;
  if (local.reflectance) s.reflectance = rounded(*local.reflectance);
}

Vec3 brdf(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
          const Vec3& normal, const Vec3& tint, const ShadingContext& local) {
  SurfaceFields s = surface_of(material);
  place(s, tint, local);
  return composition_of(material).surface_brdf(s, rounded(light), to_viewer, normal);
}

Vec3 radiance(const Material& material, const materials::Incidence& light, const Vec3& to_viewer,
              const Vec3& normal, const Vec3& tint, const ShadingContext& local) {
  SurfaceFields s = surface_of(material);
  place(s, tint, local);
  return composition_of(material).surface_radiance(s, rounded(light), to_viewer, normal);
}

Vec3 emission(const Material& material, const Vec3& white) {
  return surface_emission(surface_of(material), white);
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

Vec3 CompiledBrdf::brdf(const materials::Incidence& light, const Vec3& to_viewer,
                        const Vec3& normal, const Vec3& tint, const ShadingContext& local) const {
  SurfaceFields s = parts_->surface;
  place(s, tint, local);
  Composition composition = parts_->composition;
  return composition.surface_brdf(s, rounded(light), to_viewer, normal);
}
