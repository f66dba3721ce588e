// Reflectance of surfels: the albedos of a model's materials, with textures. No OpenGL.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/math.h"
#include "trace/model.h"
#include "transport/surfels.h"

namespace panwright::transport {

// Directional albedo of a material, RGB: microfacets, coats and mirrors reflect as if diffuse.
class Reflectance {
 public:
  explicit Reflectance(const materials::Material& material);

  // Returns the albedo of light from one direction, of cosine mu.
  //
  //   tint  multiplies the diffuse colour
  Vec3 directional(double mu, const Vec3& tint) const;
  // Returns that of light from everywhere.
  Vec3 mean(const Vec3& tint) const { return black_mean_ + tint * (white_mean_ - black_mean_); }
  const Vec3& emitted() const { return emitted_; }  // radiosity, of white

  // Returns true for lobes or mirrors to speak of.
  bool is_glossy() const { return glossy_; }
  // Returns the part of directional() that lobes and mirrors reflect.
  Vec3 glossy(double mu) const;
  // Returns the radiance that lobes send of an irradiance of 1 on a plane across the light. They
  // are one lobe of GGX's, at least 0.2 wide, with the albedo of the material's own.
  //
  //   to_light, to_viewer, normal  unit; both above the horizon
  glm::vec3 lobe(const glm::vec3& to_light, const glm::vec3& to_viewer,
                 const glm::vec3& normal) const;

 private:
  static constexpr int kNodes = 6;
  std::array<Vec3, kNodes> black_{}, white_{};  // at mu² of the middle of sixths
  Vec3 black_mean_{0}, white_mean_{0};
  Vec3 emitted_{0};
  bool glossy_ = false;
  float slope2_ = 0;                        // of the lobe
  std::array<glm::vec3, kNodes> scales_{};  // of it
};

// Materials of a model.
class ModelReflectance {
 public:
  explicit ModelReflectance(const trace::Model& model);

  struct At {
    const Reflectance* reflectance = nullptr;
    Vec3 tint{1};
  };
  // Returns the surface at a point, decals and maps of roughness, reflectance and bumps left out.
  At at(const Point& point) const;

 private:
  struct Side {
    std::uint32_t material = 0;
    std::int32_t texture = -1, albedo = -1;
    bool colored = false;
  };
  const trace::Model& model_;
  std::vector<Reflectance> materials_;
  std::vector<std::array<Side, 2>> sides_;  // front and back, by part
};

}  // namespace panwright::transport
